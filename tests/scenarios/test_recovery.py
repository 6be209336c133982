"""Recovery studies: the bound is the bound, a small study reaches it, and what cannot show is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.error_model.model import Readings
from diagnosis.report.provenance import day, version
from scenarios.studies.machines import Machines
from scenarios.studies.recovery.cells import BASELINE, SLOTS, Cell, Grid, bounds, simulate
from scenarios.studies.recovery.plot import map_figures
from scenarios.studies.recovery.run import check, folder_of, recover, run
from tests.diagnosis.cases import point_of
from tests.scenarios.study_jobs import content
from twin.errors import UserError

GRID = Grid(
    causes=(BASELINE,),
    noises_deg=(0.01, 0.05),
    points=(45,),
    turns=(1,),
    amplitudes_deg=(0.05,),
    fits=60,
    sweeps=1,
    seed=0,
)


def test_the_bound_is_that_of_the_error_models_own_slopes() -> None:
    cell = Cell(cause=BASELINE, noise_deg=0.02, points=72, turns=1, amplitude_deg=0.0)
    motion = cell.motion()
    chain, sweep = simulate(cell, motion, np.random.default_rng(0))
    ours = bounds(chain, cell, motion)
    point = point_of(chain.values)
    readings = Readings.of(np.radians(sweep.reference_deg), np.radians(sweep.measured_deg))
    _, slopes = readings.linearised(point[None])
    information = slopes[0] @ slopes[0].T / np.radians(cell.noise_deg) ** 2
    theirs = np.sqrt(np.diagonal(np.linalg.inv(information)))
    in_twin_units = theirs * np.array([100.0, 100.0, 1.0, np.degrees(1.0), 100.0, np.degrees(1.0)])
    np.testing.assert_allclose(ours, in_twin_units, rtol=0.03)


def test_a_cause_costs_the_baseline_some_of_its_bound() -> None:
    plain = Cell(cause=BASELINE, noise_deg=0.02, points=72, turns=1, amplitude_deg=0.05)
    other = replace(plain, cause="saturation")
    motion = plain.motion()
    chain, _ = simulate(other, motion, np.random.default_rng(0))
    with_cause = bounds(chain, other, motion)
    # Its size and its exponent.
    assert with_cause.size == SLOTS + 2
    assert np.all(with_cause[:SLOTS] >= bounds(chain, plain, motion) * (1.0 - 1e-9))


def test_the_baseline_reaches_its_bound_and_any_number_of_workers_says_so(tmp_path: Path) -> None:
    for count, name in ((2, "two"), (1, "one")):
        with folder_of(GRID, tmp_path / name) as folder:
            found = recover(GRID, folder, Machines(workers=count))
    assert content(tmp_path / "one") == content(tmp_path / "two")
    for entry in found:
        for parameter in entry["parameters"].values():
            assert parameter["recovered"] == 60
            assert 0.7 < parameter["rms_over_bound"] < 1.35
            assert abs(parameter["bias_over_bound"]) < 0.5
            assert parameter["coverage"] > 0.85


def test_the_command_asks_about_causes_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    grid = replace(GRID, causes=(BASELINE, "clean", "saturation"), noises_deg=(0.01,), amplitudes_deg=(0.2,), fits=8)
    run(grid, tmp_path / "s", plot=True, machines=Machines(workers=2), command="again")
    assert "saturation" in capsys.readouterr().out
    for name in ("recovery.json", "baseline.png", "causes.png"):
        assert (tmp_path / "s" / name).stat().st_size > 0
    answer = json.loads((tmp_path / "s/recovery.json").read_text())
    assert [answer[key] for key in ("version", "date", "seed", "command")] == [version(), day(), GRID.seed, "again"]


def test_a_cause_that_cannot_show_is_refused() -> None:
    with pytest.raises(UserError, match="'gain_drift' does not show at 45 points"):
        check(replace(GRID, causes=("gain_drift",)))


def test_maps_have_a_colour_bar_and_the_number_of_sweeps() -> None:
    pytest.importorskip("matplotlib")
    cells = [
        {
            **{"cause": cause, "noise_deg": noise, "points": 45, "turns": turns, "amplitude_deg": 0.05, "repeats": 5},
            **{"named": 0.4, "false_alarms": 0.0},
        }
        for cause in ("saturation", "hysteresis")
        for noise in (0.01, 0.02)
        for turns in (1, 2)
    ]
    figure = map_figures(cells)["causes"]
    maps = [axes for axes in figure.axes if axes.images]
    bars = [axes.get_ylabel() for axes in figure.axes if not axes.images]
    assert bars == ["share in which it is named"] * len(maps) == ["share in which it is named"] * 2
    for panel, cause in zip(maps, ("saturation", "hysteresis"), strict=True):
        assert panel.get_title() == f"{cause}\n10 sweeps a cell, 1 and 2 turns each way\namplitude 0.05 deg"
