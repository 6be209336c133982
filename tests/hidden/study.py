"""Score an answerer on sweeps it has never seen.

    python -m tests.hidden.study --set single,pairs --draws 20 --seed 7 -o study.json
    python -m tests.hidden.study --set physics,physics_clean,physics_outside --draws 3 --seed 7 -o study.json
    python -m tests.hidden.study --make hysteresis --seed 5 --bench hard -o sweep.csv
    python -m tests.hidden.study --make-physics froehlich --seed 5 --recording 1 -o sweep.csv

The last two write one draw, as the list of failures of the first two names it.
"""

from __future__ import annotations

import argparse
import importlib
import json
import multiprocessing
import os
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rich.console import Console

from .coverage import Interval, held
from .coverage_table import table as coverage_table
from .generator import Hidden, draw
from .physics.generator import draw as draw_physics
from .physics.kind import Kind
from .physics.kinds import KINDS
from .physics.sets import PHYSICS, PhysicsJob, physics_jobs
from .scoring import verdict
from .sets import GROUPS, Job, jobs
from .tables import print_group

Answerer = Callable[[str], Mapping[str, Any]]
DEFAULT_ANSWERER = "tests.answerer:explain_file"
Predictor = Callable[[str, str], tuple[Mapping[str, Any], float]]
DEFAULT_PREDICTOR = "tests.answerer:explain_and_predict"
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
GRAINY = frozenset(
    {
        "output_quantisation",
        "cordic_truncation",
        "stale_frames",
        "adc_stuck_bit",
        "reference_jitter",
        "time_jitter",
        "noise_burst",
    }
)
"""Where the noise put in is not what a perfect answer leaves."""


@dataclass(frozen=True)
class Result:
    """What became of one draw."""

    job: Job | PhysicsJob
    truth: Mapping[str, Any]
    verdict: str
    """One of scoring.VERDICTS, or failed."""
    names: tuple[str, ...]
    alternatives: tuple[tuple[str, ...], ...]
    says: str
    """The answer's own verdict."""
    cpu_s: float
    noise_ratio: float | None
    """RMS that the extended twin leaves over that of noise and rounding."""
    transfer: float | None = None
    """The same on another recording of the device, of which the twin has seen nothing."""
    intervals: Mapping[str, Interval] = field(default_factory=dict)
    """By "cause.parameter" or "baseline.factor", each with its truth."""
    answered: tuple[Mapping[str, Any], ...] = ()
    """The causes as the answer gave them."""
    message: str = ""

    def record(self) -> dict[str, object]:
        """For a JSON file."""
        return {
            **self.job.record(),
            "command": self.job.command(),
            "verdict": self.verdict,
            "names": list(self.names),
            "indistinguishable_from": [list(one) for one in self.alternatives],
            "answer_verdict": self.says,
            "cpu_s": self.cpu_s,
            "noise_ratio": self.noise_ratio,
            "transfer": self.transfer,
            "intervals": {label: interval.record() for label, interval in self.intervals.items()},
            "answered": [dict(entry) for entry in self.answered],
            "message": self.message,
            "truth": dict(self.truth),
        }


def load(answerer: str) -> Answerer:
    """The callable that "module:function" names."""
    found: Answerer = _named(answerer)
    return found


def _named(path: str) -> Any:
    module, _, function = path.partition(":")
    return getattr(importlib.import_module(module), function)


