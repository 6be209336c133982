"""One device at several air gaps: what each effect is there by physics, expected and as built.

The laws stand here by hand, the field on the axis is magpylib's, and the errors are the signatures of
:mod:`tests.contract.examples`, worked out from first principles: nothing of it is the twin's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest

from scenarios.commands import simulate
from scenarios.commands.protocol import Protocol
from tests.contract.examples import EXAMPLES, Params
from twin.adc.converter import Converter
from twin.air_gap import at_air_gap
from twin.angles import TAU, Array, wrap
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.each_recording import in_setup
from twin.errors import UserError
from twin.example import full_motion
from twin.limits import OutOfRangeError
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import Motion
from twin.parts import Parts
from twin.presets import read_preset
from twin.recordings import Setup
from twin.sweep import Sweep

NEAR_MM, GAPS_MM = 1.5, (0.8, 1.5, 3.0)
DIAMETER_MM, HEIGHT_MM = 6.0, 2.5

VOLTS, STAYS, SQUARE = -1, 0, 1
"""Powers of the field of what is constant in volts (or millitesla), of a share, of a term of second order."""
FOLLOWS: Mapping[str, Mapping[str, int]] = {
    "stray_field": {"field_mT": 1},
    "motor_field": {"field_mT": 1},
    "hysteresis": {"lag_deg": VOLTS},  # a coercive field against the one that turns
    "saturation": {"k_percent": 2},  # a loss of third order, against the first
    "quadratic_nonlinearity": {"q_percent": SQUARE},
    "offset": {"x_percent": VOLTS, "y_percent": VOLTS},
    "multipole": {"x_percent": VOLTS, "y_percent": VOLTS},
    "offset_drift": {"x_percent_per_K": VOLTS, "y_percent_per_K": VOLTS},
    "mains_pickup": {"x_percent": VOLTS, "y_percent": VOLTS},
    "noise": {"rms_deg": VOLTS},
    "clipping": {"level_percent": VOLTS},
    "adc_stuck_bit": {"step_percent": VOLTS, "blur_percent": VOLTS},
    "adc_inl": {"full_scale_percent": VOLTS},  # its errors are steps of that range
    "adc_quantisation": {"full_scale_percent": VOLTS},
    "cordic_truncation": {"full_scale_percent": VOLTS},
}
"""What follows the field. All else is an angle, a time, a share of the signal, or has no cause that would say."""


def field_mT(gap_mm: float) -> float:
    import magpylib

    body = magpylib.magnet.Cylinder(polarization=(-1.21, 0.0, 0.0), dimension=(DIAMETER_MM, HEIGHT_MM))
    return float(1e3 * body.getB([0.0, 0.0, gap_mm + 0.5 * HEIGHT_MM])[0])


def ratio(gap_mm: float) -> float:
    """The field against that at the gap where the device is stated."""
    return field_mT(gap_mm) / field_mT(NEAR_MM)


def further(gap_mm: float) -> float:
    """The distance from the magnet's centre, likewise."""
    return (gap_mm + 0.5 * HEIGHT_MM) / (NEAR_MM + 0.5 * HEIGHT_MM)


def device(name: str = "", **params: float) -> Chain:
    # One magnet that warmth does not weaken: the field is that of its gap alone.
    magnet = Magnet(diameter_mm=DIAMETER_MM, height_mm=HEIGHT_MM, percent_per_K=0.0)
    chain = Chain().with_magnet(Assembly(magnet, Placement(air_gap_mm=NEAR_MM)))
    return chain.with_effect(name, **params) if name else chain


def physical(name: str, params: Params, gap_mm: float) -> dict[str, float]:
    """The parameters at this gap."""
    powers = FOLLOWS.get(name, {})
    found = {key: value * ratio(gap_mm) ** powers.get(key, STAYS) for key, value in params.items()}
    if name == "magnet_harmonic":
        # The field of order n + 1 falls n powers of the distance faster than the dipole's.
        found["amplitude_deg"] *= further(gap_mm) ** -params["order"]
    return found


