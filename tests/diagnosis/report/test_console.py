"""What a person sees in the terminal: everything that the answer says, at any width, without colour codes in a pipe."""

from __future__ import annotations

import io
import re
from typing import Any

import pytest
from rich.console import Console

from diagnosis.report.console import show
from diagnosis.report.statements import (
    baseline_words,
    factor_rows,
    floor_words,
    held_words,
    not_visible,
    percent_shown,
    single_rows_words,
    verdict_words,
)
from diagnosis.report.wording import chance, figure, instances, label, plain, structure_words
from scenarios.commands.causes import as_markdown, groups
from twin.catalogue import CATALOGUE


def parameter(value: float, half: float, unit: str) -> dict[str, Any]:
    return {"value": value, "low": value - half, "high": value + half, "unit": unit, "at_bound": False}


def an_answer(**changes: Any) -> dict[str, Any]:
    """An answer with two causes and a structure without a name."""
    baseline = {
        "Vx_over_Ax": parameter(0.0075, 0.0001, "1"),
        "Vy_over_Ay": parameter(-0.007, 0.0001, "1"),
        "gain_ratio": parameter(1.0098, 0.0001, "1"),
        "beta_deg": parameter(0.172, 0.004, "deg"),
        "quad": parameter(0.0019, 0.0001, "1"),
        "zero_deg": parameter(33.125, 0.002, "deg"),
    }
    hysteresis = {
        "name": "hysteresis",
        "stage": "concentrator",
        "parameters": {"lag_deg": parameter(0.118, 0.002, "deg"), "memory_deg": parameter(8.4, 0.6, "deg")},
        "false_alarm_probability": 1e-30,
        "heldout_rms_deg_before": 0.125,
        "heldout_rms_deg_after": 0.031,
        "indistinguishable_from": ["backlash"],
        "to_tell_apart": "sample every 0.5 deg for 20 deg after a reversal",
    }
    unnamed = {
        **hysteresis,
        "name": "unnamed",
        "stage": "empirical",
        "parameters": {"order": parameter(13.0, 0.01, "1/turn"), "amplitude_deg": parameter(0.05, 0.001, "deg")},
        "false_alarm_probability": 3e-4,
        "heldout_rms_deg_before": 0.031,
        "heldout_rms_deg_after": 0.0212,
        "indistinguishable_from": [],
        "to_tell_apart": "",
    }
    return {
        "changed": [],
        "in_factors": [],
        "setup": [],
        "other_device": False,
        "fitted_anew": False,
        "sweep": {
            "name": "bench.csv",
            "rows": 2880,
            "used": 2878,
            "fitted": 2878,
            "rejected": 2,
            "touched": 0,
            "direction_in_doubt": 0,
            "wild": 0,
            "wild_rows": [],
            "rejected_rows": {"411": "time_s missing or not finite", "1207": "time_s missing or not finite"},
            "turns": 8.0,
            "columns": ["reference_deg", "measured_deg"],
            "output_bits": 14,
        },
        "baseline": {
            "parameters": baseline,
            "rms_deg": 0.124,
            "heldout_rms_deg": 0.125,
            "fitted_error_rms_deg": 0.412,
            "fitted_rms_deg": 0.124,
            "explained_percent": 90.9416,
        },
        "noise_floor_deg": 0.021,
        "noise_floor_from": "held-out readings",
        "verdict": "partly explained",
        "causes": [hysteresis, unnamed],
        "unexplained": {
            "rms_deg": 0.021,
            "structure": [{"kind": "order", "order": 13.0, "amplitude_deg": 0.05, "phase_deg": 1.0}],
        },
        "extended": {
            "parameters": {**baseline, "quad": parameter(0.0025, 0.0001, "1")},
            "moved": ["quad"],
            "rms_deg": 0.021,
            "heldout_rms_deg": 0.0212,
            "gain": 5.9,
            "likeness_p": 0.43,
            "likeness_worst": "",
            "likeness_not_checked": None,
        },
        "not_visible": {
            "offset_drift": ["temperature_c", "two temperatures"],
            "gain_drift": ["temperature_c", "two temperatures"],
            "latency": ["two speeds|both directions", "moving shaft"],
        },
        **changes,
    }


def test_a_twin_that_is_told_from_the_sweep_is_said_to_be() -> None:
    answer = an_answer()
    answer["extended"] |= {"likeness_p": 0.005, "likeness_worst": "the scatter depends on the angle"}
    text = shown(answer, 120)
    assert "simulated sweeps do not match (p < 0.01: the scatter depends on the angle)" in " ".join(text.split())


def shown(answer: dict[str, Any], width: int) -> str:
    out = io.StringIO()
    show(answer, Console(file=out, width=width, highlight=False))
    return out.getvalue()


