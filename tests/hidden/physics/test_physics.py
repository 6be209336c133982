"""The physics does what it says, stands clear of the noise, and owes nothing to what it tests."""

from __future__ import annotations

import ast
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ..motion import Layout, Leg, Motion, run
from ..scoring import verdict
from ..streams import stream
from . import converters, cordics, magnetisation, magnets, references, rotor, shaken
from .clear import clearance_sigma
from .device import IDEAL, record
from .generator import CLEAR, WORDS, draw, settle
from .kinds import CLEAN, KINDS
from .loops import exponential, first_order, follow_by, mean_delay, second_order
from .plays import relays, scalar_plays, vector_plays
from .sets import PHYSICS, physics_jobs
from .thermal import lagged

OF_A_MEAN = sorted(name for name in KINDS if name not in CLEAN and name not in WORDS and not KINDS[name].noisy)


def spin(rpm: float, turns: int = 2, points: int = 360) -> Motion:
    layout = Layout(points_per_turn=points, start_deg=10.0, jitter_deg=0.0, legs=(Leg(turns, 1, rpm),))
    return run("spin", layout, stream(1))


def test_imports_nothing_but_numpy_and_the_standard_library() -> None:
    for path in Path(__file__).parent.glob("*.py"):
        allowed = {"numpy", *sys.stdlib_module_names, *(["pytest"] if "test_" in path.name else [])}
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                assert node.level <= 2, path
                names = [node.module or ""] if node.level == 0 else []
            assert {name.split(".")[0] for name in names} <= allowed, path


@pytest.mark.parametrize("label", OF_A_MEAN)
def test_mechanism_stands_clear_and_is_nothing_without_its_physics(label: str) -> None:
    settled = settle(label, 5)
    assert clearance_sigma(settled.device, settled.first, settled.noise_deg) >= CLEAR
    idle = replace(settled.device, mechanism=IDEAL)
    # rounding of numbers alone, on angles of up to a hundred turns
    assert clearance_sigma(idle, settled.first, settled.noise_deg) < 1e-3


@pytest.mark.parametrize("label", sorted(set(KINDS) - set(OF_A_MEAN)))
def test_words_and_noise_are_not_those_of_an_ideal_device(label: str) -> None:
    settled = settle(label, 5)
    with_it, without = (
        record(device, settled.first, settled.noise_deg, stream(3))
        for device in (settled.device, replace(settled.device, mechanism=IDEAL))
    )
    pairs = [(getattr(with_it, name), getattr(without, name)) for name in ("word_deg", "x", "reference_deg")]
    same = all(np.array_equal(one, other) for one, other in pairs)
    assert same == (label in ("white_raw", "coarse_word"))


def test_same_arguments_same_sweep_and_another_recording_is_of_the_same_device() -> None:
    first, same, again = draw("tanh", seed=4), draw("tanh", seed=4), draw("tanh", seed=4, recording=1)
    assert all(np.array_equal(first.columns[name], same.columns[name]) for name in first.columns)
    assert first.truth["baseline"] == again.truth["baseline"]
    assert len(first.columns["measured_deg"]) != len(again.columns["measured_deg"]) or not np.array_equal(
        first.columns["measured_deg"], again.columns["measured_deg"]
    )


def test_a_job_names_the_command_that_makes_it_again() -> None:
    jobs = [job for group in PHYSICS for job in physics_jobs(group, draws=1, seed=3)]
    assert len({job.label for job in jobs}) == len(jobs) == len(KINDS) >= 60
    assert jobs[0].again().command() == f"--make-physics {jobs[0].label} --seed {jobs[0].seed} --recording 1"


def test_field_far_away_is_that_of_a_dipole() -> None:
    """Beyond it is the next moment: that of a magnet of 3 mm at 60 mm is below (3 / 60)^2."""
    charges = magnets.prism(magnets.circle(3.0), 2.0)
    seen = magnets.field_of(charges, magnets.Assembly(60.0, sensor_mm=(30.0, 0.0)))
    at = np.linspace(0.0, 2 * np.pi, 50)
    x, y = seen(at)
    along = 30.0**2 / (30.0**2 + 61.0**2)
    # -m + 3 (m . r) r / r^2, its part that goes round with the magnet made 1
    dipole = np.stack([(3 * along - 1) * np.cos(at), -np.sin(at)]) / (1.5 * along - 1)
    assert np.allclose(np.stack([x, y]), dipole, atol=0.01)


def test_uniform_disc_in_the_middle_turns_without_an_error() -> None:
    x, y = magnets.field_of(magnets.prism(magnets.circle(4.0), 2.5), magnets.Assembly(1.5))(np.linspace(0.0, 6.0, 40))
    assert np.allclose(x + 1j * y, np.exp(1j * np.linspace(0.0, 6.0, 40)), atol=1e-6)


@pytest.mark.parametrize("make", [magnetisation.froehlich, magnetisation.hyperbolic, magnetisation.langevin])
def test_curves_are_odd_compressive_and_of_slope_one(make: object) -> None:
    curve, h = make(5.0), np.linspace(-2.0, 2.0, 401)  # type: ignore[operator]
    assert np.allclose(curve(h), -curve(-h))
    slope = np.gradient(curve(h), h)
    assert np.all((slope > 0.0) & (slope < 1.0 + 1e-6))
    assert curve(np.array([1e-3]))[0] == pytest.approx(1e-3, rel=1e-3)


