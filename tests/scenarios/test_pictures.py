"""What a stranger needs to read a picture: units on each axis, directions told apart, no curve flattened by another."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis.correction.cross_validation import BeforeAfter
from diagnosis.factors.series import monitor
from diagnosis.thermal.recording import joined
from scenarios.commands.compensate_judge import Judged
from scenarios.commands.compensate_plot import before_after_figure
from scenarios.commands.monitor_plot import charts_figure
from scenarios.commands.paper import run as paper
from scenarios.commands.paper.work import Work
from scenarios.commands.trace import trace
from scenarios.commands.trace_plot import trace_figure
from tests.command_line import halltwin
from twin.angles import TAU
from twin.chain import Chain
from twin.motion import Motion

pytest.importorskip("matplotlib")
BOTH = Motion.from_angle(TAU * np.concatenate([np.arange(40), np.arange(40)[::-1]]) / 40)
ONE = Motion.from_angle(TAU * np.arange(40) / 40)
DEVICE = (
    Chain()
    .with_effect("zero", zero_deg=37.0)
    .with_effect("offset", x_percent=0.8)
    .with_effect("hysteresis", lag_deg=0.1, memory_deg=5.0)
    .with_effect("noise", rms_deg=0.01)
)


def shown(figure: Any) -> Iterator[Any]:
    """The panels of a figure that are seen."""
    yield from (axis for axis in figure.axes if axis.get_visible())


def legend_of(figure: Any) -> set[str]:
    """What the legend below all panels says."""
    return {text.get_text() for legend in figure.legends for text in legend.get_texts()}


def drawn() -> Iterator[Any]:
    """Pictures of commands, of sweeps there and back."""
    yield pytest.param(lambda: trace_figure(trace(DEVICE, BOTH, seed=0), title="device"), id="simulate --plot")
    yield pytest.param(
        lambda: before_after_figure([Judged("on it", "it", _errors(), joined([_sweep()]))]), id="compensate --plot"
    )
    sweeps = [DEVICE.simulate(BOTH, seed=seed) for seed in range(5)]
    yield pytest.param(lambda: charts_figure(monitor(sweeps, rng=np.random.default_rng(0))), id="monitor --plot")


def _sweep() -> Any:
    return DEVICE.simulate(BOTH, seed=0)


def _errors() -> BeforeAfter:
    errors = np.linspace(-0.01, 0.01, len(BOTH))
    return BeforeAfter(errors, 0.5 * errors)


@pytest.mark.parametrize("draw", list(drawn()))
def test_units_and_directions(draw: Any) -> None:
    figure = draw()
    for axis in shown(figure):
        assert "[" in axis.get_ylabel() or "standard deviations" in _column_title(figure, axis)
    assert {word.rpartition(", ")[2] for word in legend_of(figure)} >= {"forward", "backward"} or {
        "forward alone",
        "backward alone",
    } <= legend_of(figure)


def _column_title(figure: Any, axis: Any) -> str:
    """The title over the column that a panel stands in."""
    column = axis.get_subplotspec().colspan.start
    tops = [one for one in figure.axes if one.get_subplotspec().rowspan.start == 0]
    return str(next(one.get_title() for one in tops if one.get_subplotspec().colspan.start == column))


def test_a_large_zero_flattens_no_other_curve_of_the_trace() -> None:
    """Each effect has a panel of its own, whose height is that of its curve."""
    figure = trace_figure(trace(DEVICE, BOTH, seed=0), title="device")
    panels = {axis.get_title(): axis for axis in shown(figure)}
    for effect, size in (("offset", 0.9), ("hysteresis", 0.2), ("noise", 0.05)):
        low, high = panels[f"angle changed by {effect}"].get_ylim()
        assert 0.5 * size < high - low < 2.0 * size, effect
    low, high = panels["angle changed by zero"].get_ylim()
    assert (low, high) == pytest.approx((18.5, 55.5))


def test_a_trace_of_one_turn_lies_over_the_shaft_angle() -> None:
    figure = trace_figure(trace(DEVICE, ONE, seed=0), title="device")
    assert {axis.get_xlabel() for axis in shown(figure)} == {"", "shaft angle [deg]"}
    assert legend_of(figure) == {"forward"}


FEW = Work(cases=2)


@pytest.mark.parametrize("name", paper.FIGURES)
def test_figures_of_the_paper_have_units(name: str) -> None:
    from diagnosis.report.plotting import style

    plt = style()
    figure, _ = paper.FIGURES[name](plt, FEW)
    for axis in figure.axes:
        assert all("[" in label for label in (axis.get_xlabel(), axis.get_ylabel()))
    plt.close(figure)
    assert paper.TITLES[name]


@pytest.mark.parametrize("arguments", [("diagnose", "DATA"), ("compensate", "imc-14bit", "--check", "DATA")])
def test_more_sweeps_than_a_picture_holds_are_refused_before_any_work(
    arguments: tuple[str, ...], tmp_path: Path
) -> None:
    """Found out at the end, it would cost the answers to all sweeps."""
    for k in range(17):
        DEVICE.simulate(ONE, seed=k).write(tmp_path / f"s{k:02d}.csv")
    given = [str(tmp_path) if word == "DATA" else word for word in arguments]
    ended = halltwin(*given, "--plot", tmp_path / "p.png")
    assert (ended.code, ended.out) == (2, "")
    assert ended.err == "halltwin: p.png: 17 sweeps do not fit in one picture; draw at most 16\n"


def test_what_a_correction_leaves_has_a_scale_of_its_own() -> None:
    """An error that is a thousandth of the one before is a flat line beside it."""
    errors = np.linspace(-0.01, 0.01, len(BOTH))
    figure = before_after_figure([Judged("on it", "it", BeforeAfter(errors, 1e-3 * errors), joined([_sweep()]))])
    both, alone = shown(figure)
    assert np.ptp(alone.get_ylim()) < 0.01 * np.ptp(both.get_ylim())
