"""What the readings can and cannot tell of the parameters, in words."""

from __future__ import annotations

import numpy as np

from diagnosis.error_model import model
from diagnosis.error_model.model import NAMES, ZERO
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.mirror import Mirror
from diagnosis.factors.null_space import HIDDEN, invisible_count
from diagnosis.factors.profile_likelihood import Profile
from twin.angles import Array
from twin.baseline import FACTORS
from twin.confidence import student_95

_FEW = 9
"""Degrees of freedom from which a cause of three times the noise stands out of what is left: what explain asks for."""
TIED = 0.9
"""Correlation from which two parameters are called nearly tied."""
_WHAT = dict(zip(NAMES, (factor.label for factor in FACTORS), strict=True))
"""What people read for each parameter of the model."""


def said_of_any_sweep(fit: BaselineFit, has_channels: bool) -> tuple[str, ...]:
    """What no angle can show, whatever the readings, and what raw channels show or would show."""
    visible = f"an angle shows only {', '.join(_WHAT.values())}"
    hidden = f"{visible}; of the paper's ten unknowns {invisible_count(fit.point)} combinations stay hidden:"
    first = f"{hidden} {'; '.join(HIDDEN)}"
    if has_channels:
        return (first, "vx and vy show Ax, Ay, Vx and Vy singly, in the unit of the channels")
    return (first, "vx and vy would show Ax, Ay, Vx and Vy singly and part the sensor's errors from the reference's")


def said_of_these_readings(
    covered_deg: float, unseen: tuple[tuple[float, ...], ...], correlations: Array
) -> tuple[str, ...]:
    """Which parameters these readings cannot tell from one another."""
    said = []
    if covered_deg < 330.0:
        said.append(f"the readings cover {covered_deg:.0f} deg of the turn: parameters trade against each other there")
    for direction in unseen:
        size = np.abs(direction)
        parts = " and ".join(_WHAT[NAMES[k]] for k in np.argsort(-size) if size[k] > 0.25 * size.max())
        said.append(f"these readings do not see a combination of {parts}: only intervals of the others mean anything")
    if not unseen:
        rows, columns = np.nonzero(np.triu(np.abs(correlations), 1) > TIED)
        if rows.size > 2:
            names = ", ".join(_WHAT[NAMES[k]] for k in np.unique([rows, columns]))
            said.append(f"{names} are nearly tied to one another (correlations above {TIED})")
        else:
            said += [
                f"{_WHAT[NAMES[i]]} and {_WHAT[NAMES[j]]} are nearly tied (correlation {correlations[i, j]:+.2f})"
                for i, j in zip(rows, columns, strict=True)
            ]
    return tuple(said)


def said_of_few_readings(fit: BaselineFit) -> tuple[str, ...]:
    """How much wider so few readings make the intervals, and that they do not judge the error model itself."""
    freedom = max(fit.degrees_of_freedom, 1)
    if freedom >= _FEW:
        return ()
    wider = student_95(freedom) / student_95(np.inf)
    return (
        f"few readings: beside six parameters {freedom} degree{'s' if freedom > 1 else ''} of freedom are left, which "
        f"makes intervals {wider:.1f} times as wide as many readings of this scatter would; whether the error model "
        "holds they cannot say",
    )


def said_of_weak_parameters(fit: BaselineFit, profiles: tuple[Profile, ...]) -> tuple[str, ...]:
    """Which parameters may as well be null, have no bound on one side, or stand at the limit of the model."""
    said = []
    for profile in profiles:
        k = NAMES.index(profile.name)
        null = model.NOMINAL[k]
        if k != ZERO and profile.low <= null <= profile.high:
            said.append(f"{_WHAT[profile.name]}: not told from {null:g}, that of an ideal sensor, by these readings")
        if not np.isfinite(profile.low) or not np.isfinite(profile.high):
            said.append(f"{_WHAT[profile.name]}: the likelihood never falls off on one side; no bound there")
    said += [
        f"{_WHAT[name]} stands at the limit of the model" for name, at in zip(NAMES, fit.at_bound, strict=True) if at
    ]
    return tuple(said)


def said_of_the_mirror_solution(mirror: Mirror) -> tuple[str, ...]:
    """Who decides between the two mirror solutions; and where nobody does, the other one and what would decide."""
    if mirror.by == "quadratic term":
        return ("the quadratic term decides which way sensor and output count: the mirror solution fits worse",)
    if mirror.by is not None:
        said = {"twin": "the twin", "option": "--output-sense", "channels": ""}[mirror.by]
        return (f"{said} says which way sensor and output count: there is no mirror solution",) if said else ()
    if mirror.other is None:
        return ()
    other = mirror.other
    offset, phase = 100.0 * other.point[model.VY], np.degrees(other.point[model.BETA])
    return (
        f"the mirror solution s = {other.senses.sensor:+d}, h = {other.senses.output:+d} fits as well: offset y "
        f"{offset:+.3f} %, phase {phase:+.3f} deg; an angle parts the two by its quadratic term alone, which is too "
        "small here: vx and vy, a twin, or knowing which way the output counts (--output-sense) would decide",
    )