@pytest.mark.parametrize("width", [60, 80, 120, 200])
def test_everything_is_said_at_any_width(width: int) -> None:
    text = shown(an_answer(), width)
    assert max(map(len, text.splitlines())) <= width
    words = " ".join(text.split())
    for part in (
        "bench.csv 2880 readings, 8 turns travelled",
        "14-bit grid",
        "2 rejected (rows 411, 1207: time_s missing or not finite); 2878 fitted",
        "The paper's error model: error 0.412 -> 0.124 deg RMS; 91 % of its mean square explained",
        "noise floor not known, as no angle was read several times in a row; 0.0210 deg RMS is left on held-out",
        "gain ratio 1.00980 ±0.00010 1.00980 ±0.00010",
        "quadratic term 0.190 ±0.010 % 0.250 ±0.010 % moved",
        "With the causes known, quadratic term lies outside of the interval before",
        "1 hysteresis 0.125 -> 0.0310 < 1e-6",
        "lag 0.1180 ±0.0020 deg, memory 8.40 ±0.60 deg",
        "cannot be told from: backlash. To tell them apart: sample every 0.5 deg for 20 deg after a reversal",
        "2 unnamed 0.0310 -> 0.0212 0.0003",
        "order 13 in the shaft angle",
        "Verdict: partly explained. The extended twin is 5.9 times closer on readings it never saw; "
        "simulated sweeps match (p = 0.43). Part of that is structure without a name.",
        "offset_drift, gain_drift (no temperature_c)",
    ):
        # A narrow terminal breaks lines between a number and its unit, but drops nothing.
        assert part in words or width < 80, part


@pytest.mark.parametrize("width", [30, 40, 52])
def test_on_a_narrow_terminal_names_and_figures_are_wrapped_and_not_cut(width: int) -> None:
    answer = an_answer()
    answer["causes"][0]["name"] = "reference_eccentricity"
    text = shown(answer, width)
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= width
    words = " ".join(text.split())
    for part in (
        "What the simulation gets wrong",
        "1 reference_eccentricity held-out RMS, deg: 0.125 -> 0.0310 false alarm: < 1e-6",
        "2 unnamed held-out RMS, deg: 0.0310 -> 0.0212 false alarm: 0.0003",
    ):
        assert part in words


def test_the_noise_floor_is_one_of_repeated_readings_or_not_known() -> None:
    answer = an_answer()
    assert floor_words(answer).startswith("noise floor not known")
    answer["noise_floor_from"] = "repeated readings"
    assert floor_words(answer) == "noise floor 0.0210 deg RMS, the scatter of readings repeated at one angle"


@pytest.mark.parametrize(
    ("why", "said"),
    [
        (
            {"why": "too few beside the fitted parameters", "readings": 38, "needed": 44},
            "not checked (too few beside the fitted parameters: 38 independent readings, 44 are needed)",
        ),
        (
            {"why": "nothing but the digits of the readings is left", "readings": 38, "needed": None},
            "not checked (nothing but the digits of the readings is left)",
        ),
    ],
)
def test_a_predictive_check_that_was_not_made_is_said_not_to_be(why: dict[str, Any], said: str) -> None:
    answer = an_answer()
    answer["extended"] |= {"likeness_p": None, "likeness_worst": None, "likeness_not_checked": why}
    assert f"whether simulated sweeps match was {said}" in " ".join(shown(answer, 100).split())


def test_beside_a_given_twin_it_is_said_what_has_changed_and_what_was_held() -> None:
    answer = an_answer()
    answer["sweep"]["held_against"] = "given twin"
    for part in (answer["baseline"], answer["extended"]):
        exact = {key: {**told, "low": told["value"], "high": told["value"]} for key, told in part["parameters"].items()}
        part["parameters"] = {**exact, "zero_deg": part["parameters"]["zero_deg"]}
    answer["extended"]["moved"] = []
    words = " ".join(shown(answer, 100).split())
    assert "nothing of the given twin has changed beyond chance" in words
    assert "stays within its interval" not in words
    assert [row.flag for row in factor_rows(answer)] == ["held"] * 5 + [""]
    figures = {"is": 1.75, "low": 1.74, "high": 1.76, "unit": "%", "p": 1e-9}
    change = {"parameter": "offset.x_percent", "effect": "offset", "owner": "device", "was": 0.7512, **figures}
    change |= {"heldout_rms_deg_before": 0.45, "heldout_rms_deg_after": 0.0196, "indistinguishable_from": []}
    lag = {**change, "parameter": "hysteresis.lag_deg", "effect": "hysteresis", "unit": "deg"}
    answer["changed"] = [change, {**lag, "indistinguishable_from": ["backlash"]}]
    for width in (100, 44):
        words = " ".join(shown(answer, width).split())
        assert "What has changed since the twin" in words
        assert "was 0.751 %, is 1.750 ±0.010 %; it belongs to the device" in words
        assert "hysteresis lag" in words
        assert "cannot be told from: backlash" in words
        assert "All else of the given twin has not changed beyond chance, and stays as it was" in words
    assert "not that device" not in words
    answer["fitted_anew"] = True
    assert "it was fitted anew, as the twin had hardly told some of it" in " ".join(shown(answer, 100).split())
    answer["other_device"] = True
    words = " ".join(shown(answer, 100).split())
    assert "This is not that device's twin: 2 parameters that belong to a device are others." in words
    # Of another device all is other: nobody has looked for what else would do the same.
    assert "cannot be told from: nothing" not in words.partition("What the simulation")[0]
    answer["changed"] = []
    assert "it counts the other way" in " ".join(shown(answer, 100).split())


