"""Our continuous correction against a look-up table with linear interpolation, calibrated on the same few readings.

``python -m tests.benchmarks.compensation``, on the measured sweeps beside the checkout. Each draw takes so many
readings evenly round the circle (of one turn where the file has turns, as a calibration does), builds both
corrections, and tests them on all other readings. Where the reference finds its zero anew at every turn, each turn's
own zero is taken out of both. The table averages readings repeated at one angle.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from diagnosis.correction.calibration import calibrate
from diagnosis.correction.compensation import correction_of
from diagnosis.correction.cross_validation import against
from tests.measured import REAL
from twin.angles import TAU, Array, radians, wrap
from twin.sweep import Sweep

FILES = (
    "jig_hall_sensor2",
    "jig_hall_sensor3",
    "jig_hall_sensor5",
    "oven_b_start1",
    "oven_b_start2",
    "room_repeat",
    "stepper_as5047d_a",
    "stepper_as5047d_b",
    "stepper_as5047d_c",
)
POINTS = (8, 16, 32, 64)
DRAWS = 10
_SAME_ANGLE_DEG = 0.01
_SAME_PLACE = np.radians(0.5)


def look_up_table(reference: Array, measured: Array) -> Callable[[Array], Array]:
    """What firmware does today: the error at the calibrated readings (n,) [rad], straight lines between them."""
    slope = 1.0 if _follows(reference, measured, 1.0) >= _follows(reference, measured, -1.0) else -1.0
    _, group = np.unique(np.round(np.degrees(reference) % 360.0 / _SAME_ANGLE_DEG), return_inverse=True)
    count = np.bincount(group)
    error = wrap(reference - slope * measured)
    middle = float(np.angle(np.mean(np.exp(1j * error))))
    knots = np.bincount(group, wrap(error - middle)) / count
    place = np.angle(np.bincount(group, np.cos(measured)) + 1j * np.bincount(group, np.sin(measured))) % TAU
    order = np.argsort(place)
    return lambda reading: wrap(
        slope * reading + middle + np.interp(reading % TAU, place[order], knots[order], period=TAU)
    )


def drawn(reference: Array, points: int, rng: np.random.Generator) -> Array:
    """Indices (points,) of readings evenly round the circle from a random start, no reading twice."""
    free = np.ones(reference.size, dtype=np.bool_)
    start = rng.uniform(0.0, TAU)
    picked = []
    for k in range(points):
        distance = np.where(free, np.abs(wrap(reference - start - TAU * k / points)), np.inf)
        index = int(rng.choice(np.flatnonzero(distance < distance.min() + _SAME_PLACE)))
        free[index] = False
        picked.append(index)
    return np.array(picked)


def compared(sweep: Sweep, points: int, seed: int) -> tuple[float, float]:
    """RMS [deg] on the readings left out, ours and the table's, for one draw of calibration readings."""
    rng = np.random.default_rng(seed)
    reference, measured = radians(sweep.reference_deg), radians(sweep.measured_deg)
    pool = np.arange(len(sweep))
    if sweep.turn is not None:
        pool = np.flatnonzero(sweep.turn == rng.choice(np.unique(sweep.turn)))
    chosen = pool[drawn(reference[pool], min(points, pool.size - 1), rng)]
    rest = np.ones(len(sweep), dtype=np.bool_)
    rest[chosen] = False
    ours = correction_of(calibrate(reference[chosen], measured[chosen], rng=rng).chain).shaft
    table = look_up_table(reference[chosen], measured[chosen])
    turn = np.zeros(int(rest.sum())) if sweep.turn is None else sweep.turn[rest]
    found = []
    for shaft in (ours, table):
        error = against(reference[rest], measured[rest], shaft)
        found.append((error if sweep.turn is None else error.per_turn(turn)).rms_deg[1])
    return found[0], found[1]


def mean_of_draws(sweep: Sweep, points: int, draws: int = DRAWS) -> tuple[float, float, int]:
    """Mean RMS [deg] of ours and of the table over several draws, and in how many of them ours is the smaller."""
    results = np.array([compared(sweep, points, seed) for seed in range(draws)])
    wins = int(np.count_nonzero(results[:, 0] < results[:, 1]))
    return float(results[:, 0].mean()), float(results[:, 1].mean()), wins


def at_angles_left_out(sweep: Sweep) -> tuple[float, float]:
    """RMS [deg] of ours and of the table at each angle in turn, calibrated on all readings at the other angles."""
    reference, measured = radians(sweep.reference_deg), radians(sweep.measured_deg)
    place = np.round(sweep.reference_deg % 360.0 / _SAME_ANGLE_DEG)
    squares = np.zeros(2)
    for value in np.unique(place):
        out = place == value
        ours = correction_of(calibrate(reference[~out], measured[~out], rng=np.random.default_rng(0)).chain).shaft
        table = look_up_table(reference[~out], measured[~out])
        for k, shaft in enumerate((ours, table)):
            squares[k] += np.sum(against(reference[out], measured[out], shaft).after_rad ** 2)
    rms = np.degrees(np.sqrt(squares / len(sweep)))
    return float(rms[0]), float(rms[1])


def _follows(reference: Array, measured: Array, sense: float) -> float:
    return float(np.abs(np.mean(np.exp(1j * (measured - sense * reference)))))


def main() -> None:
    """Compare on every measured sweep and print."""
    if not REAL.exists():
        print(f"no measured sweeps at {REAL}")
        return
    print(
        f"RMS [deg] on readings left out, mean of {DRAWS} draws: ours / look-up table (draws in which ours is smaller)"
    )
    print(f"{'':20}" + "".join(f"{f'{points} points':>26}" for points in POINTS))
    for name in FILES:
        sweep = Sweep.read(REAL / f"{name}.csv")
        cells = []
        for points in POINTS:
            ours, table, wins = mean_of_draws(sweep, points)
            cells.append(f"{ours:8.4f} / {table:6.4f} ({wins:2d}/{DRAWS})")
        print(f"{name:20}" + "".join(f"{cell:>26}" for cell in cells))
    print(
        "The jigs have 16 angles, so 32 and 64 readings repeat them. At each angle in turn, calibrated on the others:"
    )
    for name in FILES[:3]:
        ours, table = at_angles_left_out(Sweep.read(REAL / f"{name}.csv"))
        print(f"{name:20}{ours:8.4f} / {table:6.4f}")


if __name__ == "__main__":
    main()