def misaligned(motion: Motion, params: Params, gap_mm: float) -> Array:
    """The counter-rotating share s^2 S'/S of a sensor off the axis, S' = -a''/8, by differences of magpylib's field."""
    step = 0.05
    values = [field_mT(gap_mm + way * step) for way in (-1.0, 0.0, 1.0)]
    share = -(values[0] - 2.0 * values[1] + values[2]) / step**2 / (8.0 * values[1]) * params["off_axis_mm"] ** 2
    return np.asarray(-share * np.sin(2.0 * (motion.shaft_rad - np.radians(params["direction_deg"]))))


@pytest.mark.parametrize("effect", CATALOGUE, ids=lambda effect: effect.name)
def test_every_effect_follows_the_field_as_physics_has_it(effect) -> None:  # type: ignore[no-untyped-def]
    """What each declares, and what becomes of a twin and of a recording at another gap."""
    params = dict(EXAMPLES[effect.name].params)
    for gap in GAPS_MM:
        wanted = physical(effect.name, {**effect.null(), **params}, gap)
        moved = at_air_gap(device(effect.name, **params), gap).values[effect.name]
        recorded = in_setup(effect, {**effect.null(), **params}, Setup(field=ratio(gap), distance=further(gap)))
        for name in params:
            assert moved[name] == pytest.approx(wanted[name], rel=1e-6)
            assert recorded[name] == pytest.approx(wanted[name], rel=1e-6)
    assert set(FOLLOWS.get(effect.name, {})) == set(effect.follow_field) - {"amplitude_deg"}


SIGNED = [name for name, one in EXAMPLES.items() if one.signature is not None and name != "clipping"]


@pytest.mark.parametrize("gap", GAPS_MM)
@pytest.mark.parametrize("name", SIGNED)
def test_expected_errors_at_each_gap_are_those_of_first_principles(name: str, gap: float) -> None:
    """At a tenth of the examples' strengths, half of those whose square counts, higher terms are below 3 %."""
    example, motion = EXAMPLES[name], full_motion()
    params = example.scaled(0.1 if example.power == 1.0 else 0.5, find(name).null())
    moved = at_air_gap(device(name, **params), gap)
    error = moved.error(motion)
    there = physical(name, params, gap)
    if name == "magnet_misalignment":
        wanted = misaligned(motion, there, gap)
    else:
        assert example.signature is not None
        wanted = example.signature(motion, there)
    left = np.abs(wrap(error - wanted))
    assert np.quantile(left, 1.0 - 2.0 * example.kinks) < 0.03 * np.max(np.abs(wanted))


def in_volts(gap_mm: float, motion: Motion) -> Array:
    """The ideal channels (2, n) in volts, one at the gap where the device is stated."""
    return np.asarray(ratio(gap_mm) * np.stack([np.cos(motion.shaft_rad), np.sin(motion.shaft_rad)]))


def rounded(volts: Array, bits: int, range_v: float) -> Array:
    step = 2.0 * range_v / 2**bits
    return np.asarray(step * np.clip(np.round(volts / step), -(2 ** (bits - 1)), 2 ** (bits - 1) - 1))


AS_BUILT: dict[str, tuple[dict[str, float], Callable[[Array], Array], float]] = {
    "clipping": ({"level_percent": 70.0}, lambda v: np.clip(v, -0.7, 0.7), 1e-9),
    "adc_quantisation": ({"bits": 7.0}, lambda v: rounded(v, 7, 1.25), 1e-9),
    # A bit held at 0 leaves out its step where it would be set; half of that is in the offset.
    "adc_stuck_bit": (
        {"step_percent": 4.0},
        lambda v: v + 0.04 * (0.5 - np.floor(v / 0.04 + 0.5) % 2.0),
        1e-9,
    ),
    # Rounds to words of eight bits, and its own sixteen more leave nothing beside that.
    "cordic_truncation": (
        {"iterations": 22.0, "word_bits": 8.0, "guard_bits": 16.0},
        lambda v: rounded(v, 8, 1.25),
        1e-5,
    ),
}
"""Parameters, what the device does with its channels in volts, and to how many radians that is exact."""


