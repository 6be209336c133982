"""One physical cause, one name: sweeps made from physics, not by the twin's own formulas.

Each holds one cause beside offsets and a gain mismatch, far stronger than the noise, so that the right name is certain
and everything else is an invention.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from diagnosis import explain
from twin.angles import Array

NOISE_DEG = 0.02


def channels(field_rad: Array, curve: Callable[[Array], Array] = np.asarray) -> Array:
    """Two channels (2, n) of a field at these angles, each behind the same curve."""
    x, y = curve(np.cos(field_rad + 0.7)), curve(np.sin(field_rad + 0.7))
    return np.stack([x + 0.006, 1.004 * y - 0.004])


def sweep(shaft_rad: Array, signal: Array, seed: int, **columns: Array) -> dict[str, Array]:
    """Columns of a sweep: noise on both channels, the angle in words of 14 bits."""
    noisy = signal + np.radians(NOISE_DEG) * np.random.default_rng(seed).standard_normal(signal.shape)
    step = 360.0 / 2**14
    measured = step * np.round(np.degrees(np.arctan2(noisy[1], noisy[0])) / step)
    return {"reference_deg": np.degrees(shaft_rad), "measured_deg": measured, **columns}


def named(columns: dict[str, Array]) -> dict[str, dict[str, Any]]:
    """The causes by name, each with its parameters' figures."""
    return {cause["name"]: cause["parameters"] for cause in explain(columns).to_dict()["causes"]}


def turns(points: int, count: int) -> Array:
    """Angles [rad] of so many turns one way."""
    return np.arange(points * count) * 2.0 * np.pi / points


def froehlich(field: Array) -> Array:
    """Froehlich's magnetisation curve: 2 % less at full amplitude."""
    return np.asarray(field / (1.0 + 0.02 * np.abs(field)))


def cubic(field: Array) -> Array:
    """So strong that the error is steeper from reading to reading than the noise."""
    return np.asarray(field - 0.0333 * field**3)


@pytest.mark.parametrize(("curve", "k_percent"), [(froehlich, 1.54), (cubic, 3.33)])
def test_any_curve_that_falls_behind_is_one_saturation(curve: Callable[[Array], Array], k_percent: float) -> None:
    """k is that of the cubic with the same order 4, in Froehlich's curve by its Fourier series 0.77 of the loss."""
    shaft = turns(90, 4)
    signal = channels(shaft, curve)
    found = named(sweep(shaft, signal, 3, vx=signal[0], vy=signal[1]))
    assert list(found) == ["saturation"]
    assert found["saturation"]["k_percent"]["value"] == pytest.approx(k_percent, abs=0.06)


@pytest.mark.parametrize(("k", "raw"), [(0.02, True), (0.05, True), (0.02, False)])
def test_a_curve_that_runs_ahead_is_an_s_of_the_converter(k: float, raw: bool) -> None:
    """No saturation does that; in angles alone a magnet's harmonic does the same.

    A channel c + k c^3 has, straight through both ends of a range of R amplitudes, an S of 2 k R^2 / sqrt(27) /
    (1 + k R^2) of its amplitude. The sweep tells k; R is known to be about 1.25 +- 0.3, and so is the S.
    """
    shaft = turns(90, 4)
    straight = channels(shaft)
    signal = straight + k * straight**3
    answer = explain(sweep(shaft, signal, 7, **({"vx": signal[0], "vy": signal[1]} if raw else {}))).to_dict()
    (cause,) = answer["causes"]
    assert {cause["name"], *cause["indistinguishable_from"]} == {"adc_inl"} | (set() if raw else {"magnet_harmonic"})
    if cause["name"] == "adc_inl":
        assert set(cause["parameters"]) == {"s_lsb", "full_scale_percent", "cubic_percent"}
        told = cause["parameters"]["cubic_percent"]
        assert told["low"] < 100.0 * k < told["high"]
        # Its order 4 is k / 4 of a turn's radian in angle and radius, each with 0.02 deg in 360 readings: a standard
        # deviation of 0.01 % of k, of the angle alone 0.015 %.
        assert told["high"] - told["low"] < 4.0 * 1.3 * (0.01 if raw else 0.015)
        for assumed in (1.1, 1.55):
            steps = 2.0 * k * assumed**2 / np.sqrt(27.0) / (1.0 + k * assumed**2) * 2.0**13
            assert cause["parameters"]["s_lsb"]["low"] < -steps < cause["parameters"]["s_lsb"]["high"]


