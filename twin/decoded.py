"""A recording whose link errs, decoded: what faults its words show, and the readings as they would be without them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from twin.angles import TAU, Array, radians, wrap
from twin.effect import BoolArray, Effect
from twin.sweep import Sweep
from twin.words import LIMIT_LOG_P, WordFault, Words, faults_of


@dataclass(frozen=True, eq=False)
class Decoded:
    """A recording without the faults of its words.

    ``sweep`` holds the readings told back, and where nothing is left of one what is expected there; ``lost`` (n,) masks
    the latter. ``faults`` are those that were found, each with the key of its instance; ``off_rad`` is the RMS of what
    each did to the readings that it touched.
    """

    sweep: Sweep
    lost: BoolArray
    faults: tuple[tuple[str, WordFault], ...]
    off_rad: tuple[float, ...]


def decoded(sweep: Sweep, effects: Iterable[Effect], *, limit_log_p: float = LIMIT_LOG_P) -> Decoded:
    """Tell the faults of the words that are as improbable by chance as this, and take them off the readings.

    Parameters
    ----------
    sweep : Sweep
        The recording, of one run.
    effects : iterable of Effect
        Those that may have acted; the ones told by words alone are looked for.
    limit_log_p : float, optional
        Log probability by chance from which on a fault counts.

    Returns
    -------
    Decoded
        The very same sweep where no fault is found.
    """
    finders = {effect.name: effect.in_words for effect in effects if effect.in_words is not None}
    lost = np.zeros(len(sweep), dtype=bool)
    measured = radians(sweep.measured_deg)
    words = Words(radians(sweep.reference_deg), measured, ~lost)
    found = faults_of(words, finders, limit_log_p) if finders else ()
    if not found:
        return Decoded(sweep, lost, (), ())
    for _, fault in found:
        words, lost = words.without(fault), lost | fault.lost
    expected = np.round(words.expected.angle / words.step) * words.step
    told = np.where(lost, expected, words.measured)
    off = tuple(_rms(wrap(measured - told)[fault.touched]) for _, fault in found)
    # Readings that no fault touched keep the digits of the file.
    changed = np.abs(wrap(told - measured)) > 1e-9
    read = np.where(changed, np.degrees(told % TAU), sweep.measured_deg)
    return Decoded(replace(sweep, measured_deg=read), lost, _numbered(found), off)


def _numbered(found: Iterable[tuple[str, WordFault]]) -> tuple[tuple[str, WordFault], ...]:
    """The faults with the keys of their instances: ``NAME``, ``NAME#2`` and so on."""
    count: dict[str, int] = {}
    told = []
    for name, fault in found:
        count[name] = count.get(name, 0) + 1
        told.append((name if count[name] == 1 else f"{name}#{count[name]}", fault))
    return tuple(told)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
