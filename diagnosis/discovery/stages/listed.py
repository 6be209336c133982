"""Listed: a cause that might as well be nothing, or gains nothing where it stands in the list, is dropped."""

from __future__ import annotations

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.intervals import may_be_null
from diagnosis.discovery.search.likelihood_ratio import drop, settle
from diagnosis.discovery.stages.answer import answer
from diagnosis.discovery.stages.final_fit import final_fit
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.state import State
from twin.catalogue import find


def listed(state: State) -> State:
    """Keep the entries that the answer's own figures bear out: intervals, and RMS on held-out readings.

    What is left is fitted and proven anew, until every entry stands.
    """
    while idle := _idle(state):
        fit = state.fit
        for key in idle:
            if key in state.keys:
                fit, _ = settle(drop(fit, key))
        gone = {*state.keys, *idle}
        state = state.with_(
            fit,
            keys=tuple(key for key in state.keys if key not in idle),
            findings=tuple(one for one in state.findings if one.keys[0] not in gone),
        )
        state = answer(final_fit(held_out_selection(state)))
    return state


def _idle(state: State) -> tuple[str, ...]:
    """Keys of the causes that the answer does not bear out."""
    may_be_nothing = tuple(key for key in state.keys if may_be_null(state.fit, key))
    if may_be_nothing:
        return may_be_nothing
    # One entry after the other: without it another may gain.
    return next((tuple(cause.keys) for cause in reversed(state.causes) if _gains_nothing(state, cause)), ())


def _gains_nothing(state: State, cause: Finding) -> bool:
    """Whether a cause that ought to leaves the held-out readings no nearer; unknown where none was held out.

    Those in the mean ought to, and the output's grid, which is said to limit the readings. What shows in the spread, in
    single readings or in the words themselves need not.
    """
    ought = (key in state.keys or find(key, state.fit.chain.effects).output_grid for key in cause.keys)
    return all(ought) and cause.after_deg >= cause.before_deg
