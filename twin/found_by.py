"""What an effect is found by where a grid of its shapes is not it: a periodogram, or marks on single readings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from twin.angles import Array
from twin.motion import Motion

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Line:
    """A periodic shape: found by a periodogram instead of a grid.

    ``param`` is the parameter that holds its order, frequency or weight; ``clock`` is what it is periodic in: the shaft
    angle (orders), time (Hz), or a channel's value (a bit's weight, %). ``limits`` maps a motion to the lowest and
    highest order, frequency or weight worth looking at; ``within`` maps an array of these to a mask of those that
    belong to the effect; ``multiples`` are multiples of it at which the same source shows again. ``begin`` maps such a
    value to further shape parameters that a search sets out from. ``waves``: forms that a value's wave may have, each
    as the phase of its fundamental, of modulus 1, and the shape parameters that stand for it. ``sidebands``: the order
    of the angle by which a wave in time is multiplied, so that it shows as two lines of one size, so many orders below
    and above its frequency; 0: it shows at its own.
    """

    param: str
    clock: Literal["shaft", "time", "channels"]
    limits: Callable[[Motion], tuple[float, float]]
    within: Callable[[Array], BoolArray]
    multiples: tuple[int, ...] = ()
    begin: Callable[[float], Mapping[str, float]] | None = None
    waves: tuple[tuple[complex, Mapping[str, float]], ...] = ()
    sidebands: int = 0

    def begun(self, value: float) -> Mapping[str, float]:
        """The shape that a search sets out from at this order, frequency or weight."""
        return {self.param: value, **({} if self.begin is None else self.begin(value))}

    def some(self, motion: Motion) -> Array:
        """Orders, frequencies or weights (m,) of the effect, ascending, over all its limits, whole ones among them."""
        low, high = self.limits(motion)
        tried = np.linspace(low, high, 201)
        tried = np.concatenate([tried, np.unique(np.round(tried))])
        return np.sort(tried[self.within(tried) & (tried >= low) & (tried <= high)])


@dataclass(frozen=True, kw_only=True)
class Comb:
    """Lines at whole orders over the turn that one cause makes.

    ``orders`` maps the parameters to the orders of its lines. ``parts`` are groups of strengths of which each has to
    show by itself for a search to take the cause: one of its lines alone is what makes a single line. ``unite`` maps
    the orders of lines that have been found one by one to the shapes of the cause that may have made several of them,
    most likely first, and ``united`` such a shape to all orders that it makes: of such a cause each line is an instance
    of its own, with the order in ``order``. ``also``: the stage of which some part, that no effect stands for, makes
    the same line and leaves the radius of the channels as it is, and what would tell it apart. ``falling``: one body
    makes a line at each order of its shapes, which falls off with the order; each is an instance of its own.
    """

    orders: Callable[[Mapping[str, Any]], tuple[float, ...]]
    parts: tuple[tuple[str, ...], ...] = ()
    unite: Callable[[Sequence[int]], Sequence[Mapping[str, float]]] | None = None
    united: Callable[[Mapping[str, Any]], tuple[int, ...]] | None = None
    also: tuple[str, str] | None = None
    falling: bool = False


def order_of(values: Mapping[str, Any]) -> tuple[float, ...]:
    """The one order of a cause that is a line: its parameter ``order``."""
    return (float(values["order"]),)


class FindMarks(Protocol):
    """Finds the single readings that an effect of the footprint "sequence" has touched.

    From readings and residual [rad] (n,), the RMS of the noise [rad], of each reading (n,) where some are louder than
    others, the step of the output's grid [rad] (0: none) and the motion to a mask (n,) of the touched readings and the
    log probability that chance alone marks as many.
    """

    def __call__(
        self, measured: Array, residual: Array, noise: Array | float, step: float, motion: Motion
    ) -> tuple[BoolArray, float]: ...


@dataclass(frozen=True, kw_only=True)
class Marks:
    """How an effect of the footprint "sequence" is looked for, and what is said of it. Called, it does ``find``.

    Attributes
    ----------
    find : FindMarks
        Finds the touched readings.
    told : callable
        From the number of touched readings and of all readings to the parameters, each with its standard deviation.
    early : bool
        Whether its marks would pass for structure unless they are looked for first; they are looked for once more in
        what is left at the end. Others are looked for at the end alone, on readings that no other effect has claimed.
    rows_listed : bool
        Whether the answer names each touched row.
    """

    find: FindMarks
    told: Callable[[int, int], Mapping[str, tuple[float, float]]]
    early: bool = False
    rows_listed: bool = False

    def __call__(
        self, measured: Array, residual: Array, noise: Array | float, step: float, motion: Motion
    ) -> tuple[BoolArray, float]:
        """The touched rows (n,) and the log probability of as many by chance: see :class:`FindMarks`."""
        return self.find(measured, residual, noise, step, motion)


@dataclass(frozen=True)
class OverSpeed:
    """The variance [rad^2] that a cause adds to the angle, from the shaft's speed (n,) [rad/s] and the parameters."""

    variance: Callable[[Array, Mapping[str, Any]], Array]

    def __call__(self, speed_rad_s: Array, values: Mapping[str, Any]) -> Array:
        return self.variance(speed_rad_s, values)


def added_variance(
    spread: Callable[[Array, Mapping[str, Any]], Array], angle: Array, motion: Motion, values: Mapping[str, Any]
) -> Array:
    """Variance (n,) [rad^2] that a cause adds at each reading: by its sensor angle (n,) [rad], or by its speed."""
    return spread(motion.speed_rad_s if isinstance(spread, OverSpeed) else angle, values)
