"""The factors of diagnosed sweeps as a person reads them: what ``halltwin diagnose`` prints.

Each function takes the answer (the content of the JSON) and nothing else, so that both say the same.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from diagnosis.error_model.descents import STARTS
from diagnosis.report import temperature_text
from diagnosis.report.factor_names import LABELS, SCALES, UNITS
from diagnosis.report.row_counts import diagnosed_rows, left_out_words
from diagnosis.report.wording import figure, plain

_OF_AMPLITUDE = {"%": "% of amplitude"}
_INDENT = 16
_SHORTEST_NAME = 12
_MOST_NAMED = 5
_ONE_LINE = 72
"""Characters in which a factor, its interval and what is said of it fit."""


def text(answer: Mapping[str, Any], *, width: int) -> str:
    """The answer in lines of at most this many characters: all about a single sweep, or one line each for many."""
    sweeps = answer["sweeps"]
    lines = one_sweep(sweeps[0], width=width) if len(sweeps) == 1 else many_sweeps(sweeps, width=width)
    bands = bands_words(sweeps) if len(sweeps) > 1 else []
    over_gaps, thermal = answer["air_gap_fit"], answer["temperature"]
    said = [*bands, *(over_gaps["sentences"] if over_gaps else ())]
    over_temperature = [] if thermal is None else ["", *temperature_text.lines(thermal, width)]
    return "\n".join([*lines, *_listed(said, width), *over_temperature])


def one_sweep(sweep: Mapping[str, Any], *, width: int) -> list[str]:
    """The answer for one sweep, line by line."""
    steps, senses, mirror = sweep["steps"], sweep["senses"], sweep["mirror_solution"]
    alone, polished = (_deg(rms) for rms in (steps["zero_only_rms_deg"], sweep["rms_deg"]))
    particles = steps["particles_evaluated"]
    facts = {
        "error RMS": f"{alone} with the zero alone, {_searched(steps)}, {polished} after the polish",
        "senses": _pair(senses)
        if mirror is None
        else f"{_pair(senses)} or {_pair(mirror)}: these readings do not tell",
        "range": _range_words(sweep["search"]),
    }
    if "band" in sweep:
        facts["band"] = band_words(sweep["band"], particles)
    return [
        *_wrapped(f"{sweep['sweep']}   {sweep['rows']} readings; {diagnosed_rows(sweep)}", width, 2),
        "",
        *_parameter_lines(sweep["parameters"], width=width),
        *_mirror_lines(mirror, width=width),
        "",
        *(line for name, said in facts.items() for line in _wrapped(f"{name:{_INDENT}}{said}", width, _INDENT)),
        "",
        *_wrapped(mechanical_words(sweep["mechanical"]), width, 2),
        *(() if mirror is None else _wrapped(f"{_pair(mirror)}: {mechanical_words(mirror['mechanical'])}", width, 2)),
        "",
        *_listed(sweep["sentences"], width),
    ]


def bands_words(sweeps: Sequence[Mapping[str, Any]]) -> list[str]:
    """Which of many sweeps keep the band; empty without one."""
    asked = [sweep for sweep in sweeps if "band" in sweep]
    if not asked:
        return []
    out = [sweep["sweep"] for sweep in asked if sweep["band"]["readings_outside"]]
    kept, size = len(asked) - len(out), _deg(asked[0]["band"]["delta_e_deg"])
    more = f" and {len(out) - 5} more" if len(out) > 5 else ""
    rest = f"; not {', '.join(out[:5])}{more}" if out else ""
    return [f"Delta E {size} (Eq. 7): {kept} of {len(asked)} sweeps stay within it of their fitted curve{rest}"]


def band_words(band: Mapping[str, Any], particles: int) -> str:
    """What the discard rule did, and whether the fitted curve keeps the band."""
    out = band["readings_outside"]
    keeps = "every reading" if not out else f"all readings but {out}"
    discarded = f"{band['particles_discarded']} of {particles} particles discarded (Eq. 11)"
    return (
        f"Delta E {_deg(band['delta_e_deg'])} (Eq. 7); {discarded}; {keeps} within it of the fitted curve, "
        f"the farthest {_deg(band['largest_deg'])} off"
        + ("; Eq. 7 rejects these factors: more acts than they, which halltwin explain looks for" if out else "")
    )


def _pair(senses: Mapping[str, Any]) -> str:
    return f"s = {senses['sensor']:+d}, h = {senses['output']:+d}"


def _mirror_lines(mirror: Mapping[str, Any] | None, *, width: int) -> Iterator[str]:
    """The table of the mirror solution, where it fits as well."""
    if mirror is not None:
        yield f"as well, with {_pair(mirror)}:"
        yield from _factor_lines(mirror["parameters"], width=width)


def _parameter_lines(parameters: Mapping[str, Any], *, width: int) -> Iterator[str]:
    """The table of the six factors, with its head."""
    yield from f"{'':{_INDENT}}{'value':>12}{_behind(width)}95 % interval".split("\n")
    yield from _factor_lines(parameters, width=width)


def _behind(width: int) -> str:
    """What stands before an interval: where a line has no room for it, a line of its own begins."""
    return "   " if width >= _ONE_LINE else "\n    "


def _factor_lines(parameters: Mapping[str, Any], *, width: int) -> Iterator[str]:
    """The six factors, with the profile's limits below those that have them."""
    behind = _behind(width)
    for key, label in LABELS.items():
        parameter = parameters[key]
        unit = _OF_AMPLITUDE.get(UNITS[key], UNITS[key])
        value, _ = figure(parameter, SCALES[key])
        bound = "   at the model's limit" if parameter["at_bound"] else ""
        limits = _limits(parameter["low"], parameter["high"], value, SCALES[key])
        yield from f"{label:{_INDENT}}{value:>12}{behind}{limits} {unit}{bound}".rstrip().split("\n")
        if "profile" in parameter:
            low, high = parameter["profile"]
            limits = _limits(low, high, value, SCALES[key])
            gap = f"{'':>12}" if width >= _ONE_LINE else ""
            yield from f"{'  profile':{_INDENT}}{gap}{behind}{limits} {unit}".rstrip().split("\n")