def test_plays_lag_by_their_radius_and_relays_are_plays() -> None:
    angle = np.linspace(0.0, 4 * np.pi, 4001)
    path, radius = np.stack([np.cos(angle), np.sin(angle)], axis=1), np.array([0.1])
    held = vector_plays(path, radius)[-1, :, 0]
    # where the drawn state settles it is tangential: a right angle at it
    assert np.arctan2(-held[1], held[0]) == pytest.approx(np.arcsin(0.1), rel=0.01)
    assert np.hypot(*held) == pytest.approx(np.cos(np.arcsin(0.1)), rel=0.01)
    played = scalar_plays(path, radius)[:, :, 0]
    relayed = relays(path, np.linspace(-1.2, 1.2, 4801), radius) * 1.2
    # a play's output is between relays by half their spacing, and starts in the middle of its width
    assert np.allclose(played[400:], relayed[400:], atol=1e-3)


def test_ideal_converters_are_rulers() -> None:
    value = np.linspace(0.01, 4094.99, 5000)
    weights = 2.0 ** np.arange(11, -1, -1)
    assert np.array_equal(converters.approximate(value, weights), np.floor(value))
    codes = converters.approximate(value, weights, stuck=(8, 1)).astype(int)
    assert np.all(codes & 0b1000)
    inside = np.linspace(-0.99, 0.99, 999)
    assert np.allclose(converters.pipelined(inside, stages=14, first_gain=2.0), inside, atol=2.0**-13)
    assert np.ptp(converters.pipelined(inside, stages=14, first_gain=1.98) - inside) > 0.004


def test_cordic_errs_by_its_last_angle_and_by_its_guard_bits() -> None:
    angle = np.linspace(-3.1, 3.1, 2000)
    channels = np.cos(angle), np.sin(angle)

    def worst(iterations: int, guard: int) -> float:
        off = np.radians(cordics.integer_cordic(channels, iterations=iterations, guard=guard)) - angle
        return float(np.max(np.abs(np.angle(np.exp(1j * off)))))

    # 12-bit channels: a rounding of half a step at a length of 1024, and of one step of carry in each iteration
    assert worst(8, 6) == pytest.approx(np.arctan(2.0**-7), abs=1.0 / 1024)
    assert worst(12, 2) > 1.2 * worst(12, 8)


def test_joint_is_exact() -> None:
    planned = rotor.universal_joint(stream(2), settle("universal_joint", 2))  # type: ignore[arg-type]
    assert planned.mechanism.shaft is not None
    at = np.arange(0.0, 360.0, 0.5)
    moved = planned.mechanism.shaft(at, spin(60.0)) - at
    amplitude = planned.parameters["cardan_coupling"]["amplitude_deg"]
    # the series of the exact formula: tan^2(bend / 2), and its square over two at twice the order
    assert 2 * np.abs(np.mean(moved * np.exp(-2j * np.radians(at)))) == pytest.approx(amplitude, rel=1e-6)


@pytest.mark.parametrize("taps", [first_order(), second_order(0.7), exponential(0.25), np.full(8, 0.125)])
def test_filters_are_behind_a_ramp_by_their_mean_delay(taps: np.ndarray) -> None:
    motion, step_s = spin(600.0), 1e-5
    behind = follow_by(taps, step_s)(lambda shaft: shaft, motion)
    assert np.allclose(behind, -3600.0 * step_s * mean_delay(taps), rtol=1e-6)


def test_opposite_heads_cancel_an_eccentricity_to_its_square() -> None:
    turn = np.arange(360.0)
    one, other = (references.seen_by_head(turn, 0.004, 20.0, head) for head in (0.0, 180.0))
    assert np.max(np.abs(one)) == pytest.approx(np.degrees(0.004), rel=0.01)
    assert np.max(np.abs(one + other)) / 2 < np.degrees(0.004**2)


def test_lag_answers_a_step_exponentially() -> None:
    time = np.arange(0.0, 50.0, 0.7)
    chip = lagged(np.where(time > 0, 80.0, 20.0), time, 12.0)
    assert np.allclose(chip, 80.0 - 60.0 * np.exp(-time / 12.0))


def test_ringing_noise_has_unit_variance_and_its_resonance() -> None:
    radius, place = 0.9, 0.2
    first, second = 2 * radius * np.cos(2 * np.pi * place), -(radius**2)
    made = shaken.autoregressive(stream(1).standard_normal(200_000), first, second)
    # a share 1 - r^2 of the readings counts as independent: 3 standard errors of a variance
    assert np.var(made) == pytest.approx(1.0, abs=3 * np.sqrt(2 / (200_000 * 0.19)))
    power = np.abs(np.fft.rfft(made.reshape(-1, 500), axis=1)).mean(axis=0)
    assert np.argmax(power[1:]) + 1 == pytest.approx(place * 500, abs=5)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["adc_inl"], "right"),
        (["unnamed"], "right"),
        (["saturation"], "wrong name"),
        (["adc_inl", "saturation"], "extra"),
        ([], "missed"),
    ],
)
def test_several_answers_may_be_right(names: list[str], expected: str) -> None:
    truth = {"causes": ["adc_inl"], "answers": [["adc_inl"], ["unnamed"]], "tolerated": [], "named": True}
    assert verdict({"causes": [{"name": name} for name in names]}, truth) == expected


def test_unnamed_where_there_is_a_name_is_honest() -> None:
    truth = {"causes": ["saturation"], "answers": [["saturation"]], "tolerated": ["magnet_misalignment"], "named": True}

    def said(*names: str) -> str:
        return verdict({"causes": [{"name": name} for name in names]}, truth)

    assert said("unnamed", "unnamed", "magnet_misalignment") == "honest unnamed"
    assert said("unnamed", "clipping") == "wrong name"
    assert said("saturation", "unnamed") == "extra"
