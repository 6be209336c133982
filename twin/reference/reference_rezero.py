"""reference_rezero: an incremental reference without index finds a new zero for each turn (sweep)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import Array, radians
from twin.confidence import Z95
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    turns = int(motion.turn.max(initial=0)) + 1
    zeros = values.get("zeros_deg")
    # Zeros belong to the recording they were fitted to; another one, with another number of turns, draws its own.
    if zeros is not None and np.shape(zeros)[-1:] == (turns,) and turns > 1:
        zeros_deg = np.asarray(zeros, dtype=np.float64)
    elif rng is not None:
        spread = np.asarray(values.get("spread_deg", 0.0))
        zeros_deg = spread * rng.standard_normal((*signal.shape[:-2], 1, turns))
    else:
        return signal
    return signal + radians(zeros_deg)[..., motion.turn]


def derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    """The scatter of the turns' zeros."""
    zeros = np.ravel(values.get("zeros_deg", 0.0))
    spread = float(np.std(zeros, ddof=1)) if zeros.size > 1 else 0.0
    # The scatter of a scatter: log-normal with a relative deviation of 1/sqrt(2 (turns - 1)).
    factor = float(np.exp(Z95 / np.sqrt(2.0 * max(zeros.size - 1, 1))))
    return {"spread_deg": (spread, spread / factor, spread * factor, "deg")}


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """The scatter alone: each sweep's own turns are drawn when it is simulated."""
    return {"spread_deg": strength_deg}


REFERENCE_REZERO = Effect(
    name="reference_rezero",
    stage="reference",
    acts_on="reference",
    params={
        "zeros_deg": Param(
            unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="one zero a turn", role="per turn", owner="recording"
        ),
        "spread_deg": Param(
            unit="deg",
            null=0.0,
            lower=0.0,
            upper=360.0,
            doc="scatter of zeros drawn anew",
            role="random",
            owner="recording",
        ),
    },
    forward=forward,
    derived=derived,
    record_wide=True,
    drawing=drawing,
    needs=frozenset({"a reference", "turn", "two turns"}),
    source="definition: an incremental encoder counts from where it was switched on",
    signature="order 0, constant within a turn",
)
