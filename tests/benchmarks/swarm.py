"""Our fit and swarm against the ordinary tools, on the same data in one process: ``python -m tests.benchmarks.swarm``.

Every method searches the same six parameters in the same box (Table 2's, zero within 2 deg of the mean error), from
one sweep with 0.02 deg of noise. Ours work on the quadratic form, the others evaluate all readings, from their cosines,
whose making counts for everyone. What would take longer than ``--patience`` seconds is timed over a few evaluations and
scaled up: marked ~, without an RMS.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from diagnosis.error_model import model, swarm
from diagnosis.error_model.fit import fit_baseline
from diagnosis.error_model.global_search import QUICK
from diagnosis.error_model.grid_search import full_grid_count, grid_search
from diagnosis.error_model.model import NOMINAL, ZERO, Readings
from diagnosis.error_model.search_range import first_box
from twin.angles import TAU, Array, wrap

NOISE_DEG = 0.02
PARTICLES, ITERATIONS = 100, 200
_PROBE = 40


@dataclass(frozen=True)
class Problem:
    """One sweep, and the box (6,) that every method searches."""

    reference: Array
    measured: Array
    lower: Array
    upper: Array

    def rms_deg(self, point: Array) -> float:
        """Exact RMS angle error of a point (6,)."""
        residual = Readings.of(self.reference, self.measured).residual(point)
        return float(np.degrees(np.sqrt(np.mean(residual**2))))


@dataclass(frozen=True)
class Outcome:
    """Time [s], RMS [deg] (None where scaled up), evaluations of the objective over all readings or particles."""

    seconds: float
    rms_deg: float | None
    evaluations: int


def problem(readings: int, seed: int) -> Problem:
    """A device drawn from Table 2's ranges, measured at equally spaced angles."""
    rng = np.random.default_rng(seed)
    reference = TAU * np.arange(readings) / readings
    box = first_box(np.zeros(1))
    point = rng.uniform(box.lower[0], box.upper[0])
    x, y = Readings.of(reference, reference).channels(point)
    measured = np.arctan2(y, x) + np.radians(NOISE_DEG) * rng.standard_normal(readings)
    mean = np.angle(np.mean(np.exp(1j * (measured - reference))))
    centred = first_box(np.array([mean]))
    return Problem(reference, measured, centred.lower[0], centred.upper[0])


class Objective:
    """Sum of squares of the exact angle error over all readings, one point at a time: what the other tools are given.

    The cosines of the readings are kept between evaluations, as a careful user would.
    """

    def __init__(self, task: Problem) -> None:
        self.cos_shaft, self.sin_shaft = np.cos(task.reference), np.sin(task.reference)
        self.cos_read, self.sin_read = np.cos(task.measured), np.sin(task.measured)
        self.count = 0

    def residual(self, point: Array) -> Array:
        """(n,) [rad]"""
        self.count += 1
        return self._errors(np.asarray(point))

    def cost(self, point: Array) -> float:
        """[rad^2]"""
        residual = self.residual(point)
        return float(residual @ residual)

    def costs(self, points: Array) -> Array:
        """(particles,)"""
        if self.cos_shaft.size > 20000:
            return np.array([self.cost(point) for point in points])
        self.count += len(points)
        residual = self._errors(points)
        return np.asarray(np.einsum("ij,ij->i", residual, residual))

    def _errors(self, points: Array) -> Array:
        """Angle errors (..., n) [rad] of points (..., 6)."""
        vx, vy, gain, beta, quad, zero = (points[..., k, None] for k in range(6))
        cosine = np.cos(zero) * self.cos_shaft - np.sin(zero) * self.sin_shaft
        sine = np.cos(zero + beta) * self.sin_shaft + np.sin(zero + beta) * self.cos_shaft
        x, y = vx + cosine * (1.0 + quad * cosine), gain * (vy + sine * (1.0 + quad * sine))
        return np.arctan2(x * self.sin_read - y * self.cos_read, x * self.cos_read + y * self.sin_read)


class Written(Objective):
    """The same from Eq. 4 and 5 as they are written: all trigonometry in every evaluation."""

    def __init__(self, task: Problem) -> None:
        super().__init__(task)
        self.task = task

    def costs(self, points: Array) -> Array:
        """(particles,)"""
        if self.task.reference.size > 20000:
            return np.concatenate([self._costs(point[None]) for point in points])
        return self._costs(points)

    def _costs(self, points: Array) -> Array:
        self.count += len(points)
        vx, vy, gain, beta, quad, zero = points.T[..., None]
        angle = self.task.reference + zero
        cosine, sine = np.cos(angle), np.cos(angle - np.pi / 2 + beta)
        x = vx + cosine + quad * cosine**2
        y = gain * (vy + sine + quad * sine**2)
        residual = wrap(self.task.measured - np.arctan2(y, x))
        return np.asarray((residual**2).sum(axis=1))


