"""The trace of a run: every intermediate signal with its unit, as a table and as a picture."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from twin.angles import Array, wrap
from twin.catalogue import STAGES
from twin.chain import Chain, Step
from twin.hall.spinning_current import residual_offset_mT
from twin.hardware import INSIDE, in_units
from twin.motion import Motion
from twin.sweep_file import csv_text

CONVERSIONS = {
    "after shaft": "field angle",
    "after field": "driven channels",
    "after channels": "computed angle",
    "after angle": "reading",
}


_NAMES = {
    "magnet": ("field in the plane", "mT"),
    "concentrator": ("vertical field", "mT"),
    "hall": ("Hall voltage", "uV"),
}
"""By stage the name and the unit of the signal behind it."""


@dataclass(frozen=True, eq=False)
class Signal:
    """One operation's output: ``values`` (1 or 2, n) in ``unit``, and ``moved_deg`` (n,), what it did to the angle."""

    name: str
    unit: str
    values: Array
    moved_deg: Array


@dataclass(frozen=True, eq=False)
class Trace:
    """All signals of one run in the order of the chain, and the reference's reading [deg] (n,)."""

    motion: Motion
    signals: tuple[Signal, ...]
    reference_deg: Array
    error_deg: Array
    notes: tuple[str, ...]


def trace(chain: Chain, motion: Motion, *, seed: int) -> Trace:
    """Run the chain as :meth:`Chain.simulate` does with this seed, and keep every signal."""
    rng = np.random.default_rng(seed)
    signals = [Signal("shaft", "deg", np.degrees(motion.shaft_rad)[None], np.zeros(len(motion)))]
    last: Array = signals[0].values
    inside = _Inside(chain)
    for step in chain.steps(motion, rng):
        kind = step.effect.acts_on if step.effect else step.key.removeprefix("after ")
        # Before a later stage acts on the channels, the earlier ones' signal is what the hardware has there.
        if kind == "channels":
            signals.extend(inside.before(step))
        is_channels = kind == "channels" if step.effect else kind == "field"
        values = step.after if is_channels else np.degrees(step.after)
        name = step.key if step.effect else CONVERSIONS[step.key]
        signals.append(Signal(name, "1" if is_channels else "deg", values, _moved_deg(step, kind)))
        last = step.after
    reference = chain.recorded_reference(motion, rng)
    slope = chain.sensor_sense * chain.output_sense
    error = np.degrees(wrap(last[0] - slope * reference))
    return Trace(motion, tuple(signals), np.degrees(reference), error, _notes(chain))


class _Inside:
    """The channels in the units of the hardware, each once: in the plane after the magnet's effects, under the disk

    after the concentrator's, at the plates after theirs. Scale: the chain's nominal field, its disk and its plate.
    """

    def __init__(self, chain: Chain) -> None:
        self.parts, self.nominal = chain.parts, chain.nominal_mT
        self.left = list(INSIDE)

    def before(self, step: Step) -> Iterator[Signal]:
        """What is complete before this step acts."""
        reached = STAGES.index(step.effect.stage) if step.effect else len(STAGES)
        while self.left and STAGES.index(self.left[0]) < reached:
            stage = self.left.pop(0)
            values = in_units(self.parts, self.nominal, stage, step.before)
            yield Signal(*_NAMES[stage], values, np.zeros(values.shape[-1]))


def _notes(chain: Chain) -> tuple[str, ...]:
    """What the columns in mT and uV are counted with."""
    parts = chain.parts
    plate = parts.plates[0]
    before, after = residual_offset_mT(plate)
    field = "[hardware]" if chain.magnet is None else "[magnet]"
    return (
        f"nominal field {chain.nominal_mT:.4g} mT by {field} of the twin; concentrator's gain {parts.gain:g} and "
        f"sensitivity {plate.sensitivity_uV_per_mT:g} uV/mT by [hardware]; what is not given there is typical",
        f"offset of the Hall plate of x: {before:.4g} mT before spinning current, {after:.4g} mT after it",
    )


def _moved_deg(step: Step, kind: str) -> Array:
    """What the operation did to the angle that the signal stands for [deg] (n,).

    The conversion to channels moves it where a magnet's field is not the ideal one, that to an angle where a CORDIC on
    integers makes it; the other conversions do not.
    """
    if step.effect is None and kind not in ("field", "channels"):
        return np.zeros(step.after.shape[-1])
    before = _angle(step.before, kind)
    after = _angle(step.after, kind if step.effect else {"field": "channels", "channels": "angle"}[kind])
    return np.asarray(np.degrees(wrap(after - before)))


def _angle(signal: Array, kind: str) -> Array:
    if kind == "channels":
        return np.asarray(np.arctan2(signal[1], signal[0]))
    if len(signal) == 2:
        return np.asarray(np.arctan2(np.sin(signal[1]), np.cos(signal[0])))
    return np.asarray(signal[0])


def trace_text(traced: Trace) -> str:
    """The trace as CSV, one row a reading; the unit ends each name, ``_1`` being the nominal amplitude."""
    columns = {"time_s": traced.motion.time_s}
    for place, signal in enumerate(traced.signals):
        stem = f"{place:02d}_{signal.name.replace(' ', '_')}"
        for axis, values in zip(("_x", "_y") if len(signal.values) == 2 else ("",), signal.values, strict=True):
            columns[f"{stem}{axis}_{signal.unit}"] = values
    columns["reference_deg"] = traced.reference_deg
    columns["error_deg"] = traced.error_deg
    return csv_text(columns, comments=traced.notes)
