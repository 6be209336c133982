"""The declaration every effect makes; simulating, fitting, discovering and documenting all read it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from twin.angles import TAU, Array
from twin.forward import ActsOn as ActsOn
from twin.forward import Behind as Behind
from twin.forward import Forward as Forward
from twin.found_by import BoolArray as BoolArray
from twin.found_by import Comb as Comb
from twin.found_by import FindMarks as FindMarks
from twin.found_by import Line as Line
from twin.found_by import Marks as Marks
from twin.motion import Motion
from twin.param import OWNER_OF_STAGE
from twin.param import Owner as Owner
from twin.param import Param as Param
from twin.param import Parameters as Parameters
from twin.param import Role as Role
from twin.words import InWords as InWords

Footprint = Literal["mean", "spread", "values", "sequence"]
"""Where an effect leaves its mark: on the expected reading, on its spread, on the set of values that readings can
take, or on single readings and their sequence."""

TOLD_APART_BY = frozenset({"vx", "two air gaps", "two mountings"})
"""Needs of an effect that acts without them too: they tell it from what else does the same to an angle."""

Drawing = Callable[[Array, Array, Motion], Mapping[str, Array]]
"""Draws an effect's parameters for training sweeps.

Called with strengths [deg] (k,), uniform numbers (k, 4) and a motion, it returns parameters (k,) by name at which the
effect is about that strong.
"""


def _one_shape(motion: Motion) -> Sequence[Mapping[str, float]]:
    return ({},)


def _as_they_are(values: Parameters) -> Parameters:
    return values


def _nothing_derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    return {}


def _all_told(values: Parameters) -> Mapping[str, tuple[float, float]]:
    return {}


def _negative(value: Any) -> Any:
    return -value if np.ndim(value) == 0 else -np.asarray(value)


def _no_figures(values: Parameters) -> Mapping[str, float]:
    return {}


@dataclass(frozen=True, kw_only=True)
class Effect:
    """One physical effect: what it does, what it needs to be seen, and where its definition comes from.

    Attributes
    ----------
    name, stage : str
        Its name in the catalogue, and the part of the device or bench where it sits.
    acts_on : str
        The signal that it changes: see :data:`ActsOn`.
    params : mapping of str to Param
        Its parameters; names end in their units.
    forward : Forward
        What it does to its signal.
    behind : Behind, optional
        What it also does to a signal behind that one.
    acting : tuple of str
        Of an operation of :attr:`operations`: the parameters at whose nulls it does nothing; none: :attr:`acts_by`.
    source, signature : str
        Where its definition can be looked up; what it does to the error, to leading order.
    needs : frozenset of str
        Names of :attr:`Motion.provides` without which it is invisible; ``"a|b"`` means a or b.
    footprint : str
        Where it shows: see :data:`Footprint`.
    baseline : bool
        Whether it is part of the paper's error model: always fitted, never a discovery.
    shapes : callable
        From a motion to the values of its shape parameters that a search tries: a grid fine enough for a fit to start.
    zoomed : tuple of str
        Shape and level parameters that are searched more finely around the grid's best point.
    fitted_shapes, channel_shapes : tuple of str
        Those that a fit then moves smoothly: always; only where the channels are recorded, as an angle does not show
        them.
    begin : callable
        From the parameters of a first-order fit to those that an exact fit starts from.
    line : Line, optional
        For periodic shapes: the shape parameter is found by a periodogram.
    comb : Comb, optional
        For lines at whole orders: which they are, and how several are known for one cause.
    derived : callable
        From the parameters to further figures: value, low, high (both the value: as well known as they are), unit.
    angle_only : callable
        From the parameters to low and high of those that an angle alone leaves open.
    spread : callable, optional
        For the footprint "spread": from the angle (n,) and the parameters to the added variance of the angle [rad^2].
    attainable : callable, optional
        For the footprint "values": from the parameters to all angles [rad] that a reading can take.
    stair : callable, optional
        For the footprint "values": from the parameters to the mean step [rad] between these; not given: counted.
    output_grid : bool
        Whether its attainable angles are the grid of the output's word, which the readings themselves show.
    marks, in_words : Marks and InWords, optional
        For the footprint "sequence": how the touched readings are found; how the words tell them ahead of every fit.
    computes : callable, optional
        For a stage that computes the angle: from the channels (..., 2, n) and its parameters to the angle [rad]
        (..., 1, n) as its integers return it, or None where the parameters do not say how it is built. Where they do, a
        run as built has this in place of the arctangent and of `forward`.
    at_magnet, assumes : callable, optional, and str
        From a described magnet (an ``Assembly``) to the same effect in its field; what figures count against without.
    vectors : tuple of tuple of str
        Levels that a search sets together, as the components of a field are.
    repeatable : bool
        Whether a second instance beside the first makes sense: another source with parameters of its own.
    record_wide : bool
        Whether what it does to a reading depends on readings still to come (the record's length, middle or extremes),
        so that it cannot be simulated reading by reading.
    handicap : float
        Log likelihood [nats] that it must gain beyond others, where a plainer description exists.
    drawing : Drawing, optional
        For training sweeps: parameters in place of those that :func:`twin.drawing.by_declaration` takes.
    kind : str
        For structure without a name: its kind, a word of the answer's vocabulary.
    words : str
        The same as a sentence: a format string over the answer's figures, with ``{order:4}`` for four digits and
        ``largest_deg`` for the largest of the figures in degrees.
    figures : callable
        From the parameters to further figures of structure without a name.
    """

    name: str
    stage: str
    acts_on: ActsOn
    params: Mapping[str, Param]
    forward: Forward
    source: str
    signature: str
    behind: Behind | None = None
    acting: tuple[str, ...] = ()
    needs: frozenset[str] = frozenset()
    footprint: Footprint = "mean"
    baseline: bool = False
    shapes: Callable[[Motion], Sequence[Mapping[str, float]]] = field(default=_one_shape)
    zoomed: tuple[str, ...] = ()
    fitted_shapes: tuple[str, ...] = ()
    channel_shapes: tuple[str, ...] = ()
    begin: Callable[[Parameters], Parameters] = field(default=_as_they_are)
    line: Line | None = None
    comb: Comb | None = None
    derived: Callable[[Parameters], Mapping[str, tuple[float, float, float, str]]] = field(default=_nothing_derived)
    angle_only: Callable[[Parameters], Mapping[str, tuple[float, float]]] = field(default=_all_told)
    spread: Callable[[Array, Parameters], Array] | None = None
    attainable: Callable[[Parameters], Array] | None = None
    stair: Callable[[Parameters], float] | None = None
    output_grid: bool = False
    marks: Marks | None = None
    in_words: InWords | None = None
    computes: Callable[[Array, Parameters], Array | None] | None = None
    at_magnet: Callable[[Any], Effect] | None = None
    assumes: str = ""
    vectors: tuple[tuple[str, ...], ...] = ()
    repeatable: bool = False
    record_wide: bool = False
    handicap: float = 0.0
    drawing: Drawing | None = None
    kind: str = ""
    words: str = ""
    figures: Callable[[Parameters], Mapping[str, float]] = field(default=_no_figures)

    def roles(self, role: Role) -> tuple[str, ...]:
        """Names of the parameters with this role, in the order of the declaration."""
        return tuple(name for name, param in self.params.items() if param.role == role)

    @cached_property
    def operations(self) -> tuple[Effect, ...]:
        """The effect as operations on one signal each, in the order of the chain: itself, and what it does behind."""
        if self.behind is None:
            return (self,)
        one = self.behind
        second = replace(self, acts_on=one.acts_on, forward=one.forward, record_wide=one.record_wide)
        return self, replace(second, behind=None, acting=one.params)

    def acts(self, values: Parameters) -> bool:
        """Whether it does anything with these parameters."""
        if self.acting:
            return not all(self.params[name].at_null(values[name]) for name in self.acting)
        return not self.is_null(values)

    def details(self, provides: frozenset[str]) -> tuple[str, ...]:
        """Names of what a fit of such a recording moves from its null only where that pays."""
        return tuple(name for name, param in self.params.items() if param.detail and param.told_by <= provides)

    def null(self) -> dict[str, float]:
        """The parameters at which the effect vanishes exactly."""
        return {name: param.null for name, param in self.params.items()}

    @cached_property
    def acts_by(self) -> tuple[str, ...]:
        """Names of the parameters that make it act: strengths of every kind, and shapes that act by themselves."""
        acting = ("strength", "level", "per turn", "random")
        return tuple(name for name, param in self.params.items() if param.role in acting or param.by_itself)

    def is_null(self, values: Parameters) -> bool:
        """Whether every parameter that makes it act is at its null, so that the effect does nothing."""
        return all(name not in values or self.params[name].at_null(values[name]) for name in self.acts_by)

    def visible_in(self, provides: frozenset[str]) -> bool:
        """Whether a sweep that provides this can show the effect at all."""
        return not self.missing(provides)

    def missing(self, provides: frozenset[str]) -> tuple[str, ...]:
        """What a sweep lacks for this effect to be visible, sorted."""
        return tuple(sorted(need for need in self.needs if not any(part in provides for part in need.split("|"))))

    def acts_in(self, provides: frozenset[str]) -> bool:
        """Whether what it would do to the readings of such a sweep is known, even where something else does the same.

        Then it may stand behind a cause that the sweep names, though the sweep alone can never name it.
        """
        return all(TOLD_APART_BY.intersection(need.split("|")) for need in self.missing(provides))

    def stair_rad(self, values: Parameters) -> float:
        """Mean step [rad] between the angles that a reading can take; 0 where it can take any."""
        if self.attainable is None or self.is_null(values):
            return 0.0
        return TAU / self.attainable(values).size if self.stair is None else self.stair(values)

    @property
    def drawn(self) -> tuple[str, ...]:
        """Strengths that are draws from one distribution, as a zero for each turn is; others may be of any size."""
        return tuple(
            name
            for name, param in self.params.items()
            if param.role == "per turn" or (param.role == "strength" and param.prior_sd > 0.0)
        )

    def drawn_of(self, terms: int) -> int:
        """How many of so many linear coefficients are draws from one distribution."""
        return terms if self.roles("per turn") else len(self.drawn)

    @property
    def stand_aside(self) -> tuple[tuple[str, ...], ...]:
        """Levels that an answer gives only where they are not at their null, those of a vector together."""
        aside = [name for name in self.roles("level") if self.params[name].aside]
        return *self.vectors, *((name,) for name in aside if not any(name in one for one in self.vectors))

    @property
    def sought_alone(self) -> tuple[Effect, ...]:
        """The effect with one strength alone, or a vector's, for each that a search sets, within the bounds of that.

        What it is counted in, such as a range that the sweep does not show, is as uncertain as it was before.
        """
        set_so = (names for names in self.stand_aside if all(self.params[name].sought for name in names))
        forms = (self.alone(*names, sought=True) for names in set_so)
        return tuple(replace(form, fitted_shapes=self.fitted_shapes) for form in forms)

    def alone(self, *names: str, sought: bool = False) -> Effect:
        """The same effect where these are its only strengths, and all other parameters stay at their null.

        ``sought``: within the bounds at which a search sets them, in place of those of their declaration.
        """
        params = {other: replace(param, role="shape") for other, param in self.params.items()}
        for name in names:
            lower, upper = (sought and params[name].sought) or (params[name].lower, params[name].upper)
            params[name] = replace(params[name], role="strength", lower=lower, upper=upper)
        return replace(
            self, params=params, shapes=_one_shape, zoomed=(), fitted_shapes=(), channel_shapes=(), line=None
        )

    def without_strengths(self, names: Iterable[str]) -> Effect:
        """The effect where these of its strengths stay at their null."""
        return replace(
            self, params={**self.params, **{name: replace(self.params[name], role="shape") for name in names}}
        )

    @property
    def whole(self) -> bool:
        """Whether a search takes its change as it is at each level of its grid: it has no strength in proportion."""
        return bool(self.roles("level")) and not self.roles("strength")

    @property
    def zeroes_turns(self) -> bool:
        """Whether it gives the reference a zero of its own in each turn."""
        return self.acts_on == "reference" and bool(self.roles("per turn"))

    def spread_of_turns(self, values: Parameters) -> dict[str, float]:
        """Random parameters as the turns' own values show them: another record's turns are drawn with these."""
        told = self.derived(values) if self.roles("per turn") else {}
        return {name: told[name][0] for name in self.roles("random") if name in told}

    def owner(self, name: str) -> Owner:
        """Whose a parameter is: see :data:`twin.param.Owner`."""
        return self.params[name].owner or OWNER_OF_STAGE[self.stage]

    # ---- what becomes of it elsewhere ---------------------------------------------------------------------------

    def field_factor(self, name: str, values: Parameters, *, field_ratio: Any, distance_ratio: Any = 1.0) -> Any:
        """What a parameter is multiplied by where the magnet's field and distance are multiplied by these ratios.

        Either may be an array; so is then the factor.
        """
        param = self.params[name]
        power = param.field_power(values) if callable(param.field_power) else param.field_power
        factor = field_ratio**power
        return factor if param.distance_power is None else factor * distance_ratio ** param.distance_power(values)

    def in_field(
        self, values: Parameters, names: Iterable[str], *, field_ratio: Any, distance_ratio: Any
    ) -> dict[str, Any]:
        """The named ones of its complete parameters where field and distance are multiplied by these ratios."""
        ratios = {"field_ratio": field_ratio, "distance_ratio": distance_ratio}
        return {name: values[name] * self.field_factor(name, values, **ratios) for name in names}

    @property
    def follow_field(self) -> tuple[str, ...]:
        """The parameters that change with the magnet's field or its distance."""
        return tuple(n for n, p in self.params.items() if p.field_power != 0.0 or p.distance_power is not None)

    def mirror(self, name: str) -> int:
        """What a parameter is multiplied by (-1, 1) in the mirrored chain; 0: no value of it reads the same there.

        The mirrored chain counts its field and its computed angle the other way. What is added to either of them
        changes sign; shaft and reference are as they were, and so are sizes of noise, frequencies and phases.
        """
        param = self.params[name]
        if param.mirror is not None:
            return param.mirror
        added = self.acts_on in ("field", "angle") and param.role in ("strength", "per turn")
        return -1 if added else 1

    def mirrored(self, values: Parameters) -> dict[str, Any]:
        """The parameters with which the chain that counts the other way on both sides reads the same.

        Those without such a value are kept. An amplitude keeps its sign; its phase turns by half a turn instead.
        """
        found = {name: _negative(value) if self.mirror(name) < 0 else value for name, value in values.items()}
        phases, strengths = self.roles("phase"), [name for name in self.roles("strength") if name in values]
        if phases and strengths and all(self.mirror(n) == -1 and self.params[n].lower == 0.0 for n in strengths):
            found |= {name: values[name] for name in strengths}
            phase_deg = found.get(phases[0], self.params[phases[0]].null)
            found[phases[0]] = phase_deg - np.copysign(180.0, phase_deg)
        return found

    @property
    def mirrors(self) -> bool:
        """Whether every parameter has a value with which the mirrored chain reads the same."""
        return all(self.mirror(name) != 0 for name in self.params)
