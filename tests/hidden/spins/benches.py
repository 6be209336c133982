"""Rotors, drives and sampling as small benches have them, drawn for each protocol."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .drives import Rocking, Speeds, Stepping
from .rotor import Belt, Drive, Hum, Rotor, Step, Trajectory, Wave, integrate

TURN = 2.0 * math.pi
READINGS_A_TURN = 8.0
"""At the highest speed, at least."""
LARGEST_SWING = 0.15
"""Of the speed, rad: by how much a torque of one order changes it at the lowest speed."""
COGGING = (2, 3, 4, 6, 7, 8, 12, 14)


@dataclass(frozen=True)
class Spin:
    """One log's motion, before anything is sampled."""

    rotor: Rotor
    drive: Drive | None
    start: float
    """rad/s, signed."""
    duration_s: float
    stop: float = 0.0
    angle: float = 0.0
    slowest: float = 0.0
    """rad/s: where torques show most."""
    from_s: float = 0.0
    """Before it, nothing is recorded."""
    ends_s: float | None = None
    """When a coast is expected to have reached ``stop``."""

    @property
    def expected_s(self) -> float:
        """Length of the log, about."""
        return self.duration_s if self.ends_s is None else self.ends_s

    def run(self) -> Trajectory:
        """The motion."""
        return integrate(
            self.rotor,
            self.drive,
            speed=self.start,
            duration_s=self.duration_s + self.from_s,
            angle=self.angle,
            stop=self.stop,
        )

    @property
    def fastest(self) -> float:
        """rad/s."""
        top = max(abs(one) for one in self.drive.targets) if isinstance(self.drive, Speeds) else abs(self.start)
        return top if not isinstance(self.drive, Rocking) else self.drive.swing * TURN * self.drive.frequency_Hz


def rotor_of(rng: np.random.Generator, *, slowest: float, deceleration: float, middle: float, hard: bool) -> Rotor:
    """A rotor that slows by ``deceleration`` [rad/s^2] at the speed ``middle``, torques sized at ``slowest`` [rad/s].

    ``hard``: with all that a small motor has; else what is locked to the angle is mild, and nothing else is there.
    """
    shares = rng.dirichlet((3.0, 2.0, 1.0)) * deceleration
    waves = []
    base = int(rng.choice(COGGING))
    for order, weight in ((1, rng.uniform(0.2, 1.0)), (base, 1.0), (2 * base, rng.uniform(0.1, 0.5))):
        response = math.radians(float(np.exp(rng.uniform(np.log(0.02), np.log(0.5 if hard else 0.05)))) * weight)
        response = min(response, LARGEST_SWING / order)
        waves.append(Wave(order, response * (order * slowest) ** 2, float(rng.uniform(0.0, TURN))))
    rotor = Rotor(
        coulomb=float(shares[0]),
        viscous=float(shares[1] / middle),
        quadratic=float(shares[2] / middle**2),
        drag_ripple=0.1,
        viscous_ripple=0.02,
        drag_phase=float(rng.uniform(0.0, TURN)),
        waves=tuple(waves),
    )
    if not hard:
        return replace(rotor, drag_ripple=0.02, viscous_ripple=0.0)
    if rng.random() < 0.2:
        belt = Belt(float(rng.uniform(20.0, 80.0)), float(rng.uniform(0.01, 0.05)), float(rng.uniform(0.1, 0.5)))
        rotor = replace(rotor, belt=belt)
    return rotor


