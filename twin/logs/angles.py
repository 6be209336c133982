"""In which unit two angles of a log are, told by their values: the units in which one follows the other."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.following import distance_deg, follows, spread_deg
from twin.logs.names import Meaning
from twin.logs.statement import Column, Term

_ROUND = (100, 120, 125, 144, 150, 160, 180, 200, 240, 250, 300, 360, 400, 500, 600, 720, 800, 900)
COUNTS_PER_TURN = tuple(
    sorted(
        {2**k for k in range(6, 25)}
        | {200 * 2**k for k in range(12)}
        | {m * 10**k for m in _ROUND for k in range(5)}
        | {1_296_000}
    )
)
"""Counts of a turn that encoders, converters and steppers have: powers of two, whole steps, and round numbers."""
_JUDGED_ROWS = 2000
_CLEARLY = 2.0
_ALIKE_DEG = 0.02
_FEW = 4
_PARTED_TURNS = 1.1
_DRIFT = 6.0
_LEAST_DRIFT_DEG = 0.1
"""A wrong number of counts drifts, in a turn by more than this many times what scatters about it; on a single turn an
error of first order seems to drift by 4.3 times."""
_WRAP_SHARE = 0.5
_LEAST_DEG = 6.4
"""A span up to this looks like one turn of radians, or less."""


@dataclass(frozen=True)
class AngleUnit:
    """A unit of an angle: a name that ``--columns`` knows, or counts by how many make a turn."""

    name: str = ""
    counts: int = 0

    def degrees(self, values: Array) -> Array:
        """Values (n,) in degrees."""
        return values * _FACTOR[self.name] if self.name else values * 360.0 / self.counts

    def column(self, target: str, source: str) -> Column:
        """The statement of a column in this unit."""
        if self.counts:
            return Column(target, Term(source, (("*", 360.0), ("/", float(self.counts)))))
        return Column(target, Term(source), None if self.name == "deg" else self.name)

    def __str__(self) -> str:
        return f"{self.counts} counts a turn" if self.counts else self.name


_FACTOR = {"deg": 1.0, "rad": 180.0 / np.pi, "rev": 360.0, "mrad": 0.18 / np.pi, "gon": 0.9}
_TURN = {"deg": 360.0, "rad": 2.0 * np.pi, "rev": 1.0, "gon": 400.0}
Pair = tuple[AngleUnit, AngleUnit]


def units_of_pair(reference: Array, measured: Array, *, said: tuple[Meaning, Meaning]) -> list[Pair]:
    """The units in which two angles (n,) follow each other, those that fit equally well; none where they do not."""
    both = np.isfinite(reference) & np.isfinite(measured)
    rows = np.flatnonzero(both)
    if rows.size < 4:
        return []
    rows = rows[:: -(-rows.size // _JUDGED_ROWS)]
    options = [_options(values[both], one) for values, one in zip((reference, measured), said, strict=True)]
    many = min(sum(bool(one.counts) for one in each) for each in options) > _FEW
    fitting: list[tuple[float, Pair]] = []
    for pair in itertools.product(options[0], options[1]):
        counted = [bool(one.counts) for one in pair]
        if many and all(counted):
            continue
        a, b = pair[0].degrees(reference[rows]), pair[1].degrees(measured[rows])
        if min(np.ptp(a), np.ptp(b)) == 0.0 or not follows(b, a) or _small(pair, reference[rows], measured[rows]):
            continue
        if not (any(counted) and _drifts(a, b)):
            fitting.append((distance_deg(b, a), pair))
    least = min((distance for distance, _ in fitting), default=0.0)
    kept = [pair for distance, pair in fitting if distance <= _CLEARLY * least + _ALIKE_DEG]
    return _preferred(kept)


def _small(pair: Pair, reference: Array, measured: Array) -> bool:
    """Whether both are called degrees and span no more than a turn of radians does."""
    spans = float(np.ptp(reference)), float(np.ptp(measured))
    return {one.name for one in pair} == {"deg"} and max(spans) <= _LEAST_DEG


def _drifts(reference: Array, measured: Array) -> bool:
    """Whether one angle (n,) [deg] runs away from the other, as with a wrong number of counts a turn."""
    order = np.argsort(reference)
    sense = min((1.0, -1.0), key=lambda one: spread_deg(measured - one * reference))
    error = np.unwrap((measured - sense * reference)[order], period=360.0)
    at = np.radians(reference[order])
    shapes = [np.ones_like(at), at / (2.0 * np.pi)]
    whole = bool(np.ptp(at) >= _PARTED_TURNS * 2.0 * np.pi)
    # On more than a turn what repeats with it is told from what grows; on less an error of first order grows, too.
    shapes += [wave(order * at) for order in (1.0, 2.0) for wave in (np.cos, np.sin)] if whole else []
    design = np.stack(shapes, axis=1)
    fitted = np.linalg.lstsq(design, error, rcond=None)[0]
    scatter = float(np.std(error - design @ fitted))
    drift = abs(float(fitted[1])) * (1.0 if whole else float(np.ptp(at)) / (2.0 * np.pi))
    return drift > _DRIFT * scatter + _LEAST_DRIFT_DEG


def _options(values: Array, said: Meaning) -> list[AngleUnit]:
    """The units that a column (n,) may be in, by its name or else by its values."""
    if said.unit is not None:
        return [AngleUnit(said.unit.name)]
    counts = _counts(values, stated=said.counts)
    if said.counts:
        return counts
    span = float(np.ptp(values))
    if bool(np.any(np.abs(np.diff(values)) > _WRAP_SHARE * span)):
        named = [AngleUnit(name) for name, turn in _TURN.items() if 0.9 * turn <= span <= 1.001 * turn]
        return named or counts
    named = [AngleUnit(name) for name, most in (("deg", 0.0), ("rad", 0.0), ("rev", 0.0)) if span > most]
    return named + counts


def _counts(values: Array, *, stated: bool) -> list[AngleUnit]:
    """Whole numbers as counts: of the numbers that may make a turn those that the values nearly fill, if any."""
    span = float(np.ptp(values))
    whole = bool(np.all(values == np.round(values)))
    if not (whole or stated) or span < 50.0:
        return []
    wraps = bool(np.any(np.abs(np.diff(values)) > _WRAP_SHARE * span))
    # Of what is not called counts, 360 a turn are degrees.
    known = [n for n in COUNTS_PER_TURN if (stated or n != 360) and not _leaps(values, n)]
    full = [n for n in known if 0.95 * n <= span <= n]
    return [AngleUnit(counts=n) for n in (full if wraps and full else known)]


def _leaps(values: Array, a_turn: int) -> bool:
    """Whether counts (n,) that are not wrapped would go on by more than a third of a turn from row to row."""
    return bool(np.ptp(values) > 1.5 * a_turn and np.median(np.abs(np.diff(values))) > a_turn / 3.0)


def _preferred(pairs: list[Pair]) -> list[Pair]:
    """Without those that no values could tell from a plainer one: both in the same unit, or both in equal counts."""
    same = [pair for pair in pairs if pair[0] == pair[1]]
    for name in ("deg", "rad"):
        plain = (AngleUnit(name), AngleUnit(name))
        if plain in same:
            return [plain, *(pair for pair in pairs if pair[0] != pair[1])]
    return pairs