def our_swarm(task: Problem, seed: int) -> Outcome:
    """The paper's 100 particles and 200 iterations, on the quadratic form; the pass that builds it included."""
    start = time.perf_counter()
    root = model.factor(Readings.of(task.reference, task.measured).gram())
    result = swarm.run(
        lambda points: model.cost(model.coefficients(points), root),
        task.lower[None],
        task.upper[None],
        rng=np.random.default_rng(seed),
    )
    seconds = time.perf_counter() - start
    return Outcome(seconds, task.rms_deg(result.best[0]), result.evaluations)


def our_quick_swarm(task: Problem, seed: int) -> Outcome:
    """The swarm as the diagnoser runs it where descents disagree: 32 particles, stopped where it has settled."""
    start = time.perf_counter()
    root = model.factor(Readings.of(task.reference, task.measured).gram())
    result = swarm.run(
        lambda points: model.cost(model.coefficients(points), root),
        task.lower[None],
        task.upper[None],
        rng=np.random.default_rng(seed),
        settings=QUICK,
    )
    seconds = time.perf_counter() - start
    return Outcome(seconds, task.rms_deg(result.best[0]), result.evaluations)


def our_fit(task: Problem, seed: int) -> Outcome:
    """Descents, least squares, covariance and residuals: everything that fit_baseline does."""
    start = time.perf_counter()
    fit = fit_baseline(task.reference, task.measured, rng=np.random.default_rng(seed), senses=(1, 1))
    seconds = time.perf_counter() - start
    return Outcome(seconds, task.rms_deg(fit.point), fit.contributions.particles_evaluated)


def numpy_swarm(task: Problem, seed: int, patience: float) -> Outcome:
    """Our own swarm's moves with the full readings in the objective: what the quadratic form buys."""
    objective = Objective(task)
    scaled = _scaled(objective, task, PARTICLES * (ITERATIONS + 1), patience)
    if scaled is not None:
        return scaled
    start = time.perf_counter()
    result = swarm.run(
        lambda points: objective.costs(points[0])[None],
        task.lower[None],
        task.upper[None],
        rng=np.random.default_rng(seed),
    )
    return Outcome(time.perf_counter() - start, task.rms_deg(result.best[0]), objective.count)


def pyswarms(task: Problem, seed: int, patience: float, objective: Objective) -> Outcome:
    """pyswarms.single.GlobalBestPSO with the usual constants; it draws from NumPy's global generator."""
    import logging

    from pyswarms.single import GlobalBestPSO

    scaled = _scaled(objective, task, PARTICLES * ITERATIONS, patience)
    if scaled is not None:
        return scaled
    logging.disable(logging.CRITICAL)
    np.random.seed(seed)  # noqa: NPY002
    start = time.perf_counter()
    optimiser = GlobalBestPSO(
        n_particles=PARTICLES,
        dimensions=6,
        options={"c1": 1.494, "c2": 1.494, "w": 0.729},
        bounds=(task.lower, task.upper),
    )
    _, best = optimiser.optimize(objective.costs, iters=ITERATIONS, verbose=False)
    return Outcome(time.perf_counter() - start, task.rms_deg(best), objective.count)


def differential_evolution(task: Problem, seed: int, patience: float, evaluations: int) -> Outcome:
    """scipy.optimize.differential_evolution as it comes, its own polish included."""
    from scipy.optimize import differential_evolution as evolve

    objective = Objective(task)
    scaled = _scaled(objective, task, evaluations, patience)
    if scaled is not None:
        return scaled
    start = time.perf_counter()
    found = evolve(objective.cost, list(zip(task.lower, task.upper, strict=True)), rng=seed)
    return Outcome(time.perf_counter() - start, task.rms_deg(found.x), objective.count)


def least_squares(task: Problem, seed: int) -> Outcome:
    """scipy.optimize.least_squares from an ideal sensor, tolerances tightened so that it comes to rest."""
    from scipy.optimize import least_squares as solve

    start = time.perf_counter()
    objective = Objective(task)
    found = solve(objective.residual, _ideal(task), xtol=1e-12, ftol=1e-12, gtol=1e-12)
    return Outcome(time.perf_counter() - start, task.rms_deg(found.x), objective.count)