@pytest.mark.parametrize("level", [0.5, 0.67, 0.75, 0.8])
def test_channels_that_are_cut_off_by_a_third_are_clipped(level: float) -> None:
    """So deep that below the root of a half both are cut off at once between the axes, and the angle stands still."""
    shaft = turns(100, 2)
    signal = np.clip(channels(shaft), -level, level)
    found = named(sweep(shaft, signal, 11))
    assert list(found) == ["clipping"]
    told = found["clipping"]["level_percent"]
    assert told["low"] <= 100.0 * level <= told["high"]


@pytest.mark.parametrize(("level", "ends"), [(0.15, (-1, 1)), (0.64, (1,)), (0.4, (-1,))])
def test_a_range_may_cut_off_nearly_all_or_one_end_alone(level: float, ends: tuple[int, ...]) -> None:
    """Down to a square wave; and at one end only, as of channels whose middle is not that of the converter."""
    shaft = turns(100, 1)
    signal = np.clip(channels(shaft), -level if -1 in ends else -2.0, level if 1 in ends else 2.0)
    found = named(sweep(shaft, signal, 13))
    assert list(found) == ["clipping"]
    told = found["clipping"]["level_percent"]
    assert told["low"] <= 100.0 * level <= told["high"]
    sides = {name: abs(found["clipping"][name]["value"]) for name in found["clipping"] if name.endswith("_side")}
    assert sides == ({} if len(ends) == 2 else {"x_side": 1.0, "y_side": 1.0})


def follower(shaft_rad: Array, radius: float) -> Array:
    """A vector that is dragged by the unit vector at these angles on a leash of this length, as complex (n,)."""
    path = np.concatenate([np.linspace(a, b, 30) for a, b in itertools.pairwise(shaft_rad)])
    dragged = np.sqrt(1.0 - radius**2) * np.exp(1j * (shaft_rad[0] - np.sign(path[1] - path[0]) * np.arcsin(radius)))
    found = [dragged]
    for place, angle in enumerate(path):
        leash = np.exp(1j * angle) - dragged
        dragged += leash * max(1.0 - radius / max(abs(leash), 1e-12), 0.0)
        if place % 30 == 29:
            found.append(dragged)
    return np.array(found)


def test_a_stack_of_plays_is_one_hysteresis() -> None:
    """Also where the stop at which the shaft turns round is recorded with the way in which it is left."""
    up = np.radians(np.arange(0.0, 725.0, 5.0))
    shaft = np.concatenate([up, up[-2::-1], up[1:], up[-2::-1]])
    field = np.exp(1j * shaft) + sum(0.03 * follower(shaft, radius) for radius in (0.03, 0.08, 0.15))
    left = np.sign(np.diff(shaft, append=2.0 * shaft[-1] - shaft[-2]))
    found = named(sweep(shaft, channels(np.unwrap(np.angle(field))), 5, direction=left))
    assert list(found) == ["hysteresis"]
    steady = np.degrees(sum(0.03 * r * np.sqrt(1.0 - r * r) for r in (0.03, 0.08, 0.15)) / 1.09)
    assert found["hysteresis"]["lag_deg"]["value"] == pytest.approx(steady, rel=0.1)


def played(axis: Array, radius: float) -> Array:
    """What a play of this radius makes of the path (n,) of one axis, which it has run along before."""
    state, out = axis[0] - np.sign(axis[1] - axis[0]) * radius, np.empty_like(axis)
    for row, at in enumerate(axis):
        state = out[row] = np.clip(state, at - radius, at + radius)
    return out


