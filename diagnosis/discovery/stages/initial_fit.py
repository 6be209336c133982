"""Initial fit: the paper's error model, or a given twin with its zeros set free."""

from __future__ import annotations

from diagnosis.discovery.fitting.initial_fit import baseline_fit, fit_of_given
from diagnosis.discovery.marks.row_masks import mask_spikes
from diagnosis.discovery.state import State


def initial_fit(state: State) -> State:
    """Fit what is not to be explained: all of the baseline, or of a given twin what no device owns.

    The chain that it sets out from is robust against single readings; least squares is not. So what stands out of that
    chain is kept out: a flipped top bit, half a turn off, would pull the fit to where nothing stands out any more.
    """
    fit = mask_spikes(state.fit, state.step, state.touched)
    return state.with_(baseline_fit(fit) if state.given is None else fit_of_given(fit))
