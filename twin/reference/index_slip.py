"""index_slip: the reference's zero jumps, once or several times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import Array, IntArray, radians, wrap
from twin.confidence import OF_MAD
from twin.drawing import span
from twin.effect import BoolArray, Effect, Param, Parameters
from twin.motion import Motion
from twin.step_gains import step_gains
from twin.words import NEAR_RAD, ORDERS, InWords, WordFault, Words, noise_of, of_orders

MOST_JUMPS = 4
_FEWEST = 40
_FEWEST_BETWEEN = 8
"""Readings between two jumps: a few that are off together are an error of the link."""
_CLEAR = 3
"""Readings on either side of a jump, beyond which the motion goes on as before: its step itself looks like one back."""
_NOISE_RATIO = 2.0
"""What is left is noise where it is hardly larger than what differs from reading to reading."""
_LEAST_SIGMA = 10.0
"""Standard deviations of a reading: a jump of fewer is left to the search."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    after = motion.time_s >= np.asarray(values["time_s"])
    # A zero that moves on by a step makes every later reading fall by it, and the error e rise.
    return signal - radians(values["step_deg"]) * after


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    rows = np.unique(np.linspace(2, len(motion) - 2, min(len(motion) - 3, 64)).astype(int))
    return [{"time_s": float(motion.time_s[row])} for row in rows]


def find(words: Words) -> WordFault | None:
    """Two jumps or more that leave no more than noise beside orders 0 to 2, where none is a change of the motion.

    Each is added where it gains most, and all are placed anew beside the others, until nothing else is left. A single
    one, or what else moves the zero in steps, as a change of direction or speed does, is left to the search.
    """
    before, motion = words.expected, words.motion
    rows = np.flatnonzero(words.usable & (np.abs(before.residual) < NEAR_RAD))
    least = words.step / np.sqrt(12.0)
    if motion is None or rows.size < _FEWEST or before.sigma <= 2.0 * max(noise_of(before.residual[rows]), least):
        return None
    off = wrap(words.measured - before.sense * words.reference - before.zero)[rows]
    jumps, sizes, sigma = _jumps(words.reference[rows], off, before.sense, float(least))
    if len(jumps) < 2 or np.min(np.abs(sizes)) < _LEAST_SIGMA * max(sigma, words.step) or sigma > 0.5 * before.sigma:
        return None
    at = rows[jumps]
    if np.min(np.diff(np.sort(at))) < _FEWEST_BETWEEN or np.any(_moves_otherwise(motion, at)):
        return None
    after = np.arange(len(words)) >= at[:, None]
    told = [
        {"step_deg": float(np.degrees(before.sense * size)), "time_s": float(motion.time_s[row])}
        for size, row in zip(sizes, at, strict=True)
    ]
    none = np.zeros(len(words), dtype=bool)
    return WordFault(told[0], -np.inf, after[0], none, words.measured - sizes @ after, also=tuple(told[1:]))


def _jumps(reference: Array, off: Array, sense: float, least: float) -> tuple[list[int], Array, float]:
    """Places (from 0) and sizes [rad] of the jumps in angles (n,) [rad], and the robust deviation of what is left.

    ``least`` [rad] is the least that noise can be: that of the words' rounding.
    """
    jumps: list[int] = []
    shaft = reference
    for _ in range(MOST_JUMPS):
        columns = of_orders(shaft, ORDERS)
        jumps.append(_best(columns, off, jumps))
        for place in range(len(jumps)) if len(jumps) > 1 else ():
            jumps[place] = _best(columns, off, jumps[:place] + jumps[place + 1 :])
        for _ in range(2):
            # Behind a jump the shaft stands elsewhere than the reference says, and so does the error's curve.
            design = _with_jumps(of_orders(shaft, ORDERS), jumps)
            found = np.linalg.lstsq(design, off, rcond=None)[0]
            left, sizes = off - design @ found, np.asarray(found[-len(jumps) :])
            shaft = reference + sense * design[:, -len(jumps) :] @ sizes
        sigma = float(OF_MAD * np.median(np.abs(left)))
        if sigma <= _NOISE_RATIO * max(noise_of(left), least):
            return jumps, sizes, sigma
    return [], np.zeros(0), 0.0


def _with_jumps(columns: Array, jumps: Sequence[int]) -> Array:
    steps = np.arange(len(columns))[:, None] >= np.asarray(jumps, dtype=np.int64)
    return np.concatenate([columns, steps], axis=1)


def _best(columns: Array, off: Array, others: Sequence[int]) -> int:
    """Where a further jump gains most."""
    basis = np.linalg.qr(_with_jumps(columns, others))[0]
    left = off - basis @ (basis.T @ off)
    return int(np.argmax(step_gains(left, basis, least=1.0)[2:-2])) + 2


def _moves_otherwise(motion: Motion, at: IntArray) -> BoolArray:
    """Whether direction, turn, speed or temperature is another some rows behind each of these (m,) than ahead of it."""
    ahead, behind = (np.clip(at + by, 0, len(motion) - 1) for by in (-_CLEAR, _CLEAR))
    changed = motion.direction[ahead] != motion.direction[behind]
    if "turn" in motion.columns:
        changed |= motion.turn[ahead] != motion.turn[behind]
    paces = np.array(
        [[_pace(motion, row - _FEWEST_BETWEEN, row), _pace(motion, row, row + _FEWEST_BETWEEN)] for row in at]
    )
    changed |= np.abs(np.diff(paces, axis=1)[:, 0]) > 0.05 * np.max(np.abs(paces), axis=1)
    return np.asarray(changed | (np.abs(motion.temperature_c[ahead] - motion.temperature_c[behind]) > 1.0))


def _pace(motion: Motion, first: int, end: int) -> float:
    """Median speed [rad/s] over the rows from ``first`` up to ``end``: a jump at the latter is not among its steps."""
    rows = slice(max(first, 0), end)
    duration = np.diff(motion.time_s[rows])
    steps = wrap(np.diff(motion.shaft_rad[rows]))[duration > 0.0] / duration[duration > 0.0]
    return float(np.median(steps)) if steps.size else 0.0


def said(values: Mapping[str, float]) -> str:
    """By how much the reference jumps, and when."""
    return f"the reference jumps by {values['step_deg']:.3g} deg at {values['time_s']:.6g} s"


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Well within the record."""
    start, end = motion.time_s[0], motion.time_s[-1]
    return {"time_s": start + (end - start) * span(uniform[:, 2], 0.2, 0.8)}


INDEX_SLIP = Effect(
    name="index_slip",
    stage="reference",
    acts_on="reference",
    params={
        "step_deg": Param(unit="deg", null=0.0, lower=-180.0, upper=180.0, doc="the jump", owner="recording"),
        "time_s": Param(
            unit="s",
            null=0.0,
            lower=-1e12,
            upper=1e12,
            doc="its instant; the row without time stamps",
            role="shape",
            owner="recording",
        ),
    },
    forward=forward,
    shapes=shapes,
    zoomed=("time_s",),
    in_words=InWords(find=find, said=said),
    repeatable=True,
    drawing=drawing,
    needs=frozenset({"a reference", "time_s"}),
    source="definition: an incremental encoder that loses or gains counts",
    signature="a step in order 0, or several",
)
