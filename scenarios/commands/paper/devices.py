"""Table 2's devices simulated, diagnosed and compensated: Table 2, Figures 14 and 16.

Each device is the preset ``paper-encoder`` with the factors of its column: converter, CORDIC, hysteresis, noise and
word stay. The diagnosis sees one recording of two turns there and back, four groups of readings as in Fig. 14; the
correction that follows from it is held against a second recording.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis import Diagnosis, diagnose
from diagnosis.correction.compensation import correction_of
from diagnosis.correction.cross_validation import BeforeAfter, against
from diagnosis.factors.findings import curve_deg
from scenarios.commands.paper.held import Held
from scenarios.commands.paper.table_2 import DEVICES, Q_PER_MT, visible, with_device
from scenarios.commands.protocol import Protocol
from twin.angles import Array, IntArray, wrap_deg
from twin.confidence import Z95
from twin.presets import read_preset
from twin.sweep import Sweep

SHOWN = Protocol(turns=2, points=90, both_directions=True)
"""What is diagnosed: four groups of readings of the same angles."""
CHECKED = Protocol(turns=1, points=360, both_directions=True)
"""What is compensated."""
REACHED_DEG = 0.2
"""Section 4.2: the accuracy after compensation, over the whole turn."""


@dataclass(frozen=True, eq=False)
class Device:
    """One device of Table 2: its recording, what the diagnosis found, errors of another recording compensated."""

    name: str
    sweep: Sweep
    found: Diagnosis
    second: Sweep
    compensated: BeforeAfter


def devices(seed: int) -> dict[str, Device]:
    """All four, by name."""
    return {name: _device(name, seed + 10 * place) for place, name in enumerate(DEVICES)}


def _device(name: str, seed: int) -> Device:
    chain = with_device(read_preset("paper-encoder"), name)
    amplitude = DEVICES[name][1]
    # The twin counts in amplitudes of x; the recorded volts have the table's.
    first, second = (
        _in_volts(chain.simulate(each.motion(), seed=seed + k), amplitude) for k, each in enumerate((SHOWN, CHECKED))
    )
    found = diagnose(replace(first, name=f"device {name}"), seed=seed)
    shaft = correction_of(found.twin).shaft
    compensated = against(np.radians(second.reference_deg), np.radians(second.measured_deg), shaft)
    return Device(name, first, found, second, compensated)


def _in_volts(sweep: Sweep, amplitude: float) -> Sweep:
    assert sweep.vx is not None
    assert sweep.vy is not None
    return replace(sweep, vx=amplitude * sweep.vx, vy=amplitude * sweep.vy)


def table_2(found: dict[str, Device]) -> list[Held]:
    """Every parameter of every device: what shows from the angle alone; Vx, Ax, Vy and Ay from the raw channels."""
    return [row for device in found.values() for row in _parameters(device)]


def _parameters(device: Device) -> Iterator[Held]:
    where, printed = f"Table 2 {device.name}", DEVICES[device.name]
    shown = dict(zip(("Vx/Ax", "Vy/Ay", "Ay/Ax", "Px", "Magx"), visible(*printed), strict=True))
    names = {"Vx/Ax": "Vx_over_Ax", "Vy/Ay": "Vy_over_Ay", "Ay/Ax": "gain_ratio", "Px": "beta_deg", "Magx": "quad"}
    units = {"Px": "deg", "Magx": "mT"}
    for what, factor in names.items():
        one = device.found.factors[factor]
        scale = 1.0 / Q_PER_MT if what == "Magx" else 1.0
        there = np.degrees(shown[what]) if what == "Px" else shown[what] * scale
        assert one.low is not None
        assert one.high is not None
        yield Held(
            where=where,
            what=f"{what}, from the angle",
            printed=float(there),
            ours=scale * one.value,
            low=scale * one.low,
            high=scale * one.high,
            unit=units.get(what, "1"),
        )
    added = device.found.findings.added
    assert added is not None
    for what, value, error in zip(
        ("Vx", "Vy", "Ax", "Ay"), added.curve.values, added.curve.standard_errors, strict=False
    ):
        there = printed[("Vx", "Ax", "Vy", "Ay").index(what)]
        yield Held(
            where=where,
            what=f"{what}, from the raw channels",
            printed=there,
            ours=float(value),
            low=float(value - Z95 * error),
            high=float(value + Z95 * error),
            unit="V",
        )


def accuracy(found: dict[str, Device]) -> list[Held]:
    """Fig. 16: the largest error after compensation, against the accuracy that the paper states."""
    rows = []
    for device in found.values():
        before, after = device.compensated.peak_deg
        rows.append(
            Held(
                where=f"Fig. 16 {device.name}",
                what="largest error after compensation",
                printed=REACHED_DEG,
                ours=after,
                unit="deg",
                remark=f"{before:.3g} deg before; RMS {device.compensated.rms_deg[0]:.3g} to "
                f"{device.compensated.rms_deg[1]:.3g} deg, on a recording that the diagnosis never saw",
            )
        )
    return rows


def figure_14(plt: Any, found: dict[str, Device]) -> tuple[Any, dict[str, Array]]:
    """Fig. 14: the measured errors of the four devices as points, and the curves of the diagnosed parameters."""
    figure, axes = plt.subplots(2, 2, figsize=(9.5, 6.8), layout="constrained", sharex=True)
    turn: Array = np.linspace(0.0, 360.0, 361)
    columns = {"angle_deg": turn}
    for axis, device in zip(axes.flat, found.values(), strict=True):
        fit = device.found.findings.fit
        error, group = _groups(device)
        for number in range(4):
            rows = group == number
            axis.plot(
                device.sweep.reference_deg[rows] % 360.0,
                error[rows],
                ".x+1"[number],
                markersize=4,
                markeredgewidth=0.7,
                label=f"measured, group {number + 1} ({('forward', 'backward')[number // 2]})",
            )
        columns[f"error_{device.name}_deg"] = curve_deg(fit, turn)
        axis.plot(
            turn, columns[f"error_{device.name}_deg"], "-", color="black", linewidth=1.2, label="diagnosed parameters"
        )
        axis.plot(
            turn, _printed_curve(device, turn), "--", color="crimson", linewidth=1.0, label="parameters of Table 2"
        )
        _framed(axis, f"({device.name})  {device.found.rms_deg:.3f} deg RMS left")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
    return figure, columns


def _framed(axis: Any, title: str) -> None:
    """Title, axes and grid of one device's error over the turn."""
    axis.set(title=title, xlabel="shaft angle [deg]", ylabel="angle error [deg]", xticks=range(0, 361, 90))
    axis.grid(alpha=0.3)