def lmfit(task: Problem, seed: int) -> Outcome:
    """lmfit.minimize (leastsq) from an ideal sensor."""
    from lmfit import Parameters, minimize

    start = time.perf_counter()
    objective = Objective(task)
    parameters = Parameters()
    for k, value in enumerate(_ideal(task)):
        parameters.add(f"p{k}", value=float(value))
    found = minimize(lambda given: objective.residual(np.array([given[f"p{k}"].value for k in range(6)])), parameters)
    point = np.array([found.params[f"p{k}"].value for k in range(6)])
    return Outcome(time.perf_counter() - start, task.rms_deg(point), objective.count)


def our_grid(task: Problem, points: int) -> Outcome:
    """The ordinary method on a grid of so many points a parameter."""
    start = time.perf_counter()
    gram = Readings.of(task.reference, task.measured).gram()
    found = grid_search(gram, task.lower, task.upper, points=points)
    return Outcome(time.perf_counter() - start, task.rms_deg(found.best), found.evaluations)


def _ideal(task: Problem) -> Array:
    start = NOMINAL.copy()
    start[ZERO] = 0.5 * (task.lower[ZERO] + task.upper[ZERO])
    return start


def _scaled(objective: Objective, task: Problem, evaluations: int, patience: float) -> Outcome | None:
    """The time of so many evaluations, from a few, where it is beyond patience; else None."""
    points = np.random.default_rng(0).uniform(task.lower, task.upper, (_PROBE, 6))
    start = time.perf_counter()
    objective.costs(points)
    each = (time.perf_counter() - start) / _PROBE
    objective.count = 0
    return Outcome(each * evaluations, None, evaluations) if each * evaluations > patience else None


def _line(name: str, run: Callable[[], Outcome], reference_s: float | None = None, repeats: int = 1) -> Outcome | None:
    try:
        outcomes = [run() for _ in range(repeats)]
    except ImportError as error:
        print(f"  {name:34} not installed: {error}")
        return None
    best = min(outcomes, key=lambda outcome: outcome.seconds)
    rms = "      -     " if best.rms_deg is None else f"{best.rms_deg:12.9f}"
    mark = "~" if best.rms_deg is None else " "
    factor = "" if reference_s is None else f"   {best.seconds / reference_s:9.1f} x"
    print(f"  {name:34} {mark}{best.seconds * 1e3:12.2f} ms   {rms} deg   {best.evaluations:8d}{factor}", flush=True)
    return best


def main() -> None:
    """Run the comparison and print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--readings", type=int, nargs="+", default=[360, 10_000, 1_000_000])
    parser.add_argument("--patience", type=float, default=60.0, help="longest run of one method [s]")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    seed, patience = options.seed, options.patience
    print(f"Table 2's full grid: {full_grid_count():.3g} points; the swarm evaluates {PARTICLES * ITERATIONS}")
    our_fit(problem(360, seed), seed)
    evolved = 10_000
    for readings in options.readings:
        evolved = compare(problem(readings, seed), seed, patience, evolved)


def compare(task: Problem, seed: int, patience: float, evolved: int) -> int:
    """Run every method on one problem; returns the evaluations that differential evolution needed."""
    readings = task.reference.size
    repeats = 5 if readings <= 20000 else 2
    print(f"{readings} readings{'':18}        time           RMS reached      evaluations   time over ours")
    ours = _line("our fit: descents, least squares, intervals", lambda: our_fit(task, seed), repeats=repeats)
    assert ours is not None
    base = ours.seconds
    _line("our swarm as the diagnoser asks for it", lambda: our_quick_swarm(task, seed), base, repeats)
    _line("our swarm, 100 x 200", lambda: our_swarm(task, seed), base, repeats)
    _line("our moves on all readings", lambda: numpy_swarm(task, seed, patience), base)
    _line("pyswarms, Eq. 4 as written", lambda: pyswarms(task, seed, patience, Written(task)), base)
    _line("pyswarms, cosines kept", lambda: pyswarms(task, seed, patience, Objective(task)), base)
    found = _line("scipy differential_evolution", lambda: differential_evolution(task, seed, patience, evolved), base)
    _line("scipy least_squares", lambda: least_squares(task, seed), base, repeats)
    _line("lmfit leastsq", lambda: lmfit(task, seed), base, repeats)
    _line("ordinary method, 7 points each", lambda: our_grid(task, 7), base)
    return evolved if found is None else found.evaluations


if __name__ == "__main__":
    main()
