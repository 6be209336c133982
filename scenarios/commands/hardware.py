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
from twin.chain import Chain
from twin.extensions import effects_with
from twin.hall.spinning_current import residual_offset_mT
from twin.hardware import Run, run
from twin.presets import read_twin_or_preset
from twin.sweep_file import csv_text


def run_command(twin: str, folder: Path, *, effect_files: Sequence[Path] = (), force: bool = False, seed: int) -> None:
    """Write hardware.csv, hardware.png and .svg: the signals of a twin's chain as built, on one turn."""
    csv, png, svg = (folder / f"hardware.{ending}" for ending in ("csv", "png", "svg"))
    files = OutputFiles.checked(
        [(csv, TABLE), (png, PICTURE), (svg, PICTURE)], inputs=[twin, *effect_files], force=force, folders=True
    )
    chain = read_twin_or_preset(twin, effects=effects_with(effect_files))
    motion = Protocol().motion()
    rng = np.random.default_rng(seed)
    signals = run(chain, motion, rng)
    shaft, reference = np.degrees(motion.shaft_rad), np.degrees(chain.recorded_reference(motion, rng))
    columns = table(chain, signals, shaft, reference)
    figure = _figure(columns)
    files.write({csv: csv_text(columns), png: figure, svg: figure})
    for axis, plate in zip("xy", chain.parts.plates, strict=True):
        before, after = residual_offset_mT(plate)
        left = f"{after:.4g} mT after it" if plate.spun else "which stay: its bias does not spin"
        print(f"plate {axis}: offset {before:.4g} mT before spinning, {left}")
    bits = signals.bits
    print(f"field in the plane {chain.nominal_mT:.4g} mT; {int(signals.sound.sum())} sound frames of {bits} bit")
    print(f"largest error {np.max(np.abs(columns['error_deg'])):.4g} deg")
    files.tell_written()


def table(chain: Chain, signals: Run, shaft_deg: Array, reference_deg: Array) -> dict[str, Array]:
    """Every signal (n,) by name and unit, in the order of the chain; the error is against the reference's reading.

    A converter without a word length has no codes, and they no columns.
    """
    columns = {"shaft_deg": shaft_deg, "reference_deg": reference_deg}
    for row, axis in enumerate("xy"):
        columns[f"in_plane_{axis}_mT"] = signals.in_plane_mT[row]
        columns[f"vertical_{axis}_mT"] = signals.vertical_mT[row]
        columns[f"unspun_{axis}_mT"] = signals.unspun_mT[row]
        columns[f"spun_{axis}_mT"] = signals.spun_mT[row]
        columns[f"voltage_{axis}_uV"] = signals.voltage_uV[row]
        columns[f"amplitude_{axis}_1"] = signals.amplitude[row]
        if signals.codes is not None:
            columns[f"code_{axis}_lsb"] = signals.codes[row].astype(np.float64)
    columns["cordic_deg"] = np.degrees(signals.computed_rad)
    columns["word_lsb"] = signals.words.astype(np.float64)
    columns["received_deg"] = np.asarray(np.degrees(signals.received_rad), dtype=np.float64)
    slope = chain.sensor_sense * chain.output_sense
    columns["error_deg"] = wrap_deg(columns["received_deg"] - slope * reference_deg)
    return columns


def _figure(columns: dict[str, Array]) -> Any:
    plt = style()
    figure, axes = plt.subplots(3, 2, figsize=(10.0, 9.0), sharex=True, layout="constrained")
    across = columns["shaft_deg"]
    coded = "code_x_lsb" in columns
    name, unit = ("code_{axis}_lsb", "code [LSB]") if coded else ("amplitude_{axis}_1", "nominal amplitudes")
    arctangent = np.arctan2(columns[name.format(axis="y")], columns[name.format(axis="x")])
    panels: list[tuple[str, str, dict[str, Array]]] = [
        ("magnet", "field in the plane [mT]", {axis: columns[f"in_plane_{axis}_mT"] for axis in "xy"}),
        ("concentrator", "vertical field [mT]", {axis: columns[f"vertical_{axis}_mT"] for axis in "xy"}),
        (
            "Hall plates, with the effects of their stage",
            "output minus field [mT]",
            {
                f"{axis}, {name}": columns[f"{kind}_{axis}_mT"] - columns[f"vertical_{axis}_mT"]
                for kind, name in (("unspun", "without spinning"), ("spun", "as built"))
                for axis in "xy"
            },
        ),
        ("converter", unit, {axis: columns[name.format(axis=axis)] for axis in "xy"}),
        (
            "CORDIC",
            "angle minus arctangent of its input [deg]",
            {"CORDIC": wrap_deg(columns["cordic_deg"] - np.degrees(arctangent))},
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
