"""The discovery: what the simulation gets wrong about a sweep, as a list of stages.

Each stage is a pure function from a state to a state, in a file of its own under :mod:`diagnosis.discovery.stages`.
Leave one out, exchange it, or add one: ``discover(state, stages)``.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

from diagnosis.discovery.result import Discovery
from diagnosis.discovery.stages.answer import answer
from diagnosis.discovery.stages.changes import changes
from diagnosis.discovery.stages.final_fit import final_fit
from diagnosis.discovery.stages.flipped_bits import flipped_bits
from diagnosis.discovery.stages.further_measurements import further_measurements
from diagnosis.discovery.stages.grid_cause import grid_cause
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.stages.initial_fit import initial_fit
from diagnosis.discovery.stages.listed import listed
from diagnosis.discovery.stages.motion_freedom import motion_freedom
from diagnosis.discovery.stages.observe import observe
from diagnosis.discovery.stages.one_source import one_source
from diagnosis.discovery.stages.own_parameters import own_parameters
from diagnosis.discovery.stages.own_shapes import own_shapes
from diagnosis.discovery.stages.predictive_check import predictive_check
from diagnosis.discovery.stages.quantisation import quantisation
from diagnosis.discovery.stages.recording_levels import recording_levels
from diagnosis.discovery.stages.recordings_alone import recordings_alone
from diagnosis.discovery.stages.repeated_frames import repeated_frames
from diagnosis.discovery.stages.ringing import ringing
from diagnosis.discovery.stages.rival_fits import rival_fits
from diagnosis.discovery.stages.row_masks import row_masks
from diagnosis.discovery.stages.sense_check import sense_check
from diagnosis.discovery.stages.spread import spread
from diagnosis.discovery.stages.spread_check import spread_check
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.stages.variance import variance
from diagnosis.discovery.state import Stage, State, until_still

__all__ = ["PIPELINE", "Discovery", "State", "discover"]

PIPELINE: tuple[Stage, ...] = (
    observe,  # rows that count as independent angles; the grid of the output
    initial_fit,  # the paper's error model, or a given twin with its zeros free
    row_masks,  # single readings that stand alone are kept out of the fits
    own_parameters,  # strengths of a given twin are free, so that a cause is only what none of them can do
    quantisation,  # stairs that the set of values shows
    until_still(
        recording_levels,  # of several recordings, the noise of each
        repeated_frames,  # readings that repeat the one before
        variance,  # rows that are beyond doubt louder weigh less
        stepwise,  # causes in the mean: add, exchange, remove
        motion_freedom,  # without a reference, how free the shaft is against the noise that is left
        ringing,  # lines that are a narrow band of noise
        one_source,  # lines that one cause makes together
        sense_check,  # who counts which way, now that the causes are known
        own_shapes,  # of a given twin's effects, which without the causes would go anywhere
        spread,  # causes in the scatter; the rows weigh by it
    ),
    held_out_selection,  # what gains on readings that no fit has seen, and is not chance
    spread_check,  # what makes rows louder, by the causes that are proven
    flipped_bits,  # single readings told by the size of their errors
    grid_cause,  # the output's rounding, where it limits the readings
    changes,  # which of a given twin's own parameters have moved; the others go back
    final_fit,  # the optimum itself, and the baseline on the same rows
    recordings_alone,  # of several recordings, whether they share one device
    answer,  # one entry a cause, with its figures
    listed,  # only entries that their own figures bear out
    rival_fits,  # all that explains the readings as well, for how far the factors are known
    further_measurements,  # what would part each cause from its rivals
    predictive_check,  # would sweeps simulated from the extended twin look alike
)


def discover(state: State, stages: Sequence[Stage] = PIPELINE) -> Discovery:
    """Explain a sweep.

    Parameters
    ----------
    state : State
        What the first stage is handed: see :meth:`State.of`.
    stages : sequence of callables
        From a state to a state, in order.

    Returns
    -------
    Discovery
        The causes with their proof, the extended fit and the baseline.
    """
    return Discovery.of(reduce(_handed_on, stages, state))


def _handed_on(state: State, stage: Stage) -> State:
    """What a stage makes of the state. Raises TypeError where that is no state."""
    after = stage(state.told(stage))
    if not isinstance(after, State):
        name = getattr(stage, "__name__", repr(stage))
        raise TypeError(f"stage {name} returned {type(after).__name__}; expected the State that it hands on")
    return after
