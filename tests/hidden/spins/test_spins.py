"""The spins obey mechanics, their sensors err by what was put in, and the judge sees what is left."""

from __future__ import annotations

import ast
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ..baseline import Baseline, Injected
from . import study
from .__main__ import main
from .benches import PROTOCOLS, TURN, coast
from .drives import Speeds
from .generator import Drawn, draw
from .judging import left_by, names_verdict, open_orders, wrong_orders
from .peers import PEERS, unwrapped
from .rotor import Belt, Hum, Rotor, Step, Trajectory, Wave, integrate
from .sensor import AtRest, Order, at_rest, coefficients, rms_of_orders
from .sets import NAMED, Job, clean, of_causes, of_protocols
from .stamps import Clock

HERE = Path(__file__).parent
PERFECT = Baseline(
    zero_deg=40.0,
    offset_x=0.0,
    offset_y=0.0,
    amplitude_x=1.0,
    amplitude_y=1.0,
    phase_deg=0.0,
    quadratic=0.0,
)
Array = np.ndarray[Any, np.dtype[np.float64]]


def test_imports_nothing_but_numpy_rich_and_the_standard_library() -> None:
    for path in HERE.glob("*.py"):
        allowed = {"numpy", "rich", *sys.stdlib_module_names, *(["pytest"] if "test_" in path.name else [])}
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [node.module or ""]
            assert {name.partition(".")[0] for name in names} <= allowed, path.name


def test_same_arguments_same_bytes() -> None:
    first, again, other = (draw("two_speeds", seed=seed, causes=()) for seed in (5, 5, 6))
    assert [log.csv() for log in first.logs] == [log.csv() for log in again.logs]
    assert first.truth == again.truth
    assert [log.csv() for log in first.logs] != [log.csv() for log in other.logs]


# --- mechanics ------------------------------------------------------------------------------------


def energy_of(rotor: Rotor, path: Trajectory) -> Array:
    """Energies [rad^2/s^2], a unit of the rotor's inertia, all but what friction takes."""
    energy = 0.5 * path.speed**2
    for wave in rotor.waves:
        energy = energy + wave.size / wave.order * np.cos(wave.order * path.angle + wave.phase)
    if rotor.belt is not None:
        stiffness = rotor.belt.inertia * (TURN * rotor.belt.frequency_Hz) ** 2
        twist = path.angle - path.behind_angle
        energy = energy + 0.5 * rotor.belt.inertia * path.behind_speed**2 + 0.5 * stiffness * twist**2
    return np.asarray(energy)


def test_without_friction_the_energy_stays() -> None:
    waves = (Wave(1, 30.0, 0.3), Wave(6, 400.0, 1.0))
    rotor = Rotor(waves=waves, belt=Belt(30.0, 0.0, 0.3))
    path = integrate(rotor, None, speed=60.0, duration_s=2.0)
    energy = energy_of(rotor, path)
    exchanged = np.ptp(0.5 * path.speed**2)
    assert exchanged > 100.0
    assert np.ptp(energy) < 1e-3 * exchanged


def test_friction_takes_the_energy_that_is_lost() -> None:
    rotor = Rotor(
        coulomb=10.0,
        viscous=0.4,
        quadratic=0.002,
        drag_ripple=0.1,
        viscous_ripple=0.05,
        drag_phase=0.7,
        waves=(Wave(4, 200.0, 0.2),),
    )
    path = integrate(rotor, None, speed=100.0, duration_s=4.0, stop=20.0)
    power = [
        (rotor.friction(speed) + (1.0 + 0.02 * speed) * math.cos(angle + 0.7)) * speed
        for angle, speed in zip(path.angle.tolist(), path.speed.tolist(), strict=True)
    ]
    energy = energy_of(rotor, path)
    assert np.sum(0.5 * np.add(power[1:], power[:-1]) * np.diff(path.time_s)) == pytest.approx(
        energy[0] - energy[-1], rel=1e-3
    )
    assert path.speed[-1] == pytest.approx(20.0, rel=0.05)


