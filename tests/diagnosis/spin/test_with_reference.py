"""A coast that has a reference, and no speed beside it: what goes with the speed is seen all the same."""

from __future__ import annotations

from diagnosis import explain
from diagnosis.report.console import text
from tests.hidden.spins.generator import draw


def test_a_late_reading_is_told_by_the_speed_that_time_and_reference_tell() -> None:
    drawn = draw("coast", seed=1, causes=("latency",), shown=True)
    columns = drawn.logs[0].columns
    answer = explain({**columns, "reference_deg": columns["shaft_deg"]}).to_dict()
    assert [cause["name"] for cause in answer["causes"]] == ["latency"]
    delay = answer["causes"][0]["parameters"]["delay_us"]
    true = drawn.truth["parameters"]["latency"]["delay_us"]  # type: ignore[index]
    # Speeds that are off by 6e-4 RMS of themselves move a delay by less than that.
    assert abs(delay["value"] - true) < 6e-4 * true
    assert answer["sweep"]["speed_from"] == "time_s and reference_deg"
    said = text(answer, width=200)
    assert "by time_s and reference_deg" in said
    assert "2.9 to 15 deg apart" in said
