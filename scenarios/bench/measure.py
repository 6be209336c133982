"""One measurement: the plan run to its end or to a fault, journal, pretreatment, sweep file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from scenarios.bench.faults import Opener
from scenarios.bench.journal import Journal
from scenarios.bench.link import Link
from scenarios.bench.plan import Plan
from scenarios.bench.pretreatment import MANIFEST_DEG, Pretreated, pretreat, write_sweep
from scenarios.bench.progress import progress
from scenarios.bench.readings import Assembler, Reading
from scenarios.bench.sequence import NodeGone, Patience, Sequence
from twin.errors import UserError


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """What to measure and where to put it."""

    plan: Plan
    output: Path
    twin: str = "a real bench"
    channels: bool = True
    chamber: bool = True
    patience: Patience = field(default_factory=Patience)
    record: Path | None = None
    manifest_deg: float = MANIFEST_DEG


@dataclass(frozen=True)
class Measured:
    """What came of it: readings used and rejected, what happened on the bus, how many were there already."""

    pretreated: Pretreated
    counts: Counter[str]
    continued: int


def measure(
    job: Measurement, journal: Journal, open_bus: Opener, *, prepare: Callable[[Sequence], None] | None = None
) -> Measured:
    """Run the plan, from the last complete reading where there is one. Raises UserError where a node is gone.

    ``prepare`` (sequence -> None) is called first: to load a correction, or to take one out.
    """
    continued = len(journal.readings)
    done = {reading.index for reading in journal.readings}
    stops = [stop for stop in job.plan.stops() if stop.index not in done]
    if job.record is not None and continued:
        journal.close()
        raise UserError(
            f"{journal.path}: holds {continued} readings of a broken run, and a log would lack them; "
            "go on without --record, or --restart"
        )
    assembler = Assembler(channels=job.channels, chamber=job.chamber, on_event=journal.note)
    if stops:
        try:
            link = Link(open_bus, assembler, job.record)
        except BaseException:
            journal.close()
            raise
        clock = _Clock(journal)
        try:
            sequence = Sequence(link, assembler, job.patience)
            if prepare is not None:
                prepare(sequence)
            sequence.prepare(job.plan, stops[0])
            with progress(job.plan.readings, assembler, job.output.name) as display:

                def keep(reading: Reading) -> None:
                    journal.keep(clock.going_on(reading))
                    display.show(journal.readings)

                sequence.take(job.plan, stops, keep)
        except NodeGone as error:
            journal.close()
            raise UserError(
                f"{error}; {len(journal.readings)} of {job.plan.readings} readings are kept in {journal.path}: "
                "mend it and run again with the same options to go on"
            ) from None
        except BaseException as error:
            journal.close()
            if isinstance(error, KeyboardInterrupt) and journal.readings:
                print(f"{len(journal.readings)} readings are kept in {journal.path}: run again to go on")
            raise
        finally:
            link.close()
    pretreated = pretreat(journal.readings, manifest_deg=job.manifest_deg)
    write_sweep(job.output, pretreated.kept)
    journal.finish({"readings": len(pretreated.kept), "rejected": pretreated.rejected, "bus": dict(assembler.counts)})
    return Measured(pretreated, assembler.counts, continued)


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
