"""Draw logs of a shaft that spins with a sensor on it and no reference, with what is true of both.

    drawn = draw("coast", seed=3)
    drawn.write("folder")

The same arguments give the same bytes. Independent of what is tested: numpy and the standard library only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .. import baseline as baselines
from ..baseline import Baseline, Injected, Setting
from ..catalogue import CAUSES
from ..chain import Bench, sample
from ..motion import Motion
from ..noise import Noise
from ..streams import stream
from .benches import PROTOCOLS, TURN, Spin
from .drives import Rocking, Stepping
from .frames import PLANS, UNSEEN, send
from .rotor import Array, Trajectory
from .sensor import AtRest, Order, at_rest, bent, motion_of
from .stamps import Clock, clock_of, through_frames

ORDERS = 16


@dataclass(frozen=True)
class Log:
    """One log: its columns as written, and what was true while it was written; shape (n,) each."""

    columns: dict[str, Array]
    shaft_deg: Array
    time_s: Array
    """True, from the beginning of the log."""

    def csv(self) -> str:
        """The file's text; times to a tenth of a microsecond."""
        cells = [
            [f"{one:.7f}" if name == "time_s" else f"{one:.6f}" for one in values]
            for name, values in self.columns.items()
        ]
        return "\n".join([",".join(self.columns), *(",".join(row) for row in zip(*cells, strict=True))]) + "\n"


@dataclass(frozen=True)
class Drawn:
    """The logs of one sensor on one rotor, its true error over the turn, and all that is known of the draw."""

    logs: tuple[Log, ...]
    at_rest: AtRest
    """What the sensor reads over the turn."""
    truth: dict[str, object]

    def write(self, folder: str | Path) -> list[Path]:
        """One file a log."""
        paths = [Path(folder) / f"log{number}.csv" for number in range(len(self.logs))]
        for path, log in zip(paths, self.logs, strict=True):
            path.write_text(log.csv(), encoding="utf-8")
        return paths


@dataclass(frozen=True)
class _Sensor:
    own: Baseline
    noise: Noise
    orders: tuple[Order, ...]
    bits: int
    channels: bool


def draw(
    protocol: str, *, seed: int, causes: tuple[str, ...] | None = None, usb: bool = False, shown: bool = False
) -> Drawn:
    """The logs of one protocol.

    Without ``causes`` the sensor has orders of its own and at times saturation, and the bench is a hard one: belt,
    steps of load, mains in the torque, rows dropped. With them, be it none, the bench is a mild one and they are what
    is wrong with the sensor. ``usb``: all stamps are those of frames of 1 ms. ``shown``: the true shaft is a column.
    """
    hard = causes is None

    def of(*names: str) -> np.random.Generator:
        return stream(seed, protocol, "+".join(causes) if causes is not None else "any", *names)

    spins = PROTOCOLS[protocol](of("rotor"), hard=hard)
    sensor = _sensor(of("sensor"), causes)
    clock = _clock(of("clock"), spins, sensor.noise.sigma_deg, hard=hard)
    clock = through_frames(clock) if usb else clock
    paths = [spin.run() for spin in spins]
    moved = [
        _sampled(
            spin, path, clock.instants(float(path.time_s[-1]) - spin.from_s, of("instants", str(number))), protocol
        )
        for number, (spin, path) in enumerate(zip(spins, paths, strict=True))
    ]
    names = _causes_of(of("which"), causes)
    setting = Setting(max((one for one in moved), key=_top), sensor.own, sensor.noise, sensor.bits, weak=False)
    injected = [_settled(name, of("cause", name), setting) for name in names]
    sensor = _with_word(sensor, injected)
    delay_s = sum(1e-6 * one.parameters["delay_us"] for one in injected if one.name == "latency")
    logs = []
    for number, (spin, path, motion) in enumerate(zip(spins, paths, moved, strict=True)):
        seen = replace(_sampled(spin, path, motion.time_s - delay_s, protocol), time_s=motion.time_s)
        columns = _columns(seen, sensor, injected, clock, (of("noise", str(number)), of("stamps", str(number))))
        extra = {"shaft_deg": motion.shaft_deg} if shown else {}
        logs.append(Log(columns | _command(spin, motion) | extra, motion.shaft_deg, motion.time_s))
    truth = _truth(spins, sensor, injected, clock, moved) | {"protocol": protocol, "seed": seed, "usb": usb}
    return Drawn(tuple(logs), at_rest(sensor.own, injected, sensor.orders), truth)


