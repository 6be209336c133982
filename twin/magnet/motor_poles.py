"""motor_poles: a motor turns the angle at the multiples of its slots, of its poles, and where the two meet again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import gcd, lcm

import numpy as np

from twin.angles import Array, radians
from twin.drawing import whole
from twin.effect import Comb, Effect, Param, Parameters
from twin.found_by import order_of
from twin.motion import Motion

LOWEST_ORDER = 4
PHASES = 3
MULTIPLES = (1, 2, 3)
"""Of slots and poles: their fields fall off quickly with the order."""
CONCENTRATED = (0.7, 1.6)
"""Slots over poles of windings around single teeth, from 3/4 to 3/2."""
_UNNAMED = range(9, 20)
"""Orders of which one alone has no cause of its own."""
_COMMON = ((12, 14), (12, 10), (9, 8), (9, 6), (6, 4), (24, 28), (18, 16), (36, 42))


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # It is the rotor's angle that slots and poles meet at, wherever the magnet may have been turned to.
    wave = np.sin(np.asarray(values["order"]) * motion.shaft_rad + radians(values["phase_deg"]))
    return signal + radians(values["amplitude_deg"]) * wave


def no_shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    """None by itself: a single line is what it is without a motor."""
    return ()


def balanced(slots: int, poles: int) -> bool:
    """Whether a winding of three phases fits: slots / (3 gcd(slots, pole pairs)) is whole."""
    return poles % 2 == 0 and slots % (PHASES * gcd(slots, poles // 2)) == 0


def lines(slots: int, poles: int) -> tuple[set[int], set[int]]:
    """The orders of the slots and of the poles; where they meet belongs to both."""
    both = lcm(slots, poles)
    return {both, *(k * slots for k in MULTIPLES)}, {both, *(k * poles for k in MULTIPLES)}


def told(slots: int, poles: int, orders: set[int]) -> tuple[int, int]:
    """How many of these orders the motor makes, and how many of slots and poles themselves; 0 where it is not told.

    It is told by at least one line of the slots and one of the poles that the other does not make, three lines in all:
    of two orders some motor can be found too easily, unless they are its slots and poles and neither has another cause.
    Where the slots are a multiple of the poles, all lines are multiples of one order: then a fourth is asked for.
    """
    of_slots, of_poles = lines(slots, poles)
    made = orders & (of_slots | of_poles)
    first = len({slots, poles} & orders)
    if not (made & of_slots) - of_poles or not (made & of_poles) - of_slots:
        return 0, first
    bare = made == {slots, poles} and all(order in _UNNAMED for order in made)
    fewest = 4 if slots % poles == 0 else 2 if bare else 3
    return (len(made) if len(made) >= fewest else 0), first


def unite(orders: Sequence[int]) -> Sequence[Mapping[str, float]]:
    """The motors that make several of these lines, the one that makes most of them first."""
    found = {order for order in orders if order >= LOWEST_ORDER}
    sizes = {order // k for order in found for k in MULTIPLES if order % k == 0 and order // k >= LOWEST_ORDER}
    motors = [
        (told(slots, poles, found), slots, poles)
        for slots in sizes
        for poles in sizes
        if balanced(slots, poles) and _usual(slots, poles)
    ]
    motors.sort(key=lambda motor: (motor[0], -motor[1] - motor[2]), reverse=True)
    return [{"slots": float(slots), "poles": float(poles)} for (count, _), slots, poles in motors if count]


def _usual(slots: int, poles: int) -> bool:
    """Whether motors are wound like this: around single teeth, or over as many slots for each pole and phase."""
    return CONCENTRATED[0] <= slots / poles <= CONCENTRATED[1] or slots % (PHASES * poles) == 0


def of_motor(shape: Parameters) -> tuple[int, ...]:
    """All orders that a motor makes, ascending."""
    of_slots, of_poles = lines(int(shape["slots"]), int(shape["poles"]))
    return tuple(sorted(of_slots | of_poles))


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A common motor, and one of its two lowest orders."""
    chosen = np.array(_COMMON, dtype=np.float64)[whole(uniform[:, 2], 0, len(_COMMON) - 1).astype(np.int64)]
    order = np.where(uniform[:, 3] < 0.5, chosen[:, 0], chosen[:, 1])
    return {"slots": chosen[:, 0], "poles": chosen[:, 1], "order": order}


MOTOR_POLES = Effect(
    name="motor_poles",
    stage="magnet",
    acts_on="shaft",
    params={
        "slots": Param(
            unit="1/turn",
            null=12.0,
            lower=3.0,
            upper=1e4,
            doc="slots of the stator",
            role="shape",
            counts=True,
            owner="bench",
        ),
        "poles": Param(
            unit="1/turn",
            null=14.0,
            lower=2.0,
            upper=1e4,
            doc="poles of the rotor",
            role="shape",
            counts=True,
            owner="bench",
        ),
        "order": Param(
            unit="1/turn",
            null=12.0,
            lower=float(LOWEST_ORDER),
            upper=1e5,
            doc="a multiple of either, or of both",
            role="shape",
            counts=True,
            owner="bench",
        ),
        "amplitude_deg": Param(unit="deg", null=0.0, lower=0.0, upper=20.0, doc="amplitude", owner="bench"),
        "phase_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase", role="phase", owner="bench"),
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    shapes=no_shapes,
    repeatable=True,
    comb=Comb(orders=order_of, unite=unite, united=of_motor),
    drawing=drawing,
    source="Z. Q. Zhu and D. Howe, IEEE Transactions on Energy Conversion 15 (2000) 407: cogging at the least common "
    "multiple of slots and poles; stray fields at the multiples of either",
    signature="several lines at multiples of slots and poles, from order 4",
)
