"""A virtual bench for tests: an encoder without noise, so that every column but the time must come out to the bit."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenarios.bench.buses import Interface, with_bench_faults
from scenarios.bench.faults import parse
from scenarios.bench.hidden import hidden_encoder
from scenarios.bench.measure import Measured, Measurement, journal_of, measure
from scenarios.bench.plan import Plan
from scenarios.bench.sequence import Patience
from scenarios.bench.virtual import Setup, running
from scenarios.bench.written import files_of_measurement
from twin.chain import Chain
from twin.sweep_reader import read_columns

PLAN = Plan(points=64, both_directions=True)


def quiet_encoder() -> Chain:
    """The default encoder without what is random."""
    return hidden_encoder(None, ()).without("noise")


@dataclass(frozen=True)
class Outcome:
    """What a run gave, and the faults that were done to it, by node."""

    measured: Measured
    faults: dict[str, Counter[str]]


def run_bench(
    output: Path,
    *,
    faults: Sequence[str] = (),
    plan: Plan = PLAN,
    record: Path | None = None,
    patience: Patience | None = None,
) -> Outcome:
    """One measurement on the quiet encoder."""
    parsed = [fault for text in faults for fault in parse(text)]
    open_bus = Interface().opener()
    job = Measurement(
        plan=plan,
        output=output,
        files=files_of_measurement(output, record=record),
        record=record,
        patience=patience or Patience(timeout_s=0.03, attempts=100),
    )
    setup = Setup(chain=quiet_encoder(), faults=parsed)
    with (
        contextlib.closing(journal_of(job, restart=False)) as journal,
        running(setup, open_bus) as done,
    ):
        found = measure(job, journal, with_bench_faults(open_bus, parsed, 0))
    return Outcome(found, done)


def assert_same_readings(found: Path, wanted: Path, *, without: Sequence[int] = ()) -> None:
    """Every column but the time to the bit; ``without`` are readings that were rejected."""
    first, second = read_columns(found), read_columns(wanted)
    assert first.keys() == second.keys()
    keep = np.setdiff1d(np.arange(second["reference_deg"].size), list(without))
    for name in second.keys() - {"time_s"}:
        np.testing.assert_array_equal(first[name], second[name][keep], err_msg=name)
    assert np.all(np.diff(first["time_s"]) > 0.0)
