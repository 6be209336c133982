"""One entry of the answer: a cause, how improbable it is by chance, its rivals, and the held-out figures around it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.settings import over_footprints
from twin.catalogue import CATALOGUE, base_name, find, of_one_source, unnamed
from twin.each_recording import everywhere
from twin.effect import Effect
from twin.words import Alike

if TYPE_CHECKING:
    from diagnosis.discovery.further.power import Option


@dataclass(frozen=True, eq=False)
class Finding:
    """One entry of the answer: a cause, its probability, rivals, and the held-out RMS around it [deg].

    ``log_p`` is the log probability by chance of this effect alone, ``family_log_p`` that of any effect with the same
    footprint.
    ``rivals`` are the fits with another effect in its place, ``options`` the measurements that would part them.
    ``rows`` are the raw rows (from 0) that a cause of single readings has touched; ``intervals`` are of parameters
    that no fit of the mean has, by instance and name. ``rows_off_deg`` is the RMS of what it did to its rows, where
    that was taken off them ahead of the fit; ``alike`` are the faults that send the very same words.
    """

    keys: tuple[str, ...]
    log_p: float
    gain: float
    family_log_p: float
    rivals: Mapping[str, Fit] = field(default_factory=dict)
    options: tuple[Option, ...] = ()
    before_deg: float = float("nan")
    after_deg: float = float("nan")
    rows: tuple[int, ...] = ()
    intervals: Mapping[tuple[str, str], tuple[float, float]] = field(default_factory=dict)
    rows_off_deg: float | None = None
    alike: tuple[Alike, ...] = ()

    def __repr__(self) -> str:
        others = ", ".join(dict.fromkeys(map(everywhere, self.rivals)))
        rivals = f", cannot be told from {others}" if others else ""
        return (
            f"Finding({', '.join(self.keys)}; held-out RMS {self.before_deg:.4g} -> {self.after_deg:.4g} deg{rivals})"
        )

    @classmethod
    def among(cls, family: int, key: str, log_p: float, *, gain: float, **more: Any) -> Finding:
        """A finding of one effect among so many that were looked for in its footprint (Bonferroni)."""
        return cls((key,), log_p, gain, log_p + float(np.log(family)), **more)

    @property
    def false_alarm_probability(self) -> float:
        """Probability that a sweep without a cause looks as much like any, in any of the footprints (Bonferroni)."""
        return over_footprints(self.family_log_p)

    @property
    def name(self) -> str:
        """The catalogue's name, or ``unnamed``."""
        name = everywhere(base_name(self.keys[0]))
        return "unnamed" if unnamed(name) else name


def merge(entries: Sequence[Finding], effects: tuple[Effect, ...] = CATALOGUE) -> list[Finding]:
    """Instances of one effect, and all structure without a name, as one entry each; strongest first.

    Instances of which one has another rival than the other may come of different causes: they are entries of their own,
    unless they are lines of one source. The held-out figures of a merged entry are those of no single instance: they
    are left open.
    """
    merged: dict[tuple[str, frozenset[str]], Finding] = {}
    for entry in entries:
        apart = entry.name != "unnamed" and not of_one_source(find(entry.keys[0], effects))
        which = (entry.name, frozenset(entry.rivals if apart else ()))
        if which in merged:
            first = merged[which]
            merged[which] = replace(
                first,
                keys=(*first.keys, *entry.keys),
                log_p=min(first.log_p, entry.log_p),
                family_log_p=min(first.family_log_p, entry.family_log_p),
                gain=first.gain + entry.gain,
                rivals={name: fit for name, fit in first.rivals.items() if name in entry.rivals},
                before_deg=float("nan"),
                after_deg=float("nan"),
                rows=tuple(sorted({*first.rows, *entry.rows})),
                intervals={**first.intervals, **entry.intervals},
            )
        else:
            merged[which] = entry
    return sorted(merged.values(), key=lambda e: -e.gain)
