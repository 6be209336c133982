"""A batch as one HTML page: what is said of it, and every device in a picture that a person can turn over.

The page needs nothing else, no network and no library. Its figures are numbers in one line of text, five digits each,
so that ten thousand devices are a megabyte and open at once.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

from diagnosis.report.style import CSS
from diagnosis.report.wording import chance, figure, listed, minus, plain, unit_shown
from scenarios.studies.fleet import table
from scenarios.studies.fleet.devices import drawn_columns
from scenarios.studies.fleet.page_script import SCRIPT, STYLE
from scenarios.studies.fleet.result import Result
from twin.angles import Array

_DIGITS = 5


def page(found: Result, answer: Mapping[str, Any]) -> str:
    """The page as HTML."""
    count = answer["devices"]["used"]
    body = "".join(
        [
            f"<h1>A batch of {count:,} devices</h1>",
            f'<p class="verdict">{escape(_headline(answer))}</p>',
            "".join(f"<p>{_text(line)}.</p>" for line in table.head(answer)),
            _picture(),
            _factors(answer),
            _lines("Common to the devices", table.causes(answer)),
            _apart(answer),
            _lines("Over the order of the devices", table.changes(answer)),
            _corrections(answer),
            _unusable(answer),
            f"<footer>halltwin {escape(answer['version'])}, {escape(answer['date'])}; "
            f"<code>{escape(answer['command'] or '')}</code></footer>",
        ]
    )
    data = json.dumps(drawn(found), separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{count:,} devices</title><style>{CSS}{STYLE}</style></head>\n<body>{body}"
        f'<script type="application/json" id="data">{data}</script><script>{SCRIPT}</script></body></html>\n'
    )


def drawn(found: Result) -> dict[str, Any]:
    """What the picture holds: names of the files, which stand apart (places), and figures by label."""
    apart = {found.population.batch.names[one.device]: one for one in found.population.apart}
    return {
        "names": list(found.names),
        "apart": {str(place): ", ".join(apart[n].figures) for place, n in enumerate(found.names) if n in apart},
        "figures": [
            {"name": f"{name}{f', {unit}' if unit else ''}", "values": _short(values)}
            for name, (unit, values) in drawn_columns(found).items()
        ],
    }


def _short(values: Array) -> list[float | None]:
    """Figures to as many digits as a picture shows of their range; None where there is none."""
    known = values[np.isfinite(values)]
    span = float(np.ptp(known)) if known.size else 0.0
    decimals = _DIGITS - int(np.floor(np.log10(span))) if span > 0.0 else 12
    return [round(float(value), decimals) if np.isfinite(value) else None for value in values]


def _headline(answer: Mapping[str, Any]) -> str:
    causes = list(dict.fromkeys(cause["name"].replace("_", " ") for cause in answer["causes"]))
    shared = f"Common to all: {listed(causes)}" if causes else "No cause is common to all"
    count = len(answer["apart"])
    apart = f"{count:,} stand{'s' * (count == 1)} apart" if count else "none stands apart"
    changed = "; ".join(f"{one['figure']} changes from {one['file']} on" for one in answer["changes"][:1])
    return f"{shared}; {apart}{f'; {changed}' if changed else ''}."


def _picture() -> str:
    return (
        '<h2>Every device</h2><div class="pick"><label>Down <select id="down"></select></label>'
        '<label>Across <select id="across"></select></label>'
        '<label>Find <input id="find" placeholder="part of a name"></label><span id="said" class="soft"></span></div>'
        '<div class="canvas"><canvas id="points"></canvas><canvas id="spread"></canvas></div>'
    )


def _factors(answer: Mapping[str, Any]) -> str:
    head = ("factor", "mean", "unit", "spread", "spread, 95 %", "error of one device")
    rows = [
        (
            one["label"],
            " ".join(figure({"value": one["mean"], "low": one["low"], "high": one["high"]})),
            unit_shown(one["unit"]),
            plain(one["spread"], 2),
            f"{plain(one['spread_low'], 2)} to {plain(one['spread_high'], 2)}",
            plain(one["own_error"], 2),
        )
        for one in answer["factors"]
    ]
    return f"<h2>The factors</h2>{_table(head, rows)}"


def _apart(answer: Mapping[str, Any]) -> str:
    if not answer["apart"]:
        return _lines("Standing apart", table.apart(answer))
    head = ("device", "number", "in", "standard deviations", "chance", "what explain says")
    rows = [
        (
            one["file"],
            str(one["place"]),
            listed(one["figures"]),
            plain(one["distance"]),
            chance(one["chance"]),
            table.explained_words(one["explained"]).removeprefix("; explain: "),
        )
        for one in answer["apart"]
    ]
    return f"<h2>Standing apart</h2>{_table(head, rows)}"


def _corrections(answer: Mapping[str, Any]) -> str:
    head = ("correction", "error left, deg RMS", "95 % of the devices below, deg")
    rows = [
        (table.CORRECTIONS[one["name"]], plain(one["rms_deg"]), plain(one["largest_deg"]))
        for one in answer["corrections"]
    ]
    return f"<h2>What a correction would leave</h2>{_table(head, rows)}"


def _unusable(answer: Mapping[str, Any]) -> str:
    found = answer["devices"]["unusable"]
    if not found:
        return ""
    rows = [(one["file"], one["reason"]) for one in found]
    return f"<h2>Files that were not used</h2>{_table(('file', 'why'), rows)}"


def _lines(title: str, lines: Iterator[str]) -> str:
    """What is said under a title; a first line that only leads to others is the title itself."""
    first, *rest = lines
    items = "".join(f"<p>{_text(line.strip())}</p>" for line in rest or [first])
    return f"<h2>{escape(title)}</h2>{items}"


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    heads = "".join(f"<th>{escape(name)}</th>" for name in head)
    cells = "".join(f"<tr>{''.join(f'<td>{_text(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f'<div class="scroll"><table><thead><tr>{heads}</tr></thead><tbody>{cells}</tbody></table></div>'


def _text(words: str) -> str:
    return escape(minus(words))
