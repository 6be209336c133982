"""One entry of the answer: a cause, how improbable it is by chance, its rivals, and the held-out figures around it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from twin.catalogue import base_name, unnamed

if TYPE_CHECKING:
    from diagnosis.discovery.further.power import Option


@dataclass(frozen=True, eq=False)
class Finding:
    """One entry of the answer: a cause, its probability, rivals, and the held-out RMS around it [deg].

    ``log_p`` is the log probability by chance of this effect alone, ``family_log_p`` that of any effect, where known.
    ``rivals`` are the fits with another effect in its place, ``options`` the measurements that would part them.
    ``rows`` are the raw rows (from 0) that a cause of single readings has touched; ``intervals`` are of parameters
    that no fit of the mean has, by instance and name.
    """

    keys: tuple[str, ...]
    log_p: float
    gain: float
    rivals: Mapping[str, Fit] = field(default_factory=dict)
    options: tuple[Option, ...] = ()
    before_deg: float = float("nan")
    after_deg: float = float("nan")
    rows: tuple[int, ...] = ()
    intervals: Mapping[tuple[str, str], tuple[float, float]] = field(default_factory=dict)
    family_log_p: float | None = None

    def __repr__(self) -> str:
        rivals = f", cannot be told from {', '.join(self.rivals)}" if self.rivals else ""
        return (
            f"Finding({', '.join(self.keys)}; held-out RMS {self.before_deg:.4g} -> {self.after_deg:.4g} deg{rivals})"
        )

    def false_alarm_probability(self, looked_at: int) -> float:
        """Probability that noise looks as much like any of so many effects."""
        log_p = self.log_p + float(np.log(max(looked_at, 1))) if self.family_log_p is None else self.family_log_p
        return float(np.exp(max(min(log_p, 0.0), -300.0)))

    @property
    def name(self) -> str:
        """The catalogue's name, or ``unnamed``."""
        name = base_name(self.keys[0])
        return "unnamed" if unnamed(name) else name


def merge(entries: Sequence[Finding]) -> list[Finding]:
    """Instances of one effect, and all structure without a name, as one entry each; strongest first.

    The held-out figures of a merged entry are those of no single instance: they are left open.
    """
    merged: dict[str, Finding] = {}
    for entry in entries:
        if entry.name in merged:
            first = merged[entry.name]
            merged[entry.name] = replace(
                first,
                keys=(*first.keys, *entry.keys),
                log_p=min(first.log_p, entry.log_p),
                family_log_p=min((p for p in (first.family_log_p, entry.family_log_p) if p is not None), default=None),
                gain=first.gain + entry.gain,
                rivals={name: fit for name, fit in first.rivals.items() if name in entry.rivals},
                before_deg=float("nan"),
                after_deg=float("nan"),
                rows=tuple(sorted({*first.rows, *entry.rows})),
                intervals={**first.intervals, **entry.intervals},
            )
        else:
            merged[entry.name] = entry
    return sorted(merged.values(), key=lambda e: -e.gain)
