"""The generator does what it says, and owes nothing to what it tests."""

from __future__ import annotations

import ast
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from . import generator
from .baseline import Injected
from .chain import Bench, field_channels, sample
from .clearance import angle_change
from .generator import STRENGTHS, Hidden, draw
from .scoring import verdict
from .sets import GROUPS, Job, jobs
from .streams import stream
from .structures import STRUCTURES

HERE = Path(__file__).parent

PEAK = {
    "saturation",
    "clipping",
    "magnet_harmonic",
    "cardan_coupling",
    "reference_eccentricity",
    "bearing_wobble",
    "hysteresis",
    "backlash",
    "latency",
    "motor_field",
    "load_torsion",
    "xy_skew",
    "phase_drift",
    "offset_drift",
    "gain_drift",
    *STRUCTURES,
} - {"noise_burst"}
"""Strength is the largest angle."""
ROOT_MEAN_SQUARE = {"multipole", "motor_poles", "drive_ripple", "mains_pickup", "reference_ripple"}
ROOT_MEAN_SQUARE |= {"reference_jitter", "time_jitter"}
"""Strength is sqrt(2) times the RMS."""


@pytest.fixture
def parts(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Bench, list[Injected]]]:
    """Bench and causes of the draws that follow, as the generator passes them on."""
    caught: list[tuple[Bench, list[Injected]]] = []

    def listening(bench: Bench, causes: list[Injected], rng: np.random.Generator) -> object:
        caught.append((bench, list(causes)))
        return sample(bench, causes, rng)

    monkeypatch.setattr(generator, "sample", listening)
    return caught


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Degrees into -180 .. 180."""
    return (angle + 180.0) % 360.0 - 180.0


def alone(name: str, seed: int, bench: str = "easy") -> Hidden:
    """A cause or a structure by itself."""
    return draw(
        [] if name in STRUCTURES else [name],
        seed=seed,
        bench=bench,
        structure=name if name in STRUCTURES else None,
    )


@pytest.mark.parametrize("folder", [HERE, HERE / "spins"], ids=lambda folder: folder.name)
def test_imports_nothing_but_numpy_rich_and_the_standard_library(folder: Path) -> None:
    for path in folder.glob("*.py"):
        allowed = {"numpy", "rich", *sys.stdlib_module_names, *(["pytest"] if "test_" in path.name else [])}
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [node.module or ""]
            assert {name.partition(".")[0] for name in names} <= allowed, path.name


def test_same_arguments_same_bytes(tmp_path: Path) -> None:
    for name in ("one.csv", "two.csv"):
        draw(["hysteresis", "bus_glitch"], seed=5, bench="hard").write_csv(tmp_path / name)
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()
    draw(["hysteresis", "bus_glitch"], seed=6, bench="hard").write_csv(tmp_path / "three.csv")
    assert (tmp_path / "one.csv").read_bytes() != (tmp_path / "three.csv").read_bytes()


@pytest.mark.parametrize("name", sorted(PEAK | ROOT_MEAN_SQUARE))
def test_strength_is_what_was_put_in(name: str, parts: list[tuple[Bench, list[Injected]]]) -> None:
    for seed in range(3):
        asked = alone(name, seed).truth["strength_deg"]
        assert isinstance(asked, dict)
        low, high = STRENGTHS["normal"]
        assert low <= asked[name] <= high
        change = angle_change(*parts[-1], name)
        if name in PEAK:
            assert np.abs(change).max() == pytest.approx(asked[name], rel=0.1)
        else:
            assert np.sqrt(2 * np.mean(change**2)) == pytest.approx(asked[name], rel=0.1)


@pytest.mark.parametrize("bench", ["easy", "hard"])
@pytest.mark.parametrize("group", sorted(GROUPS))
def test_every_set_can_be_drawn(group: str, bench: str) -> None:
    for job in jobs(group, draws=2, seed=3):
        hidden = replace(job, bench=bench).draw()
        rows = hidden.truth["rows"]
        assert all(column.shape == (rows,) for column in hidden.columns.values())
        full = {name: column for name, column in hidden.columns.items() if name != "temperature_c"}
        assert all(np.isfinite(column).all() for column in full.values())
        assert hidden.truth["bench"] == bench
        if "time_s" in hidden.columns:
            assert np.all(np.diff(hidden.columns["time_s"]) > 0)


def test_channels_are_what_the_angle_was_computed_from() -> None:
    for seed in range(12):
        hidden = draw([], seed=seed, bench="hard", protocol="static+channels")
        shown = np.degrees(np.arctan2(hidden.columns["vy"], hidden.columns["vx"]))
        own = hidden.truth["baseline"]
        assert isinstance(own, dict)
        off = wrapped(own["channel_sense"] * shown - hidden.columns["measured_deg"])
        assert np.abs(off).max() < 360 / 2**12 * 0.51


def test_noise_is_of_the_size_and_colour_stated(parts: list[tuple[Bench, list[Injected]]]) -> None:
    seen = set()
    for seed in range(40):
        truth = draw([], seed=seed, bench="hard").truth
        bench, _ = parts[-1]
        many = bench.noise.sample(stream(seed), 200_000)
        # a few slow waves hold much of 1/f noise
        loose = 0.2 if bench.noise.kind == "pink" else 0.05
        assert np.std(many) == pytest.approx(bench.noise.sigma_deg, rel=loose)
        neighbours = np.corrcoef(many[1:], many[:-1])[0, 1]
        if bench.noise.kind == "ar1":
            assert neighbours == pytest.approx(bench.noise.correlation, abs=0.02)
        whitened = bench.noise.whiten(many[:, None])[:, 0]
        # 1/sqrt(10) of a jig's error is not shared by its repeats
        assert np.std(whitened) == pytest.approx(1.0, rel=0.07)
        seen.add(truth["noise_kind"])
    assert seen == {"ar1", "pink", "jig"}


def test_a_glitch_is_one_bit_and_a_stale_frame_repeats(parts: list[tuple[Bench, list[Injected]]]) -> None:
    for name in ("bus_glitch", "stale_frames"):
        draw([name], seed=2)
        bench, causes = parts[-1]
        good = sample(bench, [], stream(1)).word_deg
        sent = sample(bench, causes, stream(1)).word_deg
        rows = np.flatnonzero(sent != good)
        assert rows.tolist() == causes[0].hidden["rows"].tolist()
        if name == "stale_frames":
            assert np.array_equal(sent[rows], sent[rows - 1])
            continue
        words = (np.stack([sent, good])[:, rows] * (2**bench.output_bits / 360.0)).round().astype(int)
        assert {int(one).bit_count() for one in words[0] ^ words[1]} == {1}


def test_memory_of_the_two_direction_causes(parts: list[tuple[Bench, list[Injected]]]) -> None:
    draw(["hysteresis"], seed=1, protocol="static_both")
    bench, causes = parts[-1]
    bench = replace(bench, channels=False)
    change = angle_change(bench, causes, "hysteresis")
    given = causes[0].parameters
    (turned,) = np.flatnonzero(np.diff(bench.motion.direction))[:1]
    before, after = change[turned], change[turned + 1 :][: bench.motion.points_per_turn // 3]
    assert before == pytest.approx(-given["lag_deg"], rel=0.05)
    travel = np.cumsum(np.abs(bench.motion.travel_deg[turned + 1 :]))[: len(after)]
    expected = given["lag_deg"] * (1 - 2 * np.exp(-travel / given["memory_deg"]))
    assert np.allclose(after, expected, atol=0.05 * given["lag_deg"])

    draw(["backlash"], seed=1, protocol="static_both")
    bench, causes = parts[-1]
    change = angle_change(replace(bench, channels=False), causes, "backlash")
    settled = np.abs(bench.motion.direction + np.roll(bench.motion.direction, 4)) == 2
    half = causes[0].parameters["half_width_deg"]
    assert np.allclose((-change * bench.motion.direction)[settled], half, rtol=0.05)


def test_field_stays_the_paper_model_when_nothing_is_hidden(
    parts: list[tuple[Bench, list[Injected]]],
) -> None:
    draw([], seed=3, bench="hard")
    bench, _ = parts[-1]
    x, y = field_channels(bench, [])
    own = bench.baseline
    angle = np.radians(own.sense * bench.motion.shaft_deg + own.zero_deg)
    sine = np.sin(angle + np.radians(own.phase_deg))
    assert np.allclose(x, own.offset_x + own.amplitude_x * np.cos(angle) * (1 + own.quadratic * np.cos(angle)))
    assert np.allclose(y, own.offset_y + own.amplitude_y * sine * (1 + own.quadratic * sine))


def test_a_job_can_be_made_again() -> None:
    job = Job("pairs", "x", ("latency", "hysteresis"), 77, bench="hard", structure="order_9_to_19")
    assert "--make latency+hysteresis --seed 77 --bench hard" in job.command()
    first, second = job.draw(), job.draw()
    assert first.truth == second.truth


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        ([["hysteresis"], ["saturation"]], "right"),
        ([["backlash", "hysteresis"], ["saturation"]], "right"),
        ([["saturation", "hysteresis"], ["magnet_harmonic", "saturation"]], "right"),
        ([["saturation"]], "missed"),
        ([["hysteresis"], ["saturation"], ["unnamed"]], "extra"),
        ([["hysteresis"], ["saturation"], ["output_quantisation"]], "right"),
        ([["hysteresis"], ["unnamed"]], "wrong name"),
        ([], "missed"),
    ],
)
def test_verdict(names: list[list[str]], expected: str) -> None:
    answer = {"causes": [{"name": one, "indistinguishable_from": rest} for one, *rest in names]}
    truth = {"causes": ["hysteresis", "saturation"], "tolerated": ["output_quantisation"]}
    assert verdict(answer, truth) == expected
