"""The spins obey mechanics, their sensors err by what was put in, and the judge sees what is left."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ..baseline import Baseline, Injected
from .benches import PROTOCOLS
from .generator import Drawn, draw
from .sensor import PERFECT, Order, at_rest, coefficients
from .sets import NAMED, clean, of_causes
from .stamps import Clock

HERE = Path(__file__).parent
Array = np.ndarray[Any, np.dtype[np.float64]]


def test_same_arguments_same_bytes() -> None:
    first, again, other = (draw("two_speeds", seed=seed, causes=()) for seed in (5, 5, 6))
    assert [log.csv() for log in first.logs] == [log.csv() for log in again.logs]
    assert first.truth == again.truth
    assert [log.csv() for log in first.logs] != [log.csv() for log in other.logs]


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


def test_a_delay_is_nothing_that_a_sensor_alone_shows() -> None:
    """The same path with the time's zero moved: the torques know the angle, and not the time."""
    drawn = next(one for one in of_causes(draws=1, seed=2) if one.label == "latency").draw()
    assert drawn.truth["causes"] == []


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
    behind = stamps - times - float(str(drawn.truth["stamps_from_s"]))
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
