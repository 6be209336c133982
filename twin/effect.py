"""The declaration every effect makes; simulating, fitting, discovering and documenting all read it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from twin.angles import Array
from twin.motion import Motion

ActsOn = Literal["shaft", "field", "channels", "angle", "reference"]
"""The signal an effect changes, in the order of the chain.

``shaft``      angle of the magnet on the shaft [rad], one for each channel's sampling instant, ``(..., 2, n)``
``field``      angle of the field in the sensor's axes [rad], ``(..., 2, n)``
``channels``   x and y, nominal amplitude 1, ``(..., 2, n)``
``angle``      the angle computed from them [rad], ``(..., 1, n)``
``reference``  the reference encoder's reading [rad], ``(..., 1, n)``
"""

Footprint = Literal["mean", "spread", "values", "sequence"]
"""Where an effect leaves its mark: on the expected reading, on its spread, on the set of values that readings can
take, or on single readings and their sequence."""

Role = Literal["strength", "level", "phase", "shape", "per turn", "random"]
"""What a parameter is to a fit.

``strength``  null where the effect vanishes, and the change of the signal is nearly proportional to it
``level``     null where the effect vanishes, but its change is not proportional: searched on the grid ``shapes``
``phase``     turns a strength's shape by quadrature
``shape``     order, memory, frequency: means nothing at zero strength, searched on the grid ``shapes``
``per turn``  a strength of its own for each turn of the sweep
``random``    acts only where a generator is given: the size of a spread, the number of rare events
"""

Parameters = Mapping[str, Any]
BoolArray = NDArray[np.bool_]


class Forward(Protocol):
    """signal ``(..., k, n)``, motion, parameters (scalars or ``(batch, 1, 1)``), generator -> signal of that shape.

    Without a generator the effect acts in expectation: what is random then does nothing.
    """

    def __call__(self, signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array: ...


@dataclass(frozen=True, kw_only=True)
class Param:
    """One parameter: ``lower <= null <= upper``, in the unit its name ends with.

    ``typical`` is the size at which the effect is about 0.1 deg: the yardstick for numerical derivatives.
    ``counts`` marks whole numbers (bits, orders, iterations).
    """

    unit: str
    null: float
    lower: float
    upper: float
    doc: str
    role: Role = "strength"
    typical: float = 0.1
    counts: bool = False

    def __post_init__(self) -> None:
        if not self.lower <= self.null <= self.upper:
            raise ValueError(f"null {self.null} outside [{self.lower}, {self.upper}]")


@dataclass(frozen=True, kw_only=True)
class Line:
    """A periodic shape in the shaft angle (orders), in time (Hz) or in the channels' value (a bit's weight, %).

    It is screened by one spectrum instead of a grid. ``limits`` maps a motion to the lowest and highest order or
    frequency worth looking at; ``within`` says of an array of them which belong to the effect.
    """

    param: str
    clock: Literal["shaft", "time", "channels"]
    limits: Callable[[Motion], tuple[float, float]]
    within: Callable[[Array], BoolArray]


def _one_shape(motion: Motion) -> Sequence[Mapping[str, float]]:
    return ({},)


def _as_they_are(values: Parameters) -> Parameters:
    return values


def _nothing_derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    return {}


def _all_told(values: Parameters) -> Mapping[str, tuple[float, float]]:
    return {}


@dataclass(frozen=True, kw_only=True)
class Effect:
    """One physical effect: what it does, what it needs to be seen, and where its definition comes from.

    ``needs``     names of :attr:`Motion.provides` without which it is invisible; ``"a|b"`` means a or b.
    ``shapes``    the values of the shape parameters worth trying on a motion (a grid fine enough to climb from).
    ``zoomed``    the shape and level parameters that are searched more finely around the grid's best point.
    ``fitted_shapes`` those that a fit may move smoothly from there; ``channel_shapes`` those that it may move where the
    channels are recorded, because an angle alone does not show them.
    ``begin``     parameters of a first-order fit -> those that an exact fit sets out from.
    ``line``      for sinusoids: the shape parameter that is found by a spectrum.
    ``derived``   parameters -> further figures to report: value, low, high, unit.
    ``angle_only`` parameters -> low and high of those that an angle alone leaves open, as others make up for them.
    ``spread``    for the footprint "spread": angle (n,), parameters -> added variance of the angle [rad^2].
    ``attainable`` for the footprint "values": parameters -> all angles [rad] a reading can take.
    ``marks``     for the footprint "sequence": see :class:`Marks`.
    ``baseline``  part of the paper's error model: always fitted, never a discovery.
    """

    name: str
    stage: str
    acts_on: ActsOn
    params: Mapping[str, Param]
    forward: Forward
    source: str
    signature: str
    needs: frozenset[str] = frozenset()
    footprint: Footprint = "mean"
    baseline: bool = False
    shapes: Callable[[Motion], Sequence[Mapping[str, float]]] = field(default=_one_shape)
    zoomed: tuple[str, ...] = ()
    fitted_shapes: tuple[str, ...] = ()
    channel_shapes: tuple[str, ...] = ()
    begin: Callable[[Parameters], Parameters] = field(default=_as_they_are)
    line: Line | None = None
    derived: Callable[[Parameters], Mapping[str, tuple[float, float, float, str]]] = field(default=_nothing_derived)
    angle_only: Callable[[Parameters], Mapping[str, tuple[float, float]]] = field(default=_all_told)
    spread: Callable[[Array, Parameters], Array] | None = None
    attainable: Callable[[Parameters], Array] | None = None
    marks: Marks | None = None

    def roles(self, role: Role) -> tuple[str, ...]:
        """Names of the parameters with this role, in the order of the declaration."""
        return tuple(name for name, param in self.params.items() if param.role == role)

    def null(self) -> dict[str, float]:
        """The parameters at which the effect vanishes exactly."""
        return {name: param.null for name, param in self.params.items()}

    def is_null(self, values: Parameters) -> bool:
        """Whether every strength is at its null, so that the effect does nothing."""
        return all(
            np.all(np.asarray(values.get(name, param.null)) == param.null)
            for name, param in self.params.items()
            if param.role in ("strength", "level", "per turn", "random")
        )

    def visible_in(self, provides: frozenset[str]) -> bool:
        """Whether a sweep that provides this can show the effect at all."""
        return not self.missing(provides)

    def missing(self, provides: frozenset[str]) -> tuple[str, ...]:
        """What a sweep lacks for this effect to be visible, sorted."""
        return tuple(sorted(need for need in self.needs if not any(part in provides for part in need.split("|"))))


class Marks(Protocol):
    """Finds the single readings that an effect of the footprint "sequence" has touched.

    measured [rad] (n,), residual [rad] (n,), noise [rad], step of the output grid [rad] or 0, motion ->
    (mask of the touched rows, log of the probability that chance alone marks as many).
    """

    def __call__(
        self, measured: Array, residual: Array, noise: float, step: float, motion: Motion
    ) -> tuple[BoolArray, float]: ...