def _top(motion: Motion) -> float:
    return float(np.max(np.abs(motion.speed_rpm)))


def _sensor(rng: np.random.Generator, causes: tuple[str, ...] | None) -> _Sensor:
    own = replace(baselines.choose(rng, bench="easy"), sense=1, channel_sense=1)
    if causes is not None:
        noise = Noise("white", float(rng.uniform(0.01, 0.03)))
        # a coarse word would leave nothing of the set of angles to see
        coarse = noise.sigma_deg > 0.02 and "cordic_truncation" not in causes
        return _Sensor(own, noise, (), 14 if coarse else 16, False)
    noise = Noise("white", float(np.exp(rng.uniform(np.log(0.01), np.log(0.1)))))
    count = int(rng.integers(1, 4))
    orders = tuple(
        Order(int(order), float(np.exp(rng.uniform(np.log(0.03), np.log(0.3)))), float(rng.uniform(-180.0, 180.0)))
        for order in rng.choice(np.arange(1, 9), count, replace=False)
    )
    return _Sensor(own, noise, orders, 14 if noise.sigma_deg > 0.03 else 16, bool(rng.random() < 0.2))


def _clock(rng: np.random.Generator, spins: tuple[Spin, ...], noise_deg: float, *, hard: bool) -> Clock:
    fastest = max(spin.fastest for spin in spins) / TURN
    return clock_of(
        rng,
        duration_s=max(spin.expected_s for spin in spins),
        fastest_Hz=fastest,
        least_rate_Hz=8.0 * fastest,
        noise_deg=noise_deg,
        hard=hard,
    )


def _sampled(spin: Spin, path: Trajectory, times: Array, protocol: str) -> Motion:
    """The shaft at these times from the beginning of the log."""
    angle, speed = path.at(times + spin.from_s)
    return motion_of(times, np.degrees(angle), np.degrees(speed), protocol=protocol)


def _causes_of(rng: np.random.Generator, causes: tuple[str, ...] | None) -> tuple[str, ...]:
    if causes is not None:
        return causes
    return ("saturation",) if rng.random() < 0.3 else ()


def _settled(name: str, rng: np.random.Generator, setting: Setting) -> Injected:
    strength = float(rng.uniform(0.05, 0.15))
    return PLANS[name](rng, setting) if name in PLANS else CAUSES[name].plan(rng, strength, setting)


def _with_word(sensor: _Sensor, injected: list[Injected]) -> _Sensor:
    """Where rounding is the cause, the word is short and the noise small enough for it to show."""
    for one in injected:
        if one.name == "output_quantisation":
            bits = int(one.parameters["bits"])
            most = 360.0 / 2**bits / np.sqrt(12.0) / 0.8
            return replace(sensor, bits=bits, noise=replace(sensor.noise, sigma_deg=min(sensor.noise.sigma_deg, most)))
    return sensor


def _columns(
    motion: Motion,
    sensor: _Sensor,
    injected: list[Injected],
    clock: Clock,
    rngs: tuple[np.random.Generator, np.random.Generator],
) -> dict[str, Array]:
    """What the logger writes of a shaft that the sensor sees so; from the streams of the noise and of the stamps."""
    bench = Bench(
        replace(motion, shaft_deg=bent(motion.shaft_deg, sensor.orders)),
        sensor.own,
        sensor.noise,
        sensor.bits,
        channels=sensor.channels,
        channel_scale=1.0,
        channel_step=2.0**-15,
    )
    readings = sample(bench, _of_rows(injected, motion), rngs[0])
    columns = {"time_s": clock.stamps(motion.time_s, rngs[1])}
    columns["measured_deg"] = send(readings.word_deg, sensor.bits, injected, rngs[1])
    return columns | ({"vx": readings.x, "vy": readings.y} if sensor.channels else {})


