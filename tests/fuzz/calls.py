"""What is done with each broken input, and what has to hold of an answer."""

from __future__ import annotations

import contextlib
import io
import json
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis import diagnose, explain
from diagnosis.correction.compensation import correction_of
from diagnosis.correction.targets.known import TARGETS
from diagnosis.report.provenance import Provenance
from diagnosis.setup.of_log import read_record
from diagnosis.setup.several_readings import checked_log
from scenarios.bench.replay import replay
from scenarios.commands import doctor, export
from scenarios.commands.export_made import Asked
from scenarios.commands.protocol import Protocol
from tests.fuzz import logs, options, sweeps, twins
from tests.fuzz.trial import ANSWERED, FAILED, LONGEST_S, REFUSED, Ended, tried, within
from twin.chain import Chain
from twin.files import from_dict, read_twin, to_dict
from twin.sweep import Sweep

Generator = np.random.Generator


@dataclass(frozen=True)
class Kind:
    """A kind of input: ``make`` draws one as (ending of the file, bytes), ``use`` does with the file what is tried."""

    make: Callable[[Generator], tuple[str, bytes]]
    use: Callable[[Path], None]


def _as_json(answer: Mapping[str, Any]) -> None:
    """An answer is JSON: no figure in it is NaN or infinite."""
    json.dumps(answer, allow_nan=False)


def read_and_diagnosed(path: Path) -> None:
    """The reader, then the error factors with all that is said of them."""
    found = diagnose(Sweep.read(path))
    _as_json(found.to_dict())
    assert found.summary()


def explained(path: Path) -> None:
    """The search, all that is said of it, and the extended twin read back."""
    found = explain(Sweep.read(path))
    answer = found.to_dict()
    _as_json(answer)
    assert found.summary(72)
    with tempfile.TemporaryDirectory() as folder:
        found.write_report(Path(folder) / "report.html")
    again = from_dict(answer["twin"], effects=found.extended.effects)
    assert again.values.keys() <= found.extended.values.keys()


def twin_used(path: Path) -> None:
    """A twin read, simulated, inverted, and written as it was read."""
    chain = read_twin(path)
    motion = Protocol(turns=2, points=24, both_directions=True, speeds_rpm=(60.0,), temperatures_c=(25.0,)).motion()
    sweep = chain.simulate(motion, seed=1)
    assert np.isfinite(sweep.measured_deg).all()
    assert np.isfinite(sweep.reference_deg).all()
    chain.trace(motion, seed=1)
    correction = correction_of(chain)
    assert np.isfinite(correction.table(16)).all()
    assert _same(from_dict(to_dict(chain)), chain)


def _same(one: Chain, other: Chain) -> bool:
    return to_dict(one) == to_dict(other)


def replayed(path: Path) -> None:
    """The sweep of a recorded bus, read back."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "sweep.csv"
        replay(path, output)
        Sweep.read(output)


def readable(rng: Generator) -> tuple[str, bytes]:
    """The first of some broken sweeps that the reader takes: what is refused at the door tries no search."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "asked.csv"
        for _ in range(100):
            raw = sweeps.mutated(rng)
            path.write_bytes(raw)
            with contextlib.suppress(Exception), within(LONGEST_S):
                Sweep.read(path)
                return ".csv", raw
    raise AssertionError("none of a hundred broken sweeps can be read")


def log_checked(path: Path) -> None:
    """The set-up of a log, whether it is a sweep or not, and what is said of it."""
    read = read_record(path, name=path.name)
    answer = doctor.to_dict(read, checked_log(read), Provenance.today(seed=0))
    _as_json(answer)
    with contextlib.redirect_stdout(io.StringIO()):
        doctor.show(answer)


def exported(path: Path) -> None:
    """The correction of a sweep as a table of each target, by the command."""
    for target in TARGETS:
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            wish = Asked.checked(target.name, "worst", 25.0, "fuzz")
            export.run([path], wish=wish, outputs=export.Outputs(table=Path(folder) / f"table{target.ending}"))


KINDS: Mapping[str, Kind] = {
    "sweeps": Kind(lambda rng: (".csv", sweeps.mutated(rng)), read_and_diagnosed),
    "explain": Kind(readable, explained),
    "doctor": Kind(lambda rng: (".csv", sweeps.mutated(rng)), log_checked),
    "export": Kind(readable, exported),
    "twins": Kind(lambda rng: (".toml", twins.mutated(rng)), twin_used),
    "logs": Kind(logs.mutated, replayed),
    "options": Kind(lambda rng: (".txt", options.drawn(rng)), options.run),
}


def content(kind: str, number: int, seed: int) -> tuple[str, bytes]:
    """The input of this number: the same for the same seed, whatever was drawn before."""
    return KINDS[kind].make(np.random.default_rng([seed, sorted(KINDS).index(kind), number]))


def trial(kind: str, number: int, seed: int) -> tuple[Ended, str, bytes]:
    """One input tried: how it ended, and the input as file ending and bytes."""
    ending, raw = content(kind, number, seed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"input{ending}"
        path.write_bytes(raw)
        return tried(lambda: KINDS[kind].use(path)), ending, raw


__all__ = ["ANSWERED", "FAILED", "KINDS", "REFUSED", "content", "trial"]
