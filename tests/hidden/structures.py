"""Structure that is in no catalogue: what an honest diagnosis calls `unnamed`.

Each plan returns an `Injected` whose parameters describe the structure, its strength being the
amplitude; `added` turns it into degrees to add to the sensor's angle, `noise_factor` into a
factor on the noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .baseline import Injected, Setting
from .motion import NO_DEMANDS, Array, Demands, Motion
from .protocols import PROTOCOLS

Plan = Callable[[np.random.Generator, Setting], dict[str, float]]
Added = Callable[[Motion, dict[str, float]], Array]


def _wave(turns: Array, given: dict[str, float]) -> Array:
    """sin of an angle in turns, with the structure's phase."""
    wave: Array = np.sin(2 * np.pi * turns + np.radians(given["phase_deg"]))
    return wave


def _phase(rng: np.random.Generator) -> float:
    return float(rng.uniform(-180.0, 180.0))


def _plan_high_order(rng: np.random.Generator, setting: Setting) -> dict[str, float]:
    return {"order": float(rng.integers(9, 20)), "phase_deg": _phase(rng)}


def _order(motion: Motion, given: dict[str, float]) -> Array:
    return _wave(given["order"] * motion.shaft_deg / 360.0, given)


def _plan_non_integer(rng: np.random.Generator, setting: Setting) -> dict[str, float]:
    # far enough from the whole orders for the turns at hand, and above the cage orders
    whole = float(rng.integers(0, 8))
    lowest = 0.62 if whole == 0 else 0.25
    return {"order": whole + float(rng.uniform(lowest, 0.75)), "phase_deg": _phase(rng)}


def _non_integer(motion: Motion, given: dict[str, float]) -> Array:
    return _wave(given["order"] * (motion.shaft_deg - motion.shaft_deg[0]) / 360.0, given)


def _plan_bump(rng: np.random.Generator, setting: Setting) -> dict[str, float]:
    way = float(rng.choice((-1.0, 1.0)))
    return {
        "centre_deg": float(rng.uniform(0.0, 360.0)),
        "fwhm_deg": float(rng.uniform(10.0, 40.0)),
        "sign": way,
    }


def _bump(motion: Motion, given: dict[str, float]) -> Array:
    away = np.mod(motion.shaft_deg - given["centre_deg"] + 180.0, 360.0) - 180.0
    bump: Array = given["sign"] * np.exp(-4 * np.log(2.0) * (away / given["fwhm_deg"]) ** 2)
    return bump


def _plan_direction(rng: np.random.Generator, setting: Setting) -> dict[str, float]:
    return {"order": float(rng.integers(1, 6)), "phase_deg": _phase(rng)}


def _direction(motion: Motion, given: dict[str, float]) -> Array:
    return motion.direction * _order(motion, given)


def _plan_temperature(rng: np.random.Generator, setting: Setting) -> dict[str, float]:
    return {"order": float(rng.integers(3, 7)), "phase_deg": _phase(rng)}


def _temperature(motion: Motion, given: dict[str, float]) -> Array:
    share: Array = motion.warmth / np.abs(motion.warmth).max()
    return share * _order(motion, given)


def _plan_time(rng: np.random.Generator, setting: Setting) -> dict[str, float]:
    # several periods in the sweep, several readings in a period at every speed
    motion = setting.motion
    slowest = float(np.max(np.diff(motion.time_s)))
    lowest, highest = 4.0 / float(np.ptp(motion.time_s)), 0.3 / slowest
    return {
        "frequency_Hz": float(np.exp(rng.uniform(np.log(max(lowest, 3.0)), np.log(highest)))),
        "phase_deg": _phase(rng),
    }


def _time(motion: Motion, given: dict[str, float]) -> Array:
    return _wave(given["frequency_Hz"] * motion.time_s, given)


def _plan_burst(rng: np.random.Generator, setting: Setting) -> dict[str, float]:
    rows = len(setting.motion.time_s)
    length = int(rng.uniform(0.06, 0.15) * rows)
    return {"row": float(rng.integers(0, rows - length)), "rows": float(length), "factor": 4.0}


def _burst(motion: Motion, given: dict[str, float]) -> Array:
    return np.zeros_like(motion.shaft_deg)


def _plan_speed(rng: np.random.Generator, setting: Setting) -> dict[str, float]:
    return {}


def _speed(motion: Motion, given: dict[str, float]) -> Array:
    share = motion.speed_rpm / np.abs(motion.speed_rpm).max()
    lag: Array = -share * np.abs(share)
    return lag


@dataclass(frozen=True)
class Structure:
    """How a structure is drawn and where it shows."""

    protocols: tuple[str, ...]
    plan: Plan
    added: Added
    """Unit amplitude, shape (n,)."""
    demands: Demands = NO_DEMANDS


ALL = tuple(PROTOCOLS)
STRUCTURES: dict[str, Structure] = {
    "order_9_to_19": Structure(ALL, _plan_high_order, _order),
    "non_integer_order": Structure(("static", "many_turns", "spin"), _plan_non_integer, _non_integer, Demands(turns=4)),
    "local_bump": Structure(ALL, _plan_bump, _bump),
    "direction_times_order": Structure(("static_both", "oven_both", "spin_both"), _plan_direction, _direction),
    "temperature_times_order": Structure(("oven", "oven_both"), _plan_temperature, _temperature),
    "time_frequency": Structure(("speeds", "speeds_one_way"), _plan_time, _time, Demands(time_column=True)),
    "noise_burst": Structure(
        ("static", "static_both", "many_turns"), _plan_burst, _burst, Demands(turns=2, single_readings=True)
    ),
    "speed_squared_lag": Structure(("speeds",), _plan_speed, _speed),
}


def plan(name: str, rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Settle a structure."""
    return Injected(name, strength, STRUCTURES[name].plan(rng, setting))


def added(motion: Motion, injected: Injected) -> Array:
    """Degrees on the sensor's side, shape (n,)."""
    return injected.strength_deg * STRUCTURES[injected.name].added(motion, dict(injected.parameters))


def noise_factor(rows: int, injected: Injected) -> Array:
    """Factor on the noise, shape (rows,)."""
    factor = np.ones(rows)
    if injected.name == "noise_burst":
        first = int(injected.parameters["row"])
        factor[first : first + int(injected.parameters["rows"])] = injected.parameters["factor"]
    return factor
