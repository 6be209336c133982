"""Recordings of one device side by side: how each was set up, and what is left of its error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from diagnosis.discovery.proof.cross_validation import rms_deg
from diagnosis.discovery.result import Discovery
from diagnosis.factors.mounting import HELD_WORDS
from diagnosis.report.factor_names import LABELS, SCALES, UNITS
from diagnosis.report.wording import plain
from twin.each_recording import acts_in

RMS_HEADS = ("baseline", "extended", "own")
"""The RMS errors in deg: of the error model, with the causes, and with causes fitted to that recording alone."""
HEADS = (
    *("recording", "readings", "air gap, mm", "turned, deg", "temperature, C", "zero, deg"),
    *RMS_HEADS,
)
"""Columns of the table."""


def recordings_answer(found: Discovery) -> dict[str, Any]:
    """What the JSON says of several recordings; nothing of a single one."""
    recordings = found.sweep.recordings
    if recordings is None:
        return {}
    return {
        "recordings": [_recording(found, number) for number in range(len(recordings))],
        "held_out_by": "recordings" if found.whole_recordings else "blocks",
        "columns_left_out": list(recordings.left_out),
    }


def in_recordings(found: Discovery, keys: Sequence[str]) -> dict[str, list[str]]:
    """The names of the recordings that alone a cause acts in; nothing where it acts in all."""
    recordings, places = found.sweep.recordings, [acts_in(key) for key in keys]
    if recordings is None:
        return {}
    names = [recordings.setups[place].name for place in places if place is not None]
    return {"in_recordings": list(dict.fromkeys(names))} if names else {}


def where_words(cause: Mapping[str, Any]) -> str:
    """In which recordings alone a cause acts; empty where it acts in all."""
    names = cause.get("in_recordings", [])
    return f"in {' and '.join(names)} alone" if names else ""


def _recording(found: Discovery, number: int) -> dict[str, Any]:
    recordings, motion = found.fit.observations.motion.recordings, found.fit.observations.motion
    assert recordings is not None
    setup, part = recordings.setups[number], motion.parts[number]
    rows = found.fit.observations.usable & (recordings.number == number)
    told: dict[str, Any] = {
        "name": setup.name,
        "rows": int(np.count_nonzero(found.sweep.recordings.number == number)) if found.sweep.recordings else 0,
        "turns": part.turns,
        "air_gap_mm": setup.air_gap_mm,
        "field_ratio": setup.field,
        "amplitude_held": setup.amplitude_held,
        "offset_ratio": setup.offset_ratio,
        "turned_deg": setup.turned_deg,
        "turn_stated_deg": setup.turn_stated_deg,
        "turn_told": setup.turn_told,
        "reference_counted_on_deg": setup.reference_deg,
        "temperature_c": float(np.median(part.temperature_c)) if "temperature_c" in motion.columns else None,
        "baseline_rms_deg": rms_deg(found.baseline.residual[0], rows),
        "extended_rms_deg": rms_deg(found.fit.residual[0], rows),
    }
    if found.alone:
        alone = found.alone[number]
        differ = {name: {"own": own, "common": common} for name, (own, common) in alone.differ.items()}
        told |= {"zero_deg": alone.zero_deg, "own_rms_deg": alone.own_deg, "rms_ratio": alone.ratio, "differ": differ}
    return told


def recordings_table(answer: Mapping[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Heads and rows of the table of the recordings, without columns that say nothing; no rows for a single one."""
    rows = [
        [
            one["name"],
            str(one["rows"]),
            _shown(one["air_gap_mm"]),
            _turn_shown(one),
            _shown(one["temperature_c"]),
            _shown(one.get("zero_deg"), 5),
            plain(one["baseline_rms_deg"]),
            plain(one["extended_rms_deg"]),
            _shown(one.get("own_rms_deg")),
        ]
        for one in answer.get("recordings", ())
    ]
    told = [place for place in range(len(HEADS)) if any(row[place] not in ("", "0") for row in rows)]
    return [HEADS[place] for place in told], [[row[place] for place in told] for row in rows]


