"""A batch asked by loops that one would write oneself, and by ours: ``python -m tests.benchmarks.side_by_side``.

200 devices of 720 readings, forth and back, with 0.02 deg of noise; all have a hysteresis of 0.0007 deg, a quarter of
what a single one shows, and one has a ripple. A loop of scipy's ``least_squares`` with lmfit's report of each device, a
loop of pyswarms (a few devices, scaled up), a loop of ``diagnose``, and what ``halltwin fleet`` computes, on one core.
The loops fit the error model and ask no more; the fleet's time holds its search for shared causes and odd devices.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence

import numpy as np

from diagnosis import diagnose
from diagnosis.error_model.model import NOMINAL, ZERO
from diagnosis.error_model.search_range import first_box
from diagnosis.population.looks import looked_at_sweeps
from diagnosis.population.population import Population
from diagnosis.population.template import template_of
from tests.benchmarks import swarm
from tests.benchmarks.swarm import Objective, Problem
from tests.hidden.fleets.generator import Plan
from tests.hidden.fleets.study import sweeps_of
from twin.angles import Array
from twin.sweep import Sweep

PLAN = Plan(count=200, cause="hysteresis", strength_deg=0.0007, odd={4: ("drive_ripple", 0.1)})
FEW = 3
"""Devices that pyswarms is given."""


def problem_of(sweep: Sweep) -> Problem:
    """A device as the other tools are given it: its readings, and the box about the mean error."""
    measured = np.radians(sweep.measured_deg)
    mean = np.angle(np.mean(np.exp(1j * (measured - np.radians(sweep.reference_deg)))))
    box = first_box(np.array([mean]))
    return Problem(np.radians(sweep.reference_deg), measured, box.lower[0], box.upper[0])


def reported(task: Problem) -> float:
    """RMS [deg] that scipy's least_squares leaves, with lmfit's report of the factors and their errors."""
    from lmfit import Parameters, fit_report, minimize

    objective = Objective(task)
    parameters = Parameters()
    start = NOMINAL.copy()
    start[ZERO] = 0.5 * (task.lower[ZERO] + task.upper[ZERO])
    for k, (value, low, high) in enumerate(zip(start, task.lower, task.upper, strict=True)):
        parameters.add(f"p{k}", value=float(value), min=float(low), max=float(high))

    def residual(given: Parameters) -> Array:
        return objective.residual(np.array([given[f"p{k}"].value for k in range(6)]))

    found = minimize(residual, parameters, method="least_squares")
    fit_report(found)
    return task.rms_deg(np.array([found.params[f"p{k}"].value for k in range(6)]))


def swarmed(task: Problem) -> float:
    """RMS [deg] that pyswarms leaves with the paper's particles and iterations."""
    return swarm.pyswarms(task, 1, float("inf"), Objective(task)).rms_deg or np.nan


def population(sweeps: Sequence[Sweep]) -> Population:
    """What ``halltwin fleet`` says of them before it explains those that stand apart."""
    return looked_at_sweeps(template_of(sweeps[:32], told_sense=None, seed=0), sweeps).population


def timed(run: Callable[[], object]) -> float:
    """Seconds that it takes."""
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def main() -> None:
    """Run them one after the other and print milliseconds a device, and what each leaves."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.side_by_side", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    sweeps = sweeps_of(PLAN, seed=asked.seed)
    tasks = [problem_of(sweep) for sweep in sweeps]
    # What is loaded and set up once counts for no one.
    reported(tasks[0])
    diagnose(sweeps[0])
    population(sweeps[:40])

    found: list[Population] = []
    left: dict[str, list[float]] = {"loop": [], "pyswarms": []}
    ours = timed(lambda: found.append(population(sweeps))) / len(sweeps)
    told = timed(lambda: [diagnose(sweep) for sweep in sweeps]) / len(sweeps)
    loop = timed(lambda: left["loop"].extend(map(reported, tasks))) / len(sweeps)
    swarms = timed(lambda: left["pyswarms"].extend(map(swarmed, tasks[:FEW]))) / FEW
    readings = sweeps[0].reference_deg.size
    print(f"{len(sweeps)} devices of {readings} readings, one core             ms a device   over fleet's")
    rows = (
        ("fleet: factors, causes, who stands apart", ours),
        ("diagnose, one by one", told),
        ("least_squares, lmfit's report, one by one", loop),
        ("pyswarms 100 x 200, one by one", swarms),
    )
    for name, seconds in rows:
        print(f"  {name:52} {1e3 * seconds:10.2f} {seconds / ours:12.2f}")
    medians = [float(np.median(left[name])) for name in ("loop", "pyswarms")]
    print(f"RMS left, median: {medians[0]:.6f} deg by the loop, {medians[1]:.6f} by pyswarms")
    causes = ", ".join(f"{cause.name} {cause.amplitude:.2g}" for cause in found[0].causes) or "none"
    apart = ", ".join(sweeps[one.device].name for one in found[0].apart)
    print(f"the fleet names beside the factors: {causes}; apart: {apart}")


if __name__ == "__main__":
    main()