def test_plays_on_each_axis_are_one_hysteresis() -> None:
    """Over a turn the lag ripples four and eight times, and the axes fall short at their ends as if they saturated."""
    up = turns(180, 2)
    shaft = np.concatenate([up, up[::-1]])
    axes = np.stack([np.cos(shaft + 0.7), np.sin(shaft + 0.7)])
    radii = (0.03, 0.08, 0.15)
    lagging = np.stack([(0.985 * axis + sum(0.005 * played(axis, radius) for radius in radii)) for axis in axes])
    direction = np.repeat([1.0, -1.0], up.size)
    columns = sweep(shaft, lagging * np.array([[1.0], [1.004]]) + np.array([[0.006], [-0.004]]), 5, direction=direction)
    found = named(columns)
    assert list(found) == ["hysteresis"]
    # a play lags by its radius but for its way back, over which it is nothing in the mean: 2 r of the axis' 2
    steady = np.degrees(sum(0.005 * radius * (1.0 - radius) for radius in radii) * 4.0 / np.pi)
    assert found["hysteresis"]["lag_deg"]["value"] == pytest.approx(steady, rel=0.05)
    assert found["hysteresis"]["on_axes"]["value"] == pytest.approx(1.0, abs=0.15)


def test_a_shaft_that_drag_twists_is_one_thing() -> None:
    """It stays behind with the square of the speed, and all errors of the sensor with it."""
    turn, columns = turns(120, 1), []
    for rpm, way in itertools.product((100.0, 600.0, 1800.0), (1.0, -1.0)):
        twist = np.radians(0.3) * way * (rpm / 1800.0) ** 2
        x, y = channels(turn[:: int(way)] - twist) + np.array([[0.02], [0.01]])
        columns.append(np.stack([turn[:: int(way)], x, y, np.full(turn.size, way * rpm)]))
    shaft, x, y, rpm = np.concatenate(columns, axis=1)
    answer = explain(sweep(shaft, np.stack([x, y]), 3, speed_rpm=rpm, direction=np.sign(rpm))).to_dict()
    assert [cause["name"] for cause in answer["causes"]] == ["unnamed"]
    (structure,) = answer["unexplained"]["structure"]
    assert (structure["kind"], structure["power"]) == ("speed", 2.0)
    # 240 readings of 0.02 deg tell it to 0.0013 deg
    assert structure["amplitude_deg"] == pytest.approx(-0.3, abs=0.005)


def test_a_tracking_loop_is_one_latency() -> None:
    """A loop of type 2 adds no delay, but raises each order with the speed; behind it the word is 20 us old."""
    natural_rad_s, damping, delay_s = 2000.0, 0.8, 20e-6
    turn = turns(180, 1)
    x, y = channels(turn)
    error = np.fft.fft(np.angle((x + 1.09j * y) * np.exp(-1j * (turn + 0.7)))) / turn.size
    order = np.fft.fftfreq(turn.size, 1.0 / turn.size)
    shaft, measured, rpm = [], [], []
    for speed, way in itertools.product((100.0, 600.0, 1800.0), (1.0, -1.0)):
        rate, angle = way * speed * 2.0 * np.pi / 60.0, way * turns(180, 2)
        s = 1j * order * rate
        proportional = 2.0 * damping * natural_rad_s * s + natural_rad_s**2
        old = angle - rate * delay_s
        passed = np.exp(1j * np.outer(old, order)) @ (error * proportional / (s**2 + proportional))
        shaft.append(angle)
        measured.append(old + 0.7 + passed.real)
        rpm.append(np.full(angle.size, speed * way))
    noise = np.radians(NOISE_DEG) * np.random.default_rng(4).standard_normal(6 * 360)
    found = named(
        {
            "reference_deg": np.degrees(np.concatenate(shaft)) % 360.0,
            "measured_deg": np.degrees(np.concatenate(measured) + noise) % 360.0,
            "speed_rpm": np.concatenate(rpm),
        }
    )
    assert list(found) == ["latency"]
    told = found["latency"]
    # the fastest turns tell order 0 to 0.02 deg / sqrt(720) each way, at 10800 deg/s: four sigma
    assert told["delay_us"]["value"] == pytest.approx(1e6 * delay_s, abs=4e6 * NOISE_DEG / np.sqrt(1440.0) / 10800.0)
    # ln H = -s^2 / natural^2 + ...
    assert told["variance_ms2"]["value"] == pytest.approx(-2e6 / natural_rad_s**2, rel=0.1)


