"""One measurement: the plan run to its end or to a fault, journal, pretreatment, sweep file."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from scenarios.bench.faults import Opener
from scenarios.bench.journal import Journal
from scenarios.bench.link import Link
from scenarios.bench.plan import Plan, Stop
from scenarios.bench.pretreatment import MANIFEST_DEG, Pretreated, pretreat, sweep_text
from scenarios.bench.progress import progress
from scenarios.bench.readings import Assembler, Reading
from scenarios.bench.sequence import NodeGone, Patience, Sequence
from scenarios.commands.outputs import OutputFiles
from scenarios.commands.settings import Settings
from twin.errors import UserError


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """What to measure and where to put it: ``files`` are all that the run may write, the output among them.

    ``twin`` is what is measured, in words, and ``settings`` are all besides the plan that the readings depend on.
    ``heard`` is called with the output's name and all readings so far after each.
    """

    plan: Plan
    output: Path
    files: OutputFiles
    twin: str = "a real bench"
    settings: Settings = field(default_factory=dict)
    channels: bool = True
    chamber: bool = True
    patience: Patience = field(default_factory=Patience)
    record: Path | None = None
    manifest_deg: float = MANIFEST_DEG
    heard: Callable[[str, list[Reading]], None] | None = None


@dataclass(frozen=True)
class Measured:
    """What came of it: readings used and rejected, what happened on the bus, how many were there already."""

    pretreated: Pretreated
    counts: Counter[str]
    continued: int


def measure(
    job: Measurement,
    journal: Journal,
    open_bus: Opener,
    *,
    prepare: Callable[[Sequence], None] | None = None,
    last: bool = True,
) -> Measured:
    """Run the plan, from the last complete reading where there is one, and write the sweep.

    ``prepare`` (sequence -> None) is called first: to load a correction, or to take one out. Unless it is the ``last``
    measurement of the run, its journal stays as it is: should the run break off later, it is there to be taken up.
    Raises UserError where a node is gone or nothing can be written.
    """
    continued = len(journal.readings)
    stops = list(job.plan.stops())[continued:]
    if job.record is not None and continued and stops:
        raise UserError(
            f"{journal.path}: holds {continued} readings of a broken run, and a log would lack them; "
            "go on without --record, or --restart"
        )
    assembler = Assembler(channels=job.channels, chamber=job.chamber, on_event=journal.note)
    if stops:
        try:
            with contextlib.closing(Link(open_bus, assembler, job.record, replace=job.files.force)) as link:
                _take(job, journal, link, stops=stops, prepare=prepare)
        except NodeGone as error:
            raise UserError(f"{error}; mend it; {journal.kept()}") from None
    pretreated = pretreat(journal.readings, manifest_deg=job.manifest_deg)
    job.files.write({job.output: sweep_text(pretreated.kept)}, before=journal.will_write)
    measured = Measured(pretreated, assembler.counts, continued)
    if last:
        finish(job, journal, measured)
    return measured


def finish(job: Measurement, journal: Journal, measured: Measured, *, witness: Journal | None = None) -> None:
    """Turn the journal of a sweep that is written into its log. Raises UserError.

    ``witness`` is the journal of the run that goes on, which will know sweep and log as its own.
    """
    pretreated = measured.pretreated
    journal.summarise({"readings": len(pretreated.kept), "rejected": pretreated.rejected, "bus": dict(measured.counts)})
    # Somebody's file may lie there since the work began.
    job.files.check([journal.log])
    if witness is not None:
        witness.will_finish(journal)
    journal.finish()


def journal_of(job: Measurement, *, restart: bool) -> Journal:
    """The journal of a measurement, begun or taken up. Raises UserError."""
    return Journal(job.output, job.plan, twin=job.twin, settings=job.settings, restart=restart)


def _take(
    job: Measurement,
    journal: Journal,
    link: Link,
    *,
    stops: list[Stop],
    prepare: Callable[[Sequence], None] | None,
) -> None:
    """Take the readings at these stops into the journal."""
    clock = _Clock(journal)
    sequence = Sequence(link, link.assembler, job.patience)
    if prepare is not None:
        prepare(sequence)
    sequence.prepare(job.plan, stops[0])
    with progress(job.plan.readings, link.assembler.counts, job.output.name) as display:

        def keep(reading: Reading) -> None:
            journal.keep(clock.going_on(reading))
            display.show(journal.readings)
            if job.heard is not None:
                job.heard(job.output.name, journal.readings)

        sequence.take(job.plan, stops, keep)


class _Clock:
    """A continued run goes on in time after the run before, whatever the bench's clock says."""

    def __init__(self, journal: Journal) -> None:
        self._last_s = journal.readings[-1].time_s if journal.readings else None
        self._shift_s: float | None = None

    def going_on(self, reading: Reading) -> Reading:
        """The reading in the time of the whole measurement."""
        if self._last_s is None:
            return reading
        if self._shift_s is None:
            self._shift_s = max(self._last_s + 1.0 - reading.time_s, 0.0)
        return replace(reading, time_s=reading.time_s + self._shift_s)
