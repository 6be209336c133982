"""Tables and figures of the report as HTML. Every number is a ``data`` element that carries the JSON's value."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from diagnosis.report.change_words import change_line, change_name, change_rivals_words
from diagnosis.report.factor_names import SCALES
from diagnosis.report.statements import after_head, factor_rows, held_words, not_visible
from diagnosis.report.wording import (
    chance,
    figure,
    instances,
    label,
    minus,
    plain,
    unit_shown,
)
from twin.catalogue import STAGES, base_name, find
from twin.each_recording import everywhere
from twin.effect import Effect


def number(value: float | None, text: str | None = None) -> str:
    """A number of the answer: what is read, and behind it what the JSON says."""
    if value is None:
        return "not determined"
    shown = plain(value) if text is None else text
    return f'<data value="{value!r}">{escape(minus(shown))}</data>'


def table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], *, numbers: Sequence[int] = (), stacked: bool = True
) -> str:
    """A table of cells that are HTML already; the columns in ``numbers`` are set flush right.

    On a phone a ``stacked`` one has its cells below each other, each behind its column's head.
    """

    def cell(tag: str, place: int, text: str) -> str:
        flush = ' class="number"' if place in numbers else ""
        head = f' data-head="{escape(heads[place], quote=True)}"' if tag == "td" else ""
        return f"<{tag}{flush}{head}>{text}</{tag}>"

    body = "".join(f"<tr>{''.join(cell('td', k, text) for k, text in enumerate(row))}</tr>" for row in rows)
    head = "".join(cell("th", k, escape(text)) for k, text in enumerate(heads))
    kind = ' class="stacked"' if stacked else ""
    return f'<div class="scroll"><table{kind}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _interval(parameter: Mapping[str, Any], scale: float = 1.0) -> str:
    """The 95 % interval of a parameter, or that it is exact."""
    low, high = parameter["low"], parameter["high"]
    if low is None or high is None:
        return "not determined"
    if low == high:
        return "exact"
    text = figure(parameter, scale)[0]
    if "e" in text:
        return " … ".join(number(end, f"{end * scale:.2e}") for end in (low, high))
    decimals = len(text.partition(".")[2])
    return " … ".join(number(end, f"{end * scale:.{decimals}f}") for end in (low, high))


def factors(answer: Mapping[str, Any]) -> str:
    """The factors of the error model with their intervals, before the causes and, where there are any, with them."""
    shown = factor_rows(answer)
    several = [answer["baseline"]["parameters"]]
    if shown[0].after:
        several.append(answer["extended"]["parameters"])
    rows = []
    for row in shown:
        cells = [cell for parameters in several for cell in _with_interval(parameters[row.key], SCALES[row.key])]
        rows.append([escape(row.label), *cells, escape(row.unit), escape(row.flag)])
    heads = ["factor", "before", "95 % interval", after_head(answer), "95 % interval"][: 1 + 2 * len(several)]
    return table([*heads, "unit", ""], rows, numbers=range(1, len(heads)))


def _with_interval(parameter: Mapping[str, Any], scale: float) -> tuple[str, str]:
    """The cells of a parameter's value and of its interval."""
    return number(parameter["value"], figure(parameter, scale)[0]), _interval(parameter, scale)


def changes(answer: Mapping[str, Any]) -> str:
    """What has changed of a given twin, with the gain of each change."""
    rows = [
        [
            f'<span class="name">{escape(change_name(change))}</span>',
            f"{number(change['was'])} → {number(change['is'])} {escape(unit_shown(change['unit']))}",
            "; ".join(escape(minus(w)) for w in (change_line(change), change_rivals_words(answer, change)) if w),
            escape(held_words(change).replace("->", "→")),
            number(change["p"], chance(change["p"])),
        ]
        for change in answer["changed"]
    ]
    heads = ("parameter", "was → is", "", "held-out RMS / deg", "chance of a false alarm")
    return table(heads, rows, numbers=(1, 3, 4))


def summary(causes: Sequence[Mapping[str, Any]]) -> str:
    """All causes with their gain."""
    rows = [
        [
            f'<a href="#cause-{place}">{place}. <span class="name">{escape(cause["name"])}</span></a>',
            escape(cause["stage"]),
            number(cause["heldout_rms_deg_before"]),
            number(cause["heldout_rms_deg_after"]),
            number(cause["false_alarm_probability"], chance(cause["false_alarm_probability"])),
        ]
        for place, cause in enumerate(causes, 1)
    ]
    heads = ["cause", "stage", "held-out RMS before / deg", "after / deg", "chance of a false alarm"]
    return table(heads, rows, numbers=(2, 3, 4))


def parameters(cause: Mapping[str, Any], effect: Effect) -> str:
    """A cause's parameters, instance by instance, with what each of them means."""
    rows = []
    several = instances(cause["parameters"])
    for place, instance in enumerate(several, 1):
        for name, parameter in instance.items():
            declared = effect.params.get(name)
            prefix = f"{place}: " if len(several) > 1 else ""
            unit = unit_shown(parameter["unit"])
            value, interval = _with_interval(parameter, 1.0)
            # The instances of unnamed structure are of different kinds, and described in words beside the table.
            meaning = "" if declared is None or cause["name"] == "unnamed" else declared.doc
            rows.append([escape(prefix + label(name)), value, interval, escape(unit), escape(meaning)])
    if not rows:
        return ""
    heads = ["parameter", "value", "95 % interval", "unit", "meaning"]
    if not any(row[-1] for row in rows):
        heads, rows = heads[:-1], [row[:-1] for row in rows]
    return table(heads, rows, numbers=(1, 2))


def structure(lines: Sequence[str]) -> str:
    """Structure without a name, in words."""
    items = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f"<ol>{items}</ol>"


def invisible(missing: Mapping[str, Iterable[str]], where: str) -> str:
    """What this sweep, or these recordings, could not have shown, and what would."""
    rows = [
        [", ".join(f'<span class="name">{escape(name)}</span>' for name in names), escape(lacks), escape(todo)]
        for names, lacks, todo in not_visible(missing)
    ]
    return table(["cause", f"{where}: what there is", "to see it"], rows)


def chain(values: Iterable[str], new: Mapping[str, int], effects: tuple[Effect, ...]) -> str:
    """The extended chain as boxes in the order of the signal; ``new`` maps keys of effects to their cause's number."""
    keys = list(values)
    boxes = []
    for stage in STAGES:
        here = [key for key in keys if find(key, effects).stage == stage]
        if stage == "empirical" and not here:
            continue
        title = "reference encoder" if stage == "reference" else "unnamed" if stage == "empirical" else stage
        names = dict.fromkeys((everywhere(base_name(key)), new.get(key)) for key in here)
        items = "".join(_effect(name, place) for name, place in names)
        # The reference reads the same shaft beside the sensor: no signal of the sensor's enters it.
        kind = {"link": ' class="last"', "reference": ' class="apart"'}.get(stage, "")
        boxes.append(f"<li{kind}><h4>{title}</h4>{items or '<span class=soft>ideal</span>'}</li>")
    return f'<ol class="chain">{"".join(boxes)}</ol>'


def _effect(name: str, place: int | None) -> str:
    """An effect in its box, highlighted with its number where the search added it; it may break at its underscores."""
    text = escape(name).replace("_", "_<wbr>")
    return f'<span class="name">{text}</span>' if place is None else f'<span class="name new">{place} {text}</span>'
