"""The chain linearised: what a small change at any point of it does to the angle and to the radius.

One backward pass gives the sensitivity of both observables to the signal at every point. An effect's column is then
the change it makes to its own signal times that sensitivity, so that columns of effects which are at null cost no run
of the chain.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.blurred_stairs import blurred_stairs
from twin.angles import Array
from twin.chain import SIGNALS, Chain, Step
from twin.effect import Effect, Parameters
from twin.motion import Motion

_STEP = 1e-6


@dataclass(frozen=True, eq=False)
class Insertion:
    """A point of the chain: the signal (k, n) there and the sensitivity (O, k, n) of the observables to it."""

    signal: Array
    sensitivity: Array


@dataclass(frozen=True)
class Term:
    """One linear coefficient of a candidate: a strength at a phase [deg], or one turn's zero."""

    param: str
    phase_deg: float | None = None
    turn: int | None = None


class Linear:
    """A chain at its present parameters on a recorded motion: prediction, and columns of any effect.

    ``angle`` (n,) [rad] is the expected reading. With ``blur`` [rad] the stairs of quantisers are averaged over noise
    of that size, which is what readings do; ``stair_variance`` (n,) [rad^2] is then the variance of a reading, which
    depends on where it lies between two steps. ``log_radius`` (n,) is the log of the channels' amplitude.
    ``slopes``: edges that noise has blurred have slopes; else a stuck bit passes changes on as they are, which leads a
    search well from afar, but not to the very optimum.
    """

    def __init__(self, chain: Chain, recorded: Motion, *, blur: float, observables: int, slopes: bool = False) -> None:
        self.chain = chain
        self.slopes = slopes
        self.motion = chain.shaft(recorded)
        self.observables = observables
        self.stair_variance: Array | None = None
        self._steps = list(chain.steps(self.motion))
        computed = next(step for step in self._steps if step.key == "after channels")
        self._channels = computed.before
        self.sensor_angle = computed.after[0]
        self.angle = self._blurred(computed.after, blur) if blur > 0.0 else self._steps[-1].after[0]

    @cached_property
    def log_radius(self) -> Array:
        return np.asarray(np.log(np.hypot(self._channels[0], self._channels[1])))

    @cached_property
    def _order(self) -> dict[tuple[str, str], float]:
        return self.chain.places()

    @cached_property
    def _points(self) -> list[tuple[float, Insertion]]:
        """Backward: sensitivity of angle and log radius to the signal after each step, by its place in the chain.

        A fit asks for it only where it goes on from: a step that it takes back costs the forward run alone.
        """
        n = len(self.motion)
        sense = np.zeros((self.observables, 1, n))
        sense[0] = 1.0
        bounds = _last_places(self.chain)
        points: list[tuple[float, Insertion]] = []
        for step in reversed(self._steps):
            place = (
                bounds[step.key.removeprefix("after ")] + 0.5 if step.effect is None else self._place_of(step.effect)
            )
            points.append((place, Insertion(step.after, sense)))
            sense = self._ahead_of(step, sense)
        points.append((-1.0, Insertion(np.broadcast_to(self.motion.shaft_rad, (2, n)), sense)))
        return sorted(points, key=lambda item: item[0])

    def _ahead_of(self, step: Step, sense: Array) -> Array:
        """Sensitivity to the signal ahead of a step, from that to the signal behind it."""
        if step.effect is not None:
            # A quantiser's edges are no slopes: it passes changes on as they are.
            passed_on = step.effect.acts_on == "angle" or (is_staircase(step.effect) and not self.slopes)
            return sense if passed_on else _through(step, self.motion, sense)
        if step.key == "after channels":
            x, y = step.before
            square = x * x + y * y
            here = np.empty((self.observables, 2, len(self.motion)))
            here[0] = sense[0, 0] * np.stack([-y, x]) / square
            if self.observables == 2:
                here[1] = np.stack([x, y]) / square
            return here
        if step.key == "after field":
            return np.asarray(sense * _slope_of_channels(self.chain, step.before, self.motion))
        return (self.chain.sensor_sense if step.key == "after shaft" else self.chain.output_sense) * sense

    def _blurred(self, computed: Array, blur: float) -> Array:
        """Expected reading where stairs follow: the angle's steps averaged over Gaussian noise of RMS ``blur``.

        Stairs that follow on one another are averaged together, at the angle that reaches them.
        """
        signal = computed
        active = ((effect, values) for _, effect, values in self.chain.active("angle"))
        for stepped, group in itertools.groupby(active, key=lambda one: one[0].footprint == "values"):
            if stepped:
                away, self.stair_variance = blurred_stairs(list(group), blur).at(signal[0])
                signal = signal + away
                continue
            for effect, values in group:
                signal = effect.forward(signal, self.motion, values, None)
        signal = self.chain.output_sense * signal
        for _, effect, values in self.chain.active("word"):
            signal = effect.forward(signal, self.motion, values, None)
        return np.asarray(signal[0])

    def _place_of(self, effect: Effect) -> float:
        return self._order[effect.name, effect.acts_on]

    def at(self, effect: Effect) -> Insertion:
        """The point behind the effect's own place: the signal it made, or would be given were it not at null."""
        place = self._place_of(effect)
        return [point for where, point in self._points if where <= place][-1]

    def before(self, effect: Effect) -> Insertion:
        """The point ahead of the effect's own place."""
        place = self._place_of(effect)
        return [point for where, point in self._points if where < place][-1]

    def change(
        self, effect: Effect, old: Parameters, new: Parameters, *, batch: int | None = None, before: Array | None = None
    ) -> Array:
        """Change of the observables, (O, n) or (batch, O, n), as the effect's parameters go from old to new.

        ``before`` is the signal that the effect makes with the old ones, where it is known already.
        """
        first, *behind = effect.operations
        changed = self._changed(first, old, new, batch, before)
        for one in behind:
            if one.acts({**effect.null(), **old}) or one.acts({**effect.null(), **new}):
                changed = changed + self._changed(one, old, new, batch, None)
        return changed

    def _changed(
        self, effect: Effect, old: Parameters, new: Parameters, batch: int | None, before: Array | None
    ) -> Array:
        """The same of one operation."""
        before = self.made(effect, old) if before is None else before
        moved = effect.forward(self._given(effect), self.motion, new, None) - before
        if effect.acts_on == "reference":
            # The reference reads too much by this, so the shaft stands back by it.
            start: Array = self._points[0][1].sensitivity.sum(axis=1)
            return -start * (moved if batch is None else np.broadcast_to(moved, (batch, *moved.shape[-2:])))
        point = self.at(effect)
        if batch is None:
            return np.asarray(np.einsum("okn,kn->on", point.sensitivity, moved))
        moved = np.broadcast_to(moved, (batch, *moved.shape[-2:]))
        return np.asarray(np.einsum("okn,bkn->bon", point.sensitivity, moved))

    def made(self, effect: Effect, values: Parameters) -> Array:
        """The signal that an effect makes of the one it is given here."""
        return effect.forward(self._given(effect), self.motion, values, None)

    def _given(self, effect: Effect) -> Array:
        return self.motion.shaft_rad[None, :] if effect.acts_on == "reference" else self.before(effect).signal

    def derivatives(self, key: str, effect: Effect, moved: Sequence[tuple[str, int | None]]) -> Array:
        """Columns (len(moved), O, n) of parameters of an effect that is present, in the parameters' own units.

        Each is named with its turn, where it has one value a turn. They are moved side by side, in one batch.
        """
        values = {**effect.null(), **self.chain.values[key]}
        steps = [self._step(effect, name, values) for name, _ in moved]
        count = len(moved)
        batch = dict(values)
        for place, (name, turn) in enumerate(moved):
            if turn is None:
                batch[name] = np.full((count, 1, 1), float(values[name]))
                batch[name][place] += steps[place]
                continue
            if np.ndim(batch[name]) < 3:
                batch[name] = np.tile(np.asarray(values[name], dtype=np.float64), (count, 1, 1))
            batch[name][place, 0, turn] += steps[place]
        changes = self.change(effect, values, batch, batch=count)
        return np.asarray(changes / np.array(steps)[:, None, None])

    @staticmethod
    def _step(effect: Effect, name: str, values: Parameters) -> float:
        """By how much a parameter is moved for its derivative."""
        if effect.line is not None and name == effect.line.param:
            # Over the whole clock a small change of a frequency turns the phase by much.
            return 1e-7 * max(abs(float(values[name])), 1.0)
        return 1e-4 * effect.params[name].typical

    def terms(self, effect: Effect) -> tuple[Term, ...]:
        """The linear coefficients that a candidate has at fixed shape."""
        if effect.roles("per turn"):
            name = effect.roles("per turn")[0]
            return tuple(Term(name, turn=k) for k in range(1, int(self.motion.turn.max(initial=0)) + 1))
        if effect.whole:
            return (Term(effect.roles("level")[0]),)
        phases: tuple[float | None, ...] = (0.0, 90.0) if effect.roles("phase") else (None,)
        return tuple(Term(name, phase_deg=phase) for name in effect.roles("strength") for phase in phases)

    def columns(self, effect: Effect, shapes: Sequence[Mapping[str, float]]) -> Array:
        """Columns (len(shapes), terms, O, n) of a candidate at null, one per shape and coefficient.

        A level's column is the whole change it makes, expected with the coefficient 1.
        """
        terms = self.terms(effect)
        count = len(shapes)
        n = len(self.motion)
        if effect.roles("per turn"):
            turns = int(self.motion.turn.max(initial=0)) + 1
            unit = [self.change(effect, {}, {terms[0].param: np.eye(turns)[t.turn or 0]}) for t in terms]
            return np.broadcast_to(np.stack(unit), (count, len(terms), self.observables, n))
        grid: dict[str, Any] = {
            name: np.array([shape[name] for shape in shapes])[:, None, None] for name in (shapes[0] if shapes else {})
        }
        out = np.empty((count, len(terms), self.observables, n))
        null = {**effect.null(), **grid}
        before = self.made(effect, null) if effect.roles("strength") else None
        for place, term in enumerate(terms):
            if effect.params[term.param].role == "level":
                out[:, place] = self.change(effect, effect.null(), null, batch=count)
                continue
            step = 1e-3 * effect.params[term.param].typical
            moved = {**null, term.param: effect.params[term.param].null + step}
            if term.phase_deg is not None:
                moved[effect.roles("phase")[0]] = term.phase_deg
            out[:, place] = self.change(effect, null, moved, batch=count, before=before) / step
        return out


