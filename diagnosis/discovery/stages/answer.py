"""Answer: the findings as entries, one a cause, with the held-out RMS before and after each."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

from diagnosis.discovery.finding import Finding, merge
from diagnosis.discovery.fitting.observations import of_readings
from diagnosis.discovery.fitting.own_parameters import set_back
from diagnosis.discovery.proof.changes import Change
from diagnosis.discovery.proof.cross_validation import held_out_residual, rms_deg
from diagnosis.discovery.proof.order import by_turn
from diagnosis.discovery.state import State
from twin.angles import Array
from twin.catalogue import find


def answer(state: State) -> State:
    """Merge instances of one effect, and give every entry the held-out RMS before and after it.

    The figures chain from the baseline, over what has changed of a given twin, to the extended twin, all on the same
    rows and of single readings: what is before an entry is after the one above it. Causes of single readings and of the
    scatter change nothing there.
    """
    merged = merge(state.findings, state.fit.chain.effects)
    entries = [merged[place] for place in by_turn(state.fit, [entry.keys for entry in merged])]
    causes, changed, held = _with_figures(state, entries)
    # The turn of some comes only with what stands below them.
    early = [entry for entry, cause in zip(entries, causes, strict=True) if cause.after_deg > cause.before_deg]
    if early:
        entries = [*(entry for entry in entries if entry not in early), *early]
        causes, changed, held = _with_figures(state, entries)
    return state.with_(causes=causes, changed=changed, held=held)


def _with_figures(
    state: State, entries: Sequence[Finding]
) -> tuple[tuple[Finding, ...], tuple[Change, ...], tuple[Array, ...]]:
    """The entries in this order, and the changes ahead of them, with the RMS before and after each.

    With the held-out residuals (n,) [rad] that these are of.
    """
    held = [*_before_changes(state), *_chained(state, entries)]
    observations = state.fit.observations
    figures = [of_readings(rms_deg(residual, observations.usable), observations) for residual in held]
    pairs = list(itertools.pairwise(figures))
    count = len(state.changed)
    changed = [replace(c, before_deg=b, after_deg=a) for c, (b, a) in zip(state.changed, pairs[:count], strict=True)]
    causes = [replace(e, before_deg=b, after_deg=a) for e, (b, a) in zip(entries, pairs[count:], strict=True)]
    if state.fitted_anew and not changed:
        held.insert(0, _as_given(state))
    return tuple(causes), tuple(changed), tuple(held)


def _as_given(state: State) -> Array:
    """The held-out residual (n,) [rad] of a given twin as it is."""
    if state.given is None or state.fold is None:
        return state.held_out[0]
    own = {*state.own, *(change.free for change in state.changed)}
    before = set_back(state.fit, [one for one in state.fit.free if one in own], state.given)
    return held_out_residual(before, state.keys, (), state.fold)


def _before_changes(state: State) -> list[Array]:
    """Held-out residuals (n,) [rad] of a given twin as it is, then with its changes but the last, one by one."""
    if not state.changed or state.given is None:
        return []
    if state.fold is None:
        return [state.held_out[0]] * len(state.changed)
    held = [_as_given(state)]
    for count in range(1, len(state.changed)):
        later = [change.free for change in state.changed[count:]]
        before = set_back(state.fit, later, state.given)
        held.append(held_out_residual(before, state.keys, (), state.fold))
    return held


def _chained(state: State, entries: Sequence[Finding]) -> list[Array]:
    """Held-out residuals (n,) [rad] of the baseline without any entry, and with one after the other added."""
    predicted = [[key for key in entry.keys if _predicts(state, key)] for entry in entries]
    keys = [key for several in predicted for key in several]
    stairs = {key for key in keys if key not in state.keys}
    # Those that the proof has made already: with all stairs known, and the causes one by one.
    made = {frozenset({*stairs, *state.keys[:count]}): one for count, one in enumerate(state.held)}
    held = []
    for count in range(len(entries) + 1):
        present = frozenset(itertools.chain.from_iterable(predicted[:count]))
        if present not in made:
            made[present] = _held_out(state, keys, present)
        held.append(made[present])
    return held


def _predicts(state: State, key: str) -> bool:
    """Whether the chain predicts another reading with this finding than without it."""
    footprint = find(key, state.fit.chain.effects).footprint
    return footprint in ("mean", "values") and key in state.fit.chain.values


def _held_out(state: State, keys: Sequence[str], present: frozenset[str]) -> Array:
    """The residual (n,) [rad] on held-out rows with these of the keys; NaN where nothing was held out."""
    if state.fold is None:
        return state.held_out[0]
    return held_out_residual(state.fit, keys, present, state.fold)
