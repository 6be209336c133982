"""A recording whose link errs, decoded: what faults its words show, and the readings as they would be without them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from twin.angles import TAU, Array, radians, wrap
from twin.effect import BoolArray, Effect
from twin.sweep import Sweep
from twin.words import LIMIT_LOG_P, InWords, WordFault, Words, faults_of


@dataclass(frozen=True, eq=False)
class Decoded:
    """A recording without the faults of its words.

    ``read`` is the recording as it was read; ``sweep`` holds the readings told back, and where nothing is left of one
    what is expected there; ``lost`` (n,) masks the latter, ``told_back_rad`` (n,) is what the others had been off by.
    ``faults`` are those that were found, each with the key of its instance; ``off_rad`` is the RMS of what each did to
    the readings that it touched, and ``said`` tells it in words.
    """

    read: Sweep
    sweep: Sweep
    lost: BoolArray
    told_back_rad: Array
    faults: tuple[tuple[str, WordFault], ...] = ()
    off_rad: tuple[float, ...] = ()
    said: tuple[str, ...] = ()

    @property
    def usable(self) -> Sweep:
        """The recording without the rows of which nothing is left: these are rejected, with the reason."""
        if not self.lost.any():
            return self.sweep
        reasons: dict[int, str] = {}
        for (_, fault), words in zip(self.faults, self.said, strict=True):
            reasons.update(dict.fromkeys(self.sweep.numbers[fault.lost].tolist(), words))
        part = self.sweep.part(np.flatnonzero(~self.lost))
        rejected = dict(sorted({**self.sweep.rejected, **reasons}.items()))
        return replace(part, rejected=rejected, set_aside=self.sweep.set_aside)

    @property
    def lines(self) -> tuple[str, ...]:
        """A sentence for each fault whose readings are told back, as no rejected row tells of it."""
        return self.lines_saying("are told back")

    def lines_saying(self, became: str) -> tuple[str, ...]:
        """The same with what became of the readings in other words."""
        told = zip(self.faults, self.said, strict=True)
        return tuple(
            f"{self.sweep.name}: {words}; {np.count_nonzero(fault.touched)} readings {became}"
            for (_, fault), words in told
            if not fault.lost.any()
        )


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
    finders = finders_of(effects)
    lost = np.zeros(len(sweep), dtype=bool)
    measured = radians(sweep.measured_deg)
    words = Words(radians(sweep.reference_deg), measured, ~lost)
    found = faults_of(words, finders, limit_log_p) if finders else ()
    if not found:
        return Decoded(sweep, sweep, lost, np.zeros(len(sweep)))
    for _, fault in found:
        words, lost = words.without(fault), lost | fault.lost
    expected = np.round(words.expected.angle / words.step) * words.step
    told = np.where(lost, expected, words.measured)
    off = tuple(_rms(wrap(measured - told)[fault.touched]) for _, fault in found)
    # Readings that no fault touched keep the digits of the file.
    changed = np.abs(wrap(told - measured)) > 1e-9
    read = np.where(changed, np.degrees(told % TAU), sweep.measured_deg)
    said = tuple(f"{name}: {finders[name].said(fault.values)}" for name, fault in found)
    back = np.where(lost | ~changed, 0.0, _half_turn_down(measured - told))
    return Decoded(sweep, replace(sweep, measured_deg=read), lost, back, _numbered(found), off, said)


def begun_by_words(sweep: Sweep, lost: BoolArray, effects: Iterable[Effect]) -> tuple[tuple[str, WordFault], ...]:
    """What the words tell of effects on every reading, by name: where a fit sets out from.

    ``lost`` (n,) masks readings that say nothing.
    """
    motion = sweep.motion()
    words = Words(radians(sweep.reference_deg), radians(sweep.measured_deg), ~lost, motion)
    told = []
    for effect in effects:
        if effect.in_words is None or effect.footprint != "mean" or not effect.visible_in(motion.provides):
            continue
        fault = effect.in_words.find(words)
        if fault is not None:
            told.append((effect.name, fault))
            words = words.without(fault)
    return tuple(told)


def finders_of(effects: Iterable[Effect]) -> dict[str, InWords]:
    """The effects whose faults are taken off the words, by name, with how these tell them."""
    found = ((effect.name, effect.in_words) for effect in effects if effect.footprint == "sequence")
    return {name: way for name, way in found if way is not None}


def _numbered(found: Iterable[tuple[str, WordFault]]) -> tuple[tuple[str, WordFault], ...]:
    """The faults with the keys of their instances: ``NAME``, ``NAME#2`` and so on."""
    count: dict[str, int] = {}
    told = []
    for name, fault in found:
        count[name] = count.get(name, 0) + 1
        told.append((name if count[name] == 1 else f"{name}#{count[name]}", fault))
    return tuple(told)


def _half_turn_down(away: Array) -> Array:
    """Differences (n,) [rad] within half a turn; half a turn itself, whatever its rounding, counts downwards."""
    edge = TAU / 2.0 + 1e-6
    return np.asarray(np.mod(away + edge, TAU) - edge)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