def approximated(axis: Array, *, stuck: int) -> Array:
    """An axis (n,) in codes of 12 bits and a range of 1.25, by successive approximation with one bit held at zero."""
    value, held = (axis + 1.25) / 2.5 * 4096.0, np.zeros_like(axis)
    for bit in range(11, -1, -1):
        held += np.where((value >= held + 2.0**bit) & (bit != stuck), 2.0**bit, 0.0)
    return np.asarray((held + 0.5) / 4096.0 * 2.5 - 1.25)


def test_a_bit_stuck_inside_the_approximation_is_a_stuck_bit() -> None:
    """A step of 8 codes, 0.49 % of an amplitude, seen at 80 angles, each of them four times."""
    shaft = turns(80, 4)
    noisy = channels(shaft) + np.radians(NOISE_DEG) * np.random.default_rng(6).standard_normal((2, shaft.size))
    x, y = (approximated(axis, stuck=3) for axis in noisy)
    found = named({"reference_deg": np.degrees(shaft), "measured_deg": np.degrees(np.arctan2(y, x))})
    assert list(found) == ["adc_stuck_bit"]
    told = found["adc_stuck_bit"]
    assert told["in_approximation"]["value"] == 1.0
    assert told["level"]["value"] == 0.0
    assert told["step_percent"]["value"] == pytest.approx(100.0 * 8 * 2.5 / 4096.0, rel=0.005)


def test_a_pipeline_whose_first_gain_is_short_is_one_nonlinearity() -> None:
    """1 % short: the residue of the digits -1, 0 and 1 comes back too small, a saw with teeth of half the range."""
    shaft = turns(100, 4)
    x, y = channels(shaft) / 1.25
    short = [
        1.25 * (axis - 0.01 * (axis - 0.5 * (np.sign(axis - 0.25) + np.sign(axis + 0.25)) / 2.0)) for axis in (x, y)
    ]
    assert list(named(sweep(shaft, np.stack(short), 8))) == ["adc_inl"]


def test_an_offset_that_creeps_after_switching_on_is_seen() -> None:
    """It has no name here, but is one thing: its size at the end and its time constant are those that were put in."""
    shaft = turns(90, 4)
    time_s = 0.4 * np.arange(shaft.size)
    grown = np.radians(0.25) * -np.expm1(-time_s / 30.0)
    signal = channels(shaft) + np.stack([0.6 * grown, -0.8 * grown])
    answer = explain(sweep(shaft, signal, 9, time_s=time_s, vx=signal[0], vy=signal[1])).to_dict()
    assert [cause["name"] for cause in answer["causes"]] == ["unnamed"]
    (structure,) = answer["unexplained"]["structure"]
    assert structure["kind"] == "creep"
    # 360 readings tell each parameter to 0.02 deg / sqrt(360 / 2), a hundredth of it
    assert structure["amplitude_deg"] == pytest.approx(0.25 * -np.expm1(-time_s[-1] / 30.0), rel=0.05)
    assert structure["time_constant_s"] == pytest.approx(30.0, rel=0.15)


def test_an_offset_behind_the_oven_is_one_drift() -> None:
    """The chamber steps between turns of 36 s, the sensor follows in 25 s: most of a turn is on the way."""
    shaft = turns(90, 4)
    time_s, chamber = 0.4 * np.arange(shaft.size), np.repeat([0.0, 20.0, 40.0, 60.0], 90)
    body = np.zeros(shaft.size)
    for row in range(1, shaft.size):
        body[row] = chamber[row] + np.exp(-0.4 / 25.0) * (body[row - 1] - chamber[row])
    moved = np.radians(0.012) * (body - 25.0)
    signal = channels(shaft) + np.stack([0.6 * moved, -0.8 * moved])
    found = named(sweep(shaft, signal, 9, time_s=time_s, temperature_c=chamber))
    assert list(found) == ["offset_drift"]
    # 360 readings of 0.02 deg tell 0.4 deg to about 0.5 %, and the lag, seen in half of them, to 5 %
    assert found["offset_drift"]["lag_s"]["value"] == pytest.approx(25.0, rel=0.2)
    assert found["offset_drift"]["x_percent_per_K"]["value"] == pytest.approx(60.0 * np.radians(0.012), rel=0.05)


