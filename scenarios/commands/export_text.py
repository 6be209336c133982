"""A drive's table as a person reads it, as the comment in its file, and as the JSON."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from diagnosis.report.motion import correction_words
from diagnosis.report.provenance import Provenance
from diagnosis.report.wording import plain, rms_shown
from scenarios.commands.compensate_judge import Judged
from scenarios.commands.compensate_text import MadeOf, Rows, figures
from scenarios.commands.export_made import Exported
from scenarios.commands.left_words import left_words

SCHEMA = "halltwin.export/1"
_DIGITS = 2


def show(made: Exported, of: MadeOf, rows: Rows, console: Console | None = None) -> None:
    """Print what the table is, how it does, and what it leaves."""
    console = console or Console(highlight=False)
    console.print(Text(f"{of.name}   {of.readings}" if of.readings else of.name))
    for line in (*_what(made), *of.motion, *of.temperature):
        console.print(Text(line))
    console.print(figures(rows, console.width))
    if made.not_removed:
        console.print(Text("not removed by a table of the reading alone:"))
        for left in made.not_removed:
            console.print(Text(f"  {left_words(left)}"))
    console.print(Text(f"to load it: {made.asked.target.load}"))


def about(made: Exported, provenance: Provenance) -> tuple[str, ...]:
    """The lines of the comment in the file."""
    judged = [one for one in _with_sound(made) if not one.part]
    return (
        f"Angle correction for {made.asked.target.what}.",
        f"Made by halltwin {provenance.version} on {provenance.date} from {made.source.name}, seed {provenance.seed}"
        f"{'' if provenance.command is None else f': {provenance.command}'}",
        *_what(made)[1:],
        *(f"{line[:1].upper()}{line[1:]}." for line in _motion(made)),
        *(f"Angle error {one.name}: {_short(one)}" for one in judged),
        *(f"Not removed: {left_words(left)}" for left in made.not_removed),
        f"To load it: {made.asked.target.load}.",
    )


def _motion(made: Exported) -> list[str]:
    """What has to be kept in mind where the readings had no reference."""
    return [] if made.source.readings is None else correction_words(made.source.readings.estimated)


def _with_sound(made: Exported) -> list[Judged]:
    """What the table was judged on, and beside it without the faults of the words where there are any."""
    return [one for whole in made.judged for one in (whole, whole.sound) if one is not None]


def _what(made: Exported) -> list[str]:
    """The table in a few lines."""
    target = made.asked.target
    largest = float(np.max(np.abs(made.away_deg)))
    return [
        target.what,
        f"{len(made.table)} entries: {target.axis}; {target.sign}; unit {target.unit}",
        *([formula] if (formula := target.formula_of(made.wanted)) else []),
        f"read back, it follows the correction at {made.asked.temperature_c:g} C to {plain(largest, _DIGITS)} deg at "
        f"worst, {plain(_rms(made.away_deg), _DIGITS)} deg RMS",
    ]


def _short(one: Judged) -> str:
    found = one.found
    rms = " -> ".join(rms_shown(value, found.before_rad.size) for value in found.rms_deg)
    return f"RMS {rms} deg, largest {' -> '.join(plain(value, _DIGITS) for value in found.peak_deg)} deg"


def to_dict(made: Exported, provenance: Provenance) -> dict[str, Any]:
    """The answer as plain values."""
    target, correction = made.asked.target, made.wanted
    return {
        "schema": SCHEMA,
        **provenance.to_dict(),
        "source": made.source.name,
        "target": target.name,
        "what": target.what,
        "entries": len(made.table),
        "axis": target.axis,
        "sign": target.sign,
        "entry_unit": target.unit,
        "formula": target.formula_of(correction) or None,
        "least": made.asked.least,
        "load": target.load,
        "temperature_c": made.asked.temperature_c,
        "slope": correction.slope,
        "zero_deg": float(np.degrees(correction.zero_rad)),
        "read_back": {"largest_deg": float(np.max(np.abs(made.away_deg))), "rms_deg": _rms(made.away_deg)},
        "not_separable": None if made.source.readings is None else made.source.readings.not_separable,
        "judged": [_judged(one) for one in _with_sound(made)],
        "not_removed": [
            {
                "what": left.what,
                "causes": list(left.causes),
                "rms_deg": left.rms_deg,
                "largest_deg": left.largest_deg,
                "at": left.at,
            }
            for left in made.not_removed
        ],
    }


def _judged(one: Judged) -> dict[str, Any]:
    (before, after), (largest, largest_after) = one.found.rms_deg, one.found.peak_deg
    return {
        "on": one.name,
        "rows": int(one.found.before_rad.size),
        "rms_deg_before": before,
        "rms_deg_after": after,
        "largest_deg_before": largest,
        "largest_deg_after": largest_after,
    }


def _rms(values: Any) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
