"""multipole: the sensor turns several periods while the shaft turns once, and errs within each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from twin.angles import Array, radians, wrap
from twin.drawing import YARDSTICK_DEG
from twin.effect import Effect, Param, Parameters
from twin.found_by import Comb
from twin.hall.gain_mismatch import GAIN_MISMATCH
from twin.hall.offset import OFFSET
from twin.hall.phase import PHASE
from twin.motion import Motion

MOST_PERIODS = 19
"""Beyond it a line and its double are what a motor sets, unless it is known how many periods the sensor has."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    """Turn the field angle (..., 2, n) by what the error model does within a period, over the number of periods.

    The periods are counted, so that the angle of one, divided by their number, is that of the shaft.
    """
    periods = np.asarray(values["periods"])
    along_x, along_y = periods * signal[..., :1, :], periods * signal[..., 1:, :]
    x, y = np.cos(along_x), np.sin(along_y + radians(values["beta_deg"]))
    x, y = x + 0.01 * np.asarray(values["x_percent"]), y + 0.01 * np.asarray(values["y_percent"])
    away = np.arctan2(y * np.asarray(values["ratio"]), x) - np.arctan2(np.sin(along_y), np.cos(along_x))
    return np.asarray(signal + wrap(away) / periods)


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    # Of two periods the line of the offset is that of gain and phase of a single one.
    return [{"periods": float(p)} for p in range(3, MOST_PERIODS + 1) if 6 * p < motion.angles_in_a_turn]


def with_periods(effects: Sequence[Effect], periods: int, *, given: bool) -> tuple[Effect, ...]:
    """The effects for a sensor of a known number of periods: ``multipole`` has it, whatever the points of a turn are.

    Left out are those of a single period whose lines are the same: gain and phase of one, where there are two; not
    where a twin is ``given``, which may have them.
    """
    # Who knows the sensor's periods knows that their lines are no teeth's.
    told = None if MULTIPOLE.comb is None else replace(MULTIPOLE.comb, also=None)
    known = replace(MULTIPOLE, shapes=lambda motion: [{"periods": float(periods)}], comb=told)
    same = set() if given or periods != 2 else {GAIN_MISMATCH.name, PHASE.name}
    return tuple(known if e.name == MULTIPOLE.name else e for e in effects if e.name not in same)


def orders(values: Parameters) -> tuple[float, ...]:
    """The orders of its lines, to first order."""
    return float(values["periods"]), 2.0 * float(values["periods"])


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Few periods, as magnets and resolvers have; the errors within them grow with their number for the same angle."""
    periods = 2.0 + np.floor(7.0 * uniform[:, 2])
    size = strength_deg / YARDSTICK_DEG * periods
    around, share = 2.0 * np.pi * uniform[:, 0], 2.0 * np.pi * uniform[:, 3]
    return {
        "periods": periods,
        "x_percent": 0.15 * size * np.cos(around),
        "y_percent": 0.15 * size * np.sin(around),
        "ratio": 1.0 + 0.003 * size * np.cos(share),
        "beta_deg": 0.15 * size * np.sin(share),
    }


def _own(effect: Effect, name: str, *, mirror: Literal[-1, 1]) -> Param:
    """A factor of the error model as a factor within a period."""
    known = effect.params[name]
    return replace(known, doc=f"{known.doc}, within a period", typical=4.0 * known.typical, scatter=0.0, mirror=mirror)


MULTIPOLE = Effect(
    name="multipole",
    stage="hall",
    acts_on="field",
    params={
        "periods": Param(
            unit="1/turn", null=2.0, lower=2.0, upper=1e4, doc="periods of the sensor", role="shape", counts=True
        ),
        "x_percent": _own(OFFSET, "x_percent", mirror=1),
        "y_percent": _own(OFFSET, "y_percent", mirror=-1),
        "ratio": _own(GAIN_MISMATCH, "ratio", mirror=1),
        "beta_deg": _own(PHASE, "beta_deg", mirror=-1),
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    shapes=shapes,
    comb=Comb(
        orders=orders,
        parts=(("x_percent", "y_percent"), ("ratio", "beta_deg")),
        also=(
            "mechanics",
            "from mechanics (p teeth of a gear or belt): count them, or the sensor's own periods, and say these by "
            "--pole-pairs, of a recording with a reference",
        ),
    ),
    drawing=drawing,
    source="the paper's Eq. 1 with p times the angle: a sensor over p pole pairs, a resolver of p speeds",
    signature="orders p and 2p, phases as of offset, gain and phase within a period; 3p where these are large",
)
