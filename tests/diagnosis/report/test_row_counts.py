"""Counts of readings, in words: what is not fitted is counted and listed, and a list that is cut says so."""

from __future__ import annotations

import numpy as np

from diagnosis import diagnose
from diagnosis.report.row_counts import diagnosed_rows, explained_rows, left_out_words, rejected_words
from tests.diagnosis.report.test_console import an_answer
from twin.chain import Chain
from twin.motion import Motion


def test_rows_that_no_fit_is_made_of_are_listed_and_a_cut_list_says_so() -> None:
    sweep = an_answer()["sweep"]
    assert explained_rows(sweep) == "2 rejected (rows 411, 1207: time_s missing or not finite); 2878 fitted"
    sweep |= {"rejected": 0, "rejected_rows": {}, "wild": 113, "wild_rows": list(range(1, 101)), "fitted": 2767}
    assert explained_rows(sweep) == "113 stand alone (rows 1, 2, 3, 4, 5 and 108 more); 2767 fitted"
    sweep |= {"wild": 1, "wild_rows": [17], "touched": 4, "direction_in_doubt": 2, "fitted": 2873}
    assert explained_rows(sweep) == (
        "1 stands alone (row 17), 4 touched by a cause of single readings, 2 of a direction in doubt; 2873 fitted"
    )
    sweep |= {"wild": 0, "touched": 0, "direction_in_doubt": 0, "rejected": 130, "rejected_rows_left_out": 30}
    sweep |= {"rejected_rows": {str(row): "vx missing" for row in range(1, 101)}, "fitted": 2750}
    assert (
        explained_rows(sweep) == "130 rejected (rows 1, 2, 3, 4, 5 and 95 more: vx missing; and 30 more); 2750 fitted"
    )
    sweep |= {"rejected": 0, "fitted": 2880}
    assert explained_rows(sweep) == "all fitted"
    assert explained_rows({**sweep, "set_aside": 20_000}) == "all of them fitted"


def test_counts_of_a_diagnosed_sweep_add_up() -> None:
    motion = Motion.from_angle(np.radians(np.arange(0.0, 360.0, 3.0)))
    made = Chain().with_effect("noise", rms_deg=0.02).simulate(motion, seed=1)
    measured = made.measured_deg.copy()
    measured[[10, 50]] += 90.0
    measured[4] = np.nan
    sweep = diagnose({"reference_deg": made.reference_deg, "measured_deg": measured}).to_dict()["sweeps"][0]
    assert sweep["rows"] == sweep["rejected"] + len(sweep["glitch_rows"]) + sweep["fitted"] == 120
    assert sweep["rejected_rows"] == {"5": "measured_deg missing or not finite"}
    assert diagnosed_rows(sweep) == (
        "1 rejected (row 5: measured_deg missing or not finite), 2 gross errors set aside (rows 11, 51); 117 fitted"
    )
    assert diagnosed_rows({**sweep, "rejected": 0, "glitch_rows": [7], "fitted": 119}) == (
        "1 gross error set aside (row 7); 119 fitted"
    )
    assert diagnosed_rows({**sweep, "rejected": 0, "glitch_rows": [], "fitted": 120}) == "all fitted"
    assert rejected_words({**sweep, "rejected": 0}) == ""


def test_of_many_sweeps_those_that_were_not_fitted_whole_are_named() -> None:
    whole = {"sweep": "w.csv", "rejected": 0, "glitch_rows": []}
    assert left_out_words([whole, whole]) == ""
    both = [
        {**whole, "sweep": "a.csv", "rejected": 3, "glitch_rows": [7]},
        {**whole, "sweep": "b.csv", "glitch_rows": [1, 2]},
    ]
    assert left_out_words([whole, *both]) == (
        "readings that were not fitted: 3 rejected and 1 gross error in a.csv, 2 gross errors in b.csv"
    )
    assert left_out_words([both[0]] * 7).endswith("in a.csv, and some in 2 more")
