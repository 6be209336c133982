"""Repeated frames, and what else the values alone tell: such readings must not be searched for causes."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import solve
from diagnosis.discovery.marks.row_masks import with_rows, without_rows
from diagnosis.discovery.marks.sequence import touched_rows
from diagnosis.discovery.state import State
from twin.catalogue import base_name
from twin.effect import BoolArray, Effect


def repeated_frames(state: State) -> State:
    """Find the readings whose marks can be told before the search (``Marks.early``), name the cause, and mask them.

    Asked again after the search: structure may hide them at first; and a cause may do by itself what had passed for
    them, such as a clipped angle that stands still. The fit has not seen these readings: where it says what they read,
    they are given back. And readings that are not masked yet pull the fit to where some of their marks do not show: it
    is asked again without those that were found.
    """
    for effect in state.effects:
        if effect.marks is not None and effect.marks.early:
            for _ in range(state.settings.most_rounds):
                anew = given_back(state, effect)
                after = claimed(anew, effect)
                if np.array_equal(after.touched, state.touched):
                    break
                state = after.with_(without_rows(solve(anew.fit), after.touched))
    return state


def given_back(state: State, effect: Effect) -> State:
    """The state in which the effect has claimed no reading; the same where it had none.

    A reading that another finding claims too stays with that.
    """
    if not state.has(effect):
        return state
    own = [finding for finding in state.findings if base_name(finding.keys[0]) == effect.name]
    others = tuple(finding for finding in state.findings if finding not in own)
    back = _rows(own, state.touched.size) & ~_rows(others, state.touched.size)
    return state.with_(with_rows(state.fit, back), touched=state.touched & ~back, findings=others)


def _rows(findings: Iterable[Finding], size: int) -> BoolArray:
    """The readings (size,) that any of the findings claims."""
    claimed = np.zeros(size, dtype=bool)
    for finding in findings:
        claimed[list(finding.rows)] = True
    return claimed


def claimed(state: State, effect: Effect) -> State:
    """The state in which the effect has claimed the readings that bear its marks; the same where it is chance."""
    found = touched_rows(
        state.fit,
        state.sweep,
        effect,
        step=state.step,
        spoken_for=state.touched,
        family=state.family("sequence"),
    )
    if found is None:
        return state
    mask, cause = found
    return state.with_(touched=state.touched | mask, findings=(*state.findings, cause))