def _groups(device: Device) -> tuple[Array, IntArray]:
    """The measured errors (n,) [deg] with the fitted zero taken out, and which of the four passes each belongs to."""
    fit = device.found.findings.fit
    zero = float(np.degrees(fit.point[-1]))
    error = wrap_deg(device.sweep.measured_deg - device.sweep.reference_deg - zero)
    return error, np.arange(error.size) // SHOWN.points


def _printed_curve(device: Device, turn: Array) -> Array:
    """The error [deg] of the device's printed parameters over the turn [deg]."""
    from diagnosis.error_model.model import Readings

    point = np.array([*visible(*DEVICES[device.name]), 0.0])
    shaft = np.radians(turn)
    return -np.degrees(Readings.of(shaft, shaft).residual(point))


def figure_16(plt: Any, found: dict[str, Device]) -> tuple[Any, dict[str, Array]]:
    """Fig. 16: the error over the whole turn before and after the compensation, both directions."""
    figure, axes = plt.subplots(2, 2, figsize=(9.5, 6.8), layout="constrained", sharex=True, sharey=True)
    columns: dict[str, Array] = {}
    for axis, device in zip(axes.flat, found.values(), strict=True):
        angle = device.second.reference_deg % 360.0
        before, after = (np.degrees(error) for error in (device.compensated.before_rad, device.compensated.after_rad))
        columns["angle_deg"] = angle
        columns |= {f"before_{device.name}_deg": before, f"after_{device.name}_deg": after}
        axis.plot(angle, before, ".", markersize=2.0, label="before compensation")
        axis.plot(angle, after, ".", markersize=2.0, label="after compensation")
        for side in (-REACHED_DEG, REACHED_DEG):
            axis.axhline(
                side, color="0.3", linestyle="--", linewidth=0.9, label="0.2 deg, as printed" if side > 0 else None
            )
        largest = device.compensated.peak_deg
        _framed(axis, f"({device.name})  largest error {largest[0]:.2f} to {largest[1]:.3f} deg")
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8, markerscale=4.0
    )
    return figure, columns
