"""halltwin simulate: a sweep as the bench would record it, from a twin file or a preset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.commands.coast import Coast
from scenarios.commands.outputs import PICTURE, SWEEP, TABLE, OutputFiles
from scenarios.commands.protocol import Protocol
from scenarios.commands.trace import trace, trace_text
from scenarios.commands.trace_plot import trace_figure
from twin.air_gap import at_air_gap
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.chain import Chain
from twin.extensions import effects_with
from twin.hall.noise import NOISE
from twin.motion import Motion
from twin.presets import read_twin_or_preset
from twin.reference.encoder import Encoder
from twin.shown_name import shown_name
from twin.sweep import Sweep
from twin.sweep_file import csv_text
from twin.turned_sensor import with_sensor_turned


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """Files to write: the sweep, and where asked for the intermediate signals as a table and as a picture.

    Without ``reference``, the sweep is the log of a bench that has none. ``force``: also in place of files of others.
    """

    sweep: Path
    trace: Path | None = None
    plot: Path | None = None
    reference: bool = True
    force: bool = False


@dataclass(frozen=True, kw_only=True)
class Instead:
    """What is other than the twin says: lines of the reference encoder, air gap [mm], the sensor's turn about the shaft
    [deg], white noise of a reading [deg RMS]; None: as there."""

    reference_lines: int | None = None
    air_gap_mm: float | None = None
    mounting_deg: float | None = None
    noise_deg: float | None = None

    def of(self, chain: Chain) -> Chain:
        """The twin as it is then: the same device at that gap."""
        if self.air_gap_mm is not None:
            chain = at_air_gap(chain, self.air_gap_mm)
        if self.reference_lines is not None:
            chain = replace(chain, encoder=replace(chain.encoder or Encoder(), lines=self.reference_lines))
        if self.noise_deg is not None:
            # Its colour and what it depends on go with it.
            chain = chain.without(NOISE.name).with_effect(NOISE.name, rms_deg=self.noise_deg)
        return chain

    def turned(self, chain: Chain, motion: Motion) -> tuple[Chain, Motion]:
        """The twin and its motion with the sensor turned, where that was asked for."""
        return (chain, motion) if self.mounting_deg is None else with_sensor_turned(chain, motion, self.mounting_deg)

    def stated(self, sweep: Sweep) -> Sweep:
        """The sweep with air gap and mounting in columns of their own, where they were asked for."""
        asked = {"air_gap_mm": self.air_gap_mm, "mounting_deg": self.mounting_deg}
        told: dict[str, Any] = {name: np.full(len(sweep), value) for name, value in asked.items() if value is not None}
        return replace(sweep, **told) if told else sweep


_AS_IT_IS = Instead()
_OF_A_REFERENCE = ("reference_deg", "turn")
"""Columns that no bench without a reference has."""


def run(
    twin: str,
    outputs: Outputs,
    *,
    recorded: Path | None,
    protocol: Protocol | Coast,
    seed: int,
    instead: Instead = _AS_IT_IS,
    effect_files: Sequence[Path] = (),
    max_bytes: int = LARGEST_SWEEP_BYTES,
) -> None:
    """Simulate on the protocol, or on the motion of a recorded sweep, and write what was asked for."""
    files = OutputFiles.checked(
        [(outputs.sweep, SWEEP), (outputs.trace, TABLE), (outputs.plot, PICTURE)],
        inputs=[twin, recorded, *effect_files],
        force=outputs.force,
    )
    chain = instead.of(read_twin_or_preset(twin, effects=effects_with(effect_files)))
    # A recorded motion holds the reference's readings: the shaft is where its errors are undone.
    motion = protocol.motion() if recorded is None else chain.shaft(Sweep.read(recorded, max_bytes=max_bytes).motion())
    chain, motion = instead.turned(chain, motion)
    sweep = instead.stated(chain.simulate(motion, seed=seed))
    columns = {
        name: values for name, values in sweep.columns.items() if outputs.reference or name not in _OF_A_REFERENCE
    }
    contents: dict[Path | None, Any] = {outputs.sweep: lambda: csv_text(columns)}
    if outputs.trace is not None or outputs.plot is not None:
        traced = trace(chain, motion, seed=seed)
        contents |= {
            outputs.trace: lambda: trace_text(traced),
            outputs.plot: lambda: trace_figure(traced, title=f"{shown_name(twin).removesuffix('.toml')}, seed {seed}"),
        }
    files.write(contents)
    files.tell_written({outputs.sweep: f"{len(motion)} readings"})
