"""Draw a sweep of a kind of physics, and further recordings of the same device.

    hidden = draw("froehlich", seed=3)
    again = draw("froehlich", seed=3, recording=1)
    hidden.write_csv("sweep.csv")

The same arguments give the same sweep on every machine. Numpy and the standard library only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import baseline as baselines
from .. import protocols
from ..baseline import Setting
from ..generator import Hidden
from ..motion import Array, Motion
from ..noise import Noise
from ..streams import stream
from .clear import clearance_sigma
from .device import Device, Record, record
from .kind import Kind, Planned
from .kinds import CLEAN, KINDS, NAMED

CLEAR = 14.0
"""A mechanism of a mean is drawn anew until it stands so far clear of the noise, in standard deviations."""
TRIES = 40
ROWS = 1500
"""Readings of a sweep, at most, where a protocol can do with them."""


@dataclass(frozen=True)
class Settled:
    """A device on its bench, as all its recordings share it."""

    kind: Kind
    device: Device
    planned: Planned
    noise_deg: float
    first: Motion


def settle(label: str, seed: int) -> Settled:
    """Draw the device, the noise of its bench and the motion that its sizes are measured by."""
    kind = KINDS[label]
    for attempt in range(TRIES):
        names = (label, str(attempt))
        motion = _motion(kind, stream(seed, *names, "motion"))
        rng = stream(seed, *names, "bench")
        own = baselines.choose(rng, bench="easy")
        noise = float(rng.uniform(0.01, 0.03))
        channels = bool(rng.random() < 0.3) if kind.channels is None else kind.channels
        setting = Setting(motion, own, Noise("white", noise), kind.noise_bits, weak=False)
        planned = kind.plan(stream(seed, *names, "mechanism"), setting)
        device = Device(own, planned.mechanism, kind.noise_bits, channels)
        settled = Settled(kind, device, planned, noise, motion)
        if label in CLEAN or kind.noisy or label in WORDS or clearance_sigma(device, motion, noise) >= CLEAR:
            return settled
    raise ValueError(f"{label} with seed {seed} never stands clear of the noise in {TRIES} draws")


WORDS = frozenset({"stale_bursts", "top_bits"})
"""Seen in words and their sequence, not in a mean."""


def draw(label: str, *, seed: int, recording: int = 0) -> Hidden:
    """A sweep of a kind; `recording` above 0 is another of the same device, with a motion and noise of its own."""
    if label not in KINDS:
        raise ValueError(f"kind must be one of {sorted(KINDS)}; instead received {label!r}")
    settled = settle(label, seed)
    names = (label, "recording", str(recording))
    motion = settled.first if recording == 0 else _motion(settled.kind, stream(seed, *names, "motion"))
    read = record(settled.device, motion, settled.noise_deg, stream(seed, *names, "noise"))
    columns = _columns(settled, motion, read, stream(seed, *names, "columns"))
    return Hidden(columns, _truth(label, settled, motion, read))


def _motion(kind: Kind, rng: np.random.Generator) -> Motion:
    """A motion of the bench, not longer than need be: answers to short sweeps take less time."""
    if kind.own_motion is not None:
        return kind.own_motion(rng)
    shortest: Motion | None = None
    for _ in range(TRIES):
        motion = protocols.drive(protocols.choose(rng, kind.protocols), rng, bench="easy", demands=kind.demands)
        if shortest is None or len(motion.time_s) < len(shortest.time_s):
            shortest = motion
        if len(motion.time_s) <= ROWS:
            break
    assert shortest is not None
    return shortest


def _columns(settled: Settled, motion: Motion, read: Record, rng: np.random.Generator) -> dict[str, Array]:
    """The columns a bench writes down; those that the motion says nothing in are left out, time at times."""
    columns: dict[str, Array] = {}
    needed = motion.moving or settled.kind.demands.time_column or len(np.unique(motion.temperature_c)) > 1
    if needed or rng.random() < 0.7:
        columns["time_s"] = motion.time_s
    wrapped = rng.random() < 0.6 and motion.protocol not in ("swing", "run_up")
    columns["reference_deg"] = np.mod(read.reference_deg, 360.0) if wrapped else read.reference_deg
    columns["measured_deg"] = read.word_deg
    if np.ptp(motion.direction) > 0:
        columns["direction"] = motion.named
    if motion.moving:
        columns["speed_rpm"] = np.abs(motion.speed_rpm) * motion.named
    if np.ptp(motion.temperature_c) > 0:
        columns["temperature_c"] = motion.temperature_c
    if settled.kind.demands.turn_column or "temperature_c" in columns:
        columns["turn"] = motion.turn.astype(float)
    if settled.device.channels:
        columns["vx"], columns["vy"] = read.x, read.y
    return columns


def _truth(label: str, settled: Settled, motion: Motion, read: Record) -> dict[str, object]:
    """What is in the sweep, which answers are right, and what a perfect answer leaves."""
    kind, own, step = settled.kind, settled.device.baseline, 360.0 / 2**settled.device.output_bits
    mean = not (kind.noisy or label in WORDS)
    return {
        "kind": label,
        "causes": list(kind.answers[0]),
        "answers": [list(one) for one in kind.answers],
        "tolerated": list(kind.tolerated),
        "named": label in NAMED,
        "strength_deg": {label: settled.planned.size_deg},
        "clearance_sigma": {label: clearance_sigma(settled.device, motion, settled.noise_deg) if mean else None},
        "parameters": {name: dict(given) for name, given in settled.planned.parameters.items()},
        "noise_deg": settled.noise_deg,
        "noise_kind": "white" if settled.device.mechanism.noise is None else label,
        "floor_deg": float(np.hypot(np.std(read.noise_deg), step / np.sqrt(12.0))),
        "output_bits": settled.device.output_bits,
        "baseline": own.parameters(),
        "frame": {
            "amplitude_x": own.amplitude_x,
            "first_time_s": float(motion.time_s[0]),
            "first_reference_deg": float(read.reference_deg[0]),
            "duration_s": float(np.ptp(motion.time_s)),
        },
        "protocol": motion.protocol,
        "channels": settled.device.channels,
        "rows": len(motion.time_s),
        "transfers": kind.outcome_repeats,
    }
