"""stale_frames: a fraction of the frames repeats the one before."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import TAU, Array, wrap
from twin.drawing import span
from twin.effect import BoolArray, Effect, Marks, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is None:
        return signal
    stale = rng.random(signal.shape) < 0.01 * np.asarray(values["fraction_percent"])
    stale[..., 0] = False
    source = np.where(stale, 0, np.arange(signal.shape[-1]))
    return np.take_along_axis(signal, np.maximum.accumulate(source, axis=-1), axis=-1)


def marks(
    measured: Array, residual: Array, noise: Array | float, step: float, motion: Motion
) -> tuple[BoolArray, float]:
    """Rows that repeat the reading before bit for bit while the shaft moved on by more than grid and noise allow.

    A repeat by chance needs the noise to cancel the movement: with a movement of ``move`` and a difference of two
    noises of ``sqrt(2) noise`` its probability a row is the density there times the grid's step. Where the direction
    or the turn changes, slack or a new zero may undo the movement: no repeat is told there. Nor where what repeats is
    nearer to the reading that was expected than to the one before: a cause, such as a stuck bit, may undo the movement.
    Without a reference the shaft moved on by no more than the readings before and after say: a torque may have held it.
    """
    repeat = np.concatenate([[False], np.abs(wrap(np.diff(measured))) < 1e-9])
    on = (np.diff(motion.direction) == 0) & (np.diff(motion.turn) == 0)
    move = np.concatenate([[0.0], np.where(on, np.abs(np.diff(motion.shaft_rad)), 0.0)])
    if motion.whole_counts is not None:
        # Each of two readings of the reference is off by half a count at the most.
        move = np.maximum(move - TAU / motion.whole_counts.counts_per_turn, 0.0)
    if motion.estimated is not None:
        move = np.minimum(move, _moved_about(measured, repeat))
    grid = max(step, 1e-6)
    sigma = np.sqrt(2.0) * np.maximum(noise, 0.3 * grid)
    mask = repeat & (move > 1.5 * grid) & (move > 4.0 * sigma) & (np.abs(residual) > 0.5 * move)
    chance = grid / sigma * np.exp(-0.5 * (np.maximum(move - grid, 0.0) / sigma) ** 2)
    expected = float(np.sum(np.minimum(chance[(move > 1.5 * grid) & (move > 4.0 * sigma)], 1.0)))
    count = int(mask.sum())
    if count == 0:
        return mask, 0.0
    # Chernoff's bound on a Poisson count.
    return mask, min(0.0, count - expected + count * float(np.log(max(expected, 1e-300) / count)))


def _moved_about(measured: Array, repeat: BoolArray) -> Array:
    """How far each reading (n,) [rad] lies from the one before, by the last one ahead of it and the first one behind it
    that are no repeats of each other. The frame after one that was sent again is two steps further on."""
    fresh = np.flatnonzero(~repeat)
    run = np.cumsum(~repeat) - 1
    # Of a run of equal readings the first one; of a reading that nothing repeats the one before it.
    before = np.where(repeat, fresh[run], np.maximum(np.arange(measured.size) - 1, 0))
    behind = np.append(fresh, measured.size - 1)[run + 1]
    return np.asarray(np.abs(wrap(measured[behind] - measured[before])) / np.maximum(behind - before, 1))


def told(touched: int, readings: int) -> Mapping[str, tuple[float, float]]:
    """The share of the readings, with the deviation of a binomial's."""
    share = touched / readings
    return {"fraction_percent": (100.0 * share, 100.0 * float(np.sqrt(share * (1.0 - share) / readings)))}


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """From some frames to one in ten: their error is a step of the shaft, whatever the strength."""
    return {"fraction_percent": span(uniform[:, 0], 1.0, 10.0)}


STALE_FRAMES = Effect(
    name="stale_frames",
    stage="link",
    acts_on="angle",
    params={
        "fraction_percent": Param(
            unit="%", null=0.0, lower=0.0, upper=99.0, doc="of the frames", role="random", owner="recording"
        )
    },
    forward=forward,
    footprint="sequence",
    marks=Marks(find=marks, told=told, early=True),
    drawing=drawing,
    source="definition: a link that sends its last word again",
    signature="repeats; an error of one step",
)