def _through(step: Step, motion: Motion, sense: Array) -> Array:
    """Sensitivity (O, 2, n) ahead of a pointwise effect's step from the one behind it."""
    assert step.effect is not None
    before = step.before
    out = np.empty((sense.shape[0], before.shape[0], before.shape[1]))
    for channel in range(before.shape[0]):
        slope = _slope(step, motion, channel, _STEP)
        if step.effect.acts_on == "word":
            # Where a word begins anew there is an edge, which is no slope.
            other = _slope(step, motion, channel, -_STEP)
            slope = np.where(np.abs(other) < np.abs(slope), other, slope)
        out[:, channel] = np.einsum("okn,kn->on", sense, slope)
    return out


def _slope(step: Step, motion: Motion, channel: int, by: float) -> Array:
    """Difference quotient (k, n) of an effect's signal as one channel of what it is given moves."""
    assert step.effect is not None
    moved = np.array(step.before)
    moved[channel] += by
    return np.asarray((step.effect.forward(moved, motion, step.values, None) - step.after) / by)


def _slope_of_channels(chain: Chain, angle: Array, motion: Motion) -> Array:
    """Derivative (2, n) of the driven channels with respect to the field angles (2, n) [rad]."""
    if chain.magnet is None:
        return np.stack([-np.sin(angle[0]), np.cos(angle[1])])
    return np.asarray((chain.driven(angle + _STEP, motion) - chain.driven(angle - _STEP, motion)) / (2.0 * _STEP))


def is_staircase(effect: Effect) -> bool:
    """Whether an effect acts on the channels in steps."""
    return effect.line is not None and effect.line.clock == "channels"


def _last_places(chain: Chain) -> dict[str, float]:
    """By signal the place in the chain's order of the last effect that acts on it or on a signal ahead of it."""
    last = dict.fromkeys((str(name) for name in SIGNALS), -1.0)
    for place, effect in enumerate(chain.operations):
        if effect.acts_on in last:
            last[effect.acts_on] = float(place)
    return dict(zip(last, itertools.accumulate(last.values(), max), strict=True))