def test_a_pipe_gets_no_colour_codes() -> None:
    assert "\x1b" not in shown(an_answer(), 80)


def test_an_adequate_baseline_is_said_and_no_table_drawn() -> None:
    text = shown(an_answer(verdict="adequate", causes=[], unexplained={"rms_deg": 0.02, "structure": []}), 80)
    assert "Verdict: adequate" in text
    assert "What the simulation gets wrong" not in text


def test_a_share_is_never_negative_never_rounded_to_all_and_of_the_fitted_rows() -> None:
    answer = an_answer()
    baseline, sweep = answer["baseline"], answer["sweep"]
    told = "error 0.412 -> 0.124 deg RMS"
    assert baseline_words(answer) == f"The paper's error model: {told}; 91 % of its mean square explained"
    sweep |= {"held_against": "given twin", "fitted": 2818}
    over = "over the 2818 readings that were fitted"
    assert baseline_words(answer) == f"The given twin: {told}, {over}; 91 % of its mean square explained"
    baseline |= {"explained_percent": -39.0, "fitted_rms_deg": 0.486}
    assert baseline_words(answer) == f"The given twin makes the error larger: 0.412 -> 0.486 deg RMS, {over}"
    baseline |= {"explained_percent": None, "fitted_error_rms_deg": 0.0, "fitted_rms_deg": 0.0}
    assert baseline_words(answer) == f"The given twin leaves 0 deg RMS, {over}"
    shares = (0.0, 1e-6, 0.3, 50.4, 99.93, 99.996, 99.99999, 100.0)
    assert [percent_shown(s) for s in shares] == ["0", "< 0.01", "0.3", "50", "99.9", "> 99.99", "> 99.99", "100"]


def test_a_part_of_a_long_record_is_said_to_be_one() -> None:
    answer = an_answer()
    answer["sweep"] |= {"rows": 180_000, "used": 24_000, "set_aside": 156_000}
    assert "180000 readings, of these 24000 were searched, in stretches spread over the record, 8 turns" in " ".join(
        shown(answer, 100).split()
    )


def test_what_cannot_be_held_out_is_said_in_words() -> None:
    answer = an_answer()
    answer["extended"] |= {"gain": None, "heldout_rms_deg": None}
    for cause in answer["causes"]:
        cause |= {"heldout_rms_deg_before": None, "heldout_rms_deg_after": None}
    assert held_words(answer["causes"][0]) == "not held out"
    answer["causes"][0]["heldout_rms_deg_before"] = 0.1
    assert held_words(answer["causes"][0]) == "not held out"
    assert "Too few readings to hold any out: how much closer the extended twin is cannot be told" in verdict_words(
        answer
    )
    answer["extended"]["gain"] = 0.98
    assert "The extended twin is no closer on readings it never saw" in verdict_words(answer)
    answer["extended"]["gain"] = 1.03
    assert "The extended twin is 1.03 times closer" in verdict_words(answer)


@pytest.mark.parametrize("width", [60, 80, 160])
def test_no_figure_is_cut_by_its_column(width: int) -> None:
    answer = an_answer()
    answer["causes"][0] |= {"heldout_rms_deg_before": 0.00539123, "heldout_rms_deg_after": 0.000256123}
    answer["causes"][1] |= {"heldout_rms_deg_before": 0.000256123, "heldout_rms_deg_after": 1.2345e-05}
    answer["causes"][1]["false_alarm_probability"] = None
    text = shown(answer, width)
    for part in ("0.00539 -> 0.000256", "0.000256 -> 1.23e-05", "not determined"):
        assert part in text
    assert "…" not in text


