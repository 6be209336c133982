"""Misfit: in what the measured sweep differs from what the extended twin predicts, where, and by how much."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.proof.lack_of_fit import LackOfFit
from diagnosis.discovery.proof.predictive_check import PredictiveCheck
from diagnosis.discovery.settings import UNLIKE
from twin.angles import TAU, Array, IntArray

SECTORS = 12
"""Parts of the turn, of 30 deg each, of which the one that is farthest off is told."""
STRETCHES = 24
"""Parts of the record, likewise."""
_HIGHEST_ORDER = 90

LACK_OF_FIT, LIKENESS = "repeated readings", "simulated sweeps"
"""What a fit is held against."""


@dataclass(frozen=True)
class Misfit:
    """One thing in which the twin and the sweep differ.

    ``against``: repeated readings or simulated sweeps; ``p``: how often chance makes as much. ``what`` says it in
    words, ``where`` in words too, "" where it is everywhere; ``size_deg`` is how large it is there.
    """

    against: str
    p: float
    what: str
    where: str
    size_deg: float


def misfits(fit: Fit, likeness: PredictiveCheck | None, lack: LackOfFit | None) -> tuple[Misfit, ...]:
    """What the two checks have found that chance hardly makes."""
    found: list[Misfit] = []
    place = _Place.of(fit)
    if lack is not None and lack.p < UNLIKE:
        where = f"most at {_deg(place.angle_deg(lack.row))} deg"
        size = float(np.degrees(abs(fit.residual[0][lack.row])))
        found.append(Misfit(LACK_OF_FIT, lack.p, "the fit lies off the means of repeated readings", where, size))
    if likeness is not None and likeness.p < UNLIKE:
        where, size = PLACES[likeness.worst](place)
        found.append(Misfit(LIKENESS, likeness.p, likeness.worst, where, size))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Place:
    """What the rows in use leave [deg] (k,), and their motion; ``rows`` (k,) are their numbers."""

    fit: Fit
    rows: IntArray
    left: Array

    @classmethod
    def of(cls, fit: Fit) -> _Place:
        rows = np.flatnonzero(fit.observations.usable)
        return cls(fit, rows, np.degrees(fit.residual[0][rows]))

    def angle_deg(self, row: int) -> float:
        return float(np.degrees(self.fit.observations.motion.shaft_rad[row]) % 360.0)

    @property
    def turn(self) -> Array:
        """Shaft angle [rad]."""
        return np.asarray(self.fit.observations.motion.shaft_rad[self.rows])


def _deg(angle: float) -> str:
    return f"{angle:.0f}"


def _everywhere(place: _Place) -> tuple[str, float]:
    return "", _rms(place.left)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _reading(place: _Place) -> tuple[str, float]:
    worst = int(np.argmax(np.abs(place.left)))
    return f"most at {_deg(place.angle_deg(int(place.rows[worst])))} deg", float(abs(place.left[worst]))


def _parts(values: Array, part: IntArray, count: int) -> Array:
    """Means (count,) of the values of each part; 0 of those without any."""
    size = np.bincount(part, minlength=count)
    return np.asarray(np.bincount(part, values, minlength=count) / np.maximum(size, 1))


def _sector(place: _Place, values: Array) -> tuple[str, float]:
    """Where on the turn the mean of the values is largest."""
    part = np.floor(place.turn * (SECTORS / TAU)).astype(np.int64) % SECTORS
    means = np.abs(_parts(values, part, SECTORS))
    worst = int(np.argmax(means))
    width = 360.0 / SECTORS
    return f"most from {_deg(worst * width)} to {_deg((worst + 1) * width)} deg", float(means[worst])


def _stretch_of(place: _Place) -> tuple[IntArray, int]:
    count = min(STRETCHES, place.rows.size)
    return np.arange(place.rows.size) * count // place.rows.size, count


def _share(part: int, count: int) -> str:
    return f"most from {100.0 * part / count:.0f} to {100.0 * (part + 1) / count:.0f} % of the record"


def _along(place: _Place) -> tuple[str, float]:
    part, count = _stretch_of(place)
    means = np.abs(_parts(place.left, part, count))
    worst = int(np.argmax(means))
    return _share(worst, count), float(means[worst])


def _loud_along(place: _Place) -> tuple[str, float]:
    part, count = _stretch_of(place)
    loud = np.sqrt(_parts(place.left**2, part, count))
    worst = int(np.argmax(np.abs(loud - _rms(place.left))))
    return _share(worst, count), float(loud[worst])


def _order(place: _Place) -> tuple[str, float]:
    orders = np.arange(1, _HIGHEST_ORDER + 1)
    lines = np.array([2.0 * np.abs(np.mean(place.left * np.exp(-1j * order * place.turn))) for order in orders])
    worst = int(np.argmax(lines))
    return f"order {orders[worst]}", float(lines[worst])


def _loud_sector(place: _Place) -> tuple[str, float]:
    where, square = _sector(place, place.left**2)
    return where, float(np.sqrt(square))


def _turns(place: _Place) -> tuple[str, float]:
    turn = place.fit.observations.motion.turn[place.rows]
    means = np.abs(_parts(place.left, turn - turn.min(), int(np.ptp(turn)) + 1))
    worst = int(np.argmax(means))
    return f"most in turn {int(turn.min()) + worst}", float(means[worst])


def _by(name: str) -> Callable[[_Place], tuple[str, float]]:
    """The part of the residual that goes with a condition, and where on the turn."""

    def where(place: _Place) -> tuple[str, float]:
        weight = np.asarray(getattr(place.fit.observations.motion, name)[place.rows], dtype=np.float64)
        if name == "temperature_c":
            weight = weight - np.mean(weight)
        return _sector(place, place.left * weight / max(_rms(weight), 1e-300))

    return where


PLACES: dict[str, Callable[[_Place], tuple[str, float]]] = {
    "the residual leans to one side": _everywhere,
    "the residual has heavier tails": _reading,
    "the residual has lighter tails": _everywhere,
    "the residual is more peaked": _everywhere,
    "the residual is flatter": _everywhere,
    "single readings stand out": _reading,
    "neighbouring readings are more alike": _everywhere,
    "neighbouring readings are less alike": _everywhere,
    "readings some rows apart are correlated": _everywhere,
    "the zero wanders or jumps along the record": _along,
    "the turns' zeros scatter": _turns,
    "the scatter changes along the record": _loud_along,
    "an order of the turn stands out": _order,
    "readings at one angle are alike": lambda place: _sector(place, place.left),
    "the residual depends on the angle": lambda place: _sector(place, place.left),
    "the scatter depends on the angle": _loud_sector,
    "the residual depends on the direction": _by("direction"),
    "the residual depends on the speed": _by("speed_rad_s"),
    "the residual depends on the temperature": _by("temperature_c"),
    "the scatter depends on the direction": _everywhere,
    "the scatter depends on the speed": _everywhere,
    "the scatter depends on the temperature": _everywhere,
}
"""For each statistic of the predictive check, from what is left to the place and the size of it."""