def _limits(low: float | None, high: float | None, value: str, scale: float) -> str:
    """An interval with the digits of its value; an end that is none is said to be open."""
    decimals = len(value.partition(".")[2]) if "e" not in value else None
    ends = []
    for end in (low, high):
        if end is None:
            ends.append("open")
        else:
            ends.append(f"{end * scale:.2e}" if decimals is None else f"{end * scale:.{decimals}f}")
    return " .. ".join(ends)


def many_sweeps(sweeps: Sequence[Mapping[str, Any]], *, width: int) -> list[str]:
    """One line a sweep; with the half widths of the intervals where the lines are long enough for them."""
    keys = list(LABELS)[:5]
    first, rest = zip(*(LABELS[key].partition(" ")[::2] for key in keys), strict=True)
    units = [", ".join(filter(None, (word, UNITS[key]))) for key, word in zip(keys, rest, strict=True)]
    heads = [["rows", *first, "RMS", "before"], ["", *units, "deg", "deg"]]
    longest = max(len(sweep["sweep"]) for sweep in sweeps)
    for shown, gap in ((" ".join, 2), (_value_alone, 2), (_value_alone, 1)):
        rows = [*heads, *(_cells(sweep, keys, shown) for sweep in sweeps)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        name = width - sum(widths) - gap * len(widths)
        if name >= longest:
            break
    name = max(_SHORTEST_NAME, min(name, longest))
    firsts = ["sweep", "", *(sweep["sweep"] for sweep in sweeps)]
    lines = []
    for first, row in zip(firsts, rows, strict=True):
        cells = [f"{cell:>{size}}" for cell, size in zip(row, widths, strict=True)]
        lines.append((" " * gap).join([f"{_end_of(first, name):{name}}", *cells]).rstrip())
    return [*lines, *_below(sweeps, width)]


def _below(sweeps: Sequence[Mapping[str, Any]], width: int) -> Iterator[str]:
    """What the table of many sweeps does not say: readings that were not fitted, and solutions that are as good."""
    yield from _wrapped(left_out_words(sweeps), width, 2)
    tied = [sweep["sweep"] for sweep in sweeps if sweep["mirror_solution"] is not None]
    if tied:
        more = f" and {len(tied) - _MOST_NAMED} more" if len(tied) > _MOST_NAMED else ""
        yield from _wrapped(
            f"the sign of offset y and phase is open in {', '.join(tied[:_MOST_NAMED])}{more}: with the zero mirrored "
            "too the other one fits as well (diagnose such a sweep alone to see both)",
            width,
            2,
        )


def _value_alone(shown: tuple[str, str]) -> str:
    return shown[0]


def _cells(sweep: Mapping[str, Any], keys: Iterable[str], shown: Any) -> list[str]:
    """What the line of a sweep says behind its name."""
    factors = [shown(figure(sweep["parameters"][key], SCALES[key])) for key in keys]
    return [str(sweep["rows"]), *factors, plain(sweep["rms_deg"]), plain(sweep["steps"]["zero_only_rms_deg"])]


def _end_of(name: str, length: int) -> str:
    """A name, or of one that is too long its end: files of a series differ there."""
    return name if len(name) <= length else f"…{name[len(name) - length + 1 :]}"


def mechanical_words(equivalent: Mapping[str, Any]) -> str:
    """The mechanical causes that would make the same curve."""
    ways = []
    if equivalent["off_axis_mm"] is not None:
        towards = equivalent["off_axis_direction_deg"]
        length = _between(equivalent, "off_axis", "mm")
        ways.append(f"a sensor {length} off the axis towards {towards:.0f} deg or opposite")
    if equivalent["tilt_deg"] is not None:
        towards = equivalent["tilt_direction_deg"]
        ways.append(f"a sensor tilted {_between(equivalent, 'tilt', 'deg')} towards {towards:.0f} deg")
    same = " or ".join(ways) if ways else "no misalignment before this magnet"
    place = f"{equivalent['magnet']} at {plain(equivalent['air_gap_mm'])} mm"
    known = " (assumed: --twin, --magnet and --air-gap name yours)" if equivalent["assumed"] else ""
    stray = ", ".join(f"{plain(equivalent[f'stray_{axis}_mT'])}" for axis in "xy")
    return (
        f"would look the same: gain ratio and phase ({plain(equivalent['order_2_deg'])} deg of order 2) as {same}, "
        f"before {place}{known}; offset x and y as a stray field of {stray} mT beside a magnet of "
        f"{plain(equivalent['field_mT'])} mT, or as a magnet off the shaft where the sensor is off the axis too. "
        "Sweeps at further air gaps part these from the electronics"
    )


def _between(equivalent: Mapping[str, Any], name: str, unit: str) -> str:
    """A displacement or tilt with the ends of its interval."""
    digits = 2 if unit == "mm" else 1
    low, high = (equivalent[f"{name}_{end}_{unit}"] for end in ("low", "high"))
    ends = " .. ".join("open" if end is None else f"{end:.{digits}f}" for end in (low, high))
    return f"{equivalent[f'{name}_{unit}']:.{digits}f} {unit} ({ends})"


def _searched(steps: Mapping[str, Any]) -> str:
    if steps["swarm_rms_deg"] is None:
        return f"{_deg(steps['descents_rms_deg'])} after descents from {STARTS} starts, which agree"
    return f"{_deg(steps['swarm_rms_deg'])} after the swarm ({steps['particles_evaluated']} particles)"


def _range_words(search: Mapping[str, Any]) -> str:
    if not search["widened"]:
        return "Table 2's"
    wide = ", ".join(LABELS[key] for key in search["widened"])
    rounds = f" ({search['rounds']} rounds)" if search["rounds"] else ""
    return f"wider than Table 2's in {wide}{rounds}"


def _wrapped(words: str, width: int, indent: int) -> list[str]:
    return textwrap.wrap(words, width, subsequent_indent=" " * indent, break_long_words=False, break_on_hyphens=False)


def _listed(said: Iterable[str], width: int) -> list[str]:
    """Sentences as a list."""
    return [line for sentence in said for line in _wrapped(f"- {sentence}", width, 2)]


def _deg(value: float | None) -> str:
    return f"{plain(value)} deg"
