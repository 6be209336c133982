"""halltwin hardware: the paper's Fig. 2 end to end on one turn, every signal with its unit, as table and picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.report.plotting import style
from scenarios.commands.outputs import PICTURE, TABLE, OutputFiles
from scenarios.commands.protocol import Protocol
from twin.angles import Array, wrap_deg
from twin.cordic.bit_true import angle_rad
from twin.extensions import effects_with
from twin.hall.spinning_current import residual_offset_mT
from twin.hardware import Hardware, Run, run
from twin.magnet.assembly import Assembly
from twin.presets import read_twin_or_preset
from twin.sweep_file import csv_text


def run_command(twin: str, folder: Path, *, effect_files: Sequence[Path] = (), force: bool = False, seed: int) -> None:
    """Write hardware.csv, hardware.png and .svg for a twin's magnet, disk, plates and reference; the rest typical."""
    csv, png, svg = (folder / f"hardware.{ending}" for ending in ("csv", "png", "svg"))
    files = OutputFiles.checked(
        [(csv, TABLE), (png, PICTURE), (svg, PICTURE)], inputs=[twin, *effect_files], force=force, folders=True
    )
    chain = read_twin_or_preset(twin, effects=effects_with(effect_files))
    disk, plate = chain.parts.disk, chain.parts.plate
    hardware = Hardware(assembly=chain.magnet or Assembly(), disk=disk, plates=(plate, plate))
    motion = Protocol().motion()
    rng = np.random.default_rng(seed)
    signals = run(hardware, motion, rng)
    shaft, reference = np.degrees(motion.shaft_rad), np.degrees(chain.recorded_reference(motion, rng))
    columns = table(hardware, signals, shaft, reference)
    figure = _figure(columns)
    files.write({csv: csv_text(columns), png: figure, svg: figure})
    for axis, plate in zip("xy", hardware.plates, strict=True):
        before, after = residual_offset_mT(plate)
        print(f"plate {axis}: offset {before:.4g} mT before spinning, {after:.4g} mT after it")
    print(f"field in the plane {hardware.assembly.nominal_mT:.4g} mT; {int(signals.sound.sum())} sound frames")
    print(f"largest error {np.max(np.abs(columns['error_deg'])):.4g} deg")
    files.tell_written()


def table(hardware: Hardware, signals: Run, shaft_deg: Array, reference_deg: Array) -> dict[str, Array]:
    """Every signal (n,) by name and unit, in the order of the chain; the error is against the reference's reading."""
    columns = {"shaft_deg": shaft_deg, "reference_deg": reference_deg}
    for row, axis in enumerate("xy"):
        columns[f"in_plane_{axis}_mT"] = signals.in_plane_mT[row]
        columns[f"vertical_{axis}_mT"] = signals.vertical_mT[row]
        columns[f"unspun_{axis}_mT"] = signals.spun[row].unspun_mT
        columns[f"spun_{axis}_mT"] = signals.spun[row].output_mT
        columns[f"code_{axis}_lsb"] = signals.codes[row].astype(np.float64)
    columns["cordic_deg"] = np.degrees(angle_rad(signals.cordic_words, hardware.cordic.angle_bits))
    columns["word_lsb"] = signals.words.astype(np.float64)
    columns["received_deg"] = np.asarray(np.degrees(signals.received_rad), dtype=np.float64)
    columns["error_deg"] = wrap_deg(columns["received_deg"] - reference_deg)
    return columns


def _figure(columns: dict[str, Array]) -> Any:
    plt = style()
    figure, axes = plt.subplots(3, 2, figsize=(10.0, 9.0), sharex=True, layout="constrained")
    across = columns["shaft_deg"]
    panels: list[tuple[str, str, dict[str, Array]]] = [
        ("magnet", "field in the plane [mT]", {axis: columns[f"in_plane_{axis}_mT"] for axis in "xy"}),
        ("concentrator", "vertical field [mT]", {axis: columns[f"vertical_{axis}_mT"] for axis in "xy"}),
        (
            "spinning current",
            "output minus field [mT]",
            {
                f"{axis}, {name}": columns[f"{kind}_{axis}_mT"] - columns[f"vertical_{axis}_mT"]
                for kind, name in (("unspun", "before"), ("spun", "after"))
                for axis in "xy"
            },
        ),
        ("converter", "code [LSB]", {axis: columns[f"code_{axis}_lsb"] for axis in "xy"}),
        (
            "CORDIC",
            "angle minus that of the codes [deg]",
            {
                "integer CORDIC": wrap_deg(
                    columns["cordic_deg"] - np.degrees(np.arctan2(columns["code_y_lsb"], columns["code_x_lsb"]))
                )
            },
        ),
        ("link", "reading minus reference [deg]", {"received": columns["error_deg"]}),
    ]
    for axis, (title, label, curves) in zip(axes.flat, panels, strict=True):
        for dashes, (name, values) in zip(("-", "--", "-", "--"), curves.items(), strict=False):
            axis.plot(across, values, dashes, linewidth=0.9, label=name)
        axis.set(title=title, ylabel=label)
        axis.grid(alpha=0.3)
        if len(curves) > 1:
            axis.legend(fontsize=8, ncols=2, loc="center right" if len(curves) > 2 else "upper center")
    for axis in axes[-1]:
        axis.set_xlabel("shaft angle [deg]")
    plt.close(figure)
    return figure
