"""``halltwin doctor``: what is wrong with the set-up of a recording, before anything is asked of its physics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from diagnosis.report.provenance import Provenance
from diagnosis.report.setup_words import columns_line, setup_block
from diagnosis.setup.checks import KINDS, Checked
from diagnosis.setup.of_log import LogRecord, read_record, with_pole_pairs
from diagnosis.setup.several_readings import checked_log
from scenarios.commands.fail_on import DOCTOR, asked, in_setup, raise_found
from scenarios.commands.outputs import JSON, OutputFiles, json_text
from twin.logs.others import target_of
from twin.shown_name import shown_name

SCHEMA = "halltwin.doctor/1"


def run(
    log: Path,
    *,
    columns: str | None = None,
    pole_pairs: int | None = None,
    json: Path | None = None,
    force: bool = False,
    max_bytes: int,
    fail_on: Sequence[str] = (),
    command: str | None = None,
) -> None:
    """Read a log, check its set-up, print what is wrong. Raises UserError for a log that holds no table of numbers."""
    words = asked(fail_on, (*DOCTOR, *KINDS))
    files = OutputFiles.checked([(json, JSON)], inputs=[log], force=force)
    read = read_record(log, name=shown_name(log), columns=columns, max_bytes=max_bytes)
    if pole_pairs is not None:
        read = with_pole_pairs(read, pole_pairs)
    answer = to_dict(read, checked_log(read), Provenance.today(seed=0, command=command))
    try:
        show(answer)
    finally:
        files.write({json: lambda: json_text(answer)})
    files.tell_written()
    raise_found(words, in_setup(answer))


def to_dict(read: LogRecord, found: Checked, made: Provenance) -> dict[str, Any]:
    """The answer as plain values."""
    record = read.record
    return {
        "schema": SCHEMA,
        **made.to_dict(),
        "log": {
            "name": record.name,
            "rows": int(record.numbers.size),
            "columns": list(record.columns),
            "read_as": None if read.otherwise else read.read_as,
            "read": list(read.read),
            "notes": list(read.notes),
            "not_used": list(read.unused),
            "refused": read.refused or None,
        },
        "setup": [finding.to_dict() for finding in found.findings],
        "not_checked": {kind: list(lacking) for kind, lacking in found.not_checked.items()},
    }


def show(answer: Mapping[str, Any]) -> None:
    """Print an answer: the log, what is wrong with it, what could not be checked."""
    console = Console(highlight=False)
    log = answer["log"]
    read = "; ".join([f"{log['rows']} rows", *log["read"]])
    console.print(Text.assemble((log["name"], "bold"), f"   {read}"))
    if log["read_as"]:
        console.print(columns_line(log["read_as"], inset=2, before="read as: "), soft_wrap=True)
    lines = [f"taken for granted: {note}" for note in log["notes"]]
    if log["not_used"]:
        lines.append(f"not used: {', '.join(log['not_used'])}")
    for line in lines:
        console.print(Padding(Text(line), (0, 0, 0, 2)))
    console.print()
    console.print(setup_block(answer["setup"], _title(answer)), crop=False)
    lacking = _lacking(answer["not_checked"], log["not_used"])
    if lacking:
        console.print()
        console.print(Text(f"Not checked: {lacking}"))


def _title(answer: Mapping[str, Any]) -> str:
    faults = sum(found["level"] == "fault" for found in answer["setup"])
    notes = len(answer["setup"]) - faults
    if not answer["setup"]:
        return "Set-up: nothing wrong found"
    parts = [
        f"{count} {word}{'s' if count > 1 else ''}" for count, word in ((faults, "fault"), (notes, "note")) if count
    ]
    return f"Set-up: {' and '.join(parts)}"


def _lacking(not_checked: Mapping[str, Sequence[str]], not_used: Sequence[str]) -> str:
    """What could not be checked, by what is lacking; what the log holds and is not used for it bears its own name."""
    # Behind the name of a column stands in brackets why it is not used.
    held = {target_of(name): name for name in (one.partition(" (")[0] for one in not_used)}
    by_column: dict[str, list[str]] = {}
    for kind, lacking in not_checked.items():
        unread = [held[name] for name in lacking if name in held]
        why = f"{', '.join(unread)} not used, see above" if unread else f"no {', '.join(lacking)}"
        by_column.setdefault(why, []).append(kind)
    return "; ".join(f"{', '.join(kinds)} ({why})" for why, kinds in by_column.items())
