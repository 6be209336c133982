"""halltwin simulate: a sweep as the bench would record it, from a twin file or a preset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from scenarios.commands.protocol import Protocol
from twin.extensions import effects_with
from twin.presets import read_twin_or_preset
from twin.reference.encoder import Encoder
from twin.sweep import Sweep


def run(
    twin: str,
    output: Path,
    *,
    recorded: Path | None,
    protocol: Protocol,
    seed: int,
    reference_lines: int | None = None,
    trace_path: Path | None = None,
    plot_path: Path | None = None,
    effect_files: Sequence[Path] = (),
) -> None:
    """Simulate on the protocol, or on the motion of a recorded sweep, and write what was asked for.

    ``reference_lines``: lines of the reference encoder, in place of those of the twin's [reference]; None: as there.
    """
    chain = read_twin_or_preset(twin, effects=effects_with(effect_files))
    if reference_lines is not None:
        chain = replace(chain, encoder=replace(chain.encoder or Encoder(), lines=reference_lines))
    # A recorded motion holds the reference's readings: the shaft is where its errors are undone.
    motion = protocol.motion() if recorded is None else chain.shaft(Sweep.read(recorded).motion())
    sweep = chain.simulate(motion, seed=seed)
    sweep.write(output)
    print(f"wrote {output} ({len(motion)} readings)")
    if trace_path is None and plot_path is None:
        return
    from scenarios.commands.trace import plot_trace, trace, write_trace

    traced = trace(chain, motion, seed=seed)
    if trace_path is not None:
        write_trace(trace_path, traced)
        print(f"wrote {trace_path}")
    if plot_path is not None:
        plot_trace(plot_path, traced, title=f"{Path(twin).stem}, seed {seed}")
        print(f"wrote {plot_path}")
