"""Ringing: noise in a narrow band is noise, and a line that stands in it is none of it."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.joint_fit import evaluate, solve
from diagnosis.discovery.stages.ringing import ringing
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, with_residual
from twin.angles import Array
from twin.noise.description import Noise
from twin.noise.sequences import draw

ROWS = 720
RINGING = Noise(ringing_per_reading=0.13, ringing_quality=9.0, white_share=0.36)


def read(noise: Noise, seed: int, *, line_deg: float = 0.0, order: int = 94) -> dict[str, Array]:
    """A sweep of one turn with an offset, noise of 0.02 deg, and a line: order 94 is in mid-band."""
    shaft = np.arange(ROWS) * (360.0 / ROWS)
    rung = 0.02 * draw(np.random.default_rng(seed), (ROWS,), noise.spectrum(ROWS))
    error = 0.4 * np.sin(np.radians(shaft)) + line_deg * np.sin(np.radians(order * shaft)) + rung
    return {"reference_deg": shaft, "measured_deg": shaft + error}


def left_with(noise: Noise, seed: int) -> State:
    """The state that the stage is handed, with this noise in the place of what is left."""
    state = before(ringing, Made(points=ROWS))
    return with_residual(state, np.radians(0.02) * draw(np.random.default_rng(seed), (ROWS,), noise.spectrum(ROWS)))


@pytest.mark.parametrize("seed", range(4))
def test_a_bracket_that_rings_is_no_cause(seed: int) -> None:
    found = explain(read(RINGING, seed))
    assert found.causes == ()
    assert found.verdict == "adequate"
    told = found.extended.values["noise"]
    # A band of this width in so many readings is told to a tenth of its width, its quality to a quarter; three sigma.
    assert told["ringing_per_reading"] == pytest.approx(0.13, abs=0.3 * 0.13 / 9.0)
    assert np.log(told["ringing_quality"] / 9.0) == pytest.approx(0.0, abs=0.8)


@pytest.mark.parametrize("noise", [Noise(), RINGING], ids=["in white noise", "in the band"])
def test_a_line_that_stands_out_is_a_line(noise: Noise) -> None:
    found = explain(read(noise, 1, line_deg=0.05))
    assert [cause.name for cause in found.causes] == ["drive_ripple"]
    assert found.extended.values["drive_ripple"]["order"] == 94.0


@pytest.mark.parametrize("noise", [Noise(), Noise(correlation=0.7), Noise(flicker_exponent=1.0)], ids=lambda n: n.label)
@pytest.mark.parametrize("seed", range(3))
def test_other_noise_does_not_ring(noise: Noise, seed: int) -> None:
    state = left_with(noise, seed)
    assert ringing(state) is state


def test_from_then_on_the_noise_may_ring() -> None:
    """Both fits are weighed by the same family; once it has a resonance there is no more to say."""
    after = ringing(left_with(RINGING, 1))
    assert after.baseline is not None
    for fit in (after.fit, after.baseline):
        assert [noise.rings for noise in fit.weighting.family.members] == [False] * 16 + [True]
        assert fit.weighting.family.spectra.shape == (17, ROWS)
    assert ringing(after) is after


def test_several_lines_of_one_band_make_way_for_it() -> None:
    """A search that takes the noise to be white makes lines of the peaks of the band: all of them go."""
    state = left_with(RINGING, 0)
    line = state.fit.chain.with_effect("drive_ripple", order=94.0, amplitude_deg=0.004)
    line = line.with_effect("drive_ripple#2", order=90.0, amplitude_deg=0.004).with_effect("magnet_harmonic", order=5.0)
    keys = ("drive_ripple", "drive_ripple#2", "magnet_harmonic")
    free = tuple(Free(key, name) for key in keys for name in ("amplitude_deg", "phase_deg"))
    fit = state.fit
    fitted = solve(evaluate(line, (*fit.free, *free), fit.observations, fit.weighting))
    assert ringing(state.with_(fitted, keys=keys)).keys == ("magnet_harmonic",)


def test_without_a_reference_a_bearing_that_rings_is_no_cause() -> None:
    """In several stretches: the noise is alike in all, and the shaft's own motion is no part of it."""
    time = np.delete(np.arange(4100) / 1000.0, np.arange(2000, 2100))
    rung = 0.02 * draw(np.random.default_rng(1), (4000,), RINGING.spectrum(4000))
    found = explain({"time_s": time, "measured_deg": np.mod(360.0 * 9.3 * time + rung, 360.0)})
    assert found.to_dict()["motion"]["stretches"] > 1
    assert found.causes == ()
    told = found.extended.values["noise"]
    assert told["ringing_per_reading"] == pytest.approx(0.13, abs=0.3 * 0.13 / 9.0)