def test_an_offset_that_bends_with_temperature_is_one_drift() -> None:
    """Of four temperatures at equal times the bend makes up for what they are not equally apart: as if in time."""
    shaft = turns(90, 4)
    warm = np.repeat([-40.0, 25.0, 85.0, 125.0], 90) - 25.0
    moved = np.radians(0.002) * warm * (1.0 + 0.003 * warm)
    signal = channels(shaft) + np.stack([0.6 * moved, -0.8 * moved])
    found = named(sweep(shaft, signal, 9, time_s=0.4 * np.arange(shaft.size), temperature_c=warm + 25.0))
    assert list(found) == ["offset_drift"]
    # the offset's 0.26 deg between the ends is known to a hundredth, and so is the tenth of it that the bend makes
    assert found["offset_drift"]["bend_per_K"]["value"] == pytest.approx(0.003, rel=0.3)


def test_a_gain_that_bends_with_temperature_is_one_drift() -> None:
    """The mobility of carriers falls as a power of the absolute temperature: more steeply in the cold."""
    shaft = turns(90, 4)
    kelvin = np.repeat([-40.0, 25.0, 85.0, 125.0], 90) + 273.15
    warm, grown = kelvin - 298.15, 0.05 * ((298.15 / kelvin) ** 1.5 - 1.0)
    signal = channels(shaft)
    signal[1] *= 1.0 + grown
    found = named(sweep(shaft, signal, 9, time_s=0.4 * np.arange(shaft.size), temperature_c=kelvin - 273.15))
    assert list(found) == ["gain_drift"]
    slope, bend = np.linalg.lstsq(np.stack([warm, warm**2], axis=1), grown, rcond=None)[0]
    # 90 readings of 0.02 deg at each temperature tell the gain there to 0.01 %, of 2 to 3 % that it moves.
    assert found["gain_drift"]["percent_per_K"]["value"] == pytest.approx(100.0 * slope, rel=0.03)
    assert found["gain_drift"]["bend_per_K"]["value"] == pytest.approx(bend / slope, rel=0.1)


def test_a_play_under_weight_is_one_thing() -> None:
    """Seen in the radius too, it is no misplaced magnet with harmonics: an error of the shaft, of all odd orders."""
    shaft = turns(180, 2)
    signal = channels(shaft + np.radians(0.15) * np.tanh(np.sin(shaft - 1.0) / np.radians(4.0)))
    noisy = signal + np.radians(NOISE_DEG) * np.random.default_rng(4).standard_normal(signal.shape)
    columns = {"reference_deg": np.degrees(shaft), "measured_deg": np.degrees(np.arctan2(noisy[1], noisy[0]))}
    answer = explain({**columns, "vx": noisy[0], "vy": noisy[1]}).to_dict()
    assert [cause["name"] for cause in answer["causes"]] == ["unnamed"]
    (structure,) = answer["unexplained"]["structure"]
    assert structure["kind"] == "flanks"
    # 360 readings tell the height to 0.001 deg, and 12 on the way over where it is, to 0.2 of the width
    assert structure["height_deg"] == pytest.approx(0.15, abs=0.005)
    assert structure["centre_deg"] == pytest.approx(np.degrees(1.0), abs=2.0)


