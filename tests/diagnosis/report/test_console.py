"""What a person sees in the terminal: everything that the answer says, at any width, without colour codes in a pipe."""

from __future__ import annotations

import io
from typing import Any

import pytest
from rich.console import Console

from diagnosis.report.console import show
from diagnosis.report.wording import (
    chance,
    figure,
    instances,
    label,
    not_visible,
    plain,
    rejected_words,
    structure_words,
)
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
        "heldout_rms_deg_before": 0.124,
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
        "indistinguishable_from": [],
        "to_tell_apart": "",
    }
    return {
        "sweep": {
            "name": "bench.csv",
            "rows": 2880,
            "used": 2878,
            "rejected": 2,
            "rejected_rows": {"411": "time_s missing or not finite", "1207": "time_s missing or not finite"},
            "turns": 8.0,
            "columns": ["reference_deg", "measured_deg"],
            "output_bits": 14,
        },
        "baseline": {"parameters": baseline, "rms_deg": 0.124, "heldout_rms_deg": 0.125},
        "noise_floor_deg": 0.021,
        "verdict": "partly explained",
        "causes": [hysteresis, unnamed],
        "unexplained": {
            "rms_deg": 0.021,
            "structure": [{"kind": "order", "order": 13.0, "amplitude_deg": 0.05, "phase_deg": 1.0}],
        },
        "extended": {
            "rms_deg": 0.021,
            "heldout_rms_deg": 0.0212,
            "gain": 5.9,
            "likeness_p": 0.43,
            "likeness_worst": "",
        },
        "not_visible": {
            "offset_drift": ["temperature_c", "two temperatures"],
            "gain_drift": ["temperature_c", "two temperatures"],
            "latency": ["two speeds|both directions", "moving shaft"],
        },
        **changes,
    }


def test_a_twin_that_is_told_from_the_sweep_is_said_to_be() -> None:
    unlike = {"rms_deg": 0.021, "heldout_rms_deg": 0.0212, "gain": 5.9, "likeness_p": 0.005}
    text = shown(an_answer(extended={**unlike, "likeness_worst": "the scatter depends on the angle"}), 120)
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
        "bench.csv 2880 readings, 8 turns",
        "14-bit grid",
        "2 rejected (rows 411, 1207: time_s missing or not finite)",
        "0.124 deg RMS",
        "1.00980 ±0.00010",
        "1 hysteresis 0.124 -> 0.0310 < 1e-6",
        "lag 0.1180 ±0.0020 deg, memory 8.40 ±0.60 deg",
        "cannot be told from: backlash. To tell them apart: sample every 0.5 deg for 20 deg after a reversal",
        "2 unnamed 0.124 -> 0.0310 0.0003",
        "order 13 in the shaft angle",
        "Verdict: partly explained. The extended twin is 5.9 times closer on readings it never saw; "
        "simulated sweeps match (p = 0.43). Part of that is structure without a name.",
        "offset_drift, gain_drift (no temperature_c)",
    ):
        # A narrow terminal breaks lines between a number and its unit, but drops nothing.
        assert part in words or width < 80, part


def test_a_pipe_gets_no_colour_codes() -> None:
    assert "\x1b" not in shown(an_answer(), 80)


def test_an_adequate_baseline_is_said_and_no_table_drawn() -> None:
    text = shown(an_answer(verdict="adequate", causes=[], unexplained={"rms_deg": 0.02, "structure": []}), 80)
    assert "Verdict: adequate" in text
    assert "What the simulation gets wrong" not in text


def test_the_share_explained_is_of_the_power() -> None:
    answer = an_answer()
    answer["sweep"]["error_rms_deg"] = 0.412
    assert "explains 91 % of the error" in shown(answer, 100)
    answer["sweep"]["held_against"] = "given twin"
    assert "The given twin explains 91 %" in shown(answer, 100)


def test_numbers_have_the_digits_that_are_known() -> None:
    assert figure(parameter(0.112799, 0.00101, "deg")) == ("0.1128", "±0.0010")
    assert figure(parameter(50.0, 0.0, "1/turn")) == ("50", "")
    assert figure({"value": 1.5, "low": None, "high": None, "unit": "deg"}) == ("1.500", "±unknown")
    assert plain(0.019) == "0.0190"
    assert plain(None) == "unknown"
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
    assert rejected_words({"rejected": 0, "rejected_rows": {}}) == "none rejected"


def test_the_catalogue_is_listed_whole_with_a_source_each() -> None:
    listed = [effect.name for _, effects in groups() for effect in effects]
    assert sorted(listed) == sorted(effect.name for effect in CATALOGUE)
    text = as_markdown()
    for effect in CATALOGUE:
        line = next(line for line in text.splitlines() if line.startswith(f"| `{effect.name}` |"))
        assert line.replace("\\|", "").count("|") == 8


def test_a_cause_without_gain_on_the_mean_is_not_sold_as_one() -> None:
    answer = an_answer(verdict="explained", extended={"rms_deg": 0.02, "heldout_rms_deg": 0.02, "gain": 1.0})
    assert "in single readings or in their scatter" in " ".join(shown(answer, 80).split())
