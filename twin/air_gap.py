"""A twin at another air gap: the same device, of which the field and the distance are others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from twin.catalogue import find
from twin.chain import Chain
from twin.effect import Effect
from twin.errors import UserError
from twin.magnet.assembly import Assembly


def at_air_gap(chain: Chain, air_gap_mm: float) -> Chain:
    """The same device with its sensor at another air gap.

    What is described in its own units, disk, plates and a stray field, acts in the other field as it is. What is
    counted in amplitudes follows as its effect declares: an offset in volts is a larger share of a weaker field, a gain
    mismatch stays, a saturation's loss falls. The converter's range stays in volts.

    Parameters
    ----------
    chain : Chain
        The twin; its magnet says at which air gap its parameters are stated.
    air_gap_mm : float
        From the magnet's face to the sensing plane [mm].

    Returns
    -------
    Chain
        Another chain.

    Raises
    ------
    UserError
        Where the twin describes no magnet.
    OutOfRangeError
        For a gap, or a parameter that is then, out of range.
    """
    if chain.magnet is None:
        raise UserError("the twin describes no magnet, whose field would say what another air gap does; add [magnet]")
    near = chain.magnet
    far = replace(near, placement=replace(near.placement, air_gap_mm=air_gap_mm))
    ratios = ratios_of(far, near)
    moved = chain.without(*chain.values)
    converter = chain.parts.converter
    if converter is not None:
        smaller = 1.0 / ratios["field_ratio"]
        wider = replace(converter, full_scale=converter.full_scale * smaller, noise_rms=converter.noise_rms * smaller)
        moved = replace(moved, parts=replace(chain.parts, converter=wider))
    moved = moved.with_magnet(far)
    for key, params in chain.values.items():
        effect = find(key, chain.effects)
        # A stray field is counted in the magnet's own, which with_magnet has told.
        own = effect.at_magnet is not None
        names = [name for name in effect.follow_field if not own or name in params]
        there = restated(effect, params, names=names, ratios=ratios)
        # Plain numbers: what is out of range is printed.
        moved = moved.with_effect(key, **{**there, **{name: float(there[name]) for name in names if name in there}})
    return moved


def ratios_of(far: Assembly, near: Assembly) -> dict[str, Any]:
    """Field and distance of one magnet, or of many (designs,), over those of another."""
    return {
        "field_ratio": far.nominal_mT / near.nominal_mT,
        "distance_ratio": far.distance_mm / near.distance_mm,
    }


def restated(
    effect: Effect, params: Mapping[str, Any], *, names: Iterable[str], ratios: Mapping[str, Any]
) -> dict[str, Any]:
    """An effect's parameters where field and distance are multiplied by these ratios: the named ones follow them.

    What is not stated follows from its value of no effect; where the effect does nothing, nothing follows.
    """
    if effect.is_null(params):
        return dict(params)
    return {**params, **effect.in_field({**effect.null(), **params}, names, **ratios)}