@pytest.mark.parametrize("gap", GAPS_MM)
@pytest.mark.parametrize("name", AS_BUILT)
def test_as_built_the_converter_keeps_its_range_in_volts(name: str, gap: float) -> None:
    """But for single readings on an edge, which the field's last digit decides."""
    params, built, exact = AS_BUILT[name]
    motion = Motion.from_angle(TAU * (np.arange(720) + 0.3) / 720)
    chain = at_air_gap(device(name, **params), gap)
    found = np.radians(chain.simulate(motion, seed=0).measured_deg)
    x, y = built(in_volts(gap, motion))
    assert np.quantile(np.abs(wrap(found - np.arctan2(y, x))), 0.99) < exact


@pytest.mark.parametrize("gap", GAPS_MM)
def test_noise_of_volts_is_more_of_a_weaker_field(gap: float) -> None:
    """20,000 readings tell an RMS to 0.5 %: five of these."""
    motion = Motion.from_angle(TAU * np.arange(20_000) / 360)
    chain = at_air_gap(device("noise", rms_deg=0.1), gap)
    left = wrap(np.radians(chain.simulate(motion, seed=1).measured_deg) - motion.shaft_rad)
    assert np.degrees(np.std(left)) == pytest.approx(0.1 / ratio(gap), rel=0.025)


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0])
def test_a_loss_grows_with_its_own_power_of_the_field(exponent: float) -> None:
    """Of exponent p it is k B |B|^p in millitesla: against B it goes with B^p."""
    motion = full_motion()
    chain = device("saturation", k_percent=1.0, exponent=exponent)
    bare = device().channels(motion)
    near = chain.channels(motion) - bare
    for gap in GAPS_MM:
        far = at_air_gap(chain, gap).channels(motion) - bare
        np.testing.assert_allclose(far, near * ratio(gap) ** exponent, atol=1e-9)


def test_a_described_converter_keeps_its_range_and_noise_in_volts() -> None:
    chain = device()
    chain = Chain(magnet=chain.magnet, parts=Parts(converter=Converter(bits=10, full_scale=1.3, noise_rms=0.002)))
    moved = at_air_gap(chain, 3.0).parts.converter
    assert moved is not None
    assert moved.full_scale == pytest.approx(1.3 / ratio(3.0), rel=1e-6)
    assert moved.noise_rms == pytest.approx(0.002 / ratio(3.0), rel=1e-6)


def test_a_converter_of_no_bits_has_no_range_to_follow() -> None:
    ideal = device("adc_quantisation", bits=0.0)
    assert at_air_gap(ideal, 3.0).values == ideal.values


def test_what_is_out_of_range_at_another_gap_is_printed_plainly() -> None:
    """A cubic loss of 20 % grows with the field's square."""
    with pytest.raises(OutOfRangeError, match=rf"found {20.0 * ratio(0.5) ** 2:.4f}[0-9]*$"):
        at_air_gap(device("saturation", k_percent=20.0), 0.5)


def test_simulate_records_the_device_at_another_gap(tmp_path: Path) -> None:
    simulate.run(
        "hall-misaligned",
        simulate.Outputs(sweep=tmp_path / "far.csv"),
        recorded=None,
        protocol=Protocol(),
        seed=3,
        instead=simulate.Instead(air_gap_mm=3.0),
    )
    wanted = at_air_gap(read_preset("hall-misaligned"), 3.0).simulate(Protocol().motion(), seed=3)
    recorded = Sweep.read(tmp_path / "far.csv")
    np.testing.assert_allclose(recorded.measured_deg, wanted.measured_deg, atol=1e-6)
    assert recorded.air_gap_mm is not None
    assert set(recorded.air_gap_mm) == {3.0}


def test_without_a_magnet_nothing_says_what_a_gap_does() -> None:
    with pytest.raises(UserError, match=r"add \[magnet\]"):
        at_air_gap(Chain(), 2.0)
