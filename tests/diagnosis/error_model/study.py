"""The diagnoser on cases drawn from Table 2: ``python -m tests.diagnosis.error_model.study``.

Convergence of the swarm over 100 cases, errors against the Cramer-Rao bound and coverage of the 95 % intervals over
1,000 cases, and the four devices of Table 2 diagnosed on one sweep and compensated on another.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.correction.compensation import correction_of
from diagnosis.correction.cross_validation import BeforeAfter, against
from diagnosis.error_model import least_squares, model, swarm
from diagnosis.error_model.error_band import delta_e_rad, outside
from diagnosis.error_model.fit import fit_baseline, fit_equal
from diagnosis.error_model.model import NAMES, ZERO, Readings
from diagnosis.error_model.search_range import first_box
from twin.angles import TAU, Array, wrap
from twin.chain import Chain
from twin.motion import Motion

READINGS = 360
NOISE_DEG = 0.02
Q_PER_MT = 1.896e-5
"""q = K1 mag / K2 of the paper's 100 mT figure, per mT."""

DEVICES = {
    "a": (0.008943, 1.008607, 0.000491, 0.994536, 0.000368, 113.0),
    "b": (0.005878, 1.000057, 0.007176, 0.995089, 0.001508, 135.0),
    "c": (0.007500, 0.993573, -0.006990, 1.003337, 0.003005, 71.0),
    "d": (0.007711, 0.994878, -0.003980, 0.992822, 0.002122, 110.0),
}
"""Table 2: Vx, Ax, Vy, Ay, Px [rad], Magx [mT]."""

STEPS: Array = np.array([1e-6, 1e-6, 1e-6, np.radians(9e-5), Q_PER_MT, 1e-6])
"""Table 2's steps in the visible parameters; the zero moves like the offsets."""


@dataclass(frozen=True, eq=False)
class Cases:
    """True points (cases, 6), reference and measured angles (cases, n) [rad]."""

    points: Array
    reference: Array
    measured: Array


def draw(cases: int, rng: np.random.Generator, *, readings: int = READINGS) -> Cases:
    """Devices drawn evenly from Table 2's ranges with any zero, measured once round with white noise."""
    vx, ax, vy, ay, beta, field, zero = rng.uniform(
        [-0.01, 0.99, -0.01, 0.99, -np.radians(0.9), 50.0, -np.pi],
        [0.01, 1.01, 0.01, 1.01, np.radians(0.9), 150.0, np.pi],
        (cases, 7),
    ).T
    points = np.stack([vx / ax, vy / ay, ay / ax, beta, Q_PER_MT * field, zero], axis=-1)
    reference = np.tile(TAU * np.arange(readings) / readings, (cases, 1))
    x, y = Readings.of(reference, reference).channels(points)
    noise = np.radians(NOISE_DEG) * rng.standard_normal(reference.shape)
    return Cases(points, reference, np.arctan2(y, x) + noise)


def iterations_needed(
    cases: Cases,
    rng: np.random.Generator,
    *,
    steps: Array | None = None,
    band_rad: float | None = None,
    settings: swarm.SwarmSettings | None = None,
) -> Array:
    """Iterations (cases,) until the swarm's best is within 1 % of the smallest RMS there is; infinite if never."""
    settings = settings or swarm.SwarmSettings()
    readings = Readings.of(cases.reference, cases.measured)
    gram = readings.gram()
    lowest = least_squares.descend(least_squares.on_gram(gram), cases.points, count=readings.count).cost
    mean = np.angle(np.mean(np.exp(1j * (cases.measured - cases.reference)), axis=1))
    box = first_box(mean)
    root = model.factor(gram)
    result = swarm.run(
        lambda points: model.cost(model.coefficients(points), root),
        box.lower,
        box.upper,
        rng=rng,
        settings=settings,
        steps=steps,
        outside=None if band_rad is None else outside(readings, band_rad),
    )
    there = np.sqrt(result.best_history) <= 1.01 * np.sqrt(lowest)[:, None]
    return np.where(there.any(axis=1), np.argmax(there, axis=1), np.inf)


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
    vx, ax, vy, ay, beta, field = DEVICES[name]
    return (
        Chain()
        .with_effect("offset", x_percent=100 * vx / ax, y_percent=100 * vy / ay)
        .with_effect("gain_mismatch", ratio=ay / ax)
        .with_effect("phase", beta_deg=float(np.degrees(beta)))
        .with_effect("quadratic_nonlinearity", q_percent=100 * Q_PER_MT * field)
        .with_effect("adc_quantisation", bits=14)
        .with_effect("noise", rms_deg=NOISE_DEG)
    )


def compensated(name: str, seed: int = 0) -> BeforeAfter:
    """The device diagnosed on one simulated sweep and compensated on another."""
    chain = device(name)
    motion = Motion.from_angle(TAU * np.arange(READINGS) / READINGS)
    first, second = (chain.simulate(motion, seed=seed + k) for k in (0, 1))
    fit = fit_baseline(np.radians(first.reference_deg), np.radians(first.measured_deg), rng=np.random.default_rng(seed))
    correction = correction_of(fit.chain())
    return against(np.radians(second.reference_deg), np.radians(second.measured_deg), correction.shaft)


def main() -> None:
    """Run the studies and print them."""
    rng = np.random.default_rng(2015)
    cases = draw(100, rng)
    print("Convergence, 100 cases, 100 particles (Fig. 13): iterations to within 1 % of the smallest RMS")
    band = delta_e_rad(device("a"))
    for words, options in (
        ("as the paper's Eq. 8-10", {}),
        ("velocity in steps of Table 2", {"steps": STEPS}),
        (f"discard rule, Delta E = {np.degrees(band):.3f} deg", {"band_rad": band}),
    ):
        needed = iterations_needed(cases, np.random.default_rng(1), **options)  # type: ignore[arg-type]
        print(
            f"  {words:34} below 200 in {np.mean(needed < 200):.0%}; median {np.median(needed):.0f}, "
            f"largest {np.max(needed):.0f}"
        )
    ratio, coverage = ratio_and_coverage(draw(1000, rng), rng)
    print("1,000 cases after the polish      " + "".join(f"{name:>12}" for name in NAMES))
    print("  RMS error / Cramer-Rao bound    " + "".join(f"{value:12.3f}" for value in ratio))
    print("  coverage of the 95 % intervals  " + "".join(f"{value:12.1%}" for value in coverage))
    print(f"  coverage, all together            {coverage.mean():.1%}")
    print("Table 2's devices, diagnosed on one sweep, compensated on another: largest error [deg]")
    for name in DEVICES:
        before, after = compensated(name).peak_deg
        print(f"  {name}   {before:.3f} -> {after:.3f}")


if __name__ == "__main__":
    main()
