"""Mutations tried in copies of the tree: one copy a worker, one mutation at a time, its tests run there."""

from __future__ import annotations

import contextlib
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.mutations.mutation import ROOT, Mutation

COPIED = ("twin", "diagnosis", "scenarios", "tests", "pyproject.toml", "README.md")
BEING_WRITTEN = shutil.ignore_patterns("*.pyc.*")
"""What Python is compiling in the tree just now has such a name for a moment; a copy would find it gone."""
LONGEST_S = 600.0
"""Tests of one mutation that take longer are stopped: the mutation is then an error, neither killed nor survived."""
KILLED, SURVIVED, ERROR = "killed", "survived", "error"
_VERDICTS = {0: SURVIVED, 1: KILLED}
"""By pytest's exit status; any other (nothing collected, a wrong node id, a file that no longer parses) is an error."""


@dataclass(frozen=True)
class Outcome:
    """What became of a mutation: killed, survived or error, after how long, and the end of what pytest said."""

    mutation: Mutation
    result: str
    seconds: float
    said: str


class Copies:
    """Copies of the tree, one a worker, in one temporary folder; used as a context, it leaves nothing behind."""

    def __init__(self, root: Path = ROOT) -> None:
        self._root = root
        self._folder = tempfile.TemporaryDirectory(prefix="mutations-")
        self._running: set[subprocess.Popen[str]] = set()
        self._lock = threading.Lock()
        self._stopped = False

    def __enter__(self) -> Copies:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
        self._folder.cleanup()

    def new(self) -> Path:
        """The root of one more copy."""
        copy = Path(tempfile.mkdtemp(dir=self._folder.name))
        for name in COPIED:
            source = self._root / name
            if source.is_dir():
                shutil.copytree(source, copy / name, ignore=BEING_WRITTEN)
            elif source.exists():
                shutil.copy2(source, copy / name)
        return copy

    def pytest(self, copy: Path, tests: Sequence[str], *, longest_s: float) -> tuple[int | None, str]:
        """Exit status (None: stopped after ``longest_s``) and output of these tests in a copy, up to the first failure.

        Nothing compiled is written, so that no copy holds what a mutation before it was compiled to.
        """
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--no-header", *tests]
        environment = {
            **os.environ,
            "PYTHONPATH": str(copy),
            "PYTHONDONTWRITEBYTECODE": "1",
            "OPENBLAS_NUM_THREADS": "1",
            "PYTEST_ADDOPTS": "",
            # Those of other packages are not needed, and may take longer to import than the tests to run.
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
        }
        with self._lock:
            if self._stopped:
                return None, "stopped"
            process = subprocess.Popen(
                command,
                cwd=copy,
                env=environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                start_new_session=True,
            )
            self._running.add(process)
        try:
            said, _ = process.communicate(timeout=longest_s)
        except subprocess.TimeoutExpired:
            _kill(process)
            said, _ = process.communicate()
            return None, said
        finally:
            with self._lock:
                self._running.discard(process)
        return process.returncode, said

    def stop(self) -> None:
        """End every test that still runs; none is begun any more."""
        with self._lock:
            self._stopped = True
            for process in self._running:
                _kill(process)


def _kill(process: subprocess.Popen[str]) -> None:
    """End a process and all it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def try_one(copies: Copies, copy: Path, mutation: Mutation, *, longest_s: float = LONGEST_S) -> Outcome:
    """Apply a mutation to a copy, run its tests, and put the copy's file back."""
    started = time.monotonic()
    before = mutation.apply_to(copy)
    file = copy / mutation.file
    # What the file was compiled to when the tree was copied might pass for the mutated one: same size, same second.
    for compiled in (file.parent / "__pycache__").glob(f"{file.stem}.*"):
        compiled.unlink()
    try:
        status, said = copies.pytest(copy, mutation.tests, longest_s=longest_s)
    finally:
        file.write_text(before, encoding="utf-8")
    result = ERROR if status is None else _VERDICTS.get(status, ERROR)
    return Outcome(mutation, result, time.monotonic() - started, said)


def try_all(
    mutations: Iterable[Mutation],
    *,
    root: Path = ROOT,
    workers: int = 1,
    done: Callable[[Outcome], None] = lambda outcome: None,
    longest_s: float = LONGEST_S,
) -> list[Outcome]:
    """Try every mutation; ``done`` is told of each as it ends. The outcomes stand in the order of the mutations."""
    wanted = list(mutations)
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    for place in range(len(wanted)):
        waiting.put(place)
    ended: queue.SimpleQueue[tuple[int, Outcome] | BaseException] = queue.SimpleQueue()

    with Copies(root) as copies:

        def work() -> None:
            try:
                copy = copies.new()
                with contextlib.suppress(queue.Empty):
                    while True:
                        place = waiting.get_nowait()
                        ended.put((place, try_one(copies, copy, wanted[place], longest_s=longest_s)))
            except BaseException as failure:
                ended.put(failure)

        threads = [threading.Thread(target=work, daemon=True) for _ in range(min(workers, len(wanted)))]
        for thread in threads:
            thread.start()
        found: dict[int, Outcome] = {}
        try:
            while len(found) < len(wanted):
                item = ended.get()
                if isinstance(item, BaseException):
                    raise item
                found[item[0]] = item[1]
                done(item[1])
        finally:
            copies.stop()
            for thread in threads:
                thread.join()
    return [found[place] for place in range(len(wanted))]


def fail_unmutated(mutations: Iterable[Mutation], *, root: Path = ROOT) -> str | None:
    """What pytest says of the named tests in a tree without a mutation; None where all pass.

    A test that fails anyway notices nothing.
    """
    tests = list(dict.fromkeys(test for mutation in mutations for test in mutation.tests))
    with Copies(root) as copies:
        status, said = copies.pytest(copies.new(), tests, longest_s=LONGEST_S)
    return None if status == 0 else said
