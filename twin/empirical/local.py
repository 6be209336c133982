"""Unnamed structure at one place of the turn, or at two opposite ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import TAU, Array, radians, wrap
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def _bump(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    away = wrap(motion.shaft_rad - radians(values["centre_deg"]))
    width = radians(np.maximum(values["width_deg"], 0.1))
    return signal + radians(values["height_deg"]) * np.exp(-0.5 * (away / width) ** 2)


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    finest = 2.0 * 360.0 / max(motion.points_per_turn, 8.0)
    widths = [width for width in (3.0, 6.0, 12.0, 20.0) if width >= finest] or [finest]
    return [
        {"width_deg": width, "centre_deg": float(centre)}
        for width in widths
        for centre in np.arange(0.0, 360.0, max(1.3 * width, 4.0))
    ]


UNNAMED_BUMP = Effect(
    name="unnamed_bump",
    stage="empirical",
    acts_on="angle",
    params={
        "centre_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=720.0, doc="place", role="shape", typical=5.0),
        "width_deg": Param(unit="deg", null=10.0, lower=1.0, upper=20.0, doc="sigma", role="shape", typical=5.0),
        "height_deg": Param(unit="deg", null=0.0, lower=-90.0, upper=90.0, doc="height"),
    },
    forward=_bump,
    shapes=shapes,
    zoomed=("centre_deg", "width_deg"),
    fitted_shapes=("centre_deg", "width_deg"),
    needs=frozenset({"one turn"}),
    repeatable=True,
    kind="local",
    words="a bump at {centre_deg:4} deg of the shaft, {height_deg} deg high, sigma {width_deg} deg",
    source="Gaussian bump",
    signature="an error at one place of the turn",
)


def _seam(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    behind = np.mod(motion.shaft_rad - radians(values["centre_deg"]), TAU)
    return signal + radians(values["step_deg"]) * (0.5 - behind / TAU)


_ONE_TURN = 1.5
"""Turns of travel from which on a drift shows over the turns, and no seam is looked for."""


def _seam_shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    if motion.turns > _ONE_TURN:
        return ()
    return [{"centre_deg": float(centre)} for centre in np.arange(0.0, 360.0, max(360.0 / motion.points_per_turn, 4.0))]


UNNAMED_SEAM = Effect(
    name="unnamed_seam",
    stage="empirical",
    acts_on="angle",
    params={
        "centre_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=720.0, doc="place", role="shape", typical=5.0),
        "step_deg": Param(unit="deg", null=0.0, lower=-90.0, upper=90.0, doc="step, made up for over the turn"),
    },
    forward=_seam,
    shapes=_seam_shapes,
    zoomed=("centre_deg",),
    needs=frozenset({"one turn"}),
    kind="seam",
    words="a turn that does not close: a step of {step_deg} deg at {centre_deg:4} deg of the shaft, made up for evenly "
    "over the rest of the turn, as where a turn that drifted began and ended",
    source="sawtooth: a linear drift over one turn, told over the angle",
    signature="a step at one place of the turn, and orders that fall as 1/n",
)


def _flanks(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    lever = np.sin(motion.shaft_rad - radians(values["centre_deg"]))
    return signal + radians(values["height_deg"]) * np.tanh(lever / np.sin(radians(values["width_deg"])))


def _flank_shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    finest = 360.0 / max(motion.points_per_turn, 8.0)
    return [
        {"width_deg": width, "centre_deg": float(centre)}
        for width in (2.0, 5.0, 12.0)
        if width >= finest
        for centre in np.arange(0.0, 360.0, max(width, 4.0))
    ]


UNNAMED_FLANKS = Effect(
    name="unnamed_flanks",
    stage="empirical",
    # What it turns is what the magnet sits on: the other errors move along.
    acts_on="shaft",
    params={
        "height_deg": Param(unit="deg", null=0.0, lower=0.0, upper=90.0, doc="half of the way over", owner="bench"),
        "centre_deg": Param(
            unit="deg",
            null=0.0,
            lower=-360.0,
            upper=720.0,
            doc="place where it goes over to the higher flank",
            role="shape",
            typical=5.0,
            owner="bench",
        ),
        "width_deg": Param(
            unit="deg",
            null=5.0,
            lower=0.2,
            upper=40.0,
            doc="over which it goes",
            role="shape",
            typical=5.0,
            owner="bench",
        ),
    },
    forward=_flanks,
    shapes=_flank_shapes,
    zoomed=("centre_deg", "width_deg"),
    fitted_shapes=("centre_deg", "width_deg"),
    needs=frozenset({"one turn"}),
    kind="flanks",
    words="a shaft that lies on one flank of a play for half a turn, then on the other: {height_deg} deg to either "
    "side, over at {centre_deg:4} deg",
    source="play of a coupling under the weight of an unbalanced rotor: h tanh(sin(a - centre) / sin(width))",
    signature="odd orders that fall as 1/n, up to the softness of the flanks",
)
