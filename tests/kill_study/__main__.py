"""The command: ``python -m tests.kill_study``."""

from __future__ import annotations

import argparse
import json
import signal
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from tests.kill_study.disks import can_mount, fill
from tests.kill_study.kills import kill
from tests.kill_study.pairs import pair
from tests.kill_study.trials import COMMANDS, Command, Trial, ended, write_inputs

KINDS = {"kill": "kill -9", "disk": "full disk", "pair": "two at once"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Try what is asked for; 0 where all is as promised, 1 where not."""
    names = [command.name for command in COMMANDS]
    parser = argparse.ArgumentParser(prog="python -m tests.kill_study", description="Is anything lost or ruined?")
    parser.add_argument("--only", action="append", choices=names, help="this command alone; may be given repeatedly")
    parser.add_argument("--kills", type=int, default=25, help="kills of each command (25)")
    parser.add_argument("--disks", type=int, default=10, help="fill levels of the disk (10)")
    parser.add_argument("--pairs", type=int, default=10, help="how often two are started in one folder (10)")
    parser.add_argument("-o", "--output", type=Path, metavar="JSON", help="write the trials to this file")
    asked = parser.parse_args(arguments)
    chosen = [command for command in COMMANDS if asked.only is None or command.name in asked.only]
    # An end by a signal leaves no files behind either; a shell's background jobs ignore interrupts unless told.
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, signal.default_int_handler)
    trials: list[Trial] = []
    try:
        with tempfile.TemporaryDirectory(prefix="kill-study-", ignore_cleanup_errors=True) as folder:
            complete = _try_all(chosen, Path(folder), asked, trials)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130
    if asked.output is not None:
        asked.output.write_text(json.dumps([asdict(trial) for trial in trials], indent=1) + "\n", encoding="utf-8")
    print(table(chosen, trials))
    return 0 if complete and all(trial.good for trial in trials) else 1


def _try_all(commands: Sequence[Command], work: Path, asked: argparse.Namespace, trials: list[Trial]) -> bool:
    """Every trial of every command, told as it ends; whether all could be tried."""

    def tell(trial: Trial) -> None:
        trials.append(trial)
        word = "ok " if trial.good else "BAD"
        print(f"{word} {trial.command:8} {KINDS[trial.kind]:11} {trial.done}: {trial.outcome}", flush=True)

    disks = asked.disks if asked.disks and can_mount() else 0
    if disks < asked.disks:
        print("full disks are not tried: this user may not mount one (unshare -rm, tmpfs)", file=sys.stderr)
    write_inputs(work)
    for command in commands:
        calm = work / f"{command.name}-calm"
        process = command.start(calm)
        command.wait_until_begun(process, calm)
        start = time.monotonic()
        first = ended(process)
        seconds = time.monotonic() - start
        if first.code != 0:
            print(f"{command.name} fails undisturbed: {first.last_line}", file=sys.stderr)
            return False
        print(f"    {command.name} works for {seconds:.1f} s undisturbed", flush=True)
        for number in range(asked.kills):
            kill(command, work, calm, number=number, seconds=seconds, tell=tell)
        if disks:
            fill(command, calm, levels=disks, tell=tell)
        for number in range(asked.pairs):
            pair(command, work, calm, number=number, tell=tell)
    return True


def table(commands: Sequence[Command], trials: Sequence[Trial]) -> str:
    """How many trials of each kind went as promised, and how."""
    lines = [f"{'':10} {'':11} {'tried':>5} {'equal':>6} {'refused':>8} {'bad':>4}"]
    for command in commands:
        for kind, words in KINDS.items():
            of = [trial for trial in trials if trial.command == command.name and trial.kind == kind]
            refused = sum(trial.outcome.startswith("refused") for trial in of if trial.good)
            bad = sum(not trial.good for trial in of)
            if of:
                equal = len(of) - refused - bad
                lines.append(f"{command.name:10} {words:11} {len(of):5} {equal:6} {refused:8} {bad:4}")
    return "\n".join(lines)


if __name__ == "__main__":
    raise SystemExit(main())
