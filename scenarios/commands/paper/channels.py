"""Figures 3 to 9 of the paper: what each factor of the channels, the converter and the CORDIC do, from the twin."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenarios.commands.paper.disk_curve import PRINTED_NL_MT, PRINTED_UP_TO_MT, disk_curve
from scenarios.commands.paper.table_1 import cordic_error, non_linear, offset_of, whole_turn
from twin.adc.converter import Converter, convert
from twin.angles import Array
from twin.chain import Chain
from twin.hall.gain_mismatch import GAIN_MISMATCH
from twin.hall.phase import PHASE

Columns = dict[str, Array]
TURN = whole_turn(360)
ANGLE_DEG = np.degrees(TURN.shaft_rad)


def _error_deg(chain: Chain) -> Array:
    return np.degrees(chain.error(TURN))


def offsets(plt: Any) -> tuple[Any, Columns]:
    """Fig. 3: the error for offsets of one axis, of orders of magnitude, and of both."""
    panels: dict[str, list[tuple[str, float, float]]] = {
        "orders of magnitude, both axes": [(f"{mv:g} mV", mv, mv) for mv in (0.01, 0.1, 1.0, 10.0)],
        "x axis": [(f"{mv:g} mV", mv, 0.0) for mv in (1.0, 2.0, 3.0)],
        "y axis": [(f"{mv:g} mV", 0.0, mv) for mv in (1.0, 2.0, 3.0)],
        "both axes": [(f"x {x:g} mV, y {y:g} mV", x, y) for x, y in ((1.0, 1.0), (1.0, 2.0), (2.0, 1.0), (2.0, 2.0))],
    }
    figure, axes = plt.subplots(2, 2, figsize=(9.0, 6.5), layout="constrained")
    columns = {"angle_deg": ANGLE_DEG}
    for axis, (title, curves) in zip(axes.flat, panels.items(), strict=True):
        for label, x, y in curves:
            error = _error_deg(offset_of(x, y))
            axis.plot(ANGLE_DEG, error, label=label)
            columns[f"error_x_{x:g}mV_y_{y:g}mV_deg"] = error
        _label(axis, title, "angle [deg]", "error [deg]", legend="offset, amplitude 1 V")
    axes[0, 0].set_yscale("symlog", linthresh=1e-3)
    return figure, columns


def gain(plt: Any) -> tuple[Any, Columns]:
    """Fig. 4: the error over angle and gain mismatch."""
    percents = np.linspace(0.0, 1.0, 21)
    chains = [Chain().with_effect(GAIN_MISMATCH.name, ratio=1.0 + 0.01 * percent) for percent in percents]
    return _surface(plt, percents, chains, "gain mismatch [%]", "mismatch_percent")


def phase(plt: Any) -> tuple[Any, Columns]:
    """Fig. 5: the error over angle and phase deviation."""
    degrees = np.linspace(0.0, 0.5, 21)
    chains = [Chain().with_effect(PHASE.name, beta_deg=beta) for beta in degrees]
    return _surface(plt, degrees, chains, "phase deviation [deg]", "beta_deg")


def field_and_voltage(plt: Any) -> tuple[Any, Columns]:
    """Fig. 6: output voltage against field, of the concentrator's disk; and the quadratic that Eq. 2 fits to it."""
    curve = disk_curve()
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.0), layout="constrained")
    axes[0].plot(curve.field_mT, curve.deviation_mT, label="the disk")
    axes[0].plot(curve.field_mT, curve.fitted_deviation_mT, "--", label="quadratic fitted to it (Eq. 2)")
    axes[0].plot(PRINTED_UP_TO_MT, -PRINTED_NL_MT, "k*", label="0.5 mT up to 80 mT, as printed")
    _label(axes[0], "behind a straight line of the slope at zero", "field in the plane [mT]", "deviation [mT]")
    axes[1].plot(curve.field_mT, curve.voltage_V, label="the disk")
    axes[1].plot(curve.field_mT, curve.fitted_V, "--", label="quadratic fitted to it (Eq. 2)")
    _label(axes[1], "output, scaled to 1 V at 100 mT", "field in the plane [mT]", "voltage [V]")
    return figure, {"field_mT": curve.field_mT, "voltage_V": curve.voltage_V, "fitted_V": curve.fitted_V}


