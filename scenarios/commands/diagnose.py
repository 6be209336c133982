"""``halltwin diagnose``: the paper's error factors of one or many sweeps, with what each figure is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from diagnosis import diagnose_many
from scenarios.commands.error_band import band_deg
from scenarios.commands.fail_on import DIAGNOSE, asked, in_diagnoses, raise_found
from scenarios.commands.inputs import SweepFiles, check_panels
from scenarios.commands.known import Known
from scenarios.commands.outputs import JSON, PICTURE, OutputFiles, json_text
from scenarios.commands.progress import progress_line
from scenarios.commands.terminal import terminal_width


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """What to write; None where not asked for. ``force``: also in place of files of others."""

    json: Path | None = None
    plot: Path | None = None
    convergence: Path | None = None
    force: bool = False


def run(
    given: SweepFiles,
    *,
    outputs: Outputs | None = None,
    known: Known | None = None,
    seed: int = 0,
    band: str | None = None,
    swarm: bool = False,
    fail_on: Sequence[str] = (),
    command: str | None = None,
) -> None:
    """Diagnose what the names stand for; print the answer; write JSON and pictures where asked.

    A picture of the swarm asks for it.
    """
    words = asked(fail_on, DIAGNOSE)
    delta_e_deg = None if band is None else band_deg(band)
    arguments = (known or Known()).arguments()
    paths = given.paths()
    to = outputs or Outputs()
    wanted = [(to.json, JSON), (to.plot, PICTURE), (to.convergence, PICTURE)]
    files = OutputFiles.checked(wanted, inputs=[*paths, band, known.twin if known else None], force=to.force)
    read = given.read(paths)
    check_panels(to.plot, len(read.sweeps))
    with progress_line() as listener:
        asked_for = swarm or to.convergence is not None
        found = diagnose_many(
            read.sweeps, seed=seed, band_deg=delta_e_deg, progress=listener, swarm=asked_for, **arguments
        )
    found = replace(found, made=replace(found.made, command=command))
    answer = {**found.to_dict(), "unusable": read.listed()}
    try:
        for line in (found.summary(terminal_width()), *read.lines):
            print(line)
    finally:
        files.write({to.json: lambda: json_text(answer), to.plot: found.plot, to.convergence: found.plot_convergence})
    files.tell_written()
    raise_found(words, in_diagnoses(answer))
    read.raise_unusable()
