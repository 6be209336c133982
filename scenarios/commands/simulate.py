"""halltwin simulate: a sweep as the bench would record it, from a twin file or a preset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from scenarios.commands.outputs import PICTURE, SWEEP, TABLE, OutputFiles
from scenarios.commands.protocol import Protocol
from scenarios.commands.trace import trace, trace_text
from scenarios.commands.trace_plot import trace_figure
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.extensions import effects_with
from twin.presets import read_twin_or_preset
from twin.reference.encoder import Encoder
from twin.shown_name import shown_name
from twin.sweep import Sweep
from twin.sweep_file import csv_text


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """Files to write: the sweep, and where asked for the intermediate signals as a table and as a picture.

    ``force``: also in place of files of others.
    """

    sweep: Path
    trace: Path | None = None
    plot: Path | None = None
    force: bool = False


def run(
    twin: str,
    outputs: Outputs,
    *,
    recorded: Path | None,
    protocol: Protocol,
    seed: int,
    reference_lines: int | None = None,
    effect_files: Sequence[Path] = (),
    max_bytes: int = LARGEST_SWEEP_BYTES,
) -> None:
    """Simulate on the protocol, or on the motion of a recorded sweep, and write what was asked for.

    ``reference_lines``: lines of the reference encoder, in place of those of the twin's [reference]; None: as there.
    """
    files = OutputFiles.checked(
        [(outputs.sweep, SWEEP), (outputs.trace, TABLE), (outputs.plot, PICTURE)],
        inputs=[twin, recorded, *effect_files],
        force=outputs.force,
    )
    chain = read_twin_or_preset(twin, effects=effects_with(effect_files))
    if reference_lines is not None:
        chain = replace(chain, encoder=replace(chain.encoder or Encoder(), lines=reference_lines))
    # A recorded motion holds the reference's readings: the shaft is where its errors are undone.
    motion = protocol.motion() if recorded is None else chain.shaft(Sweep.read(recorded, max_bytes=max_bytes).motion())
    sweep = chain.simulate(motion, seed=seed)
    contents: dict[Path | None, Any] = {outputs.sweep: lambda: csv_text(sweep.columns)}
    if outputs.trace is not None or outputs.plot is not None:
        traced = trace(chain, motion, seed=seed)
        contents |= {
            outputs.trace: lambda: trace_text(traced),
            outputs.plot: lambda: trace_figure(traced, title=f"{shown_name(twin).removesuffix('.toml')}, seed {seed}"),
        }
    files.write(contents)
    files.tell_written({outputs.sweep: f"{len(motion)} readings"})
