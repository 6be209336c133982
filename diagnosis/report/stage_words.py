"""The stages of a call in plain words: what a person reads while it runs, or where it was stopped."""

from __future__ import annotations

from diagnosis.progress import Progress

STAGES = {
    "reading": "reading the sweeps",
    "estimated_motion": "estimating the shaft's motion from the readings",
    "judging": "judging what the readings can tell",
    "error_model": "fitting the paper's error model",
    "observe": "averaging repeated readings",
    "initial_fit": "fitting the baseline",
    "row_masks": "looking for single readings that stand alone",
    "quantisation": "looking for the stairs of a rounded output",
    "search": "searching for causes",
    "recording_levels": "weighing each recording by its noise",
    "recordings_alone": "fitting each recording by itself",
    "repeated_frames": "looking for repeated frames",
    "variance": "weighing noisy stretches",
    "stepwise": "searching for causes",
    "sense_check": "asking which way sensor and reference count",
    "own_parameters": "asking which of the twin's own parameters have moved",
    "own_shapes": "fitting the shapes of the twin's own effects",
    "changes": "proving what has changed of the twin",
    "motion_freedom": "asking how free the shaft was against what noise is left",
    "ringing": "asking whether lines are a narrow band of noise",
    "one_source": "asking whether several lines come of one motor",
    "spread": "looking for causes in the scatter",
    "held_out_selection": "proving the causes on readings they never saw",
    "spread_check": "judging the scatter once more",
    "flipped_bits": "looking for flipped bits",
    "grid_cause": "judging the rounding of the output",
    "final_fit": "fitting the extended twin",
    "answer": "working out what each cause gains",
    "listed": "holding each cause against its own figures",
    "rival_fits": "fitting what explains the readings as well",
    "further_measurements": "weighing further measurements",
    "predictive_check": "comparing simulated sweeps with the measured one",
}
"""By the name of the stage; a stage of one's own is told by its name."""


def stage_words(stage: str) -> str:
    """A stage in plain words."""
    return STAGES.get(stage, stage.replace("_", " "))


def progress_words(progress: Progress, hint: str = "") -> str:
    """Where a call stands, without the time: the stage, how many sweeps are done, a hint, the causes held."""
    said = [stage_words(progress.stage)]
    if progress.total > 1:
        said[0] += f", {progress.done} of {progress.total} done"
    if progress.stopped:
        said.insert(0, "stopped (Ctrl-C again ends at once)")
    elif hint:
        said.append(hint)
    if progress.causes:
        said.append(f"held so far: {', '.join(progress.causes)}")
    return "; ".join(said)