def test_single_readings_say_how_far_off_they_are() -> None:
    off = "off by 22.5 deg RMS, which no held-out figure counts"
    assert single_rows_words({"rows": [41, 201], "rows_rms_deg": 22.5}) == f"rows 41, 201: {off}"
    assert single_rows_words({"rows_rms_deg": 22.5}) == f"the readings that it touched are {off}"
    assert single_rows_words({"rows": list(range(1, 13))}) == "rows 1, 2, 3, 4, 5, 6, 7, 8 and 4 more"
    assert single_rows_words({}) == ""


def leaves(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The places of all figures that may be missing in an answer: rows, lists of them and flags are always known."""
    if isinstance(value, dict):
        return [place for key, item in value.items() for place in leaves(item, (*path, key))]
    if isinstance(value, list):
        return [place for key, item in enumerate(value) for place in leaves(item, (*path, key))]
    return [path] if isinstance(value, float) and path[0] != "sweep" else []


@pytest.mark.parametrize("place", leaves(an_answer()), ids=lambda place: ".".join(map(str, place)))
def test_a_figure_that_is_missing_reaches_no_text(place: tuple[Any, ...]) -> None:
    answer = an_answer()
    holder: Any = answer
    for key in place[:-1]:
        holder = holder[key]
    holder[place[-1]] = None
    if place == ("baseline", "fitted_error_rms_deg"):
        answer["baseline"]["explained_percent"] = None
    assert not re.search(r"\b(nan|none(?! rejected)|inf|unknown)\b", shown(answer, 100).lower())


def test_numbers_have_the_digits_that_are_known() -> None:
    assert figure(parameter(0.112799, 0.00101, "deg")) == ("0.1128", "±0.0010")
    assert figure(parameter(50.0, 0.0, "1/turn")) == ("50", "")
    assert figure({"value": 1.5, "low": None, "high": None, "unit": "deg"}) == ("1.500", "±∞")
    assert plain(0.019) == "0.0190"
    assert plain(None) == "not determined"
    # A row of zeros says nothing.
    assert figure(parameter(1.2345e-11, 3.2e-13, "1")) == ("1.235e-11", "±0.032e-11")
    assert figure(parameter(0.0, 3.2e-13, "1")) == ("0.0e-13", "±3.2e-13")
    assert figure(parameter(2.5e-5, 1.1e-6, "1")) == ("0.0000250", "±0.0000011")
    assert figure(parameter(12345.6, 321.0, "deg")) == ("12346", "±321")
    assert plain(123456.7) == "123457"
    assert chance(2e-9) == "< 1e-6"
    assert chance(0.004) == "0.004"


def test_parameters_are_grouped_by_instance_and_named_without_units() -> None:
    several = instances({"order": 1, "amplitude_deg": 2, "order_2": 3, "amplitude_deg_2": 4})
    assert several == [{"order": 1, "amplitude_deg": 2}, {"order": 3, "amplitude_deg": 4}]
    names = (
        "lag_deg",
        "k_percent",
        "x_percent_per_K",
        "deg_per_K",
        "delay_us",
        "percent_rms",
        "half_width_deg",
        "bits",
    )
    assert [label(name) for name in names] == ["lag", "k", "x drift", "drift", "delay", "rms", "half width", "bits"]


def test_what_is_missing_is_grouped_and_said_once() -> None:
    groups_found = not_visible(an_answer()["not_visible"])
    assert groups_found[0] == (["offset_drift", "gain_drift"], "no temperature_c", "record temperature_c")
    assert groups_found[1][0] == ["latency"]


def test_every_kind_of_structure_has_words() -> None:
    for kind in ("order", "time_frequency", "step", "drift", "temperature", "direction", "speed", "local", "code"):
        assert structure_words({"kind": kind, "amplitude_deg": 0.05, "order": 2.0})


def test_the_catalogue_is_listed_whole_with_a_source_each() -> None:
    listed = [effect.name for _, effects in groups() for effect in effects]
    assert sorted(listed) == sorted(effect.name for effect in CATALOGUE)
    text = as_markdown()
    for effect in CATALOGUE:
        line = next(line for line in text.splitlines() if line.startswith(f"| `{effect.name}` |"))
        assert line.replace("\\|", "").count("|") == 9


def test_a_cause_without_gain_on_the_mean_is_not_sold_as_one() -> None:
    answer = an_answer(verdict="explained")
    answer["causes"] = [{**answer["causes"][0], "heldout_rms_deg_before": 0.02, "heldout_rms_deg_after": 0.02}]
    answer["extended"] |= {"heldout_rms_deg": 0.02, "gain": 1.0}
    assert "in single readings or in their scatter" in " ".join(shown(answer, 80).split())
