"""Faults of a set-up: each puts one thing wrong into a bench that is right, as a person or a machine would."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tests.setup_faults.bench import Array, Bench, channels, draw, scatter

Make = Callable[[np.random.Generator], Bench]
EVERY = ("own", "radians", "counts", "semicolon", "npz")
DEGREES = ("own", "semicolon", "npz")


@dataclass(frozen=True)
class Fault:
    """A fault: how a log with it is made, the words of ``doctor`` that name it, the formats it can be written in."""

    make: Make
    named: tuple[str, ...]
    formats: tuple[str, ...] = EVERY


def _without(bench: Bench, *names: str) -> Bench:
    for name in names:
        bench.columns.pop(name, None)
    return bench


def _at(bench: Bench, reading: Array, rng: np.random.Generator) -> Bench:
    """The bench with another reading, without what was computed from the first."""
    bench.columns["measured_deg"] = reading + scatter(bench, rng)
    return _without(bench, "vx", "vy")


def axial(rng: np.random.Generator) -> Bench:
    bench = draw(rng)
    at = np.radians(bench.shaft_deg)
    turning = rng.uniform(0.1, 0.8) * np.exp(1j * at) + rng.uniform(0.0, 0.1) * np.exp(-1j * at)
    reading = np.degrees(np.angle(1.0 + turning)) + rng.uniform(0.0, 360.0)
    return _at(bench, reading, rng)


def no_magnet(rng: np.random.Generator) -> Bench:
    bench = draw(rng, turns=int(rng.integers(2, 6)))
    if rng.random() < 0.5:
        return _at(bench, rng.uniform(0.0, 360.0, bench.n), rng)
    return _at(bench, rng.uniform(0.0, 360.0) + rng.uniform(2.0, 30.0) * rng.standard_normal(bench.n), rng)


def no_magnet_beside_the_mains(rng: np.random.Generator) -> Bench:
    """No field but the mains': the reading swings along one line, about a mean or from side to side, and scatters."""
    bench = draw(rng, moving=True, turns=int(rng.integers(2, 6)))
    mains = float(rng.choice([50.0, 60.0]))
    time = np.arange(bench.n) / (mains * rng.uniform(2.3, 20.0))
    line = np.sin(2.0 * np.pi * mains * time + rng.uniform(0.0, 6.0))
    bench.columns.pop("speed_rpm", None)
    bench.columns["time_s"] = time
    if rng.random() < 0.5:
        scatter_deg = rng.uniform(2.0, 30.0)
        swing = scatter_deg * (rng.uniform(0.5, 3.0) * line + rng.standard_normal(bench.n))
        return _at(bench, rng.uniform(0.0, 360.0) + swing, rng)
    x, y = rng.standard_normal((2, bench.n))
    towards, size = rng.uniform(0.0, 6.0), rng.uniform(0.5, 4.0)
    x, y = x + size * np.cos(towards) * line, y + size * np.sin(towards) * line
    return _at(bench, np.degrees(np.arctan2(y, x)), rng)


def weak(rng: np.random.Generator) -> Bench:
    bench = draw(rng)
    if rng.random() < 0.4:
        bench.columns["agc"] = np.full(bench.n, 255.0)
        return bench
    bench.noise_deg = float(rng.uniform(2.0, 6.0))
    bench.columns["measured_deg"] = bench.columns["measured_deg"] + scatter(bench, rng)
    return _without(bench, "vx", "vy")


def strong(rng: np.random.Generator) -> Bench:
    bench = draw(rng)
    way = rng.integers(0, 3)
    if way == 0:
        bench.columns["agc"] = np.zeros(bench.n)
        bench.columns.pop("status", None)
    elif way == 1:
        bench.columns["magnitude"] = np.full(bench.n, 4095.0)
    else:
        clipped = channels(bench, rng, limit=float(rng.uniform(0.5, 0.85)))
        bench.columns |= clipped
        bench.columns["measured_deg"] = np.degrees(np.unwrap(np.arctan2(clipped["vy"], clipped["vx"])))
    return bench


