"""The diagnoser on cases drawn from Table 2: ``python -m tests.diagnosis.error_model.study``.

Errors against the Cramer-Rao bound and coverage of the 95 % intervals over 1,000 cases. ``halltwin paper`` has the
swarm's convergence and the four devices.
"""

from __future__ import annotations

import numpy as np

from diagnosis.error_model.fit import fit_equal
from diagnosis.error_model.model import NAMES, ZERO, Readings
from scenarios.commands.paper.table_2 import NOISE_DEG, Cases, draw, with_device
from twin.angles import Array, wrap
from twin.chain import Chain


def bounds(cases: Cases) -> Array:
    """Cramer-Rao bounds (cases, 6) on the standard errors at the true points and noise."""
    _, slopes = Readings.of(cases.reference, cases.measured).linearised(cases.points)
    information = slopes @ np.swapaxes(slopes, -1, -2) / np.radians(NOISE_DEG) ** 2
    return np.asarray(np.sqrt(np.einsum("bii->bi", np.linalg.inv(information))))


def ratio_and_coverage(cases: Cases, rng: np.random.Generator) -> tuple[Array, Array]:
    """RMS error over bound (6,), and the share of the 95 % intervals that hold the truth (6,); senses known."""
    fits = fit_equal(cases.reference, cases.measured, rng=rng, senses=(1, 1))
    error = np.array([fit.point for fit in fits]) - cases.points
    error[:, ZERO] = wrap(error[:, ZERO])
    half = np.array([fit.high - fit.point for fit in fits])
    ratio = np.sqrt(np.mean((error / bounds(cases)) ** 2, axis=0))
    return np.asarray(ratio), np.asarray(np.mean(np.abs(error) <= half, axis=0))


def device(name: str) -> Chain:
    """One of Table 2's devices as a twin, with 14-bit converters and noise."""
    chain = Chain().with_effect("adc_quantisation", bits=14).with_effect("noise", rms_deg=NOISE_DEG)
    return with_device(chain, name)


def main() -> None:
    """Run the studies and print them."""
    rng = np.random.default_rng(2015)
    ratio, coverage = ratio_and_coverage(draw(1000, rng), rng)
    print("1,000 cases after the polish      " + "".join(f"{name:>12}" for name in NAMES))
    print("  RMS error / Cramer-Rao bound    " + "".join(f"{value:12.3f}" for value in ratio))
    print("  coverage of the 95 % intervals  " + "".join(f"{value:12.1%}" for value in coverage))
    print(f"  coverage, all together            {coverage.mean():.1%}")


if __name__ == "__main__":
    main()
