"""What would explain the same readings as well as a cause does, and what would tell them apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.further.power import advice
from diagnosis.discovery.result import Discovery
from diagnosis.discovery.search.lines import waves_in_radius
from diagnosis.report.motion import may_be_torque
from twin.catalogue import find
from twin.each_recording import everywhere
from twin.effect import Effect, Parameters


def as_well(found: Discovery, cause: Finding) -> dict[str, Any]:
    """The answer's keys of a cause: its rivals, and the measurements that part them.

    Among the rivals is the stage of which a part that no effect stands for makes the same line, where the radius of the
    channels does not tell it apart.
    """
    told = [advice(cause.options, found.fit.settings)] if cause.rivals else []
    beside = _beside(found, cause)
    return {
        "indistinguishable_from": [*dict.fromkeys(map(everywhere, cause.rivals)), *(stage for stage, _ in beside)],
        **_same_words(found, cause),
        "rivals_sought": found.cut_short is None,
        "to_tell_apart": "; ".join([*told, *dict.fromkeys(words for _, words in beside)]),
        "to_tell_apart_options": [
            {"measurement": option.measurement, "sigma": option.sigma, "cost": option.cost} for option in cause.options
        ],
    }


def _same_words(found: Discovery, cause: Finding) -> dict[str, list[dict[str, Any]]]:
    """The faults that send the very same words, and by how much the zero is another with each."""
    sense = found.fit.chain.output_sense
    entries = [{"what": one.said, "zero_by_deg": float(np.degrees(sense * one.zero_rad))} for one in cause.alike]
    return {"same_words": entries} if entries else {}


def _beside(found: Discovery, cause: Finding) -> list[tuple[str, str]]:
    """Such stages, each with what would tell it apart; none where rivals were not looked for.

    And causes of which a fault of the words says that they do the same on this record; and the same cause with other
    numbers; and without a reference a torque locked to the angle, which no search has to find.
    """
    if found.cut_short is not None:
        return may_be_torque(found, cause)
    effect, observations = find(cause.keys[0], found.fit.chain.effects), found.fit.observations
    beside = []
    values = found.fit.chain.values
    own = [values[key] for key in cause.keys if key in values]
    if effect.comb is not None and effect.comb.also is not None:
        orders = {round(order) for line in own for order in effect.comb.orders(line)}
        # What turns the shaft unevenly turns the field as a whole: the channels' radius stays.
        more_than_turned = any(one.acts(line) for one in effect.operations[1:] for line in own)
        if not more_than_turned and not any(waves_in_radius(found.fit, order) for order in orders):
            beside.append(effect.comb.also)
    beside += may_be_torque(found, cause)
    beside += _other_makers(effect, own)
    also = effect.in_words.also if effect.in_words is not None else None
    if also is not None and also.where(observations.measured, observations.motion, cause.rows):
        beside.append((also.cause, also.tells))
    return beside


def _other_makers(effect: Effect, lines: Sequence[Parameters]) -> list[tuple[str, str]]:
    """The same cause with other numbers that make all of these lines as well."""
    comb = effect.comb
    if comb is None or comb.unite is None or comb.united is None:
        return []
    orders = sorted({round(order) for values in lines for order in comb.orders(values)})
    others = [shape for shape in comb.unite(orders) if set(orders) <= set(comb.united(shape))]
    words = [" and ".join(f"{value:g} {name}" for name, value in shape.items()) for shape in others]
    return [
        (f"{effect.name} of {said}", "count them on the part itself")
        for said, shape in zip(words, others, strict=True)
        if any(shape[name] != lines[0][name] for name in shape)
    ]
