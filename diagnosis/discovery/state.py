"""What the stages of the discovery hand on: the fit as it stands, and what has been found so far."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.watch import Watch
from twin.angles import TAU, Array, IntArray
from twin.catalogue import base_name
from twin.chain import Chain
from twin.each_recording import everywhere
from twin.effect import BoolArray, Effect, Parameters
from twin.sweep import Sweep

if TYPE_CHECKING:
    from diagnosis.discovery.proof.alone import Alone
    from diagnosis.discovery.proof.changes import Change
    from diagnosis.discovery.proof.lack_of_fit import LackOfFit
    from diagnosis.discovery.proof.predictive_check import PredictiveCheck


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """A discovery between two stages.

    Given at the start: ``sweep``; ``start``, the chain that the fit sets out from, whose effects are what is known;
    ``given``, the same where it is a known twin, which is asked what has changed; ``settings``; ``rng``, which draws
    the simulated sweeps: a stage that draws hands on a generator that is further, and leaves its own as it is;
    ``suspects``, raw rows (n_raw,) that a robust fit of the start left out: the first least-squares fit is made without
    them, because a flipped top bit, half a turn off, would pull it to where nothing stands out any more; ``watch``,
    which hears where the discovery stands and may end its search.

    Filled by the stages: ``fitted``, the chain with its free parameters, the observations and how they are weighed
    (see :attr:`fit`); ``baseline``, the same before any cause was added; ``bits``, the length of the output's word;
    ``keys`` of the causes in the joint fit; ``findings`` beside it, from values, sequence and spread; ``touched``,
    the raw rows (n_raw,) that single-reading causes have claimed; ``looked_at``, how many effects were searched for;
    ``fold`` (n,), the block in which each row was held out; ``held``, held-out residuals (n,) [rad] of the baseline and
    after each of ``keys``, and once there is an answer after each of ``causes``; ``causes``, the entries of
    the answer; ``rival_fits``, by name the fits with another effect in the place of one of these that are as good;
    ``fits_beside``, likewise those with an effect beside them that one of them hides, and its odds;
    ``likeness``, the predictive check; ``lack``, what is left against repeated readings. Of a given twin
    also ``own``, its parameters that are asked whether they have moved, ``changed``, those that have,
    ``other_device``, whether so many have that it is another's twin, and ``fitted_anew``, whether the others were not
    held at its values, as it hardly tells some from the rest. ``words``, the effects on the words as they were sent,
    which the readings of the sweep have been freed of, and ``told_back`` (n,) [rad] what that took off them; ``begun``,
    those on every reading that the words tell so plainly that the fit sets out with them. Of several recordings
    ``alone``, each of them fitted by itself.
    """

    sweep: Sweep
    start: Chain
    given: Chain | None
    settings: DiscoverySettings
    rng: np.random.Generator
    suspects: BoolArray
    touched: BoolArray
    fitted: Fit | None = None
    baseline: Fit | None = None
    bits: float | None = None
    keys: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    looked_at: int = 0
    fold: IntArray | None = None
    held: tuple[Array, ...] = ()
    causes: tuple[Finding, ...] = ()
    likeness: PredictiveCheck | None = None
    alone: tuple[Alone, ...] = ()
    rival_fits: tuple[tuple[str, Fit], ...] = ()
    fits_beside: tuple[tuple[str, Fit, float], ...] = ()
    lack: LackOfFit | None = None
    own: tuple[Free, ...] = ()
    changed: tuple[Change, ...] = ()
    other_device: bool = False
    fitted_anew: bool = False
    words: Mapping[str, Parameters] = field(default_factory=dict)
    told_back: Array | None = None
    begun: Mapping[str, Parameters] = field(default_factory=dict)
    watch: Watch = field(default_factory=Watch)

    def __repr__(self) -> str:
        """Show where the discovery stands, in one line."""
        found = ", ".join(self.held_causes) or "no cause"
        return f"State({self.sweep.name!r}, {'observed' if self.fitted is not None else 'as handed in'}: {found})"

    @classmethod
    def of(
        cls,
        sweep: Sweep,
        start: Chain,
        *,
        given: Chain | None = None,
        settings: DiscoverySettings | None = None,
        rng: np.random.Generator | None = None,
    ) -> State:
        """The state that the first stage is handed.

        Parameters
        ----------
        sweep : Sweep
            The recording, at most as long as :func:`~diagnosis.discovery.fitting.subsample.searched_part` leaves it.
        start : Chain
            Where the fit sets out from: the fitted baseline, or a given twin. Its effects are those that are known:
            those of the baseline are fitted, the others searched for.
        given : Chain, optional
            The twin, where one is held against the sweep: then it is asked what has changed since.
        settings : DiscoverySettings, optional
            Every threshold; the project's own if not given.
        rng : numpy.random.Generator, optional
            Draws the simulated sweeps that the measured one is compared with; seed 0 if not given.
        """
        settings, rng = settings or DiscoverySettings(), rng or np.random.default_rng(0)
        none = np.zeros(len(sweep), dtype=bool)
        return cls(sweep=sweep, start=start, given=given, settings=settings, rng=rng, suspects=none, touched=none)

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects that are searched for, in the mean or elsewhere."""
        return tuple(effect for effect in self.start.effects if not effect.baseline)

    @property
    def fit(self) -> Fit:
        """The joint fit as it stands.

        Raises
        ------
        RuntimeError
            Before the stage that prepares the observations.
        """
        if self.fitted is None:
            raise RuntimeError("no stage has prepared the observations yet; expected `observe` first in the pipeline")
        return self.fitted

    @property
    def step(self) -> float:
        """Step [rad] of the output's grid; 0 where the readings lie on none."""
        return TAU / 2.0**self.bits if self.bits is not None else 0.0

    @property
    def held_out(self) -> tuple[Array, Array]:
        """Held-out residuals (n,) [rad] of the baseline and of all causes together; NaN where none was held out."""
        held = self.held or (np.full(len(self.fit.observations), np.nan),)
        return held[0], held[-1]

    @property
    def searched(self) -> tuple[Effect, ...]:
        """The effects that show in the mean: those that the stepwise search is for.

        What a given twin has, and has free, is not searched for once more, unless there may be several of it.
        """
        own = {base_name(free.key) for free in self.own}
        return tuple(e for e in self.effects if e.footprint == "mean" and (e.repeatable or e.name not in own))

    def family(self, footprint: str) -> int:
        """How many effects are searched for that show there, in a recording like this: what an improbable one pays."""
        provided = self.sweep.motion().provides if self.fitted is None else self.fit.observations.motion.provides
        return sum(effect.footprint == footprint and effect.visible_in(provided) for effect in self.effects)

    def found(self, footprint: str) -> bool:
        """Whether a cause that shows there has been found beside the joint fit."""
        declared = {effect.name: effect.footprint for effect in self.effects}
        return any(declared.get(finding.keys[0]) == footprint for finding in self.findings)

    def has(self, effect: Effect) -> bool:
        """Whether this effect has been found beside the joint fit."""
        return any(finding.keys[0] == effect.name for finding in self.findings)

    @property
    def held_causes(self) -> tuple[str, ...]:
        """The causes found so far, in the joint fit and beside it, by the keys that people read."""
        keys = [*self.keys, *(finding.keys[0] for finding in self.findings)]
        return tuple(dict.fromkeys(map(everywhere, keys)))

    def told(self, stage: Stage) -> State:
        """This state, once its watch has heard that a stage runs."""
        self.watch.told(getattr(stage, "__name__", repr(stage)), self.held_causes, lambda: self)
        return self

    def with_(self, fit: Fit | None = None, **changes: Any) -> State:
        """This state with another fit, and with these fields changed."""
        return replace(self, **(changes if fit is None else {"fitted": fit, **changes}))


Stage = Callable[[State], State]
"""A stage takes a state and returns another, or the very same one where it has nothing to say."""


def until_still(*stages: Stage) -> Stage:
    """The stages one after the other, again and again, until none of them has anything more to say.

    A stage is not asked again about the state that it has itself handed on, and the loop ends after
    :attr:`DiscoverySettings.most_rounds` at the latest. Where the watch is told to stop, it ends at once with the state
    as it stands.
    """

    def rounds(state: State) -> State:
        left: dict[int, State] = {}
        for _ in range(state.settings.most_rounds):
            for place, stage in enumerate(stages):
                if left.get(place) is not state:
                    state = stage(state.told(stage))
                    left[place] = state
        return state

    def search(state: State) -> State:
        return state.watch.until_stopped(rounds, state)

    return search
