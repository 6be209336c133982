"""The measuring protocols: which legs a bench drives, drawn at random within each protocol."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .motion import Demands, Layout, Leg, Motion, run

EASY_POINTS = (180, 200, 240, 256, 300, 360, 400, 500, 512, 720)
HARD_POINTS = (72, 80, 90, 96, 100, 120, 128, 144, 180)
MOST_ROWS = 6000
TEMPERATURES = (
    (-20.0, 25.0, 60.0, 105.0),
    (-40.0, 0.0, 45.0, 85.0),
    (-10.0, 25.0, 50.0, 85.0),
    (-40.0, 25.0, 85.0, 125.0),
    (0.0, 20.0, 40.0, 60.0),
)

Draw = Callable[[np.random.Generator, bool, Demands], tuple[Leg, ...]]


def _turns(rng: np.random.Generator, choices: tuple[int, ...], least: int) -> int:
    enough = [one for one in choices if one >= least]
    return int(rng.choice(enough)) if enough else least


def _static(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """Stop and measure, one way."""
    return (Leg(_turns(rng, (1, 2, 3, 4, 5, 6) if hard else (1, 2, 4), demands.turns), 1),)


def _static_both(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """Stop and measure, up and down, once or twice."""
    rounds = int(rng.choice((1, 2)))
    if demands.turns > 2:
        rounds = 2
    each = _turns(rng, (1, 2), -(-demands.turns // (2 * rounds)))
    if hard and 2 * rounds * each > 6:
        each = 1
    return tuple(Leg(each, way) for _ in range(rounds) for way in (1, -1))


def _many_turns(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """Stop and measure or slow steady motion, one way, many turns."""
    turns = int(rng.integers(5, 7)) if hard else int(rng.integers(8, 21))
    rpm = float(rng.uniform(60.0, 240.0)) if rng.random() < 0.3 else 0.0
    return (Leg(max(turns, demands.turns), 1, rpm),)


def _three_speeds(rng: np.random.Generator) -> list[float]:
    low = np.exp(rng.uniform(np.log(90.0), np.log(200.0)))
    middle = np.exp(rng.uniform(np.log(350.0), np.log(800.0)))
    high = np.exp(rng.uniform(np.log(1100.0), np.log(2400.0)))
    return [float(one) for one in (low, middle, high)]


def _speeds(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """Three constant speeds, each in both directions."""
    each = int(rng.choice((1, 2) if hard else (2, 3)))
    return tuple(Leg(each, way, rpm) for rpm in _three_speeds(rng) for way in (1, -1))


def _speeds_one_way(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """Three constant speeds, one direction."""
    each = int(rng.choice((1, 2) if hard else (2, 3, 4)))
    return tuple(Leg(each, 1, rpm) for rpm in _three_speeds(rng))


def _one_speed(rng: np.random.Generator, demands: Demands) -> float:
    """A speed at which mains frequency is no whole number of cycles a turn, where that matters."""
    while True:
        rpm = float(rng.uniform(120.0, 500.0))
        cycles = np.array([3000.0, 3600.0]) / rpm
        if not demands.mains_free or np.all(np.abs(cycles - np.round(cycles)) > 0.25):
            return rpm


def _spin(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """One constant speed, one direction."""
    return (Leg(max(int(rng.integers(4, 7)), demands.turns), 1, _one_speed(rng, demands)),)


def _spin_both(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """One constant speed, both directions."""
    rpm = _one_speed(rng, demands)
    each = max(int(rng.choice((2, 3) if hard else (3, 4))), -(-demands.turns // 2))
    return (Leg(each, 1, rpm), Leg(each, -1, rpm))


def _levels(rng: np.random.Generator, hard: bool) -> list[float]:
    levels = list(TEMPERATURES[int(rng.integers(len(TEMPERATURES)))])
    if hard and rng.random() < 0.5:
        levels = [one + float(rng.uniform(-4.0, 4.0)) for one in levels]
    return levels


def _oven(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """Four temperatures, one way, one or two turns each."""
    each = 1 if hard else int(rng.choice((1, 2)))
    pause = 1800.0 if rng.random() < 0.4 else 0.0
    return tuple(Leg(each, 1, 0.0, level, pause if number else 0.0) for number, level in enumerate(_levels(rng, hard)))


def _oven_both(rng: np.random.Generator, hard: bool, demands: Demands) -> tuple[Leg, ...]:
    """Four temperatures, up and down at each."""
    pause = 1800.0 if rng.random() < 0.4 else 0.0
    return tuple(
        Leg(1, way, 0.0, level, pause if number and way > 0 else 0.0)
        for number, level in enumerate(_levels(rng, hard))
        for way in (1, -1)
    )


PROTOCOLS: dict[str, Draw] = {
    "static": _static,
    "static_both": _static_both,
    "many_turns": _many_turns,
    "speeds": _speeds,
    "speeds_one_way": _speeds_one_way,
    "spin": _spin,
    "spin_both": _spin_both,
    "oven": _oven,
    "oven_both": _oven_both,
}
WEIGHTS = {"static": 4.0, "static_both": 3.0, "speeds": 2.0, "oven": 1.5, "spin_both": 0.5}
"""How often a protocol is taken among the suitable ones; 1 where not listed."""


def choose(rng: np.random.Generator, suitable: tuple[str, ...]) -> str:
    """One of the suitable protocols."""
    weights = np.array([WEIGHTS.get(one, 1.0) for one in suitable])
    return str(rng.choice(np.array(suitable), p=weights / weights.sum()))


def drive(name: str, rng: np.random.Generator, *, bench: str, demands: Demands) -> Motion:
    """Draw the layout of a protocol and carry it out."""
    hard = bench == "hard"
    legs = PROTOCOLS[name](rng, hard, demands)
    turns = sum(leg.turns for leg in legs)
    choices = [
        points
        for points in (HARD_POINTS if hard else EASY_POINTS)
        if points >= demands.points and points * turns <= MOST_ROWS
    ]
    points = int(rng.choice(choices)) if choices else max(demands.points, 180)
    moving = legs[0].rpm > 0
    repeats = 1
    if hard and name == "static" and not demands.single_readings and rng.random() < 0.25:
        repeats, legs, points = 10, (Leg(max(demands.turns, 1), 1),), min(points, 100)
    style = rng.random()
    layout = Layout(
        points_per_turn=points,
        start_deg=float(rng.uniform(0.0, 360.0)),
        jitter_deg=0.0 if style < 0.15 else 0.001,
        uneven=float(rng.uniform(0.05, 0.25)) if style > 0.8 else 0.0,
        dwell_s=0.4 if rng.random() < 0.6 else float(np.round(rng.uniform(0.05, 1.5), 2)),
        start_s=float(np.round(rng.uniform(0.0, 5e4), 3)) if hard and rng.random() < 0.3 else 0.0,
        repeats=repeats,
        reversal="overrun" if moving else str(rng.choice(("overrun", "same", "back"))),
        legs=legs,
    )
    return run(name, layout, rng)