def non_linearity(plt: Any) -> tuple[Any, Columns]:
    """Fig. 7: the error over angle and field."""
    fields = np.linspace(0.0, 100.0, 21)
    return _surface(plt, fields, [non_linear(field) for field in fields], "field [mT]", "field_mT")


def fluctuation(plt: Any) -> tuple[Any, Columns]:
    """Fig. 8: the sampling error over the code for several fluctuations of the reference (Eq. 3).

    The converter's own codes beside x / 2^m D: a reference that is too high by D makes the code too low.
    """
    # The positive half of a signed word of 15 bits is a word of 14.
    converter = Converter(bits=15, full_scale=1.0)
    code = np.arange(0, 2**14, 64)
    volts = code / 2.0**14
    columns: Columns = {"code": code.astype(np.float64)}
    figure, axis = plt.subplots(figsize=(6.5, 4.5), layout="constrained")
    for millivolt in (0.5, 1.0, 2.0, 3.0):
        formula = code / 2.0**14 * millivolt
        seen = convert(np.stack([volts, volts]) / (1.0 + 1e-3 * millivolt), np.zeros((2, code.size)), converter)[0]
        (line,) = axis.plot(code, formula, label=f"{millivolt:g} mV")
        axis.plot(code, 1e3 * (volts - seen * converter.step), ".", markersize=2, color=line.get_color())
        columns[f"error_{millivolt:g}mV_mV"] = formula
        columns[f"converted_{millivolt:g}mV_mV"] = 1e3 * (volts - seen * converter.step)
    _label(
        axis,
        "lines: Eq. 3; points: the converter, full scale 1 V",
        "code of 14 bits [1]",
        "sampling error [mV]",
        legend="change of the reference",
    )
    return figure, columns


def calculation(plt: Any) -> tuple[Any, Columns]:
    """Fig. 9: the error of the CORDIC over the first quadrant, and the envelope over the iterations."""
    figure, axes = plt.subplots(1, 2, figsize=(10.0, 4.2), layout="constrained")
    columns: Columns = {}
    counts = range(4, 17)
    largest = []
    for count in counts:
        angle, error = cordic_error(count, 14_400)
        first = angle < 0.5 * np.pi
        columns["angle_deg"] = np.asarray(np.degrees(angle[first]), dtype=np.float64)
        columns[f"error_{count}_iterations_deg"] = np.asarray(np.degrees(error[first]), dtype=np.float64)
        largest.append(float(np.degrees(np.max(np.abs(error)))))
    for count in (6, 8, 10):
        axes[0].plot(columns["angle_deg"], columns[f"error_{count}_iterations_deg"], linewidth=0.6, label=f"{count}")
    _label(axes[0], "error over the first quadrant", "angle [deg]", "error [deg]", legend="iterations")
    bound = [float(np.degrees(np.arctan(2.0 ** -(count - 1)))) for count in counts]
    axes[1].semilogy(list(counts), largest, "o", label="largest error")
    axes[1].semilogy(list(counts), bound, "--", label="atan(2^-(n-1))")
    _label(axes[1], "largest error and its bound", "iterations [1]", "error [deg]")
    return figure, columns


def _surface(plt: Any, across: Array, chains: Sequence[Chain], label: str, name: str) -> tuple[Any, Columns]:
    """A surface over the angle and one parameter, and its points as three columns."""
    error = np.stack([_error_deg(chain) for chain in chains])
    angle, parameter = np.meshgrid(ANGLE_DEG, across)
    figure = plt.figure(figsize=(6.5, 5.0), layout="constrained")
    axis = figure.add_subplot(projection="3d")
    axis.plot_surface(angle, parameter, error, cmap="viridis", rcount=21, ccount=90, linewidth=0.1)
    axis.set(xlabel="angle [deg]", ylabel=label, zlabel="error [deg]")
    axis.set_box_aspect(None, zoom=0.85)
    return figure, {"angle_deg": angle.ravel(), name: parameter.ravel(), "error_deg": error.ravel()}


def _label(axis: Any, title: str, across: str, up: str, *, legend: str | None = None) -> None:
    axis.set(title=title, xlabel=across, ylabel=up)
    axis.grid(alpha=0.3)
    axis.legend(fontsize=7, title=legend, title_fontsize=7)
