"""What was measured, in words: readings, turns, directions, distances and speeds of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from diagnosis.report.facts import TIME_AND_REFERENCE
from diagnosis.report.wording import plain

_SEARCHED = "of these {used} were searched, in stretches spread over the record"
_UNEVEN = 2.0
"""Times the shortest distance between readings from which on both ends are said: a speed is then no longer one."""


def sweep_facts(sweep: Mapping[str, Any]) -> list[str]:
    """What was measured, fact by fact."""
    turns = sweep["turns"]
    said = [f"{sweep['rows']} readings"]
    if sweep.get("set_aside"):
        said.append(_SEARCHED.format(used=sweep["used"]))
    said.append(f"{turns_shown(turns)} {'turn' if turns < 1.05 else 'turns'} travelled")
    if "directions" in sweep:
        said.append("both directions" if sweep["directions"] == 2 else "one direction")
    if "points_per_turn" in sweep:
        said.append(f"{step_shown(sweep)} deg apart")
    if sweep.get("speed_from") == TIME_AND_REFERENCE:
        said.append(f"{speeds_shown(sweep['speed_rpm'])} by {TIME_AND_REFERENCE}")
    if sweep["output_bits"] is not None:
        said.append(f"output on a {sweep['output_bits']}-bit grid")
    elif sweep.get("output_step_deg") is not None:
        said.append(f"output in steps of {plain(sweep['output_step_deg'])} deg")
    return said


def turns_shown(turns: float) -> str:
    """Turns travelled, to the digits that mean something."""
    return plain(turns, 2 if turns < 10 else 3)


def speeds_shown(speed_rpm: Sequence[float]) -> str:
    """Slowest and fastest speed, once where they are one."""
    slow, fast = (plain(one, 3) for one in speed_rpm)
    return f"{slow} rpm" if slow == fast else f"{slow} to {fast} rpm"


def step_shown(sweep: Mapping[str, Any]) -> str:
    """Degrees between readings, from the shortest to the longest where one figure would not do."""
    shortest, longest = sweep["step_deg"]
    if longest > _UNEVEN * shortest:
        return f"{plain(shortest, 2)} to {plain(longest, 2)}"
    return plain(360.0 / sweep["points_per_turn"], 2)