def response(rotor: Rotor, order: int, speed: float, drive: Speeds | None = None) -> float:
    """Amplitude [deg] of an order in the angle at a nearly constant speed, about a cubic in time."""
    path = integrate(rotor, drive, speed=speed, duration_s=20.0 * TURN / speed)
    times = np.linspace(0.2, 0.9, 4000) * path.time_s[-1]
    angle = path.at(times)[0]
    share = np.linspace(-1.0, 1.0, times.size)
    waves = [np.cos(order * angle), np.sin(order * angle)]
    found = np.linalg.lstsq(np.column_stack([np.vander(share, 4), *waves]), angle, rcond=None)[0]
    return math.degrees(math.hypot(*found[-2:]))


@pytest.mark.parametrize("order", [1, 3, 12])
def test_response_to_a_torque_falls_as_speed_squared(order: int) -> None:
    rotor = Rotor(waves=(Wave(order, 20.0 * order, 0.4),))
    slow, fast = response(rotor, order, 60.0), response(rotor, order, 120.0)
    assert slow == pytest.approx(rotor.response_deg(order, 60.0), rel=0.03)
    assert slow / fast == pytest.approx(4.0, rel=0.03)


@pytest.mark.parametrize("dry", [True, False])
def test_drag_that_comes_and_goes_once_a_turn_is_an_order_1(dry: bool) -> None:
    """Of the dry friction its response falls as the speed squared, of the viscous one as the speed."""
    friction = {"coulomb": 24.0, "drag_ripple": 0.1} if dry else {"viscous": 0.4, "viscous_ripple": 0.1}
    rotor = Rotor(**friction, drag_phase=2.0)
    found = []
    for speed in (60.0, 120.0):
        drive = Speeds((0.0,), (speed,), gain=0.0, feed=rotor.friction(speed))
        found.append(response(rotor, 1, speed, drive))
        assert found[-1] == pytest.approx(rotor.response_deg(1, speed), rel=0.05)
    assert found[0] / found[1] == pytest.approx(4.0 if dry else 2.0, rel=0.05)


def test_a_torque_adds_to_the_drag() -> None:
    rotor = Rotor(coulomb=20.0, drag_ripple=0.1, drag_phase=2.0, waves=(Wave(1, 1.0, 1.0),))
    drive = Speeds((0.0,), (60.0,), gain=0.0, feed=20.0)
    assert response(rotor, 1, 60.0, drive) == pytest.approx(rotor.response_deg(1, 60.0), rel=0.05)


def test_between_the_steps_lies_the_cubic() -> None:
    """Which a motion of constant jerk is."""
    steps, between = np.array([0.0, 0.1, 0.35, 0.5]), np.array([0.0, 0.04, 0.2, 0.34, 0.5])

    def angle(time: Array) -> Array:
        return np.asarray(1.0 + 2.0 * time - 3.0 * time**2 + 4.0 * time**3)

    def speed(time: Array) -> Array:
        return np.asarray(2.0 - 6.0 * time + 12.0 * time**2)

    path = Trajectory(steps, angle(steps), speed(steps), steps, steps)
    np.testing.assert_allclose(path.at(between), [angle(between), speed(between)], rtol=1e-12)


def test_mains_and_load_act_in_time() -> None:
    hum = Hum(100.0, 50.0, 0.0)
    path = integrate(Rotor(hums=(hum,)), None, speed=50.0, duration_s=1.0)
    times = np.linspace(0.1, 0.9, 8000)
    waves = [np.cos(TURN * 100.0 * times), np.sin(TURN * 100.0 * times)]
    found = np.linalg.lstsq(np.column_stack([np.vander(times, 2), *waves]), path.at(times)[0], rcond=None)[0]
    assert math.hypot(*found[-2:]) == pytest.approx(50.0 / (TURN * 100.0) ** 2, rel=0.01)
    loaded = integrate(Rotor(steps=(Step(0.5, -8.0),)), None, speed=50.0, duration_s=1.0)
    assert loaded.at(np.array([0.49, 0.99]))[1] == pytest.approx([50.0, 50.0 - 8.0 * 0.49], rel=5e-3)


