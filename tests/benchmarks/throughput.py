"""Samples a second and core, with noise and bit-true CORDIC: ``python -m tests.benchmarks.throughput``.

Beside it the same chain as a loop over samples in plain Python, on the same twin; both agree but for their noise.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable

import numpy as np

from scenarios.commands.protocol import Protocol
from twin.adc.adc_quantisation import FULL_SCALE
from twin.angles import Array, wrap
from twin.chain import Chain
from twin.cordic.bit_true import Cordic
from twin.motion import Motion

UNIT = Cordic(iterations=14, word_bits=14, guard_bits=3, angle_bits=18)
OFFSET_X, OFFSET_Y, RATIO, BETA, Q, K, NOISE, LAG = 0.001, -0.001, 1.003, 0.1, 0.0011, 0.0015, 0.02, 0.04


def twin(noise: float) -> Chain:
    """The factors of the paper's Table 1, saturation, hysteresis and noise."""
    return (
        Chain()
        .with_effect("hysteresis", lag_deg=LAG, memory_deg=8.0)
        .with_effect("phase", beta_deg=BETA)
        .with_effect("saturation", k_percent=100.0 * K)
        .with_effect("quadratic_nonlinearity", q_percent=100.0 * Q)
        .with_effect("offset", x_percent=100.0 * OFFSET_X, y_percent=100.0 * OFFSET_Y)
        .with_effect("gain_mismatch", ratio=RATIO)
        .with_effect("noise", rms_deg=noise)
    )


def vectorised(motion: Motion, noise: float, seed: int) -> Array:
    """Readings (n,) [rad] of the chain as built: noise, the converter's codes and the integer CORDIC."""
    chain = (
        twin(noise)
        .with_effect("adc_quantisation", bits=UNIT.word_bits)
        .with_effect(
            "cordic_truncation",
            iterations=UNIT.iterations,
            word_bits=UNIT.word_bits,
            guard_bits=UNIT.guard_bits,
            angle_bits=UNIT.angle_bits,
        )
    )
    *_, last = chain.steps(motion, np.random.default_rng(seed))
    return last.after[0]


def loop(motion: Motion, noise: float, seed: int) -> list[float]:
    """The same, one sample after the other."""
    draw = random.Random(seed)
    half, full = 1 << (UNIT.word_bits - 1), 1 << UNIT.angle_bits
    steps = [int(step) for step in UNIT.steps]
    sigma, beta, target = math.radians(noise), math.radians(BETA), math.radians(LAG)
    memory, lag, last = math.radians(8.0), None, 0.0
    out = []
    for shaft, way in zip(motion.shaft_rad.tolist(), motion.direction.tolist(), strict=True):
        goal = -way * target
        lag = goal if lag is None else goal + (lag - goal) * math.exp(-abs(shaft - last) / memory)
        last = shaft
        angle = shaft + lag
        channels = []
        for value, offset in ((math.cos(angle), OFFSET_X), (math.sin(angle + beta), OFFSET_Y)):
            bent = value - K * value**3
            channels.append(bent + Q * bent**2 + offset)
        channels[1] *= RATIO
        codes = [max(-half, min(half - 1, round((c + draw.gauss(0.0, sigma)) / FULL_SCALE * half))) for c in channels]
        x, y = (code << UNIT.guard_bits for code in codes)
        word = 0
        if x < 0:
            word = full // 2 if y >= 0 else -full // 2
            x, y = -x, -y
        for shift, step in enumerate(steps):
            if y >= 0:
                x, y, word = x + (y >> shift), y - (x >> shift), word + step
            else:
                x, y, word = x - (y >> shift), y + (x >> shift), word - step
        out.append(((word + full // 2) % full - full // 2) * 2.0 * math.pi / full)
    return out


def rate(run: Callable[[], object], samples: int, repeats: int) -> float:
    """Samples a second of the fastest of several runs."""
    best = math.inf
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - start)
    return samples / best


def largest_difference_deg(turns: int = 2) -> float:
    """Largest difference [deg] of the two without noise."""
    motion = Protocol(turns=turns, points=3600, both_directions=True).motion()
    return float(np.degrees(np.max(np.abs(wrap(vectorised(motion, 0.0, 0) - np.array(loop(motion, 0.0, 0)))))))


def main() -> None:
    """Print both rates."""
    many = Protocol(turns=100, points=3600, both_directions=True).motion()
    few = Protocol(turns=5, points=3600, both_directions=True).motion()
    fast = rate(lambda: vectorised(many, NOISE, 1), len(many), 3)
    slow = rate(lambda: loop(few, NOISE, 1), len(few), 2)
    print(f"vectorised {fast:.3g} samples/s, loop over samples {slow:.3g} samples/s: {fast / slow:.0f} times")
    print(f"largest difference without noise {largest_difference_deg():.3g} deg")


if __name__ == "__main__":
    main()
