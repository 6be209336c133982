"""Ask a tool about one draw, and others beside it, and keep what came of it."""

from __future__ import annotations

import importlib
import json
import multiprocessing
import os
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from ..coverage import held
from .bound import least_rms_deg
from .generator import Drawn
from .judging import Corrected, left_by, names_verdict, open_orders, wrong_orders
from .peers import PEERS
from .sets import Job

Answerer = Callable[[Sequence[str]], tuple[Mapping[str, Any], Corrected, frozenset[int]]]
DEFAULT_ANSWERER = "tests.spin_answerer:explained"
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
Record = dict[str, Any]
SPUN = frozenset({"coast", "both_ways", "two_speeds", "two_logs", "several_speeds"})
"""Protocols in which the response to a torque falls as the speed squared, and that show it."""


def answerer_of(name: str) -> Answerer:
    """The callable that "module:function" names."""
    module, _, function = name.partition(":")
    found: Answerer = getattr(importlib.import_module(module), function)
    return found


def carry_out(job: Job, answerer: str) -> Record:
    """Draw, write, ask and judge; whatever the tool raises is kept as a failure. An empty ``answerer`` asks nobody."""
    drawn = job.draw()
    record: Record = {**job.record(), "key": job.key, "truth": drawn.truth, "peers": _peers(drawn)}
    record["least_rms_deg"] = least_rms_deg(drawn) if job.protocol in SPUN else None
    record["open_orders"] = open_orders(drawn.truth) if job.protocol == "one_speed" else ()
    if not answerer:
        return record
    with tempfile.TemporaryDirectory() as folder:
        paths = [str(path) for path in drawn.write(folder)]
        started = time.process_time()
        try:
            answer, corrected, unseparated = answerer_of(answerer)(paths)
        except Exception as error:
            return record | {"failed": f"{type(error).__name__}: {error}", "cpu_s": time.process_time() - started}
        record["cpu_s"] = time.process_time() - started
    return record | _judged(drawn, answer, corrected, unseparated)


def _judged(drawn: Drawn, answer: Mapping[str, Any], corrected: Corrected, unseparated: frozenset[int]) -> Record:
    left = left_by(corrected, drawn.at_rest)
    return {
        "rms_deg": left.rms_deg,
        "raw_rms_deg": left.raw_rms_deg,
        "factor": left.factor,
        "amplitudes_deg": left.amplitudes_deg,
        "unseparated": sorted(unseparated),
        "wrong_orders": wrong_orders(left, unseparated),
        "verdict": names_verdict(answer, drawn),
        "says": answer.get("verdict", ""),
        "names": [entry["name"] for entry in answer["causes"]],
        "alternatives": [list(entry.get("indistinguishable_from", ())) for entry in answer["causes"]],
        "intervals": {label: one.record() for label, one in held(answer, drawn.truth).items()},
    }


def _peers(drawn: Drawn) -> dict[str, float]:
    """RMS left [deg] by what others do, the mean of the logs' tables where there are several."""
    columns = [log.columns for log in drawn.logs]
    found = {}
    for name, peer in PEERS.items():
        each = [left_by(peer(one), drawn.at_rest).rms_deg for one in columns]
        found[name] = min(each)
    return found


def run(todo: Sequence[Job], *, answerer: str, processes: int, kept: Path | None) -> Iterator[Record]:
    """The records of all jobs as they come, those that ``kept`` holds first; each is added to it at once."""
    # read by the libraries when a worker loads them, so it has to stand before the pool does
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    known = {record["key"]: record for record in read(kept)}
    yield from (known[job.key] for job in todo if job.key in known)
    left = [job for job in todo if job.key not in known]
    for record in _each(left, answerer, processes):
        plain = json.loads(json.dumps(record))
        known[record["key"]] = plain
        if kept is not None:
            _write(kept, list(known.values()))
        yield plain


def _each(jobs: Sequence[Job], answerer: str, processes: int) -> Iterator[Record]:
    if processes == 1:
        yield from (carry_out(job, answerer) for job in jobs)
        return
    with ProcessPoolExecutor(processes, mp_context=multiprocessing.get_context("spawn")) as pool:
        for future in as_completed([pool.submit(carry_out, job, answerer) for job in jobs]):
            yield future.result()


def read(kept: Path | None) -> list[Record]:
    """The records of a study's file; none where there is no file."""
    if kept is None or not kept.exists():
        return []
    records: list[Record] = json.loads(kept.read_text(encoding="utf-8"))["results"]
    return records


def _write(kept: Path, records: Sequence[Record]) -> None:
    """Whole or not at all: a study that is stopped goes on where it stood."""
    beside = kept.with_name(kept.name + ".new")
    beside.write_text(json.dumps({"results": list(records)}, indent=1) + "\n", encoding="utf-8")
    beside.replace(kept)