def test_a_belt_swings_at_its_resonance() -> None:
    """Against the rotor's own inertia the spring is stiffer by the share of the second one."""
    belt = Belt(20.0, 0.0, 0.5)
    path = integrate(Rotor(belt=belt, steps=(Step(0.0, 5.0),)), None, speed=0.0, duration_s=2.0)
    times = np.linspace(0.0, 2.0, 16384, endpoint=False)
    twist = path.at(times)[0] - np.interp(times, path.time_s, path.behind_angle)
    spectrum = np.abs(np.fft.rfft((twist - twist.mean()) * np.hanning(times.size)))
    assert int(spectrum.argmax()) / 2.0 == pytest.approx(20.0 * math.sqrt(1.5), abs=0.3)


# --- sensor and log -------------------------------------------------------------------------------


def test_fourier_of_the_error_is_what_was_put_in() -> None:
    orders = (Order(1, 0.3, 20.0), Order(2, 0.2, -50.0), Order(5, 0.1, 90.0), Order(8, 0.04, 170.0))
    found = coefficients(at_rest(PERFECT, [], orders).error_deg)
    for one in orders:
        # a sin(k t + phase) = Re[-i a exp(i phase) exp(i k t)]
        wanted = -1j * one.amplitude_deg * np.exp(1j * np.radians(one.phase_deg))
        assert found[one.order - 1] == pytest.approx(wanted, abs=1e-6)
    others = [order for order in range(1, 17) if order not in {one.order for one in orders}]
    assert np.abs(found[[order - 1 for order in others]]).max() < 1e-6


def test_offset_gain_and_phase_are_orders_1_and_2() -> None:
    offset = at_rest(replace(PERFECT, offset_x=0.003, offset_y=-0.004), [], ())
    assert abs(coefficients(offset.error_deg)[0]) == pytest.approx(math.degrees(0.005), rel=0.01)
    gain = at_rest(replace(PERFECT, amplitude_y=1.01), [], ())
    assert abs(coefficients(gain.error_deg)[1]) == pytest.approx(math.degrees(0.005), rel=0.01)
    phase = at_rest(replace(PERFECT, phase_deg=0.6), [], ())
    assert abs(coefficients(phase.error_deg)[1]) == pytest.approx(0.3, rel=0.01)


def test_saturation_is_an_order_4() -> None:
    error = at_rest(PERFECT, [Injected("saturation", 0.1, {"k_percent": 1.0})], ()).error_deg
    assert abs(coefficients(error)[3]) == pytest.approx(math.degrees(0.01 / 4), rel=0.02)


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_readings_are_the_shaft_and_the_error_at_rest(protocol: str) -> None:
    """And noise and rounding, nothing else."""
    drawn = draw(protocol, seed=4)
    truth = drawn.at_rest
    for log in drawn.logs:
        wanted = np.interp(log.shaft_deg, truth.shaft_deg, truth.reading_deg - truth.shaft_deg, period=360.0)
        off = (log.columns["measured_deg"] - log.shaft_deg - wanted + 180.0) % 360.0 - 180.0
        rounding = 360.0 / 2 ** int(str(drawn.truth["output_bits"])) / math.sqrt(12.0)
        assert np.std(off) == pytest.approx(math.hypot(float(str(drawn.truth["noise_deg"])), rounding), rel=0.1)
        assert abs(np.mean(off)) < 0.01


@pytest.mark.parametrize("cause", NAMED)
def test_every_cause_shows_in_the_readings(cause: str) -> None:
    """Readings scatter about what the factors alone make of the shaft by more than noise and rounding."""
    drawn = next(one for one in of_causes(draws=1, seed=2) if one.label == cause).draw()
    assert drawn.truth["causes"] == [cause]
    assert scatter(drawn) > 1.3


@pytest.mark.parametrize("seed", range(3))
def test_nothing_but_the_factors_shows_in_clean_readings(seed: int) -> None:
    assert scatter(clean(draws=1, seed=seed)[0].draw()) == pytest.approx(1.0, abs=0.1)


