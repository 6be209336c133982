"""scale_error: the reading is k times the angle, because the counts of a turn, a factor or a gear ratio is wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import TAU, Array
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    away = np.asarray(values["factor"], dtype=np.float64) - 1.0
    word = np.mod(signal, TAU)
    # Words that go on from turn to turn have as many whole turns as the shaft, in the sense in which they count.
    together = np.sum(np.sin(np.diff(signal)) * np.diff(motion.shaft_rad), axis=-1, keepdims=True)
    sense = np.where(together < 0.0, -1.0, 1.0)
    through = sense * motion.shaft_rad
    turns = np.where(np.asarray(values["goes_on"]) == 1.0, np.round((through - word) / TAU) * TAU, 0.0)
    return np.asarray(signal + away * (word + turns))


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"goes_on": 0.0}, {"goes_on": 1.0}]


def derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    """What a whole turn reads."""
    turn = 360.0 * float(np.ravel(values["factor"])[0])
    return {"turn_reads_deg": (turn, turn, turn, "deg")}


SCALE_ERROR = Effect(
    name="scale_error",
    stage="link",
    acts_on="word",
    params={
        "factor": Param(unit="1", null=1.0, lower=0.5, upper=2.0, doc="k: what a turn reads, in turns", typical=5e-4),
        "goes_on": Param(
            unit="1",
            null=0.0,
            lower=0.0,
            upper=1.0,
            doc="1: counts go on from turn to turn, 0: they begin anew at the word 0",
            role="shape",
            counts=True,
            aside=True,
        ),
    },
    forward=forward,
    shapes=shapes,
    derived=derived,
    needs=frozenset({"one turn"}),
    source="definition: gain error of a converter, IEEE Std 1241, section 4.5 (gain and offset), on a word that wraps",
    signature="a ramp of (k - 1) times the angle, with one step a turn: a turn reads 360 k",
)
