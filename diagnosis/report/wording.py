"""Numbers and findings of an answer in words: what terminal and report have in common."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from twin.catalogue import CATALOGUE

BASELINE_LABELS = {
    "Vx_over_Ax": ("offset x", "%", 100.0),
    "Vy_over_Ay": ("offset y", "%", 100.0),
    "gain_ratio": ("gain ratio y/x", "", 1.0),
    "beta_deg": ("phase", "deg", 1.0),
    "quad": ("quadratic", "%", 100.0),
    "zero_deg": ("zero", "deg", 1.0),
}
"""Parameter of the JSON -> label, unit shown, and what the JSON's value is multiplied by for that unit."""

_LACKS = {
    "both directions": ("one direction", "turn in both directions"),
    "moving shaft": ("the shaft stood still at each reading", "record while the shaft moves, with time_s or speed_rpm"),
    "one turn": ("less than a turn", "cover a whole turn"),
    "several turns": ("less than two turns", "record several turns"),
    "temperature_c": ("no temperature_c", "record temperature_c"),
    "time_s": ("no time_s", "record time_s"),
    "turn": ("no turn column", "number the sweeps in a turn column"),
    "two air gaps": ("one air gap", "measure at a second air gap"),
    "two speeds": ("one speed", "measure at a second speed"),
    "two speeds|both directions": ("one speed, one direction", "measure at a second speed or in both directions"),
    "two temperatures": ("one temperature", "measure at a second temperature"),
    "two turns": ("one turn", "record several turns"),
    "vx": ("no vx, vy", "record vx and vy"),
}
"""What a sweep lacks for a cause to be visible: in words, and what to do about it."""

_ALSO_SAYS = {"two temperatures": "temperature_c", "two turns": "turn", "two speeds|both directions": "moving shaft"}
"""A want that goes without saying where the second one is wanted too."""

_NO_GAIN = 1.05
_UNLIKE = 0.01
_ENDING = re.compile(r"(?:^|_)(deg|percent|us|mT|mm|Hz|s)$")
_NUMBERED = re.compile(r"^(?P<name>.*?)(?:_(?P<number>\d+))?$")


# ---- numbers ----------------------------------------------------------------------------------------------------


def plain(value: float | None, digits: int = 3) -> str:
    """A figure to so many significant digits; whole numbers in full."""
    if value is None or not math.isfinite(value):
        return "unknown"
    if value == int(value) and abs(value) < 1e9:
        return str(int(value))
    text = f"{value:.{digits}g}"
    if "e" in text and abs(value) >= 1.0:
        return f"{value:.0f}"
    # Zeros that fill up the digits show how well a value is known: keep 0.0190, drop none.
    return text if "e" in text else _filled(value, digits)


def _filled(value: float, digits: int) -> str:
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:.{decimals}f}"


def minus(text: str) -> str:
    """Text with a minus sign where a hyphen stood for one: it does not break a line and is as wide as a plus."""
    return re.sub(r"(?<![\w-])-(?=\w)", "−", text)


def half_width(parameter: Mapping[str, Any]) -> float | None:
    """Half of a parameter's 95 % interval; None where it has no end."""
    low, high = parameter["low"], parameter["high"]
    return None if low is None or high is None or math.isinf(high - low) else 0.5 * (high - low)


def figure(parameter: Mapping[str, Any], scale: float = 1.0) -> tuple[str, str]:
    """Value and half width ("" where the value is exact) of a parameter, to two digits of the half width."""
    value, half = parameter["value"], half_width(parameter)
    if value is None or math.isnan(value):
        return "unknown", ""
    if half is None:
        return plain(value * scale, 4), "±unknown"
    value, half = value * scale, half * scale
    if half <= 0.0:
        return plain(value, 4), ""
    # Rounded first: 0.0999999 is to count as 0.1.
    decimals = min(max(0, 1 - math.floor(math.log10(float(f"{half:.1e}")))), 9)
    return f"{value:.{decimals}f}", f"±{half:.{decimals}f}"


def with_unit(parameter: Mapping[str, Any], unit: str | None = None, scale: float = 1.0) -> str:
    """Value, half width and unit of a parameter."""
    shown = unit_shown(parameter["unit"]) if unit is None else unit
    return " ".join(part for part in (*figure(parameter, scale), shown) if part)


def unit_shown(unit: str) -> str:
    """A unit as it stands behind a number: nothing for pure numbers."""
    return {"1": "", "row": "", "1/turn": "/turn"}.get(unit, unit)


def chance(probability: float | None) -> str:
    """The chance of a false alarm."""
    if probability is None:
        return "unknown"
    return "< 1e-6" if probability < 1e-6 else f"{probability:.1g}"


# ---- parameters -------------------------------------------------------------------------------------------------


def label(name: str) -> str:
    """A parameter's name without its unit: ``lag_deg`` is a lag."""
    if name.endswith("_per_K"):
        stem = _ENDING.sub("", name.removesuffix("_per_K"))
        return f"{stem} drift".strip()
    if name.endswith("_rms"):
        return "rms"
    return _ENDING.sub("", name).replace("_", " ") or name


