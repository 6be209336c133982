"""Selection: which causes stay, judged once more in the final fit and proven on readings that no fit has seen."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.projection import projected
from diagnosis.discovery.proof.bootstrap import noise_of
from diagnosis.discovery.proof.conditional import unforeseen
from diagnosis.discovery.proof.cross_validation import folds, held_out_residuals, rms_deg, scattered
from diagnosis.discovery.proof.family_wise import FamilyWise, family_wise
from diagnosis.discovery.proof.order import by_turn, is_strength
from diagnosis.discovery.search.likelihood_ratio import drop, likelihood, settle, take_out
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.rivals import Judged, judge
from twin.angles import Array, IntArray
from twin.catalogue import base_name, find, output_grid
from twin.effect import BoolArray, Effect


@dataclass(frozen=True, eq=False)
class Proof:
    """The causes of a fit, the most telling first, and what each gains on held-out readings.

    ``fold`` (n,) is that of each row, ``held`` the held-out residuals (n,) [rad] of the baseline and after each cause,
    ``weighed_deg`` their RMS with the rows weighed by their noise; ``family`` calibrates the probabilities, where any
    of the causes leaves a doubt, and ``effects`` are those that were searched for. ``at_once`` as in :func:`select`;
    ``narrow``: rows are held out one by one.
    """

    fit: Fit
    effects: tuple[Effect, ...]
    causes: tuple[Judged, ...]
    fold: IntArray
    held: tuple[Array, ...]
    weighed_deg: tuple[float, ...]
    family: FamilyWise | None
    at_once: bool = False
    narrow: bool = False

    @property
    def ordered(self) -> tuple[str, ...]:
        """Keys of the causes, the most telling first."""
        return tuple(cause.key for cause in self.causes)

    def by_chance(self, cause: Judged) -> float:
        """Log of the family-wise probability of a cause: calibrated, or the F test's where that leaves no doubt.

        What could not be told from it has been searched for too: the least likely of them by chance tells for all.
        """
        own = self._family_log_p(cause.key, cause.log_p)
        if own <= self.fit.settings.footprint_log_p:
            return own
        searched = {effect.name for effect in self.effects}
        rivals = {name: fit for name, fit in cause.rivals.items() if name in searched}
        return min((own, *(self._rivals_log_p(name, fit) for name, fit in rivals.items())))

    def _rivals_log_p(self, name: str, fit: Fit) -> float:
        """That of a rival, in the fit with it in the place of a cause."""
        return self._family_log_p(name, Removal.of(fit, _its_key(self.fit, name, fit)).log_p)

    def _family_log_p(self, name: str, log_p: float) -> float:
        """Log probability that any of the effects reaches what has the log probability ``log_p`` by itself."""
        if self.family is None:
            return log_p + float(np.log(max(len(self.effects), 1)))
        return self.family.log_p(base_name(name), log_p)

    def entries(self) -> tuple[Finding, ...]:
        """The causes as entries of the answer, with their held-out figures over all rows in use."""
        use = self.fit.observations.usable
        figures = [rms_deg(residual, use) for residual in self.held]
        return tuple(
            Finding(
                (cause.key,),
                cause.log_p,
                cause.gain,
                self.by_chance(cause),
                cause.rivals,
                before_deg=before,
                after_deg=after,
            )
            for cause, (before, after) in zip(self.causes, itertools.pairwise(figures), strict=True)
        )


def select(
    fit: Fit, effects: Sequence[Effect], keys: Sequence[str], *, rng: np.random.Generator, at_once: bool = False
) -> Proof:
    """Drop causes one after the other until every one that is left is proven, and is the likeliest of its class.

    ``rng`` draws the sweeps on which the family-wise probabilities are calibrated. ``at_once``: somebody waits; then no
    rivals are looked for, held-out fits go by a single step, and probabilities are those of the F test.
    """
    kept = list(keys)
    while True:
        proof = prove(fit, effects, kept, rng=rng, at_once=at_once)
        idle = _idle(proof)
        if idle is None:
            return _likeliest(proof, effects, rng=rng)
        fit, _ = settle(drop(fit, idle))
        kept.remove(idle)


def _idle(proof: Proof) -> str | None:
    """The first of the causes that is not proven."""
    return next((cause.key for place, cause in enumerate(proof.causes) if not _proven(proof, place)), None)


def _likeliest(proof: Proof, effects: Sequence[Effect], *, rng: np.random.Generator) -> Proof:
    """The proof with those causes that need less to be assumed, where the readings leave them the likelier."""
    for cause in proof.causes:
        for name, rival in cause.rivals.items():
            if not _assumes_less(proof, cause, name, rival):
                continue
            kept = [key for key in rival.chain.values if key in proof.ordered or key not in proof.fit.chain.values]
            trial = prove(settle(rival)[0], effects, kept, rng=rng)
            if _idle(trial) is None:
                return _likeliest(trial, effects, rng=rng)
    return proof


def _assumes_less(proof: Proof, cause: Judged, name: str, rival: Fit) -> bool:
    """Whether a rival needs less to be assumed than a cause that it cannot be told from, and is the likelier for it.

    A magnet is always misplaced a little: a reference that errs as well has to gain more than its misplacement does.
    And what a cause that is there already does with a further part of its own, as improbable by chance, needs no other.
    """
    declared = proof.fit.chain.effects
    own, other = find(cause.key, declared), find(name, declared)
    if other not in proof.effects:
        return False
    if name in {base_name(key) for key in proof.ordered if key != cause.key}:
        return Removal.of(rival, _its_key(proof.fit, name, rival)).log_p <= cause.log_p
    return other.handicap < own.handicap and likelihood(rival) - other.handicap > likelihood(proof.fit) - own.handicap


def _its_key(fit: Fit, name: str, rival: Fit) -> str:
    """The key that a cause of this name has in a rival of a fit, where it is not in the fit itself."""
    return next(key for key in rival.chain.values if base_name(key) == name and key not in fit.chain.values)


def prove(
    fit: Fit, effects: Sequence[Effect], keys: Sequence[str], *, rng: np.random.Generator, at_once: bool = False
) -> Proof:
    """Judge the causes of a fit, hold them out, and calibrate their probabilities; see :func:`select`.

    Of the ``effects`` those count as searched for that the recording can show; the others may be rivals of these.
    """
    views = _views(fit, effects) if keys else []
    others = () if at_once else effects
    judged = [_judged(views, key, others, keys) for key in keys]
    causes = [judged[place] for place in by_turn(fit, [(cause.key,) for cause in judged])]
    ordered = [cause.key for cause in causes]
    fold = folds(fit, ordered)
    narrow = any(least_seen(fit, [cause.key], fold) < fit.settings.heldout_seen for cause in causes)
    if narrow:
        # Narrower than a block, in one turn: held out as a whole, it leaves its parameters free to go anywhere.
        fold = scattered(fit, ordered)
    held, weighed = _held_out(fit, ordered, fold, at_once=at_once, narrow=narrow)
    visible = tuple(effect for effect in effects if effect.visible_in(fit.observations.motion.provides))
    family = None if at_once else _calibrated(fit, visible, causes, rng)
    return Proof(fit, visible, tuple(causes), fold, tuple(held), tuple(weighed), family, at_once, narrow)


def _proven(proof: Proof, place: int) -> bool:
    """Whether the cause at this place stands out of chance, and gains on readings that no fit has seen."""
    fit, cause, settings = proof.fit, proof.causes[place], proof.fit.settings
    if proof.by_chance(cause) > settings.footprint_log_p:
        # Or what was added after it has taken over what it was added for.
        return False
    if proof.weighed_deg[place + 1] < proof.weighed_deg[place]:
        return True
    # Not the last step: its turn may come only with what was added after it.
    last = [*(key for key in proof.ordered if key != cause.key), cause.key]
    _, weighed = _held_out(fit, last, proof.fold, at_once=proof.at_once, narrow=proof.narrow)
    # The RMS counts correlated noise in full: a strong cause that leaves it as it is shows elsewhere.
    slack = settings.heldout_slack if cause.log_p < settings.beyond_doubt_log_p else 1.0
    return weighed[-1] < slack * weighed[-2]


def _held_out(
    fit: Fit, keys: Sequence[str], fold: IntArray, *, at_once: bool, narrow: bool
) -> tuple[list[Array], list[float]]:
    """Held-out residuals (n,) [rad] as the causes are added one by one, and their RMS [deg] with weighed rows.

    ``narrow``: rows are held out one by one, whose neighbours foretell what the noise does there.
    """
    held = held_out_residuals(fit, keys, fold, at_once=at_once)
    told = [unforeseen(fit, residual) for residual in held] if narrow else held
    return held, [rms_deg(residual / fit.observations.scale, fit.observations.usable) for residual in told]


def least_seen(fit: Fit, keys: Sequence[str], fold: IntArray) -> float:
    """Least share of what a strength of the causes alone does, as squares, on the rows outside of one fold; 1 of none.

    What the other parameters of the fit can do on those rows tells nothing of it: a step near the beginning of a record
    is a zero on all rows behind it, and goes with the few ahead of it. A shape that the rows left do not tell, as a
    memory after the only reversal, leaves the strength to be proven.
    """
    own = np.array([free.key in keys for free in fit.free], dtype=bool)
    strength = own & [is_strength(fit, free) for free in fit.free]
    slopes = np.where(fit.observations.usable, fit.jacobian, 0.0)

    def alone(rows: BoolArray) -> Array:
        columns = slopes[..., rows].reshape(len(slopes), -1)
        return np.asarray(np.sum(projected(columns[strength], columns[~own]) ** 2, axis=1))

    squares = alone(np.ones(fold.size, dtype=bool))
    # What the others do wholly leaves rounding.
    shown = squares > 1e-12 * np.sum(slopes[strength] ** 2, axis=(1, 2))
    seen = [np.min(alone(fold != number)[shown] / squares[shown], initial=1.0) for number in np.unique(fold)]
    return float(min(seen))


def _calibrated(
    fit: Fit, effects: Sequence[Effect], causes: Sequence[Judged], rng: np.random.Generator
) -> FamilyWise | None:
    """The scores that the effects reach on sweeps without any of the causes; None where none of these is in doubt."""
    if all(cause.log_p < fit.settings.no_simulation_log_p for cause in causes):
        return None
    baseline = fit
    for cause in causes:
        baseline = take_out(baseline, cause.key)
    return family_wise(solve(baseline), fit, noise_of(fit), effects, rng=rng)


def _views(fit: Fit, effects: Sequence[Effect]) -> list[Fit]:
    """The fit; on coloured noise also the fit without the output's stairs.

    A slow noise shifts whole runs of readings against the stairs, which a cause may then seem to set right.
    """
    grid = output_grid(fit.chain.effects)
    if fit.weighting.member == 0 or grid is None or grid.name not in fit.chain.values:
        return [fit]
    return [fit, settle(solve(evaluate(fit.chain.without(grid.name), fit.free, fit.observations, fit.weighting)))[0]]


def _judged(views: Sequence[Fit], key: str, effects: Sequence[Effect], keys: Sequence[str]) -> Judged:
    """The cause as the least favourable view judges it."""
    return max((judge(view, key, effects, keys) for view in views), key=lambda cause: cause.log_p)
