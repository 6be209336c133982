"""The judge sees what is left, what others do works, and a study goes on where it stood."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from . import study
from .__main__ import main
from .benches import TURN
from .bound import least_rms_of
from .generator import Log, draw
from .judging import left_by, names_verdict, open_orders, wrong_orders
from .peers import PEERS, unwrapped
from .sensor import PERFECT, AtRest, Order, at_rest, rms_of_orders
from .sets import Job, clean, of_causes, of_protocols

Array = np.ndarray[Any, np.dtype[np.float64]]


def oracle(truth: AtRest) -> Callable[[Array], Array]:
    """The perfect correction."""
    start = truth.reading_deg[0]
    reading = np.append(truth.reading_deg - start, 360.0)
    shaft = np.append(truth.shaft_deg, 360.0)
    return lambda told: np.interp(np.mod(told - start, 360.0), reading, shaft)


@pytest.mark.parametrize(("sense", "zero"), [(1.0, 0.0), (1.0, 180.0), (-1.0, 77.0)])
def test_neither_zero_nor_sense_of_a_correction_matters(sense: float, zero: float) -> None:
    truth = draw("coast", seed=3).at_rest
    perfect = oracle(truth)
    assert left_by(lambda told: sense * perfect(told) + zero, truth).rms_deg < 1e-4
    idle = left_by(lambda told: sense * told + zero, truth)
    assert idle.factor == pytest.approx(1.0, rel=0.01)


def test_what_is_left_is_measured() -> None:
    truth = at_rest(PERFECT, [], (Order(3, 0.2, 10.0),))
    perfect = oracle(truth)
    left = left_by(lambda told: perfect(told) + 0.05 * np.sin(np.radians(5.0 * told)), truth)
    assert left.rms_deg == pytest.approx(0.05 / math.sqrt(2.0), rel=1e-3)
    assert left.raw_rms_deg == pytest.approx(0.2 / math.sqrt(2.0), rel=1e-3)
    assert wrong_orders(left, frozenset()) == (5,)
    assert wrong_orders(left, frozenset({5})) == ()


def test_the_bound_is_that_of_two_speeds() -> None:
    """At speeds of 1 and 2, readings y tell s + t and s + t / 4: s = (4 y2 - y1) / 3, each y as of its own log."""
    time = np.arange(8000) / 2000.0
    logs = [Log({}, 360.0 * speed * time, time) for speed in (20.0, 40.0)]
    each = 2.0 * 0.05**2 / 8000
    wanted = math.sqrt(32.0 * (16.0 + 1.0) / 9.0 * each / 2.0)
    assert least_rms_of(logs, noise_deg=0.05, jitter_s=0.0) == pytest.approx(wanted, rel=0.03)
    assert least_rms_of(logs[:1], noise_deg=0.05, jitter_s=0.0) == math.inf
    # an uncertain stamp is worth what the shaft turns meanwhile
    late = math.sqrt(32.0 * (16.0 * 4.0 + 1.0) / 9.0 * 2.0 * 0.072**2 / 8000 / 2.0)
    assert least_rms_of(logs, noise_deg=0.0, jitter_s=1e-5) == pytest.approx(late, rel=0.03)


def test_open_orders_are_those_a_torque_moves() -> None:
    assert open_orders({"torque_response_deg": {"1": 0.01, "2": 0.1, "16": 0.03}}) == (2, 16)


def test_a_torque_by_its_name_is_never_wrong() -> None:
    drawn = draw("one_speed", seed=3, causes=("saturation",))
    torque = {"name": "torque_ripple"}
    either = {"name": "magnet_harmonic", "indistinguishable_from": ["torque_ripple"]}
    right = {"name": "saturation", "indistinguishable_from": []}
    assert names_verdict({"causes": [right, torque, either]}, drawn) == "right"
    assert names_verdict({"causes": [right, {"name": "magnet_harmonic"}]}, drawn) == "extra"
    assert names_verdict({"causes": [torque]}, drawn) == "missed"


@pytest.mark.parametrize("name", sorted(PEERS))
def test_what_others_do_works_where_nothing_but_the_sensor_is_wrong(name: str) -> None:
    orders = (Order(1, 0.5, 20.0), Order(2, 0.3, -50.0), Order(4, 0.1, 90.0))
    truth = at_rest(PERFECT, [], orders)
    time = np.arange(8000) / 2000.0
    shaft = 360.0 * 9.7 * time
    reading = shaft + np.interp(shaft, truth.shaft_deg, truth.reading_deg - truth.shaft_deg, period=360.0)
    left = left_by(PEERS[name]({"time_s": time, "measured_deg": np.mod(reading, 360.0)}), truth)
    assert left.factor > 12.0
    torque = 0.2 * np.sin(np.radians(3.0 * shaft))
    fooled = left_by(PEERS[name]({"time_s": time, "measured_deg": np.mod(reading + torque, 360.0)}), truth)
    assert fooled.rms_deg == pytest.approx(0.2 / math.sqrt(2.0), rel=0.2)


def test_turns_in_which_something_happens_count_less_in_the_weighted_fit() -> None:
    truth = at_rest(PERFECT, [], (Order(2, 0.3, -50.0),))
    time = np.arange(8000) / 2000.0
    shaft = 360.0 * 9.7 * time + np.where(time > 2.03, 9.0, 0.0)
    reading = shaft + np.interp(shaft, truth.shaft_deg, truth.reading_deg - truth.shaft_deg, period=360.0)
    columns = {"time_s": time, "measured_deg": np.mod(reading, 360.0)}
    factors = [left_by(PEERS[name](columns), truth).factor for name in ("harmonic_fit", "weighted_fit")]
    assert factors[1] > 3.0 * factors[0]


def test_turns_are_counted_over_rows_that_never_arrived() -> None:
    time = np.concatenate([np.arange(2000), np.arange(2400, 4000)]) / 2000.0
    path = 360.0 * (30.0 * time - 2.0 * time**2) + 0.3 * np.sin(TURN * 30.0 * time)
    counted = unwrapped({"time_s": time + 5.0, "measured_deg": np.mod(path, 360.0)})
    np.testing.assert_allclose(counted[0], time, atol=1e-9)
    np.testing.assert_allclose(counted[1], path, atol=1e-6)


def pretend(paths: Sequence[str]) -> tuple[Mapping[str, Any], Callable[[Array], Array], frozenset[int]]:
    """A tool that corrects nothing."""
    assert all(Path(path).read_text(encoding="utf-8").startswith("time_s,measured_deg") for path in paths)
    ASKED.append(tuple(paths))
    if len(paths) > 1:
        raise ValueError("one log only")
    return {"causes": [{"name": "hysteresis"}], "verdict": "explained"}, lambda told: told, frozenset({1})


ASKED: list[tuple[str, ...]] = []
PRETENDER = f"{__name__}:pretend"


def test_a_study_goes_on_where_it_stood(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ASKED.clear()
    kept = tmp_path / "kept.json"
    words = ["--set", "clean", "--seed", "3", "--answerer", PRETENDER, "-o", str(kept)]
    assert main([*words, "--draws", "2"]) == 0
    assert len(ASKED) == 2
    assert main([*words, "--draws", "3"]) == 0
    assert len(ASKED) == 3
    assert "hysteresis" in capsys.readouterr().out
    assert [one["verdict"] for one in study.read(kept)] == ["extra"] * 3


def test_a_failure_is_kept_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = tmp_path / "kept.json"
    words = ["--protocol", "two_logs,one_speed", "--draws", "1", "--seed", "3", "--answerer", PRETENDER]
    assert main([*words, "-o", str(kept)]) == 0
    failed, done = sorted(study.read(kept), key=lambda one: "failed" not in one)
    assert failed["failed"] == "ValueError: one log only"
    assert done["factor"] == pytest.approx(1.0, rel=0.01)
    assert "one log only" in capsys.readouterr().out


def test_a_draw_can_be_written(tmp_path: Path) -> None:
    assert main(["--make", "both_ways", "--seed", "5", "--causes", "saturation", "-o", str(tmp_path)]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["error.csv", "log0.csv", "log1.csv", "truth.json"]
    wanted = draw("both_ways", seed=5, causes=("saturation",))
    assert (tmp_path / "log1.csv").read_text(encoding="utf-8") == wanted.logs[1].csv()
    error = np.loadtxt(tmp_path / "error.csv", delimiter=",", skiprows=1)[:, 1]
    assert rms_of_orders(error) == pytest.approx(rms_of_orders(wanted.at_rest.error_deg), rel=1e-4)


def test_draws_differ_and_can_be_told_apart() -> None:
    jobs: list[Job] = [*of_protocols(("coast", "one_speed"), draws=3, seed=1), *of_causes(draws=2, seed=1)]
    jobs += clean(draws=3, seed=1)
    assert len({job.key for job in jobs}) == len({job.seed for job in jobs}) == len(jobs)
    with pytest.raises(ValueError, match="protocol must be one of"):
        of_protocols(("rolling",), draws=1, seed=1)
