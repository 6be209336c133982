"""One parameter of an effect: its unit and bounds, and what it is to a fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

Role = Literal["strength", "level", "phase", "shape", "per turn", "random"]
"""What a parameter is to a fit.

``strength``  null where the effect vanishes, and the change of the signal is nearly proportional to it
``level``     null where the effect vanishes, but its change is not proportional: searched on the grid ``shapes``
``phase``     turns a strength's shape by quadrature
``shape``     order, memory, frequency: means nothing at zero strength unless it acts ``by_itself``, searched on the
              grid ``shapes``
``per turn``  a strength of its own for each turn of the sweep
``random``    acts only where a generator is given: the size of a spread, the number of rare events
"""

Owner = Literal["device", "mounting", "bench", "recording"]
"""Whose a parameter is: with what it stays as it is, and with what it changes.

``device``     the sensor: the same wherever and whenever it is measured, temperature laws included
``mounting``   how sensor and magnet sit: changes when either is taken off and put back; the magnet, which sits on the
               shaft, is among it
``bench``      reference, coupling, drive and surroundings: the same for every device measured there
``recording``  this one record: noise, events, movements in time, phases that count from its middle
"""

OWNER_OF_STAGE: Mapping[str, Owner] = {
    "mechanics": "bench",
    "magnet": "mounting",
    "concentrator": "device",
    "hall": "device",
    "adc": "device",
    "cordic": "device",
    "empirical": "device",
    "link": "device",
    "reference": "bench",
}
"""Whose a parameter is that does not say so itself, by its effect's stage."""

Parameters = Mapping[str, Any]
"""An effect's parameters by name: numbers, or arrays of a batch."""


@dataclass(frozen=True, kw_only=True)
class Param:
    """One parameter of an effect.

    Attributes
    ----------
    unit : str
        Its unit, in which its name ends; ``"1"`` for a pure number.
    null, lower, upper : float
        ``lower <= null <= upper``: at null a strength does nothing; the others bound what a fit may try.
    doc : str
        What it is, in a few words.
    role : str
        What it is to a fit: see :data:`Role`.
    typical : float
        The size at which the effect is about 0.1 deg: the yardstick for numerical derivatives.
    counts : bool
        Whether it is a whole number (bits, orders, iterations).
    allowed : tuple of float, optional
        Lowest and highest value that physics allows, where a fit is given more room; training sweeps keep to it.
    field_power : float or callable
        Power of the magnet's field at the sensor with which it changes, device and gain kept: 0 for angles, -1 for what
        is constant in volts or millitesla but counted in amplitudes of the channels. A callable gives it for the
        effect's parameters.
    distance_power : callable, optional
        From the effect's parameters to the power of the distance from the magnet's centre with which it also changes.
    mirror : {-1, 0, 1}, optional
        What it is multiplied by in the mirrored chain (see :meth:`Effect.mirrored`); 0: no value of it reads the same
        there. Not given: what follows from its role and from the signal that the effect acts on.
    prior_sd : float
        For a shape that a fit moves: standard deviation of what is known of it before any sweep; 0: anything goes. One
        that a sweep does not show then stays where the search set out, and its interval says so. For a strength: that
        of the distribution that it is a draw from.
    prior_mean : float, optional
        What is most likely before any sweep: it pulls the fit, as one more reading would. Not given: nothing is.
    aside : bool
        Whether an answer gives it only where it is not at null. A level that stands aside no search sets, unless it is
        ``sought``.
    sought : tuple of float, optional
        Of a level that stands aside: the lowest and highest value at which a search sets it by itself. Not given: none,
        as another effect says the same more plainly.
    detail : bool
        Whether a fit moves it from its null only where the readings call for it, as they must for a cause.
    told_by : frozenset of str
        What a recording must hold for a fit to move a detail: without, it is told by what is left over of other errors.
    by_itself : bool
        Whether a shape acts with every strength at its null, so that it counts as one where the question is whether the
        effect does anything. Others mean nothing without a strength.
    scatter : float
        Half width of the range over which devices of one kind differ in it.
    owner : str, optional
        Whose it is: see :data:`Owner`. Not given: what its effect's stage says, :data:`OWNER_OF_STAGE`.
    """

    unit: str
    null: float
    lower: float
    upper: float
    doc: str
    role: Role = "strength"
    typical: float = 0.1
    counts: bool = False
    allowed: tuple[float, float] | None = None
    field_power: float | Callable[[Parameters], Any] = 0.0
    distance_power: Callable[[Parameters], Any] | None = None
    mirror: Literal[-1, 0, 1] | None = None
    prior_sd: float = 0.0
    prior_mean: float | None = None
    aside: bool = False
    sought: tuple[float, float] | None = None
    detail: bool = False
    told_by: frozenset[str] = frozenset()
    by_itself: bool = False
    scatter: float = 0.0
    owner: Owner | None = None

    def __post_init__(self) -> None:
        if not self.lower <= self.null <= self.upper:
            raise ValueError(f"null {self.null} outside [{self.lower}, {self.upper}]")

    def at_null(self, value: Any) -> bool:
        """Whether all of its values, of any shape, are its null."""
        # A fit asks this of single numbers a million times.
        return value == self.null if isinstance(value, float) else bool(np.all(np.asarray(value) == self.null))