def recordings_notes(answer: Mapping[str, Any]) -> list[str]:
    """What is to be said of recordings that stand apart, and how they were held out; empty for a single one."""
    several = answer.get("recordings", ())
    if not several:
        return []
    said = []
    if answer["held_out_by"] == "recordings":
        said.append("held out by whole recordings: each is predicted by what the others tell of the device")
    else:
        said.append("held out by blocks of each recording: one alone could not show the causes found")
    if answer["columns_left_out"]:
        said.append(f"not used, as only some of the recordings have it: {', '.join(answer['columns_left_out'])}")
    if any(one["amplitude_held"] for one in several):
        said.append(f"{HELD_WORDS}: the fields at the stated gaps are the magnet's")
    said += [_gap_words(one, several[0]["name"]) for one in several if one["offset_ratio"] is not None]
    said += [words for one in several[1:] if (words := turn_words(one, several[0]["name"]))]
    return said + [_not_shared(one) for one in several if one.get("differ")]


def _gap_words(one: Mapping[str, Any], first: str) -> str:
    """That its offset has changed as another air gap changes it, which nobody has stated."""
    return (
        f"the offset of {one['name']} is {plain(one['offset_ratio'])} times that of {first}, as in another field: if "
        "its air gap was another one, state the gaps (--air-gap), or what follows the field may pass for causes in one "
        "of them"
    )


def turn_words(one: Mapping[str, Any], first: str) -> str:
    """What its zero says of the sensor's turn in a recording, and what was made of it; empty where nothing is open."""
    name, on_deg, stated_deg = one["name"], one["reference_counted_on_deg"], one["turn_stated_deg"]
    if one["turn_told"]:
        return (
            f"the zero of {name} has moved by {_degrees(one['turned_deg'])} deg, and its errors are those of one "
            "device only if sensor and reference were turned against each other by that. Which of the two was turned "
            "they do not tell: the sensor is taken as turned, which nobody has stated; --mounting states it, or with 0 "
            "for each that it was not"
        )
    if not on_deg:
        return ""
    reference = f"its reference is taken to count from {_degrees(on_deg)} deg elsewhere than that of {first}"
    if not stated_deg:
        asked = "; if the sensor was turned, state by how much (--mounting)" if stated_deg is None else ""
        return f"the zero of {name} has moved: {reference}{asked}"
    return (
        f"the turn of {_degrees(stated_deg)} deg that is stated of {name} does not agree with its zero, by "
        f"{_degrees(on_deg)} deg: {reference}; if it does not, state the turn that was made"
    )


def contradictions(answer: Mapping[str, Any]) -> list[str]:
    """The recordings whose stated turn does not agree with their zero."""
    several = answer.get("recordings", ())
    return [one["name"] for one in several if one["turn_stated_deg"] and one["reference_counted_on_deg"]]


def _degrees(value: float) -> str:
    """The size of an angle, whose sense depends on who counts."""
    return plain(abs(value))


def _turn_shown(one: Mapping[str, Any]) -> str:
    """By how much the sensor was turned, as it was stated; marked where only the readings tell it."""
    if one["turn_stated_deg"] is not None:
        return plain(one["turn_stated_deg"])
    return f"{_degrees(one['turned_deg'])} (not stated)" if one["turn_told"] else "0"


def _not_shared(one: Mapping[str, Any]) -> str:
    """That a recording does not share the device's parameters, and in which factors it differs."""
    differ = ", ".join(
        f"{LABELS[name]} {_apart(values['own'] * SCALES[name], values['common'] * SCALES[name])} {UNITS[name]}".rstrip()
        for name, values in one["differ"].items()
    )
    return (
        f"{one['name']} does not share one device's parameters with the others: {plain(one['rms_ratio'])} times closer "
        f"with its own ({differ}); if it is of another device, explain it by itself (--each)"
    )


def _apart(own: float, common: float) -> str:
    """Two figures, with digits enough to tell them apart."""
    told = next((n for n in range(3, 9) if plain(own, n) != plain(common, n)), 3)
    digits = min(told + 1, 9)
    return f"{plain(own, digits)} instead of {plain(common, digits)}"


def _shown(value: float | None, digits: int = 3) -> str:
    return "" if value is None else plain(value, digits)
