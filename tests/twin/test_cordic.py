"""The integer CORDIC and the table, exhaustively over all quadrants."""

from __future__ import annotations

import numpy as np
import pytest

from twin.adc.adc_quantisation import codes_of
from twin.angles import TAU, wrap
from twin.chain import Chain
from twin.cordic.bit_true import Cordic, Table, angle_rad, look_up, vectoring
from twin.cordic.cordic_truncation import rotations
from twin.cordic.cordic_truncation import vectoring as unbounded
from twin.limits import OutOfRangeError
from twin.motion import Motion

WORD_BITS = 14
RADIUS = 0.8 * 2 ** (WORD_BITS - 1)


def circle(count: int = 1 << 16) -> tuple[np.ndarray, np.ndarray]:
    """Codes on a circle of 0.8 of full scale at more angles than 14-bit codes can tell apart, axes included."""
    angle = np.arange(count) * TAU / count
    x, y = codes_of(np.stack([np.cos(angle), np.sin(angle)]), WORD_BITS)
    return x, y


@pytest.mark.parametrize("iterations", range(8, 17))
@pytest.mark.parametrize(("guard_bits", "angle_bits"), [(0, 16), (3, 18), (6, 24)])
def test_stays_within_the_bound_over_all_quadrants(iterations: int, guard_bits: int, angle_bits: int) -> None:
    unit = Cordic(iterations=iterations, word_bits=WORD_BITS, guard_bits=guard_bits, angle_bits=angle_bits)
    x, y = circle()
    words, _ = vectoring(x, y, unit)
    error = np.abs(wrap(angle_rad(words, angle_bits) - np.arctan2(y, x)))
    assert np.max(error) <= unit.bound_rad(np.min(np.hypot(x, y)))
    # The bound is no idle one: without rounding the last step's remainder is nearly reached.
    if guard_bits == 6 and iterations <= 11:
        assert np.max(error) > 0.8 * np.arctan(2.0 ** -(iterations - 1))


def test_every_code_of_a_short_word() -> None:
    """All 2^16 pairs of 8-bit codes beyond a radius of 32, in all quadrants."""
    unit = Cordic(iterations=8, word_bits=8, guard_bits=4, angle_bits=16)
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(-128, 128), np.arange(-128, 128)))
    far = np.hypot(x, y) >= 32
    words, _ = vectoring(x[far], y[far], unit)
    error = np.abs(wrap(angle_rad(words, 16) - np.arctan2(y[far], x[far])))
    assert np.max(error) <= unit.bound_rad(32.0)


@pytest.mark.parametrize("iterations", [8, 12, 16])
def test_long_words_return_what_unbounded_ones_do(iterations: int) -> None:
    unit = Cordic(iterations=iterations, word_bits=30, guard_bits=16, angle_bits=40)
    angle = np.random.default_rng(1).uniform(-np.pi, np.pi, 20_000)
    x, y = codes_of(np.stack([np.cos(angle), np.sin(angle)]), 30)
    words, _ = vectoring(x, y, unit)
    difference = np.abs(wrap(angle_rad(words, 40) - unbounded(np.arctan2(y, x), rotations({"iterations": iterations}))))
    # A vector that lands on the axis within the rounding may turn either way: hardly ever among random ones.
    assert np.quantile(difference, 0.999) < 1e-9


def test_magnitude_carries_the_gain() -> None:
    unit = Cordic(iterations=14, guard_bits=6)
    x, y = circle(4096)
    _, magnitude = vectoring(x, y, unit)
    assert unit.gain == pytest.approx(1.646760258, abs=1e-8)
    assert np.max(np.abs(magnitude - unit.gain * np.hypot(x, y))) < 3.0


@pytest.mark.parametrize("address_bits", [6, 8, 10, 12])
def test_table_stays_within_its_bound(address_bits: int) -> None:
    table = Table(address_bits=address_bits, angle_bits=18, word_bits=WORD_BITS)
    x, y = circle()
    error = np.abs(wrap(angle_rad(look_up(x, y, table), 18) - np.arctan2(y, x)))
    assert 0.5 * table.bound_rad() < np.max(error) <= table.bound_rad()


def test_axes_are_near_their_angles() -> None:
    x, y = np.array([5000, 0, -5000, 0]), np.array([0, 5000, 0, -5000])
    unit = Cordic(iterations=16, guard_bits=6, angle_bits=24)
    words, _ = vectoring(x, y, unit)
    np.testing.assert_allclose(wrap(angle_rad(words, 24) - np.array([0, 90, 180, -90]) * TAU / 360), 0.0, atol=1e-4)


def test_each_entry_of_a_batch_has_its_own_words() -> None:
    """Units of several lengths, one of unbounded codes and none at all, side by side and one by one."""
    motion = Motion.from_angle(np.radians(np.arange(0.0, 360.0, 0.7)))
    numbers = {
        "iterations": [14, 8, 8, 6, 0],
        "word_bits": [14, 14, 12, 0, 12],
        "guard_bits": 3,
        "angle_bits": [18] * 5,
    }
    for rng in (None, np.random.default_rng(0)):
        *_, last = Chain().with_effect("cordic_truncation", **numbers).steps(motion, rng)
        for k in range(5):
            own = {name: value[k] if isinstance(value, list) else value for name, value in numbers.items()}
            *_, alone = Chain().with_effect("cordic_truncation", **own).steps(motion, rng)
            np.testing.assert_array_equal(last.after[k, 0], alone.after[0])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"iterations": 0}, "iterations is 0; expected a whole number from 1 to 40"),
        ({"word_bits": 0}, "word_bits is 0 bit; expected a whole number from 1 to 32 bit"),
        ({"guard_bits": 1.5}, "guard_bits is 1.5 bit; expected a whole number from 0 to 24 bit"),
    ],
)
def test_refuses_by_name_value_and_range(options: dict[str, int], message: str) -> None:
    with pytest.raises(OutOfRangeError) as refused:
        Cordic(**options)
    assert str(refused.value) == message


def test_refuses_codes_beyond_the_word() -> None:
    with pytest.raises(OutOfRangeError, match="code x is 9000"):
        vectoring(np.array([9000]), np.array([0]), Cordic())
