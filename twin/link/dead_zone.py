"""dead_zone: a range of angles is never output; the word holds at its edge and jumps across."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import TAU, Array, IntArray, radians
from twin.drawing import span
from twin.effect import BoolArray, Effect, Param, Parameters
from twin.link.stale_frames import STALE_FRAMES
from twin.motion import Motion
from twin.runs import runs
from twin.words import MISSED, Also, InWords, WordFault, Words

_NOISE_SIGMA = 4.0
_WIDEST = TAU / 3.0


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    width, start = radians(values["width_deg"]), radians(values["start_deg"])
    inside = np.mod(signal - start, TAU)
    at_end = inside >= width * 0.01 * np.asarray(values["jump_percent"])
    moved = np.where(at_end, width - inside, -inside)
    return signal + np.where((inside < width) & (width > 0.0), moved, 0.0)


def find(words: Words) -> WordFault | None:
    """The widest range without a reading, where readings are expected in it and stand at its edges instead.

    Chance: a reading that is expected inside stands outside of it by another error, as rare as these are, and, but for
    the first at each edge, at the very word at which another one stands already.
    """
    read = np.sort(np.mod(words.measured[words.usable], TAU))
    gaps = np.diff(np.append(read, read[0] + TAU)) if read.size else np.zeros(1)
    widest = int(np.argmax(gaps))
    start, width = float(read[widest]) if read.size else 0.0, float(gaps[widest])
    expected, margin = words.expected, _NOISE_SIGMA * words.expected.sigma + 0.5 * words.step
    if width <= 2.0 * margin or width > _WIDEST:
        return None
    place = np.mod(expected.angle - start, TAU)
    inside = words.usable & (place > margin) & (place < width - margin)
    stands = np.mod(words.measured - start + 0.5 * words.step, TAU)
    low, high = stands < words.step, np.abs(stands - width - 0.5 * words.step) < 0.5 * words.step
    held, count = inside & (low | high), int(np.count_nonzero(inside))
    # One edge at least holds for several angles: an edge that each turn reaches once is a reading like any other.
    apart = max((_reach(place[held & edge]) for edge in (low, high)), default=0.0)
    if count < 2 or apart <= margin or np.count_nonzero(held) < (1.0 - MISSED) * count:
        return None
    standing, edges = int(np.count_nonzero(held)), int((held & low).any()) + int((held & high).any())
    log_p = (2 * standing - count) * np.log(MISSED) + (standing - edges) * np.log(2.0 * words.step / TAU)
    log_p = max(float(log_p), _log_p_of_repeats(words, held))
    return _fault(words, (start, width), (place, held & low, held & high), log_p)


def _log_p_of_repeats(words: Words, held: BoolArray) -> float:
    """Log probability that one of the runs of repeated frames of a sweep is as long as that in which the word held.

    Where the word held more than once, or no frame is repeated elsewhere, repeats are no explanation: minus infinity.
    After each repeat comes another one with some probability q: over what the other runs leave open of q (Beta, from
    Jeffreys' prior), the mean of its power is the ratio of two Beta functions.
    """
    from scipy.special import betaln

    if not _in_one_piece(np.flatnonzero(held)):
        return -np.inf
    moved = np.abs(np.diff(words.expected.angle, prepend=words.expected.angle[0])) > words.apart
    repeated = moved & (np.diff(words.numbers, prepend=words.numbers[0]) == 0)
    stretches = [run for run in runs(repeated) if repeated[run].all()]
    own = [run.stop - run.start for run in stretches if held[run].any()]
    others = [run.stop - run.start for run in stretches if not held[run].any()]
    if not own or not others:
        return -np.inf
    followed, ended = sum(others) - len(others) + 0.5, len(others) + 0.5
    log_mean = float(betaln(followed + max(own) - 1.0, ended) - betaln(followed, ended))
    return min(log_mean + float(np.log(len(others) + 1.0)), 0.0)


def _in_one_piece(rows: Sequence[int] | IntArray) -> bool:
    """Whether readings follow one another."""
    return bool(np.all(np.diff(np.sort(rows)) == 1))


def _reach(place: Array) -> float:
    return float(np.ptp(place)) if place.size > 1 else 0.0


def _fault(
    words: Words, zone: tuple[float, float], edges: tuple[Array, BoolArray, BoolArray], log_p: float
) -> WordFault:
    """The zone by its edges, and by where the readings expected in it change from one to the other."""
    (start, width), (place, low, high) = zone, edges
    # Readings within the noise of the edges may be held too; all say nothing of the angle.
    near = words.usable & (place < width)
    slack = 0.5 * words.step
    last_low = float(np.max(place[low], initial=0.0))
    first_high = float(np.min(place[high], initial=width))
    jump = np.array([0.5 * (last_low + first_high), min(last_low, first_high), max(last_low, first_high)])
    if not high.any():
        jump = np.array([width, last_low, width])
    if not low.any():
        jump = np.array([0.0, 0.0, first_high])
    values = {
        "width_deg": float(np.degrees(width)),
        "start_deg": float(np.degrees(start) % 360.0),
        "jump_percent": 100.0 * float(jump[0]) / width,
    }
    # An edge that no reading is held at lies anywhere up to the first reading that is held at the other.
    lower = slack if low.any() else first_high
    upper = slack if high.any() else width - last_low
    within = {
        "start_deg": (values["start_deg"] - np.degrees(slack), values["start_deg"] + np.degrees(lower)),
        "width_deg": (values["width_deg"] - np.degrees(lower + upper), values["width_deg"] + np.degrees(2.0 * slack)),
        "jump_percent": (100.0 * float(jump[1]) / width, 100.0 * float(jump[2]) / width),
    }
    return WordFault(values, log_p, low | high, near, words.measured, within)


def said(values: Mapping[str, float]) -> str:
    """Which angles are never read."""
    start, width = values["start_deg"], values["width_deg"]
    return f"no angle from {start:.2f} to {(start + width) % 360.0:.2f} deg is ever read, its edges stand for it"


def line(values: Mapping[str, float], shown: Mapping[str, str]) -> str:
    """Which angles are never read, and which edge stands for them."""
    return (
        f"no angle is ever read from {shown['start_deg']} on over a width of {shown['width_deg']}; the lower edge "
        f"stands for the first {shown['jump_percent']} of that, the upper edge for the rest"
    )


def _holds_once(read_rad: Array, motion: Motion, rows: Sequence[int]) -> bool:
    """Whether the readings that were held follow one another: then frames that were repeated do the same."""
    return _in_one_piece(rows)


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A few degrees anywhere: the error is half of that, whatever the strength."""
    return {
        "width_deg": span(uniform[:, 0], 3.0, 15.0),
        "start_deg": 360.0 * uniform[:, 1],
        "jump_percent": 100.0 * np.round(2.0 * uniform[:, 2]) / 2.0,
    }


DEAD_ZONE = Effect(
    name="dead_zone",
    stage="link",
    acts_on="word",
    params={
        "width_deg": Param(
            unit="deg", null=0.0, lower=0.0, upper=180.0, doc="of the range that is never output", role="level"
        ),
        "start_deg": Param(
            unit="deg", null=0.0, lower=-1.0, upper=361.0, doc="the word at its lower edge", role="shape", mirror=1
        ),
        "jump_percent": Param(
            unit="%",
            null=50.0,
            lower=0.0,
            upper=100.0,
            doc="of the range, up to which the lower edge is held; the upper one beyond",
            role="shape",
            mirror=1,
        ),
    },
    forward=forward,
    footprint="sequence",
    in_words=InWords(
        find=find,
        said=said,
        line=line,
        also=Also(
            cause=STALE_FRAMES.name,
            tells="record a second turn: a zone holds the word at the same angles again, frames are repeated anywhere",
            where=_holds_once,
        ),
    ),
    drawing=drawing,
    needs=frozenset({"one turn"}),
    source="dead band about the end of the range, as of an analogue or PWM output that clamps at its ends: e.g. "
    "Melexis MLX90365 data sheet, output clamping and the discontinuity point",
    signature="one gap in the values, with a ramp in the error at its place",
)
