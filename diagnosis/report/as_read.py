"""Figures as whoever looks at the readings sees them: signs as these count, phases at the first row."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.intervals import quantile_95
from diagnosis.discovery.fitting.joint_fit import Fit
from twin.angles import wrap_deg
from twin.effect import Effect, Parameters

Figures = dict[str, dict[str, Any]]


def values_as_read(effect: Effect, values: Parameters, *, output_sense: int) -> Parameters:
    """The parameters of an effect with the signs that whoever looks at the readings sees.

    A chain's output may count its computed angle backwards. An effect on that angle then does the opposite to the
    reading: a bump in the angle is a dip in the error. Its parameters are told as those of the mirrored chain, which
    reads the same (:meth:`twin.effect.Effect.mirrored`).

    Parameters
    ----------
    effect : Effect
        Whose parameters they are.
    values : mapping of str to float or array
        As the chain has them.
    output_sense : {1, -1}
        Of the chain.

    Returns
    -------
    mapping of str to float or array
        These very values where the output counts with the angle, or the effect acts elsewhere.
    """
    return effect.mirrored(values) if output_sense < 0 and effect.acts_on == "angle" else values


def as_read(effect: Effect, figures: Figures, *, output_sense: int) -> Figures:
    """The same of figures by name, each with its ``value``, ``low``, ``high`` and marks; new ones where they differ."""
    values = {name: figure["value"] for name, figure in figures.items() if name in effect.params}
    read = values_as_read(effect, values, output_sense=output_sense)
    return {
        name: _turned(figure, read[name], phase=effect.params[name].role == "phase") if name in read else figure
        for name, figure in figures.items()
    }


def phase_at_first_row(
    fit: Fit, phase: dict[str, Any], *, frequency_Hz: float, deviation_Hz: float
) -> dict[str, float | list[float]]:
    """A phase [deg], fitted in the middle of the record, where it is known best, as it is at the record's first row."""
    half_s = 0.5 * float(np.ptp(fit.observations.motion.time_s))
    value = float(wrap_deg(phase["value"] - 360.0 * frequency_Hz * half_s))
    by_frequency = 360.0 * half_s * quantile_95(fit) * deviation_Hz

    def moved(low: float, high: float) -> list[float]:
        down, up = (float(np.hypot(end - phase["value"], by_frequency)) for end in (low, high))
        return [value - down, value + up]

    return _with_ends(phase, value, moved)


def _turned(figure: dict[str, Any], value: float, *, phase: bool) -> dict[str, Any]:
    """A figure at its mirrored value: with the intervals of a phase half a turn on, or on the other side of zero."""
    was = figure["value"]
    if value == was:
        return figure

    def turned(low: float, high: float) -> list[float]:
        return [low + value - was, high + value - was] if phase else [-high, -low]

    return {**figure, **_with_ends(figure, value, turned)}


def _with_ends(
    figure: dict[str, Any], value: float, moved: Callable[[float, float], list[float]]
) -> dict[str, float | list[float]]:
    """A figure's value elsewhere, and its intervals, each with its ends where they then are."""
    low, high = moved(figure["low"], figure["high"])
    named = {"as_named": moved(*figure["as_named"])} if "as_named" in figure else {}
    return {"value": value, "low": low, "high": high, **named}
