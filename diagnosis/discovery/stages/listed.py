"""Listed: a cause that might as well be nothing, or gains nothing where it stands in the list, is dropped."""

from __future__ import annotations

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.intervals import may_be_null
from diagnosis.discovery.search.likelihood_ratio import drop, settle
from diagnosis.discovery.stages.answer import answer
from diagnosis.discovery.stages.final_fit import final_fit
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.state import State


def listed(state: State) -> State:
    """Keep the entries that the answer's own figures bear out: intervals, and RMS on held-out readings.

    What is left is fitted and proven anew, until every entry stands.
    """
    while idle := _idle(state):
        fit = state.fit
        for key in idle:
            fit, _ = settle(drop(fit, key))
        proven = {*state.keys}
        state = state.with_(
            fit,
            keys=tuple(key for key in state.keys if key not in idle),
            findings=tuple(one for one in state.findings if one.keys[0] not in proven),
        )
        state = answer(final_fit(held_out_selection(state)))
    return state


def _idle(state: State) -> tuple[str, ...]:
    """Keys of the joint fit's causes that the answer does not bear out."""
    may_be_nothing = tuple(key for key in state.keys if may_be_null(state.fit, key))
    if may_be_nothing:
        return may_be_nothing
    # One entry after the other: without it another may gain.
    return next((tuple(cause.keys) for cause in reversed(state.causes) if _gains_nothing(state, cause)), ())


def _gains_nothing(state: State, cause: Finding) -> bool:
    """Whether a cause in the mean leaves the held-out readings no nearer; unknown where none was held out."""
    return all(key in state.keys for key in cause.keys) and cause.after_deg >= cause.before_deg
