"""scale_error: the reading is k times the angle, because the counts of a turn, a factor or a gear ratio is wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import TAU, Array, wrap
from twin.confidence import Z95
from twin.effect import BoolArray, Effect, Param, Parameters
from twin.mechanics.zero_drift import ZERO_DRIFT
from twin.motion import Motion
from twin.words import LIMIT_LOG_P, ORDERS, Also, Expected, InWords, WordFault, Words, noise_of, of_orders

_PASSES = 5
_AFAR_RAD = np.radians(1.0)
"""What orders 0 to 2 leave of a ramp where the factor is some percent off."""
_STARTS = (0.88, 0.92, 0.96, 1.0, 1.04, 1.08, 1.12)


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


# ---- telling it by the words ----------------------------------------------------------------------------------------


def find(words: Words) -> WordFault | None:
    """The factor where it leaves no more than noise, and half of what is left without it at most.

    Words that begin anew at 0: of those that go on from turn to turn a drift of the zero would do the same. Where the
    ramp begins anew elsewhere, at any of so many readings, it is something else that drifted over the turn.
    """
    before = words.expected
    noise = max(noise_of(before.residual[words.usable]), words.step / np.sqrt(12.0))
    if before.sigma <= 2.0 * noise:
        return None
    # From afar a reading beyond the turn passes for a small one.
    starts = _STARTS if before.sigma > _AFAR_RAD else (1.0,)
    factor, deviation, after = min((_settled(words, start) for start in starts), key=lambda one: one[2].sigma)
    if after.sigma > 0.5 * before.sigma or after.sigma > 2.0 * max(noise_of(after.residual[words.usable]), noise):
        return None
    if _gain_of_another_place(factor - 1.0, after, words.usable) > np.log(words.usable.sum()) - LIMIT_LOG_P:
        return None
    values = {"factor": factor, "goes_on": 0.0}
    within = {"factor": (factor - Z95 * deviation, factor + Z95 * deviation)}
    log_p = float(np.log(after.sigma / before.sigma)) * words.usable.sum()
    return WordFault(values, log_p, words.usable, np.zeros(len(words), dtype=bool), after.chosen, within)


def _gain_of_another_place(away: float, after: Expected, usable: BoolArray) -> float:
    """Log likelihood gained where the ramp begins anew at the best of all places instead of at the word 0.

    Readings behind 0 up to that place then stand where the ramp ends, or those before 0 where it begins.
    """
    off, order = after.residual[usable], np.argsort(np.mod(after.angle[usable], TAU))
    behind, before = (
        after.log_densities(off[rows] - shift) - after.log_densities(off[rows])
        for shift, rows in ((away * TAU, order), (-away * TAU, order[::-1]))
    )
    return float(max(np.max(np.cumsum(gain), initial=0.0) for gain in (behind, before)))


def _settled(words: Words, start: float) -> tuple[float, float, Expected]:
    """The factor near a start, its standard deviation, and what is expected once it is taken off."""
    found = start, 0.0, words.of_candidates(_before(words, start))
    for _ in range(_PASSES):
        found = _closer(words, found[0], found[2])
        if not _STARTS[0] - 0.1 < found[0] < _STARTS[-1] + 0.1:
            return 1.0, 0.0, words.expected
    return found


def _before(words: Words, factor: float) -> Array:
    """The words (2, n) [rad] that may have been multiplied: one beyond the turn stands for a small one."""
    read = np.mod(words.measured, TAU)
    again = (read + TAU) / factor
    return np.stack([read / factor, np.where(again < TAU, again, np.nan)])


def _closer(words: Words, factor: float, now: Expected) -> tuple[float, float, Expected]:
    """The factor, its standard deviation, and what is expected once it is taken off, by one more step of least squares.

    ``now`` is what is expected with the factor as it was.
    """
    columns = np.column_stack([of_orders(words.reference, ORDERS), np.mod(now.chosen, TAU)])
    off = wrap(now.chosen - now.sense * words.reference - now.zero)
    kept = words.usable & (np.abs(now.residual) <= 5.0 * now.sigma)
    if kept.sum() <= columns.shape[1]:
        return factor, 0.0, now
    slope = float(np.linalg.lstsq(columns[kept], off[kept], rcond=None)[0][-1])
    factor *= 1.0 + slope
    after = words.of_candidates(_before(words, factor))
    _, size, right = np.linalg.svd(columns[kept], full_matrices=False)
    known = float(np.sqrt(np.sum((right[:, -1] / np.maximum(size, 1e-12)) ** 2)))
    return factor, factor * after.sigma * known, after


def said(values: Mapping[str, float]) -> str:
    """What a turn reads."""
    return f"a turn reads {360.0 * values['factor']:.5g} deg"


def _begins_anew_at_the_first_row(read_rad: Array, motion: Motion, rows: Sequence[int]) -> bool:
    """Whether one turn is recorded from where the words begin: then a zero that drifts over it makes the same ramp."""
    word = np.mod(read_rad, TAU)
    one_turn = float(np.ptp(motion.shaft_rad)) < TAU * (1.0 + 1.0 / word.size)
    return one_turn and bool(np.argmin(word) == 0 or np.argmax(word) == 0)


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
    in_words=InWords(
        find=find,
        said=said,
        also=Also(
            cause=ZERO_DRIFT.name,
            tells="record a second turn: a zero that drifts goes on there, a factor begins anew",
            where=_begins_anew_at_the_first_row,
        ),
    ),
    needs=frozenset({"one turn"}),
    source="definition: gain error of a converter, IEEE Std 1241, section 4.5 (gain and offset), on a word that wraps",
    signature="a ramp of (k - 1) times the angle, with one step a turn: a turn reads 360 k",
)
