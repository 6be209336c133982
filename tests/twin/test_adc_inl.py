"""The converter's transfer curve at its ends and in another field."""

from __future__ import annotations

import numpy as np
import pytest

from tests.hidden.physics.converters import approximate
from twin.adc.adc_inl import ADC_INL
from twin.adc.adc_quantisation import FULL_SCALE
from twin.chain import Chain
from twin.motion import Motion

VALUES = {**ADC_INL.null(), "bit1_lsb": 50.0, "bit3_lsb": -20.0}


def added(signal: np.ndarray, **values: float) -> np.ndarray:
    motion = Motion.from_angle(np.zeros(signal.shape[-1]))
    return ADC_INL.forward(signal, motion, {**VALUES, **values}, None) - signal


def test_beyond_its_range_no_bit_turns_over() -> None:
    inside, beyond = (np.full((2, 1), level * FULL_SCALE) for level in (0.998, 1.02))
    lsb = FULL_SCALE / 2**13
    # The curve's straight part goes on; of its steps none is left: half the weights' errors is what one would make.
    assert np.max(np.abs(added(beyond) - added(inside))) < 5.0 * lsb


def test_in_twice_the_field_a_step_is_half_as_much_of_the_amplitude() -> None:
    signal = np.array([[0.4, 0.9, -0.7], [0.1, -0.3, 0.8]])
    factor = {name: float(ADC_INL.field_factor(name, VALUES, field_ratio=2.0)) for name in VALUES}
    stronger = {name: value * factor[name] for name, value in VALUES.items()}
    # The same volts are twice the amplitudes of the weaker field.
    np.testing.assert_allclose(added(0.5 * signal, **stronger), 0.5 * added(signal), rtol=1e-9)
    assert Chain().with_effect("adc_inl", bit1_lsb=1.0).values


def test_an_s_that_a_saturation_may_be_is_not_sought() -> None:
    """Alone, without the bits, and only where its channels run ahead of the field."""
    (form,) = ADC_INL.sought_alone
    assert form.roles("strength") == ("s_lsb",)
    low, high = form.params["s_lsb"].lower, form.params["s_lsb"].upper
    assert high == 0.0
    signal = np.array([[0.2, 0.6, 1.0]])
    sharper = added(signal, **{**ADC_INL.null(), "s_lsb": 0.1 * low})
    assert np.all(np.diff(sharper / signal) > 0.0)


@pytest.mark.parametrize(("bit", "codes"), [(1, 12.0), (2, 12.0), (3, -9.0), (4, 7.0)])
def test_weights_that_are_off_do_what_a_successive_approximation_does(bit: int, codes: float) -> None:
    """But for a straight line and the rounding of its own code, half a step at most, also where it stands still."""
    bits = 16
    weights = 2.0 ** np.arange(bits - 1, -1, -1)
    weights[bit - 1] += codes * 2.0 ** (bits - 12)
    step = 2.0 * FULL_SCALE / 2**bits
    signal = FULL_SCALE * np.linspace(-0.99, 0.99, 4001)
    read = (approximate((signal + FULL_SCALE) / step, weights) + 0.5) * step - FULL_SCALE
    # Of 14 bit, in the code: a weight that is too heavy is counted for less than it is.
    own = {**ADC_INL.null(), f"bit{bit}_lsb": -4.0 * codes}
    rest = Motion.from_angle(np.zeros(signal.size))
    twin = ADC_INL.forward(signal[None], rest, own, np.random.default_rng(1))[0]
    line = np.polynomial.Polynomial.fit(signal, read - twin, 1)
    assert np.max(np.abs(read - twin - line(signal))) < 0.52 * step
