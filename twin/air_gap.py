"""A twin at another air gap: the same device, of which the field and the distance are others."""

from __future__ import annotations

from dataclasses import replace

from twin.catalogue import find
from twin.chain import Chain
from twin.errors import UserError


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
    ratios = {
        "field_ratio": far.nominal_mT / near.nominal_mT,
        "distance_ratio": float(far.distance_mm / near.distance_mm),
    }
    moved = chain.without(*chain.values)
    converter = chain.parts.converter
    if converter is not None:
        smaller = 1.0 / ratios["field_ratio"]
        wider = replace(converter, full_scale=converter.full_scale * smaller, noise_rms=converter.noise_rms * smaller)
        moved = replace(moved, parts=replace(chain.parts, converter=wider))
    moved = moved.with_magnet(far)
    for key, params in chain.values.items():
        effect = find(key, chain.effects)
        values = {**effect.null(), **params}
        follow = {name: values[name] * effect.field_factor(name, values, **ratios) for name in effect.follow_field}
        # A stray field is counted in the magnet's own, which with_magnet has told.
        own = effect.follow_field if effect.at_magnet is not None else ()
        moved = moved.with_effect(key, **{**params, **{n: v for n, v in follow.items() if n not in own or n in params}})
    return moved
