"""Signs as the reading counts: what is added to the computed angle, where the output counts against it."""

from __future__ import annotations

from typing import Any

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


def _turned(figure: dict[str, Any], value: float, *, phase: bool) -> dict[str, Any]:
    """A figure at its mirrored value: with the interval of a phase half a turn on, or on the other side of zero."""
    was, low, high = figure["value"], figure["low"], figure["high"]
    if value == was:
        return figure
    ends = (low + value - was, high + value - was) if phase else (-high, -low)
    return {**figure, "value": value, "low": ends[0], "high": ends[1]}