def test_a_field_that_bends_beside_the_shaft_is_no_bump() -> None:
    """Orders that fall in proportion bend the angle at one place, more broadly than what is local."""
    shaft = turns(120, 4)
    bent = sum(np.radians(0.5 * 0.45 ** (order - 3)) * np.sin(order * (shaft - 2.1)) for order in (3, 4, 5, 6))
    answer = explain(sweep(shaft, channels(shaft + bent), 10)).to_dict()
    assert "magnet_harmonic" in [cause["name"] for cause in answer["causes"]]
    assert "local" not in [structure["kind"] for structure in answer["unexplained"]["structure"]]


@pytest.mark.parametrize("seed", [1, 2])
def test_what_physics_forbids_has_no_name(seed: int) -> None:
    """A curve that runs ahead of the field, and a sensor ahead of the direction: `saturation` and lags lie at zero."""
    shaft = turns(72, 2)
    shaft = np.concatenate([shaft, shaft[::-1]])
    direction = np.repeat([1.0, -1.0], shaft.size // 2)
    signal = channels(shaft + np.radians(0.1) * direction, lambda field: field + 0.015 * field**3)
    assert {"saturation", "hysteresis", "backlash"}.isdisjoint(named(sweep(shaft, signal, seed, direction=direction)))


def test_a_reference_that_loses_counts_several_times_slips() -> None:
    """No drift and no slow order makes up for it."""
    shaft = turns(90, 4)
    time_s = 0.4 * np.arange(shaft.size)
    slips = ((40.0, 0.12), (75.0, 0.09), (110.0, 0.15))
    lost = sum(np.radians(step) * (time_s >= at) for at, step in slips)
    found = named(sweep(shaft - lost, channels(shaft), 7, time_s=time_s))
    assert list(found) == ["index_slip"]
    figures = found["index_slip"]
    instants = [figures[name]["value"] for name in ("time_s", "time_s_2", "time_s_3")]
    assert np.sort(instants) == pytest.approx([at for at, _ in slips], abs=0.4)
    steps = [figures[name]["value"] for name in ("step_deg", "step_deg_2", "step_deg_3")]
    # A step is told by a hundred readings on each side: five standard deviations.
    assert np.array(steps)[np.argsort(instants)] == pytest.approx([step for _, step in slips], abs=0.02)


def test_a_ripple_with_harmonics_is_one_reference_ripple() -> None:
    """Also where they lie beyond half the rate of the readings, which come at uneven intervals: no jitter beside."""
    rng = np.random.default_rng(1)
    time_s = np.cumsum(0.0045 * (1.0 + 0.3 * rng.uniform(-1.0, 1.0, 600)))
    shaft = 4.0 * np.pi * time_s

    def converted(at_s: Array) -> Array:
        return np.asarray(sum(0.004 * np.cos(2.0 * np.pi * 61.0 * k * at_s + k) / k for k in (1, 2, 3)))

    ratio = 1.0 + np.stack([converted(time_s), converted(time_s + 0.0009)])
    found = named(sweep(shaft, channels(shaft) * ratio, 2, time_s=time_s, speed_rpm=np.full(time_s.size, 120.0)))
    assert list(found) == ["reference_ripple"]
    lines = [figure["value"] for name, figure in found["reference_ripple"].items() if name.startswith("frequency_Hz")]
    assert np.sort(lines) == pytest.approx([61.0, 122.0, 183.0], abs=0.1)


@pytest.mark.parametrize(
    ("lines", "drive"),
    [(((50, 0.06), (100, 0.03)), {50, 100}), (((100, 0.06), (50, 0.03)), {50, 100}), (((40, 0.06), (44, 0.05)), {40})],
)
def test_a_drive_has_one_order_and_its_multiples(lines: tuple[tuple[int, float], ...], drive: set[int]) -> None:
    """Another line has no name."""
    shaft = turns(250, 2)
    moved = sum(np.radians(size) * np.sin(order * shaft + order) for order, size in lines)
    found = named(sweep(shaft, channels(shaft + moved), 4))
    assert set(found) == {"drive_ripple"} | ({"unnamed"} if len(drive) == 1 else set())
    figures = found["drive_ripple"].items()
    assert {round(figure["value"]) for name, figure in figures if name.startswith("order")} == drive
