"""Print what a study found."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any, Protocol

from rich.console import Console
from rich.table import Table

from .physics.sets import PhysicsJob
from .scoring import VERDICTS
from .sets import Job

CLEAR_SIGMA = 8.0
"""A cause with less is not seen over everything searched at any fair false-alarm rate."""


class Scored(Protocol):
    """The part of a result that a table shows."""

    @property
    def job(self) -> Job | PhysicsJob: ...
    @property
    def truth(self) -> Mapping[str, Any]: ...
    @property
    def verdict(self) -> str: ...
    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def cpu_s(self) -> float: ...
    @property
    def noise_ratio(self) -> float | None: ...
    @property
    def transfer(self) -> float | None: ...
    @property
    def message(self) -> str: ...


def clear(truth: Mapping[str, Any]) -> bool:
    """Every hidden thing stands clear of the noise, as far as that can be said."""
    return all(sigma is None or sigma >= CLEAR_SIGMA for sigma in truth["clearance_sigma"].values())


def _share(results: Sequence[Scored]) -> str:
    hits = sum(result.verdict == "right" for result in results)
    return f"{hits}/{len(results)}" if results else ""


def print_group(console: Console, group: str, results: Sequence[Scored]) -> None:
    """A table of a set, then every draw that was not answered right, with what makes it again."""
    if not results:
        return
    table = Table(title=group, title_justify="left")
    table.add_column("hidden", no_wrap=True)
    for heading in ("right", "right of clear", *VERDICTS[1:], "failed"):
        table.add_column(heading, justify="right")
    table.add_column("named instead or besides")
    labels = list(dict.fromkeys(result.job.label for result in results))
    rows = {label: [result for result in results if result.job.label == label] for label in labels}
    if len(labels) > 1:
        rows["all"] = list(results)
    for label, members in rows.items():
        if label == "all":
            table.add_section()
        counts = Counter(result.verdict for result in members)
        wrong = Counter(
            name
            for result in members
            if result.verdict != "right"
            for name in result.names
            if name not in (*result.truth["causes"], *result.truth.get("tolerated", ()))
        )
        table.add_row(
            label,
            _share(members),
            _share([result for result in members if clear(result.truth)]),
            *(str(counts[kind] or "") for kind in (*VERDICTS[1:], "failed")),
            ", ".join(f"{name} {count}" for name, count in wrong.most_common(6)),
        )
    console.print(table)
    summary = f"median {median(result.cpu_s for result in results):.2f} CPU seconds an answer"
    ratios = [result.noise_ratio for result in results if result.noise_ratio is not None]
    if ratios:
        summary += f"; RMS left over noise put in: median {median(ratios):.3f} of {len(ratios)}"
    console.print(summary)
    transfers = sorted(result.transfer for result in results if result.transfer is not None)
    if transfers:
        console.print(
            "another recording of the device predicted, RMS over noise and rounding: "
            f"median {median(transfers):.3f}, 90 % {transfers[math.ceil(0.9 * len(transfers)) - 1]:.3f}, "
            f"worst {transfers[-1]:.3f} of {len(transfers)}"
        )
    for result in results:
        if result.verdict != "right":
            console.print(failure(result), highlight=False, soft_wrap=True)
    console.print()


def failure(result: Scored) -> str:
    """One line about a draw that was not answered right."""
    truth = result.truth
    sizes = []
    for name, strength in truth["strength_deg"].items():
        sigma = truth["clearance_sigma"][name]
        sizes.append(f"{name} {strength:.3f} deg" + ("" if sigma is None else f" {sigma:.1f} sigma"))
    given = result.message or ", ".join(result.names) or "nothing"
    place = f"{truth['protocol']}{'+channels' if truth['channels'] else ''} {truth['rows']} rows"
    noise = f"{truth['noise_kind']} {truth['noise_deg']:.3f}"
    return f"  {result.verdict}: {'; '.join(sizes) or 'clean'} -> {given} ({place}, {noise}) {result.job.command()}"