def noise_ratio(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> float | None:
    """Extended RMS over the RMS of noise and rounding put in; None where values and sequence rule."""
    if GRAINY & {*truth["strength_deg"], *truth["causes"]} or "extended" not in answer:
        return None
    rms = answer["extended"].get("rms_deg")
    return None if rms is None else float(rms) / float(truth["floor_deg"])


def foretold(kind: Kind) -> bool:
    """Another recording has the same in it, and its mean shows it."""
    return kind.outcome_repeats and not GRAINY & set(kind.answers[0])


@dataclass(frozen=True)
class Asked:
    """Who answers: "module:function" each."""

    answerer: str = DEFAULT_ANSWERER
    predictor: str = DEFAULT_PREDICTOR
    """Asked in place of it where the device was recorded twice; "" for none."""

    def answer(self, job: Job | PhysicsJob, path: Path) -> tuple[Mapping[str, Any], float | None]:
        """The answer to the sweep at `path` and, where there is another recording, how well it is predicted."""
        if not (self.predictor and isinstance(job, PhysicsJob) and foretold(KINDS[job.label])):
            return load(self.answerer)(str(path)), None
        further, other = job.again().draw(), path.with_suffix(".further.csv")
        further.write_csv(other)
        predict: Predictor = _named(self.predictor)
        try:
            answer, rms_deg = predict(str(path), str(other))
        finally:
            other.unlink(missing_ok=True)
        return answer, rms_deg / float(further.truth["floor_deg"])  # type: ignore[arg-type]


def carry_out(job: Job | PhysicsJob, asked: Asked, folder: str) -> Result:
    """Draw, write, ask and score; whatever the answerer raises is kept as a failure."""
    hidden = job.draw()
    path = Path(folder) / f"{job.group}-{job.seed}-{os.getpid()}.csv"
    hidden.write_csv(path)
    started = time.process_time()
    try:
        answer, transfer = asked.answer(job, path)
        return _result(job, hidden, answer, transfer=transfer, spent=time.process_time() - started)
    except Exception as error:
        return Result(
            job=job,
            truth=hidden.truth,
            verdict="failed",
            names=(),
            alternatives=(),
            says="",
            cpu_s=time.process_time() - started,
            noise_ratio=None,
            message=f"{type(error).__name__}: {error}",
        )
    finally:
        path.unlink(missing_ok=True)


def _result(
    job: Job | PhysicsJob, hidden: Hidden, answer: Mapping[str, Any], *, transfer: float | None, spent: float
) -> Result:
    """What an answer is worth."""
    entries = list(answer["causes"])
    return Result(
        job=job,
        truth=hidden.truth,
        verdict=verdict(answer, hidden.truth),
        names=tuple(entry["name"] for entry in entries),
        alternatives=tuple(tuple(entry.get("indistinguishable_from", ())) for entry in entries),
        says=str(answer.get("verdict", "")),
        cpu_s=spent,
        noise_ratio=noise_ratio(answer, hidden.truth),
        transfer=transfer,
        intervals=held(answer, hidden.truth),
        answered=tuple(entries),
    )


def run(todo: Sequence[Job | PhysicsJob], *, asked: Asked, processes: int, console: Console) -> list[Result]:
    """Carry out all jobs, in their order."""
    # read by the libraries when a worker loads them, so it has to stand before the pool does
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    results: dict[int, Result] = {}
    context = multiprocessing.get_context("spawn")
    with (
        tempfile.TemporaryDirectory() as folder,
        ProcessPoolExecutor(processes, mp_context=context) as pool,
        console.status("drawing") as status,
    ):
        pending = {pool.submit(carry_out, job, asked, folder): at for at, job in enumerate(todo)}
        for future in as_completed(pending):
            results[pending[future]] = future.result()
            wrong = sum(result.verdict != "right" for result in results.values())
            status.update(f"{len(results)} of {len(todo)} answered, {wrong} not right")
    return [results[at] for at in range(len(todo))]


def confusion(results: Sequence[Result], group: str) -> dict[str, dict[str, int]]:
    """How often each name was given, for every label of a set; "nothing" where none was."""
    counts: dict[str, Counter[str]] = {}
    for result in results:
        if result.job.group == group:
            given = result.names or ("failed" if result.verdict == "failed" else "nothing",)
            counts.setdefault(result.job.label, Counter()).update(given)
    return {label: dict(names) for label, names in counts.items()}


def parser() -> argparse.ArgumentParser:
    """Options of the command."""
    made = argparse.ArgumentParser(prog="python -m tests.hidden.study", description=__doc__.splitlines()[0])
    made.add_argument("--set", default="single", help=f"comma-separated, of {', '.join((*GROUPS, *PHYSICS))}; or all")
    made.add_argument("--only", default="", help="comma-separated causes, structures or labels to keep")
    made.add_argument("--draws", type=int, default=20, help="draws of each label")
    made.add_argument("--seed", type=int, default=1)
    made.add_argument("--jobs", type=int, default=2, help="processes")
    made.add_argument("--answerer", default=DEFAULT_ANSWERER, help="module:function, path -> dict")
    made.add_argument("--predictor", default=DEFAULT_PREDICTOR, help="module:function, two paths -> dict, RMS; or ''")
    made.add_argument("--make-physics", metavar="KIND", help="write one draw of a kind of physics")
    made.add_argument("--recording", type=int, default=0, help="which recording of the device, of --make-physics")
    made.add_argument("--make", metavar="CAUSES", help="write one draw: names joined by + or ','; or clean")
    made.add_argument("--bench", default="easy", choices=("easy", "hard"))
    made.add_argument("--strength", default="normal", choices=("normal", "weak"))
    made.add_argument("--protocol")
    made.add_argument("--structure")
    made.add_argument("-o", "--output", type=Path, help="JSON of the study, or CSV of the draw")
    return made


def _made(options: argparse.Namespace) -> Hidden:
    """The draw that is to be written."""
    if options.make_physics is not None:
        return draw_physics(options.make_physics, seed=options.seed, recording=options.recording)
    return draw(
        [one for one in options.make.replace(",", "+").split("+") if one not in ("", "clean")],
        seed=options.seed,
        bench=options.bench,
        strength=options.strength,
        protocol=options.protocol,
        structure=options.structure,
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    options = parser().parse_args(arguments)
    # a file or a pipe has no width of its own
    console = Console() if Console().is_terminal else Console(width=160)
    if options.make is not None or options.make_physics is not None:
        hidden = _made(options)
        if options.output is not None:
            hidden.write_csv(options.output)
        console.print_json(json.dumps(hidden.truth))
        return 0

    groups = [*GROUPS, *PHYSICS] if options.set == "all" else options.set.split(",")
    only = frozenset(one.strip() for one in options.only.split(",") if one.strip())
    todo: list[Job | PhysicsJob] = []
    for group in groups:
        drawn = physics_jobs if group in PHYSICS else jobs
        todo += drawn(group, draws=options.draws, seed=options.seed, only=only)
    asked = Asked(options.answerer, options.predictor)
    results = run(todo, asked=asked, processes=options.jobs, console=console)
    if options.output is not None:
        record = {
            "answerer": options.answerer,
            "seed": options.seed,
            "draws": options.draws,
            "confusion": {group: confusion(results, group) for group in groups},
            "results": [result.record() for result in results],
        }
        options.output.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    for group in groups:
        print_group(console, group, [result for result in results if result.job.group == group])
    intervals = [result.intervals for result in results if result.verdict == "right"]
    if any(intervals):
        console.print(coverage_table(intervals))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