def off_centre(rng: np.random.Generator) -> Bench:
    bench = draw(rng)
    way, order, at = rng.integers(0, 3), int(rng.integers(1, 3)), np.radians(bench.shaft_deg)
    lead = rng.uniform(0.0, 6.0)
    if way == 0:
        share = rng.uniform(0.15, 0.5)
        bench.columns["magnitude"] = np.round(1800.0 * (1.0 + share * np.cos(order * at + lead)))
        return _at(bench, bench.shaft_deg + 20.0 * share * np.sin(order * at + lead), rng)
    if way == 1:
        return _at(bench, bench.shaft_deg + rng.uniform(10.0, 25.0) * np.sin(order * at + lead), rng)
    x = np.cos(at) + rng.uniform(0.2, 0.45) * np.cos(lead)
    y = np.sin(at) + rng.uniform(0.2, 0.45) * np.sin(lead)
    off = max(0.25 - float(np.hypot(np.mean(x), np.mean(y))), 0.0)
    x = x + off
    _at(bench, np.degrees(np.unwrap(np.arctan2(y, x))), rng)
    bench.columns |= {"vx": np.round(2000.0 * x), "vy": np.round(2000.0 * y)}
    return bench


def electrical_reading(rng: np.random.Generator) -> Bench:
    pairs = int(rng.integers(2, 12))
    bench = draw(rng, points=int(rng.integers(8 * pairs, 8 * pairs + 300)))
    own = bench.error_deg
    return _at(bench, pairs * bench.shaft_deg + own + 10.0, rng)


def electrical_reference(rng: np.random.Generator) -> Bench:
    pairs = int(rng.integers(2, 12))
    bench = draw(rng, points=int(rng.integers(8 * pairs, 8 * pairs + 300)), turns=int(rng.integers(2, 5)))
    bench.columns["reference_deg"] = pairs * bench.shaft_deg
    return bench


def other_pole_pairs(rng: np.random.Generator) -> Bench:
    true, assumed = (int(one) for one in rng.choice([2, 3, 4, 5, 7, 11], 2, replace=False))
    bench = draw(rng, turns=int(rng.integers(2, 6)), points=int(rng.integers(150, 400)))
    return _at(bench, bench.shaft_deg * true / assumed + bench.error_deg, rng)


def gear(rng: np.random.Generator) -> Bench:
    ratio = float(rng.choice([0.25, 1 / 3, 0.5, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 10.0]))
    bench = draw(rng, turns=int(rng.integers(4, 8)), points=int(rng.integers(120, 400)))
    return _at(bench, bench.shaft_deg * ratio + bench.error_deg, rng)


def other_way(rng: np.random.Generator) -> Bench:
    bench = draw(rng)
    return _at(bench, -bench.columns["measured_deg"], rng)


def wrong_counts(rng: np.random.Generator) -> Bench:
    taken, true = rng.permutation(rng.choice([[4000, 4096], [1000, 1024], [2000, 2048], [400, 360], [500, 512]]))
    bench = draw(rng, turns=int(rng.integers(2, 6)))
    bench.wrapped = False
    if rng.random() < 0.5:
        bench.columns["reference_deg"] = bench.columns["reference_deg"] * true / taken
        return bench
    return _at(bench, bench.columns["measured_deg"] * true / taken, rng)


def units(rng: np.random.Generator) -> Bench:
    """Radians or counts under the name of degrees, on one side or on both."""
    bench = draw(rng, turns=int(rng.integers(1, 4)))
    factor = float(rng.choice([np.pi / 180.0, 4096.0 / 360.0]))
    bench.wrapped = bool(factor > 1.0 or rng.random() < 0.5)
    sides = rng.choice(["reference_deg", "measured_deg", "both"])
    for name in ("reference_deg", "measured_deg") if sides == "both" else (str(sides),):
        values = np.mod(bench.columns[name], 360.0) if bench.wrapped else bench.columns[name]
        bench.columns[name] = np.round(values * factor) if factor > 1.0 else values * factor
    for name in {"reference_deg", "measured_deg"} - {str(sides)} if sides != "both" else set():
        bench.columns[name] = np.mod(bench.columns[name], 360.0)
    bench.wrapped, bench.sensor_bits = False, 0
    return _without(bench, "vx", "vy")


def coarse_time(rng: np.random.Generator) -> Bench:
    bench = draw(rng, moving=True)
    step = bench.columns["time_s"][1]
    tick = step * rng.uniform(1.5, 8.0)
    bench.columns["time_s"] = np.floor(bench.columns["time_s"] / tick) * tick
    return bench


def jittered_time(rng: np.random.Generator) -> Bench:
    bench = draw(rng, moving=True, points=int(rng.integers(120, 400)))
    step = bench.columns["time_s"][1]
    late = step * rng.uniform(0.25, 0.5) * np.abs(rng.standard_normal(bench.n))
    bench.columns["time_s"] = np.maximum.accumulate(bench.columns["time_s"] + late)
    return bench