def instances(parameters: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The parameters of each instance of a cause: ``order_2`` belongs to the second."""
    found: dict[int, dict[str, Any]] = {}
    for full, parameter in parameters.items():
        match = _NUMBERED.match(full)
        assert match is not None
        found.setdefault(int(match["number"] or 1), {})[match["name"]] = parameter
    return [found[number] for number in sorted(found)]


def parameter_line(parameters: Mapping[str, Any]) -> str:
    """One instance's parameters on one line."""
    return ", ".join(f"{label(name)} {with_unit(parameter)}" for name, parameter in parameters.items())


# ---- findings ---------------------------------------------------------------------------------------------------


def structure_words(structure: Mapping[str, Any]) -> str:
    """A structure without a name in words: those that the effect of its kind has for it."""
    figures = {name: _Figure(value) for name, value in {**structure, "largest_deg": _largest(structure)}.items()}
    for effect in CATALOGUE:
        if effect.kind and effect.kind == structure["kind"]:
            return effect.words.format_map(defaultdict(lambda: _Figure(None), figures))
    return ", ".join(f"{label(name)} {plain(value)}" for name, value in structure.items() if name != "kind")


@dataclass(frozen=True)
class _Figure:
    """A figure as it stands in a sentence: its format is the number of significant digits, 3 where none is given."""

    value: Any

    def __format__(self, digits: str) -> str:
        return plain(self.value, int(digits or 3))


def _largest(structure: Mapping[str, Any]) -> float:
    sizes = (value for name, value in structure.items() if name.endswith("_deg"))
    return max((abs(value) for value in sizes if value is not None), default=0.0)


def verdict_words(answer: Mapping[str, Any]) -> str:
    """The verdict and what follows from it, in one or two sentences."""
    like = likeness_words(answer["extended"])
    names = {cause["name"] for cause in answer["causes"]}
    rest = " Part of that is structure without a name." if len(names) > 1 and "unnamed" in names else ""
    return f"{_gain_words(answer)}{f'; {like}' if like else ''}.{rest}{cut_words(answer)}"


def cut_words(answer: Mapping[str, Any]) -> str:
    """That the search was stopped, and what that leaves open; empty where it came to its own end."""
    cut = answer.get("cut_short")
    return f" The search was stopped before its end, which leaves open {cut['left_open']}." if cut else ""


def likeness_words(extended: Mapping[str, Any]) -> str:
    """Whether sweeps simulated from the extended twin match the measured one; empty where that was not asked."""
    p = extended.get("likeness_p")
    if p is None:
        return ""
    if p < _UNLIKE:
        return f"simulated sweeps do not match (p < {_UNLIKE:g}: {extended['likeness_worst']})"
    return f"simulated sweeps match (p = {plain(p, 2)})"


def _gain_words(answer: Mapping[str, Any]) -> str:
    verdict = answer["verdict"]
    if verdict == "adequate":
        return "The baseline is adequate: nothing else stands out of the noise"
    if not answer["causes"]:
        return "No cause was found"
    gain = answer["extended"]["gain"]
    if gain < _NO_GAIN:
        # Single readings and scatter are no part of what a twin predicts for the mean.
        return "It lies in single readings or in their scatter, so that their mean is predicted no better"
    closer = f"The extended twin is {plain(gain, 2)} times closer on readings it never saw"
    if verdict == "unnamed":
        return f"Structure is there that no cause of the catalogue explains. {closer}"
    return closer


def explained_percent(before: float, after: float) -> float:
    """How much of a mean square is gone [%]."""
    return 100.0 * (1.0 - (after / before) ** 2) if before > 0.0 else 0.0


def rejected_words(sweep: Mapping[str, Any], most: int = 5) -> str:
    """How many rows were rejected, which, and why."""
    if not sweep["rejected"]:
        return "none rejected"
    rows_by_reason: dict[str, list[str]] = {}
    for row, why in sweep["rejected_rows"].items():
        rows_by_reason.setdefault(why, []).append(row)
    listed = [
        f"{'row' if len(rows) == 1 else 'rows'} {', '.join(rows[:most])}{' ...' if len(rows) > most else ''}: {why}"
        for why, rows in rows_by_reason.items()
    ]
    return f"{sweep['rejected']} rejected ({'; '.join(listed)})"


def not_visible(missing: Mapping[str, Iterable[str]]) -> list[tuple[list[str], str, str]]:
    """Causes that a sweep cannot show, grouped: (names, what is missing, what to do); the largest group first."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for name, needs in missing.items():
        wanted = set(needs)
        told = tuple(sorted(need for need in wanted if _ALSO_SAYS.get(need) not in wanted))
        groups.setdefault(told, []).append(name)
    ranked = sorted(groups.items(), key=lambda item: (-len(item[1]), item[1]))
    return [
        (
            names,
            "; ".join(_LACKS.get(need, (f"no {need}", ""))[0] for need in needs),
            "; ".join(_LACKS.get(need, ("", f"provide {need}"))[1] for need in needs),
        )
        for needs, names in ranked
    ]