def scatter(drawn: Drawn) -> float:
    """Of the readings about what the factors alone make of the shaft, over noise and rounding."""
    log = drawn.logs[0]
    off = np.angle(np.exp(1j * np.radians(log.columns["measured_deg"] - log.shaft_deg)))
    bare = at_rest(draw_baseline(drawn.truth), [], ())
    wanted = np.radians(np.interp(log.shaft_deg, bare.shaft_deg, bare.error_deg, period=360.0))
    left = np.angle(np.exp(1j * (off - wanted)))
    left = np.degrees(np.angle(np.exp(1j * (left - np.median(left)))))
    rounding = 360.0 / 2 ** int(str(drawn.truth["output_bits"])) / math.sqrt(12.0)
    if drawn.truth["causes"] == ["output_quantisation"]:
        rounding = 0.0
    return float(np.std(left) / math.hypot(float(str(drawn.truth["noise_deg"])), rounding))


def draw_baseline(truth: Mapping[str, Any]) -> Baseline:
    """The sensor's factors as the truth tells them."""
    told = truth["factors"]
    return replace(
        PERFECT,
        zero_deg=told["zero_deg"],
        offset_x=told["Vx_over_Ax"],
        offset_y=told["Vy_over_Ay"] * told["gain_ratio"],
        amplitude_y=told["gain_ratio"],
        phase_deg=told["beta_deg"],
        quadratic=told["quad"],
    )


def test_a_late_reading_is_of_where_the_shaft_was() -> None:
    drawn = next(one for one in of_causes(draws=1, seed=2) if one.label == "latency").draw()
    log, truth = drawn.logs[0], drawn.at_rest
    speed = np.gradient(log.shaft_deg, log.time_s)
    wanted = np.interp(log.shaft_deg, truth.shaft_deg, truth.reading_deg - truth.shaft_deg, period=360.0)
    off = np.unwrap(np.radians(log.columns["measured_deg"] - log.shaft_deg - wanted))
    delay = -np.polyfit(speed, np.degrees(off), 1)[0] * 1e6
    assert delay == pytest.approx(drawn.truth["parameters"]["latency"]["delay_us"], rel=0.05)  # type: ignore[index]


def test_stamps_through_usb_are_those_of_frames() -> None:
    drawn = draw("coast", seed=7, usb=True)
    stamps, times = drawn.logs[0].columns["time_s"], drawn.logs[0].time_s
    assert np.abs(stamps * 1e3 - np.round(stamps * 1e3)).max() < 1e-6
    behind = stamps - times - drawn.truth["frame"]["first_time_s"]  # type: ignore[index]
    assert -1.2e-3 < behind.min() < behind.max() < 0.2e-3
    fine = draw("coast", seed=7)
    late = fine.logs[0].columns["time_s"] - fine.logs[0].time_s
    assert np.std(late) < 3.0 * float(str(fine.truth["jitter_s"])) + 1e-6


def test_rows_are_dropped() -> None:
    even = Clock(period_s=1e-3, jitter_s=0.0, resolution_s=1e-6, dropped=0.0, gap_s=0.0, start_s=0.0)
    rng = np.random.default_rng(0)
    np.testing.assert_allclose(np.diff(even.instants(5.0, rng)), 1e-3)
    assert replace(even, dropped=0.1).instants(5.0, rng).size == pytest.approx(4500, abs=100)
    lapse = np.diff(replace(even, gap_s=0.2).instants(5.0, rng))
    assert np.count_nonzero(lapse > 0.15) == np.count_nonzero(lapse > 1.1e-3) == 1


# --- the judge ------------------------------------------------------------------------------------


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


def test_a_coast_slows_to_where_it_is_meant_to() -> None:
    """Its friction is drawn for a time; torques must neither stop it early nor keep it going."""
    for seed in range(6):
        (spin,) = coast(np.random.default_rng(seed))
        path = spin.run()
        assert path.speed[-1] < spin.stop
        assert path.time_s[-1] == pytest.approx(spin.expected_s, rel=0.6)