def unit_of_time(rng: np.random.Generator) -> Bench:
    bench = draw(rng, moving=True)
    step = float(bench.columns["time_s"][1])
    if rng.random() < 0.5:
        bench.columns["speed_rpm"] = np.full(bench.n, 60.0 / step / bench.points)
        bench.columns["time_s"] = bench.columns["time_s"] * float(rng.choice([1e3, 1e6]))
    else:
        bench.columns["time_s"] = np.round(bench.columns["time_s"] * 1e6 * max(1.0, 2e-3 / step))
        bench.columns.pop("speed_rpm", None)
    return bench


def few_points(rng: np.random.Generator) -> Bench:
    return draw(rng, points=int(rng.integers(8, 11)), turns=1, moving=False)


def alias_of_an_order(rng: np.random.Generator) -> Bench:
    points = int(rng.integers(40, 130))
    true = int(rng.integers(int(0.55 * points), int(0.74 * points) if points > 100 else points - 5))
    # Multiples of 4 are clipping's.
    true += int((points - true) % 4 == 0)
    bench = draw(rng, points=points, moving=True)
    line = rng.uniform(8.0, 20.0) * bench.noise_deg * np.sin(np.radians(true * bench.shaft_deg))
    return _at(bench, bench.columns["measured_deg"] + line, rng)


def alias_of_the_mains(rng: np.random.Generator) -> Bench:
    mains = float(rng.choice([50.0, 60.0]))
    bench = draw(rng, moving=True, turns=int(rng.integers(4, 8)), points=int(rng.integers(60, 200)))
    rate = float(rng.uniform(0.62, 0.9) * mains)
    time = np.arange(bench.n) / rate
    bench.columns["time_s"] = time
    bench.columns.pop("speed_rpm", None)
    line = max(15.0 * bench.noise_deg, 0.3) * np.sin(2.0 * np.pi * mains * time)
    return _at(bench, bench.columns["measured_deg"] + line, rng)


def frozen(rng: np.random.Generator) -> Bench:
    bench = draw(rng)
    name = str(rng.choice(["measured_deg", "measured_deg", "reference_deg"]))
    rows = int(np.ceil(rng.uniform(60.0, 200.0) / 360.0 * bench.points))
    first = int(rng.integers(0, max(bench.n - rows, 1)))
    if rng.random() < 0.3:
        first, rows = 0, bench.n
    bench.columns[name][first : first + rows] = bench.columns[name][first]
    return _without(bench, "vx", "vy")


def swapped_channels(rng: np.random.Generator) -> Bench:
    bench = draw(rng)
    both = channels(bench, rng)
    bench.columns |= {"vx": both["vy"], "vy": both["vx"]}
    return bench


def swapped_roles(rng: np.random.Generator) -> Bench:
    """The two columns exchanged: the set angles in even steps stand as the sensor's, or channels tell."""
    bench = draw(rng, moving=True, turns=int(rng.integers(2, 6)))
    bench.sensor_bits = 0
    if rng.random() < 0.5:
        bench.columns |= channels(bench, rng)
    bench.columns["reference_deg"], bench.columns["measured_deg"] = (
        bench.columns["measured_deg"],
        bench.columns["reference_deg"],
    )
    return bench


