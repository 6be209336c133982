"""Words: the faults of the link that the words themselves tell, taken off the readings ahead of every fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import Array
from twin.catalogue import base_name
from twin.chain import Chain
from twin.decoded import Decoded, decoded, finders_of
from twin.effect import BoolArray, Effect, Parameters
from twin.sweep import Sweep


@dataclass(frozen=True, eq=False)
class Read:
    """Recordings without the faults of their words: ``lost`` (n,) masks the rows of all of which nothing is left.

    ``findings`` are the faults as causes, ``words`` what each of them does, by its key; ``told_back`` (n,) [rad] is
    what readings that are told back had been off by, None where none is.
    """

    sweeps: tuple[Sweep, ...]
    lost: BoolArray
    findings: tuple[Finding, ...]
    words: dict[str, Parameters]
    told_back: Array | None

    def beside(self, given: Chain | None) -> tuple[Read, Chain | None]:
        """The same of a given twin, whose own faults of the words are no finding; and the twin without them."""
        if given is None:
            return self, None
        own = {key: values for key, values in given.values.items() if _in_words(key, given.effects)}
        new = tuple(one for one in self.findings if not _same(self.words[one.keys[0]], own.get(one.keys[0])))
        return replace(self, findings=new, words={**own, **self.words}), given.without(*own)


def read_words(sweeps: Sequence[Sweep], effects: Sequence[Effect], settings: DiscoverySettings) -> Read:
    """Tell the faults of the words in each recording of one device."""
    family = sum(effect.footprint == "sequence" for effect in effects)
    each = [decoded(sweep, effects, limit_log_p=settings.effect_log_p(family)) for sweep in sweeps]
    findings: list[Finding] = []
    words: dict[str, Parameters] = {}
    start = 0
    for one in each:
        findings += _findings(one, family, start)
        words = {**{key: fault.values for key, fault in one.faults}, **words}
        start += len(one.sweep)
    lost = np.concatenate([one.lost for one in each])
    back = np.concatenate([one.told_back_rad for one in each])
    told_back = back if back.any() else None
    return Read(tuple(one.sweep for one in each), lost, tuple(findings), words, told_back)


def _findings(one: Decoded, family: int, start: int) -> list[Finding]:
    """The faults of a recording whose first row is this one of all."""
    return [
        Finding.among(
            family,
            key,
            fault.log_p,
            gain=-2.0 * fault.log_p,
            rows=tuple((start + np.flatnonzero(fault.touched)).tolist()),
            intervals={(key, name): ends for name, ends in fault.intervals.items()},
            rows_off_deg=float(np.degrees(off)),
            alike=fault.alike,
        )
        for (key, fault), off in zip(one.faults, one.off_rad, strict=True)
    ]


def _in_words(key: str, effects: Sequence[Effect]) -> bool:
    finders = finders_of(effects)
    return base_name(key) in finders


def _same(found: Parameters, known: Parameters | None) -> bool:
    """Whether a fault is one that is known: what was counted or measured of it may differ."""
    if known is None:
        return False
    return all(abs(float(value) - float(known.get(name, value))) <= 0.5 for name, value in found.items())
