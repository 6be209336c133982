"""halltwin spinning: the spinning current phase by phase, the offset before and after, and the noise spectrum."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.report.plotting import style
from diagnosis.report.wording import plain
from scenarios.commands.outputs import PICTURE, TABLE, OutputFiles
from twin.confidence import Z95
from twin.hall.spinning_current import (
    PHASES,
    TYPICAL,
    Plate,
    Spinning,
    corner_and_error,
    density,
    residual_offset_mT,
    spin,
)
from twin.sweep_file import csv_text

SHOWN = 5
NOISE_CYCLES = 1 << 15


def run(folder: Path, *, seed: int, force: bool = False, field_mT: float = 5.0) -> None:
    """Write spinning.csv, the trace of a few cycles, spinning.png and .svg, and print the figures."""
    csv, png, svg = (folder / f"spinning.{ending}" for ending in ("csv", "png", "svg"))
    files = OutputFiles.checked([(csv, TABLE), (png, PICTURE), (svg, PICTURE)], force=force, folders=True)
    plate = TYPICAL
    rng = np.random.default_rng(seed)
    # Field off, on, off: what the output must follow.
    steps = np.repeat([0.0, field_mT, 0.0], SHOWN)
    traced = spin(steps, plate, rng)
    before, after = residual_offset_mT(plate)
    noisy = spin(np.zeros(NOISE_CYCLES), plate, rng)
    samples = {
        "time_us": 1e6 * traced.time_s,
        "plate_uV": traced.plate_uV,
        "amplified_uV": traced.amplified_uV,
        "demodulated_uV": traced.demodulated_uV,
        "output_mT": np.broadcast_to(traced.output_mT[:, None, None], traced.time_s.shape),
    }
    spectra = {
        name: density(values, plate.cycle_Hz)
        for name, values in (("without spinning", noisy.unspun_mT), ("with spinning", noisy.output_mT))
    }
    corners = {name: _stated(*corner_and_error(*spectrum), spectrum[0]) for name, spectrum in spectra.items()}
    figure = _figure(plate, traced, spectra, offsets=(before, after), corners=corners)
    trace = csv_text({name: values.ravel() for name, values in samples.items()})
    files.write({csv: trace, png: figure, svg: figure})
    told = [_two_digits(value) for value in (before, after, abs(before / after))]
    print(f"offset before {told[0]} mT, after {told[1]} mT: {told[2]} times smaller")
    for name, corner in corners.items():
        print(f"1/f corner {name}: {corner}")
    files.tell_written()


def _two_digits(value: float) -> str:
    """A figure that follows from the plate's, which are typical assumptions of one or two digits."""
    return plain(float(f"{value:.2g}"), 2)


def _stated(corner_Hz: float, error_Hz: float, frequency_Hz: np.ndarray) -> str:
    """A corner with half of its 95 % interval; below the lowest frequency of the spectrum it is only known to be."""
    lowest = frequency_Hz[0]
    if corner_Hz < lowest:
        return f"below {_two_digits(lowest)} Hz"
    half = Z95 * error_Hz
    digits = 1 - math.floor(math.log10(half))
    return f"{round(corner_Hz, digits):g} ±{round(half, digits):g} Hz"


def _figure(
    plate: Plate,
    traced: Spinning,
    spectra: dict[str, tuple[np.ndarray, np.ndarray]],
    *,
    offsets: tuple[float, float],
    corners: dict[str, str],
) -> Any:
    plt = style()
    figure, axes = plt.subplots(4, 1, figsize=(8.0, 11.0), layout="constrained")
    time = 1e6 * traced.time_s.ravel()
    axes[0].plot(time, traced.amplified_uV.ravel(), linewidth=0.8)
    axes[0].set(title="At the amplifier's output, input-referred, phase by phase; the field is on in the middle")
    axes[1].plot(time, traced.demodulated_uV.ravel(), linewidth=0.8)
    axes[1].set(title="After the demodulator: the field keeps its sign, the offset changes it from phase to phase")
    for axis in axes[:2]:
        axis.set(xlabel="time [us]", ylabel="voltage [uV]")
    cycle = 1e6 * traced.time_s.mean(axis=(1, 2))
    axes[2].plot(cycle, traced.unspun_mT, "o-", label=f"bias left in phase 0: offset {_two_digits(offsets[0])} mT")
    axes[2].plot(cycle, traced.output_mT, "o-", label=f"mean over a cycle: offset {_two_digits(offsets[1])} mT")
    axes[2].set(xlabel="time [us]", ylabel="output [mT]", title="Offset before and after spinning")
    for name, (frequency, power) in spectra.items():
        label = f"{name}: corner {corners[name]}"
        axes[3].loglog(frequency, 1e6 * np.sqrt(power), linewidth=0.8, label=label)
    axes[3].set(xlabel="frequency [Hz]", ylabel="noise [nT/sqrt(Hz)]", title="Noise of the output")
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.title.set_fontsize(9)
    for axis in axes[2:]:
        axis.legend(fontsize=8, loc="best")
    figure.suptitle(f"Spinning current, {PHASES} phases of {1e6 * plate.phase_s:g} us")
    plt.close(figure)
    return figure
