"""halltwin simulate: a sweep as the bench would record it, from a twin file or a preset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from scenarios.commands.protocol import Protocol
from twin.extensions import effects_with
from twin.presets import read_twin_or_preset
from twin.reference.encoder import Encoder
from twin.sweep import Sweep


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """Files to write: the sweep, and where asked for the intermediate signals as a table and as a picture."""

    sweep: Path
    trace: Path | None = None
    plot: Path | None = None


def run(
    twin: str,
    outputs: Outputs,
    *,
    recorded: Path | None,
    protocol: Protocol,
    seed: int,
    reference_lines: int | None = None,
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
    sweep.write(outputs.sweep)
    print(f"wrote {outputs.sweep} ({len(motion)} readings)")
    if outputs.trace is None and outputs.plot is None:
        return
    from scenarios.commands.trace import plot_trace, trace, write_trace

    traced = trace(chain, motion, seed=seed)
    if outputs.trace is not None:
        write_trace(outputs.trace, traced)
        print(f"wrote {outputs.trace}")
    if outputs.plot is not None:
        plot_trace(outputs.plot, traced, title=f"{Path(twin).stem}, seed {seed}")
        print(f"wrote {outputs.plot}")
