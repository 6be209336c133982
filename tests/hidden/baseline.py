"""The paper's error model, which every draw holds, and what each planned cause may look at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from .motion import Array, Motion
from .noise import Noise


@dataclass(frozen=True)
class Baseline:
    """Channels: x = Vx + Ax F(cos a), y = Vy + Ay F(sin(a + beta)), F(c) = c + q c^2, a = s theta + zero."""

    zero_deg: float
    offset_x: float
    offset_y: float
    amplitude_x: float
    amplitude_y: float
    phase_deg: float
    quadratic: float
    sense: int = 1
    """s: +1 where the sensor's axes turn with the reference."""
    channel_sense: int = 1
    """h: m = h atan2(y, x)."""

    def parameters(self) -> dict[str, float]:
        """By the names of the answer's baseline block."""
        return {
            "Vx_over_Ax": self.offset_x / self.amplitude_x,
            "Vy_over_Ay": self.offset_y / self.amplitude_y,
            "gain_ratio": self.amplitude_y / self.amplitude_x,
            "beta_deg": self.phase_deg,
            "quad": self.quadratic,
            "zero_deg": self.zero_deg,
            "sense": float(self.sense),
            "channel_sense": float(self.channel_sense),
        }


def choose(rng: np.random.Generator, *, bench: str) -> Baseline:
    """A baseline of the size met on real sensors."""
    hard = bench == "hard"
    offset = float(rng.uniform(0.0, 0.02 if hard else 0.015))
    towards = float(rng.uniform(0.0, 2 * np.pi))
    mismatch = float(rng.uniform(-0.16, 0.16) if hard else rng.uniform(-0.02, 0.02))
    scale = float(rng.uniform(0.99, 1.01))
    return Baseline(
        zero_deg=float(rng.uniform(0.0, 360.0)),
        offset_x=offset * np.cos(towards),
        offset_y=offset * np.sin(towards),
        amplitude_x=scale,
        amplitude_y=scale * (1.0 + mismatch),
        phase_deg=float(rng.uniform(-1.0, 1.0)),
        quadratic=float(rng.uniform(-0.005, 0.005)),
        sense=int(rng.choice((1, -1))) if hard else 1,
        channel_sense=int(rng.choice((1, -1))) if hard else 1,
    )


@dataclass(frozen=True)
class Setting:
    """What is settled before the parameters of a cause are."""

    motion: Motion
    baseline: Baseline
    noise: Noise
    output_bits: int
    weak: bool

    @property
    def word_deg(self) -> float:
        """One step of the angle word."""
        return float(360.0 / 2**self.output_bits)


@dataclass(frozen=True)
class Injected:
    """A cause with everything about it settled, chance included."""

    name: str
    strength_deg: float
    parameters: Mapping[str, float]
    """By the public names of the catalogue."""
    hidden: Mapping[str, Array] = field(default_factory=dict)
    """Chance outcomes that the public parameters do not hold: rows hit, noise drawn, zeros of the turns."""