def coarse_reference(rng: np.random.Generator) -> Bench:
    bench = draw(rng, points=int(rng.integers(150, 400)))
    held = int(rng.integers(3, 12))
    places = (np.arange(bench.n) // held) * held
    bench.columns["reference_deg"] = bench.columns["reference_deg"][places]
    return bench


def read_late(rng: np.random.Generator) -> Bench:
    """A sensor whose word is old when it is read, on a shaft that speeds up."""
    bench = draw(rng, moving=True, turns=int(rng.integers(3, 6)), points=int(rng.integers(80, 300)))
    late_s = float(rng.uniform(0.5e-3, 5e-3))
    fastest = float(rng.uniform(1.0, 4.0)) / 6.0 / late_s
    slowest = rng.uniform(0.1, 0.4)
    speed = fastest * (slowest + (1.0 - slowest) * np.sin(np.linspace(0.0, np.pi, bench.n)))
    bench.columns["time_s"] = np.cumsum(360.0 / bench.points / (6.0 * speed))
    bench.columns["speed_rpm"] = speed
    return _at(bench, bench.columns["measured_deg"] - 6.0 * late_s * speed, rng)


def open_turn(rng: np.random.Generator) -> Bench:
    bench = draw(rng, turns=int(rng.integers(2, 6)), points=int(rng.integers(60, 300)))
    slip = rng.uniform(1.0, 10.0) * rng.choice([-1.0, 1.0])
    first = int(rng.integers(bench.points // 2, bench.n - bench.points // 2))
    # Where the shaft turns round a slip looks like play.
    if abs(first - bench.n // 2) < bench.points // 6:
        first += bench.points // 3
    bench.columns["reference_deg"][first:] += slip
    return bench


def part_of_a_turn(rng: np.random.Generator) -> Bench:
    bench = draw(rng, turns=1, points=int(rng.integers(80, 400)))
    kept = np.abs(bench.shaft_deg - bench.shaft_deg[0]) < rng.uniform(150.0, 280.0)
    bench.columns = {name: values[kept] for name, values in bench.columns.items()}
    bench.shaft_deg, bench.error_deg = bench.shaft_deg[kept], bench.error_deg[kept]
    return _without(bench, "frame")


def mistyped(rng: np.random.Generator) -> Bench:
    bench = draw(rng, points=int(rng.integers(20, 48)), turns=1, moving=False)
    bench.sensor_bits, bench.wrapped = 0, True
    bench.noise_deg = min(bench.noise_deg, 0.08)
    row = int(rng.integers(0, bench.n))
    bench.columns["measured_deg"][row] += rng.uniform(4.0, 15.0) * rng.choice([-1.0, 1.0])
    return _without(bench, "vx", "vy")


def lost_frames(rng: np.random.Generator) -> Bench:
    bench = draw(rng, points=int(rng.integers(80, 400)))
    bench.columns["frame"] = np.mod(np.arange(bench.n) * 1.0, float(rng.choice([15, 100, 256])))
    lost = rng.choice(np.arange(2, bench.n - 2), int(rng.integers(1, 12)), replace=False)
    kept = np.setdiff1d(np.arange(bench.n), lost)
    bench.columns = {name: values[kept] for name, values in bench.columns.items()}
    bench.shaft_deg, bench.error_deg = bench.shaft_deg[kept], bench.error_deg[kept]
    return bench


def bad_status(rng: np.random.Generator) -> Bench:
    bench = draw(rng)
    bench.columns["status"] = np.full(bench.n, 32.0)
    bench.columns["status"][rng.choice(bench.n, max(bench.n // 30, 1), replace=False)] = 48.0
    return bench


def no_reference(rng: np.random.Generator) -> Bench:
    return _without(draw(rng, moving=True), "reference_deg", "vx", "vy")


_RATIO = ("pole_pairs",)
FAULTS: dict[str, Fault] = {
    "axial magnet": Fault(axial, ("axial_magnet",)),
    "no magnet": Fault(no_magnet, ("no_magnet",)),
    "weak magnet": Fault(weak, ("weak_field",)),
    "strong magnet": Fault(strong, ("strong_field",)),
    "off centre": Fault(off_centre, ("off_centre",)),
    "electrical reading": Fault(electrical_reading, _RATIO),
    "electrical reference": Fault(electrical_reference, _RATIO),
    "other pole pairs": Fault(other_pole_pairs, _RATIO),
    "gear": Fault(gear, _RATIO),
    "other way": Fault(other_way, ("other_way",)),
    "wrong counts": Fault(wrong_counts, ("wrong_counts", "pole_pairs"), DEGREES),
    "units": Fault(units, ("units",), ("own", "semicolon")),
    "coarse time": Fault(coarse_time, ("time_coarse", "time_jitter")),
    "jittered time": Fault(jittered_time, ("time_jitter",)),
    "unit of time": Fault(unit_of_time, ("time_unit",)),
    "few points": Fault(few_points, ("few_points",)),
    "alias of an order": Fault(alias_of_an_order, ("aliased_order",)),
    "alias of the mains": Fault(alias_of_the_mains, ("aliased_frequency",)),
    "frozen": Fault(frozen, ("frozen",)),
    "swapped channels": Fault(swapped_channels, ("swapped_channels",)),
    "swapped roles": Fault(swapped_roles, ("swapped_roles",), DEGREES),
    "coarse reference": Fault(coarse_reference, ("coarse_reference",)),
    "read late": Fault(read_late, ("read_late",)),
    "open turn": Fault(open_turn, ("turn_not_closed",)),
    "part of a turn": Fault(part_of_a_turn, ("part_of_a_turn",), ("own", "radians", "semicolon", "npz")),
    "mistyped": Fault(mistyped, ("typing_error",), DEGREES),
    "lost frames": Fault(lost_frames, ("lost_frames",)),
    "bad status": Fault(bad_status, ("other_status",)),
    "no reference": Fault(no_reference, ("no_reference",)),
    "no magnet, mains": Fault(no_magnet_beside_the_mains, ("no_magnet",)),
}
"""Every fault by name."""
CLEAN = Fault(draw, ())
