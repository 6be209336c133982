"""How good a correction is against the truth of a draw, and whether an answer says which orders stay open."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..scoring import verdict
from .generator import Drawn
from .rotor import Array
from .sensor import AtRest, coefficients, rms_of_orders

Corrected = Callable[[Array], Array]
"""The shaft's angle [deg], with any zero, at readings [deg] of any shape."""
GOAL_DEG = 0.02


@dataclass(frozen=True)
class Left:
    """What a correction leaves of the sensor's error, over orders 1 to 16; degrees."""

    rms_deg: float
    raw_rms_deg: float
    amplitudes_deg: tuple[float, ...]
    """Of each order."""

    @property
    def factor(self) -> float:
        """By how much the error has become smaller."""
        return self.raw_rms_deg / self.rms_deg


def left_by(corrected: Corrected, truth: AtRest) -> Left:
    """Compared as functions of the reading: neither the zero nor the sense that the shaft is counted in matters."""
    size = truth.shaft_deg.size
    reading = 360.0 / size * np.arange(size)
    ahead = np.concatenate([truth.shaft_deg - 360.0, truth.shaft_deg, truth.shaft_deg + 360.0])
    begins = 360.0 * np.floor(truth.reading_deg[0] / 360.0)
    read = np.concatenate([truth.reading_deg - 360.0, truth.reading_deg, truth.reading_deg + 360.0]) - begins
    order = np.argsort(read, kind="stable")
    shaft = np.interp(reading, read[order], ahead[order])
    told = np.asarray(corrected(reading), dtype=np.float64)
    sense = 1.0 if np.abs(np.mean(np.exp(1j * np.radians(told - reading)))) > 0.5 else -1.0
    away = np.exp(1j * np.radians(sense * told - shaft))
    off = np.degrees(np.angle(away * np.conj(np.mean(away))))
    return Left(
        rms_of_orders(off),
        rms_of_orders(truth.error_deg),
        tuple(float(one) for one in np.abs(coefficients(off))),
    )


def wrong_orders(left: Left, unseparated: frozenset[int]) -> tuple[int, ...]:
    """Orders that are off by more than the goal's amplitude though the answer does not say that they stay open."""
    most = GOAL_DEG * np.sqrt(2.0)
    return tuple(
        order for order, size in enumerate(left.amplitudes_deg, start=1) if size > most and order not in unseparated
    )


def open_orders(truth: Mapping[str, Any]) -> tuple[int, ...]:
    """Orders that a torque moves by more than the goal's amplitude at the slowest speed: one speed leaves them open."""
    most = GOAL_DEG * np.sqrt(2.0)
    return tuple(int(order) for order, size in truth["torque_response_deg"].items() if size > most)


def names_verdict(answer: Mapping[str, Any], drawn: Drawn) -> str:
    """The names of an answer against what is wrong with the sensor; a torque by its own name is never wrong.

    What may as well be a torque, and is said to, counts as one where nothing in the sensor answers to it.
    """
    torque = "torque_ripple"
    entries = []
    for entry in answer["causes"]:
        others = entry.get("indistinguishable_from", ())
        if torque in others:
            entry = {**entry, "name": torque, "indistinguishable_from": [entry["name"], *others]}
        entries.append(entry)
    return verdict({**answer, "causes": entries}, drawn.truth)