def _turns_per_s(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def coast(rng: np.random.Generator, *, hard: bool = True) -> tuple[Spin, ...]:
    """Let go at 10 to 60 turns/s, and recorded until a tenth to a third of that is left."""
    first = _turns_per_s(rng, 10.0, 60.0)
    last = max(first * float(rng.uniform(0.1, 0.3)), 2.0)
    lasts = min(float(rng.uniform(2.0, 20.0)), 250.0 / (0.5 * (first + last)))
    rotor = rotor_of(
        rng,
        slowest=TURN * last,
        deceleration=TURN * (first - last) / lasts,
        middle=TURN * 0.5 * (first + last),
        hard=hard,
    )
    if hard and rng.random() < 0.2:
        load = -0.2 * TURN * (first - last) / lasts
        rotor = replace(rotor, steps=(Step(float(rng.uniform(0.3, 0.7)) * lasts, load),))
    return (_coasting(rotor, TURN * first, TURN * last, lasts),)


def _coasting(rotor: Rotor, start: float, stop: float, lasts: float) -> Spin:
    return Spin(rotor, None, start, 2.0 * lasts, stop=stop, slowest=stop, ends_s=lasts)


def both_ways(rng: np.random.Generator, *, hard: bool = True) -> tuple[Spin, ...]:
    """A coast each way, of one rotor, in two logs."""
    (there,) = coast(rng, hard=hard)
    return there, replace(there, start=-there.start, angle=float(rng.uniform(0.0, TURN)))


def _driven(rng: np.random.Generator, turns_per_s: tuple[float, ...], *, hard: bool) -> tuple[Rotor, Speeds, float]:
    """Rotor, drive, and the time of one speed."""
    speeds = tuple(TURN * one for one in turns_per_s)
    slowest = min(speeds)
    friction = slowest * float(rng.uniform(0.2, 0.8))
    rotor = rotor_of(rng, slowest=slowest, deceleration=friction, middle=slowest, hard=hard)
    lasts = min(float(rng.uniform(2.0, 8.0)), 250.0 / sum(turns_per_s))
    if hard and rng.random() < 0.5:
        mains = float(rng.choice((50.0, 60.0, 100.0, 120.0)))
        swing = math.radians(float(rng.uniform(0.005, 0.05)))
        rotor = replace(rotor, hums=(Hum(mains, swing * (TURN * mains) ** 2, float(rng.uniform(0.0, TURN))),))
    if hard and rng.random() < 0.3:
        rotor = replace(rotor, steps=(Step(float(rng.uniform(0.3, 0.7)) * lasts + 2.0, -0.1 * friction),))
    # no mains supply and no load is perfectly still
    wander = tuple(
        Hum(float(rng.uniform(0.1, 3.0)), float(rng.uniform(0.0, 0.004)) * slowest, float(rng.uniform(0.0, TURN)))
        for _ in range(4)
    )
    rotor = replace(rotor, hums=rotor.hums + wander)
    drive = Speeds(
        starts_s=tuple(2.0 + lasts * k for k in range(len(speeds))),
        targets=speeds,
        gain=float(rng.uniform(2.0, 15.0)),
        feed=rotor.friction(speeds[0]),
    )
    return rotor, replace(drive, starts_s=(0.0, *drive.starts_s[1:])), lasts


def _at_speeds(rng: np.random.Generator, turns_per_s: tuple[float, ...], *, hard: bool) -> Spin:
    rotor, drive, lasts = _driven(rng, turns_per_s, hard=hard)
    return Spin(
        rotor,
        drive,
        drive.targets[0],
        lasts * len(turns_per_s),
        slowest=min(drive.targets),
        # until the start has died away
        from_s=2.0,
    )


def one_speed(rng: np.random.Generator, *, hard: bool = True) -> tuple[Spin, ...]:
    """A motor on a constant voltage."""
    return (_at_speeds(rng, (_turns_per_s(rng, 5.0, 40.0),), hard=hard),)


def two_speeds(rng: np.random.Generator, *, hard: bool = True) -> tuple[Spin, ...]:
    """One speed and then another, 1.8 to 4 times as fast, in one log; in either order."""
    slow = _turns_per_s(rng, 3.0, 15.0)
    both = [slow, slow * float(rng.uniform(1.8, 4.0))]
    return (_at_speeds(rng, tuple(both if rng.random() < 0.5 else both[::-1]), hard=hard),)


def two_logs(rng: np.random.Generator, *, hard: bool = True) -> tuple[Spin, ...]:
    """The same in two logs: each starts at any angle and any time."""
    (both,) = two_speeds(rng, hard=hard)
    drive = both.drive
    assert isinstance(drive, Speeds)
    return tuple(
        replace(
            both,
            drive=replace(drive, starts_s=(0.0,), targets=(speed,)),
            start=speed,
            duration_s=0.5 * both.duration_s,
            angle=float(rng.uniform(0.0, TURN)),
        )
        for speed in drive.targets
    )


def several_speeds(rng: np.random.Generator, *, hard: bool = True) -> tuple[Spin, ...]:
    """Four speeds in one log."""
    slow = _turns_per_s(rng, 3.0, 8.0)
    ratio = float(rng.uniform(1.4, 1.8))
    return (_at_speeds(rng, tuple(slow * ratio**k for k in range(4)), hard=hard),)


def rocking(rng: np.random.Generator, *, hard: bool = True) -> tuple[Spin, ...]:
    """Rocked by hand over 60 to 300 degrees."""
    swing, often = math.radians(float(rng.uniform(30.0, 150.0))), float(rng.uniform(0.5, 2.0))
    peak = swing * TURN * often
    rotor = rotor_of(rng, slowest=peak, deceleration=peak, middle=peak, hard=hard)
    rotor = replace(rotor, belt=None)
    drive = Rocking(float(rng.uniform(0.0, TURN)), swing, often, stiffness=900.0, damping=20.0)
    spin = Spin(rotor, drive, peak, float(rng.uniform(5.0, 15.0)), angle=drive.middle, slowest=peak, from_s=1.0)
    return (spin,)


def stepping(rng: np.random.Generator, *, hard: bool = True) -> tuple[Spin, ...]:
    """A field stepped open loop, once round each second or slower."""
    poles = int(rng.choice((7, 11, 50)))
    rate = TURN * float(rng.uniform(0.1, 0.8))
    # the rotor's own resonance in the held field, well damped
    resonance = TURN * float(rng.uniform(20.0, 60.0))
    holding = resonance**2 / poles
    waves = tuple(
        Wave(order, holding * share, float(rng.uniform(0.0, TURN)))
        for order, share in ((1, 0.004 * poles / 7), (2 * poles, 0.02), (4 * poles, 0.01))
    )
    rotor = Rotor(coulomb=0.02 * holding, viscous=0.5, waves=waves)
    fineness = poles * int(rng.choice((64, 128)))
    drive = Stepping(poles, holding, damping=0.6 * resonance, rate=rate, steps_a_turn=fineness)
    return (Spin(rotor, drive, rate, TURN * float(rng.uniform(2.0, 4.0)) / rate, slowest=rate, from_s=0.5),)


PROTOCOLS: dict[str, Callable[..., tuple[Spin, ...]]] = {
    "coast": coast,
    "two_speeds": two_speeds,
    "one_speed": one_speed,
    "two_logs": two_logs,
    "several_speeds": several_speeds,
    "both_ways": both_ways,
    "rocking": rocking,
    "stepping": stepping,
}
