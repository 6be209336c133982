"""halltwin simulate: a sweep as the bench would record it, from a twin file or a preset."""

from __future__ import annotations

from pathlib import Path

from scenarios.protocol import Protocol
from twin.presets import read_twin_or_preset
from twin.sweep import Sweep


def run(
    twin: str,
    output: Path,
    *,
    recorded: Path | None,
    protocol: Protocol,
    seed: int,
    trace_path: Path | None = None,
    plot_path: Path | None = None,
) -> None:
    """Simulate on the protocol, or on the motion of a recorded sweep, and write what was asked for."""
    chain = read_twin_or_preset(twin)
    # A recorded motion holds the reference's readings: the shaft is where its errors are undone.
    motion = protocol.motion() if recorded is None else chain.shaft(Sweep.read(recorded).motion())
    chain.simulate(motion, seed=seed).write(output)
    print(f"wrote {output} ({len(motion)} readings)")
    if trace_path is None and plot_path is None:
        return
    from scenarios.trace import plot_trace, trace, write_trace

    traced = trace(chain, motion, seed=seed)
    if trace_path is not None:
        write_trace(trace_path, traced)
        print(f"wrote {trace_path}")
    if plot_path is not None:
        plot_trace(plot_path, traced, title=f"{Path(twin).stem}, seed {seed}")
        print(f"wrote {plot_path}")
