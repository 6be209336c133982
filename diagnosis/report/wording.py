"""Numbers, parameters and structures of an answer as text."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from twin.catalogue import CATALOGUE

_MOST_DECIMALS = 7
_FIFTY = 50
"""Readings of which an RMS is known to a tenth."""
_LOPSIDED = 1.5
"""Ratio of the two sides of an interval from which on both ends are told."""
_ENDING = re.compile(r"(?:^|_)(deg|percent|us|mT(?:_per_(?:A|krpm))?|mm|mm2|ms2|ms3|lsb|Hz|s)$")
_NUMBERED = re.compile(r"^(?P<name>.*?)(?:_(?P<number>\d+))?$")


# ---- numbers ----------------------------------------------------------------------------------------------------


def plain(value: float | None, digits: int = 3) -> str:
    """A figure to so many significant digits; whole numbers in full."""
    if value is None or not math.isfinite(value):
        return "not determined"
    if value == int(value) and abs(value) < 1e9:
        return str(int(value))
    text = f"{value:.{digits}g}"
    if "e" in text and abs(value) >= 1.0:
        return f"{value:.0f}"
    # Zeros that fill up the digits show how well a value is known: keep 0.0190, drop none.
    return text if "e" in text else _filled(value, digits)


def exact(value: float) -> str:
    """A figure that somebody has stated: to six digits, without zeros that only fill up."""
    text = plain(value, 6)
    return text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text


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


def decimals_of(uncertainty: float) -> int:
    """Decimals to which a figure of this uncertainty is told: to two digits of it."""
    if not math.isfinite(uncertainty) or uncertainty <= 0.0:
        return _MOST_DECIMALS
    # Rounded first: 0.0999999 is to count as 0.1.
    return max(0, 1 - math.floor(math.log10(float(f"{uncertainty:.1e}"))))


def rms_shown(rms: float, readings: int) -> str:
    """The RMS of so many readings, known to the share 1/sqrt(2 n): three digits from fifty readings on, else two."""
    return plain(rms, 3 if readings >= _FIFTY else 2)


def figure(parameter: Mapping[str, Any], scale: float = 1.0) -> tuple[str, str]:
    """Value and half width ("" where the value is exact) of a parameter, to two digits of the half width."""
    value, half = parameter["value"], half_width(parameter)
    if value is None or math.isnan(value):
        return "not determined", ""
    if half is None:
        return plain(value * scale, 4), "±∞"
    value, half = value * scale, half * scale
    if half <= 0.0:
        return exact(value), ""
    decimals = decimals_of(half)
    if decimals <= _MOST_DECIMALS:
        return f"{value:.{decimals}f}", f"±{half:.{decimals}f}"
    # A row of zeros says nothing: both with the power of ten of the larger one.
    power = math.floor(math.log10(max(abs(value), half)))
    value, half, decimals = value / 10.0**power, half / 10.0**power, max(decimals + power, 0)
    return f"{value:.{decimals}f}e{power}", f"±{half:.{decimals}f}e{power}"


def around(parameter: Mapping[str, Any], value: float) -> dict[str, Any]:
    """Another value with the width of a parameter's interval."""
    if parameter["low"] is None or parameter["high"] is None:
        return {"value": value}
    half = 0.5 * (parameter["high"] - parameter["low"])
    return {"value": value, "low": value - half, "high": value + half}


def with_unit(parameter: Mapping[str, Any], unit: str | None = None, scale: float = 1.0) -> str:
    """Value, half width and unit of a parameter; the range of one that other causes leave open."""
    if parameter["value"] is None or math.isnan(parameter["value"]):
        return figure(parameter)[0]
    shown = unit_shown(parameter["unit"]) if unit is None else unit
    if parameter.get("open_by"):
        ends = (figure({**parameter, **around(parameter, parameter[end])}, scale)[0] for end in ("low", "high"))
        return f"{' to '.join(ends)} {shown}".rstrip()
    if _lopsided(parameter):
        value, low, high = _to_the_shorter_part(parameter, scale)
        return f"{f'{value} {shown}'.rstrip()} ({low} to {high})"
    return " ".join(part for part in (*figure(parameter, scale), shown) if part)


def _lopsided(parameter: Mapping[str, Any]) -> bool:
    """Whether an interval reaches clearly farther to one side, so that half a width misleads."""
    value, low, high = (parameter[end] for end in ("value", "low", "high"))
    if low is None or high is None or not math.isfinite(high - low):
        return False
    shorter, longer = sorted((value - low, high - value))
    return bool(longer > _LOPSIDED * shorter > 0.0)


def _to_the_shorter_part(parameter: Mapping[str, Any], scale: float) -> list[str]:
    """Value and ends of an interval, to two digits of how far the nearer end is."""
    figures = [scale * parameter[end] for end in ("value", "low", "high")]
    decimals = decimals_of(min(abs(figures[0] - end) for end in figures[1:]))
    if decimals > _MOST_DECIMALS:
        return [plain(one, 2) for one in figures]
    return [f"{one:.{decimals}f}" for one in figures]


def listed(names: Sequence[str], last: str = "and") -> str:
    """Names one after the other, with a word ahead of the last."""
    return f" {last} ".join([", ".join(names[:-1]), names[-1]]) if len(names) > 1 else names[0]


def unit_shown(unit: str) -> str:
    """A unit as it stands behind a number: nothing for pure numbers."""
    return {"1": "", "row": "", "1/turn": "/turn"}.get(unit, unit)


def chance(probability: float | None) -> str:
    """The chance of a false alarm."""
    if probability is None:
        return "not determined"
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
    """One instance's parameters on one line; of those that the sweep hardly narrows the names alone."""
    told = {name: one for name, one in parameters.items() if not one.get("hardly_told")}
    line = ", ".join(
        f"{label(name)} {with_unit(parameter)}" + (" (at its limit)" if parameter.get("at_bound") else "")
        for name, parameter in told.items()
    )
    rest = ", ".join(label(name) for name in parameters if name not in told)
    return f"{line}; hardly told by this sweep: {rest}" if rest else line


def assumed_words(cause: Mapping[str, Any]) -> str:
    """What a cause's millimetres and millitesla are counted against where nobody has described the magnet."""
    assumed = cause.get("assumed")
    return f"assumed, as no magnet is described (--magnet, --twin): {assumed}" if assumed else ""


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