def _of_rows(injected: list[Injected], motion: Motion) -> list[Injected]:
    """The chain's causes; those of single rows were settled for the log that turns fastest."""
    known = [one for one in injected if one.name in CAUSES and one.name != "latency"]
    rows = motion.time_s.size
    return [replace(one, hidden={key: _cut(values, key, rows) for key, values in one.hidden.items()}) for one in known]


def _cut(values: Array, key: str, rows: int) -> Array:
    if key == "rows":
        return values[values < rows]
    return values[:rows] if values.size > rows else values


def _command(spin: Spin, motion: Motion) -> dict[str, Array]:
    """A drive that is stepped open loop knows what it has told the field: its count is a column."""
    if not isinstance(spin.drive, Stepping):
        return {}
    times = (motion.time_s + spin.from_s).tolist()
    return {"command_deg": np.degrees([spin.drive.command(time) for time in times])}


def _truth(
    spins: tuple[Spin, ...], sensor: _Sensor, injected: list[Injected], clock: Clock, moved: list[Motion]
) -> dict[str, object]:
    rotor, slowest = spins[0].rotor, spins[0].slowest
    # a hand or a field holds the shaft against them
    held = isinstance(spins[0].drive, Rocking | Stepping)
    harmonics = [one for one in sensor.orders if one.order >= 3]
    parameters = {one.name: dict(one.parameters) for one in injected}
    if len(harmonics) == 1 and "magnet_harmonic" not in parameters:
        # its phase counts from a zero that no spin shows
        only = harmonics[0]
        parameters["magnet_harmonic"] = {"order": float(only.order), "amplitude_deg": only.amplitude_deg}
    rounding = 360.0 / 2**sensor.bits / np.sqrt(12.0)
    named = {one.name for one in injected}
    near = rounding > 0.4 * sensor.noise.sigma_deg and "output_quantisation" not in named
    # orders below 4 of the magnet's own do what the factors do
    mixed = any(one.order <= 3 for one in sensor.orders) or "magnet_harmonic" in named
    factors = sensor.own.parameters()
    return {
        "causes": [one.name for one in injected if one.name not in UNSEEN] + ["magnet_harmonic"] * len(harmonics),
        "tolerated": ["torque_ripple", "time_jitter", *(["output_quantisation"] if near else [])],
        "parameters": {key: _at_no_zero(values) for key, values in parameters.items()},
        "strength_deg": {one.name: one.strength_deg for one in injected},
        "factors": factors,
        "baseline": {} if mixed else {key: value for key, value in factors.items() if key != "zero_deg"},
        "frame": {
            "amplitude_x": sensor.own.amplitude_x,
            # Waves in time count from the log's own beginning, as its stamps need not.
            "first_time_s": float(moved[0].time_s[0]),
            "first_reference_deg": 0.0,
            "duration_s": float(np.ptp(moved[0].time_s)),
        },
        "orders": [[one.order, one.amplitude_deg, one.phase_deg] for one in sensor.orders],
        "torque_response_deg": {
            str(order): 0.0 if held else rotor.response_deg(order, slowest) for order in range(1, ORDERS + 1)
        },
        "belt": rotor.belt is not None,
        "noise_deg": sensor.noise.sigma_deg,
        "output_bits": sensor.bits,
        "channels": sensor.channels,
        "rows": [int(one.time_s.size) for one in moved],
        "turns": [float(abs(one.shaft_deg[-1] - one.shaft_deg[0]) / 360.0) for one in moved],
        "speeds_turns_s": [[float(np.min(np.abs(one.speed_rpm))) / 60.0, _top(one) / 60.0] for one in moved],
        "stamps_from_s": clock.start_s,
        "jitter_s": clock.jitter_s,
        "period_s": clock.period_s,
    }


def _at_no_zero(parameters: dict[str, float]) -> dict[str, float]:
    """Without the phases that count from the shaft's zero."""
    kept = dict(parameters)
    if "order" in kept:
        kept.pop("phase_deg", None)
    return kept
