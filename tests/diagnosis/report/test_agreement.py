"""Terminal, report and JSON say the same: every figure and list of the three is held against those of the others.

The quick sweeps are made here; those that were measured, and take minutes, are studied on request (``-m study``).
"""

from __future__ import annotations

import functools
import html
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis import Explanation, Progress, explain
from diagnosis.report import row_counts, statements
from diagnosis.report.factor_names import LABELS, SCALES
from diagnosis.report.page import page
from diagnosis.report.row_counts import explained_rows
from diagnosis.report.sweep_words import sweep_facts
from diagnosis.report.wording import figure, with_unit
from scenarios.commands.protocol import Protocol
from tests.diagnosis.report.test_page import BASE, numbers_of
from tests.measured import DATA
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.errors import UserError
from twin.sweep import Sweep

BENCH = Path(__file__).parents[3] / "scenarios" / "data"
OLD_NAMES = re.compile(r"V[xy]/A[xy]|V[xy]_over_A[xy]|\bbeta\b|\bx_percent\b|\by_percent\b")
LOST = re.compile(r"\b(nan|NaN|None|inf|unknown)\b")
NUMBER = re.compile(r"(?<![\w.#])[-+±]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w]*[a-df-zA-Z_])")
ALWAYS = (95.0, 0.01, 1e-6, 0.0, 20.0, 0.99)
"""Figures that words hold whatever the sweep: the level of the intervals, limits of probabilities, one in 20."""


def made(both: bool = True, **effects: dict[str, float]) -> Sweep:
    motion = Protocol(turns=2, points=90, both_directions=both).motion()
    return Chain().with_values({**BASE, **effects}).simulate(motion, seed=3)


def stop_at_once(progress: Progress) -> None:
    if progress.causes:
        raise StopIteration


def with_wild_rows() -> Explanation:
    """Readings that stand alone, by less than a flipped bit makes, and one that cannot be read."""
    sweep = made(saturation={"k_percent": 1.0})
    measured = sweep.measured_deg.copy()
    measured[[20, 90, 200]] += (0.31, -0.37, 0.43)
    measured[7] = np.nan
    return explain({"reference_deg": sweep.reference_deg, "measured_deg": measured})


def few_readings() -> Sweep:
    motion = Protocol(turns=1, points=30, both_directions=False).motion()
    return Chain().with_values(BASE).simulate(motion, seed=3)


def repeated() -> dict[str, np.ndarray]:
    """Every angle read three times in a row."""
    sweeps = [
        Chain().with_values(BASE).simulate(Protocol(turns=1, points=60).motion(), seed=seed) for seed in (1, 2, 3)
    ]
    columns = ("reference_deg", "measured_deg")
    return {name: np.stack([getattr(sweep, name) for sweep in sweeps], axis=1).ravel() for name in columns}


CASES: dict[str, Callable[[], Explanation]] = {
    "clean": lambda: explain(made()),
    "a cause": lambda: explain(made(hysteresis={"lag_deg": 0.12, "memory_deg": 8.0})),
    "several causes": lambda: explain(
        made(hysteresis={"lag_deg": 0.1, "memory_deg": 8.0}, drive_ripple={"order": 20.0, "amplitude_deg": 0.1})
    ),
    "no name": lambda: explain(made(unnamed_order={"order": 13.0, "amplitude_deg": 0.08})),
    "single readings": lambda: explain(made(bus_glitch={"count": 5.0})),
    "wild rows": with_wild_rows,
    "one way": lambda: explain(made(both=False, saturation={"k_percent": 1.0})),
    "given twin": lambda: explain(made(), twin=Chain().with_effect("offset", x_percent=5.0)),
    "stopped": lambda: explain(made(hysteresis={"lag_deg": 0.12, "memory_deg": 8.0}), progress=stop_at_once),
    "few": lambda: explain(few_readings()),
    "repeated": lambda: explain(repeated()),
    "bench": lambda: explain(BENCH / "bench_sweep.csv"),
}


@functools.cache
def explained(name: str) -> Explanation:
    return CASES[name]()


def terminal(found: Explanation) -> str:
    """What the terminal shows, in one line."""
    return " ".join(found.summary(width=100).split())


def report(found: Explanation) -> str:
    """What is read in the report, in one line: without pictures, with the signs of the terminal."""
    source = page(found.discovery, found.to_dict())
    source = re.sub(r'<(style|svg|footer).*?</\1>|<div class="legend">.*?</div>', " ", source, flags=re.S)
    text = html.unescape(re.sub(r"<[^>]+>", " ", re.sub(r"</?(data|small|span|code|a|b|wbr)\b[^>]*>", "", source)))
    return " ".join(text.replace("−", "-").replace("→", "->").split())


def without_declared(text: str) -> str:
    """A text without what effects declare of themselves: their signatures and what their parameters mean."""
    for effect in CATALOGUE:
        for words in (effect.signature, *(param.doc for param in effect.params.values())):
            if words and any(character.isdigit() for character in words):
                text = re.sub(rf"(?<![\w.]){re.escape(' '.join(words.split()))}(?![\w.]?\d|\w)", "", text)
    return text


def known_figures(answer: dict[str, Any]) -> Iterator[float]:
    """What a text may say in figures: those of the JSON, in percent too, half widths of intervals, and counts."""
    for value in (*numbers_of(answer), *half_widths(answer), *lengths(answer), *ALWAYS):
        yield from (value, 100.0 * value)
    yield 360.0 / answer["sweep"]["points_per_turn"]
    # Of longer lists than the JSON holds: how many rows there are behind those that are told.
    yield from (answer["sweep"][key] - row_counts.MOST_TOLD for key in ("wild", "rejected"))


def half_widths(value: Any) -> Iterator[float]:
    if isinstance(value, dict):
        if value.get("low") is not None and value.get("high") is not None:
            yield 0.5 * (value["high"] - value["low"])
        for item in value.values():
            yield from half_widths(item)
    elif isinstance(value, list):
        for item in value:
            yield from half_widths(item)


def lengths(value: Any) -> Iterator[float]:
    """Lengths of lists, places in them, and how many are left where the first few are told; instances are numbered."""
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    if isinstance(value, list | dict):
        yield from (float(k) for k in range(len(value) + 1))
    yield from (length for item in items for length in lengths(item))


def check(found: Explanation) -> None:
    answer = found.to_dict()
    check_counts(answer["sweep"])
    shown = {"terminal": terminal(found), "report": report(found)}
    for where, text in shown.items():
        assert not LOST.search(text), (where, LOST.search(text))
        assert not OLD_NAMES.search(text), (where, OLD_NAMES.search(text))
        for words in stated(answer):
            assert " ".join(words.split()) in text, (where, words)
        text = text.replace(answer["sweep"]["name"], "").replace(answer["noise"], "")
        strays = list(figures_beside(without_declared(text), answer))
        assert not strays, (where, strays)
    check_chain(answer)
    lists = re.search(r"Not visible in this sweep(.*)", shown["report"])
    for name in answer["not_visible"]:
        assert name in shown["terminal"].partition("Not visible in this sweep")[2]
        assert lists
        assert name in lists[1]


def stated(answer: dict[str, Any]) -> Iterator[str]:
    """Words that both show as they are: facts, figures with their intervals, causes with theirs, the verdict."""
    yield ", ".join(sweep_facts(answer["sweep"]))
    yield explained_rows(answer["sweep"])
    yield statements.baseline_words(answer)
    yield statements.floor_words(answer)
    yield statements.verdict_words(answer)
    yield from filter(None, (statements.moved_words(answer), statements.senses_words(answer)))
    for key, label in LABELS.items():
        yield f"{label} {figure(answer['baseline']['parameters'][key], SCALES[key])[0]}"
    for cause in answer["causes"]:
        yield cause["name"]
        yield statements.held_words(cause)
        yield from cause["indistinguishable_from"]
        # The report begins a sentence with it.
        yield statements.single_rows_words(cause)[1:]
        if cause["name"] == "unnamed":
            yield from statements.parameter_lines(answer, cause)
        else:
            told = (one for one in cause["parameters"].values() if not one.get("hardly_told"))
            # A lopsided one is told to the digits of its nearer end in a sentence, to those of its width in a table.
            values = ((figure(parameter)[0], with_unit(parameter).split()[0]) for parameter in told)
            yield from (in_table for in_table, in_sentence in values if in_table == in_sentence)


def figures_beside(text: str, answer: dict[str, Any]) -> Iterator[str]:
    """Figures of a text that are the rounding of none in the JSON."""
    known = np.unique([value for value in known_figures(answer) if np.isfinite(value)])
    for shown in NUMBER.findall(text):
        read = abs(float(shown.strip("±")))
        mantissa, _, power = shown.partition("e")
        unit = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
        # A figure of few digits may be one of its last place off, where it was rounded twice.
        near = np.abs(np.abs(known) - read) <= 0.5001 * unit + 1e-6 * read
        if not np.any(near):
            yield shown


def check_counts(sweep: dict[str, Any]) -> None:
    """Every row is counted once: in use, set aside or rejected; and of those in use fitted, or why not."""
    assert sweep["rows"] == sweep["used"] + sweep["set_aside"] + sweep["rejected"]
    assert sweep["used"] == sweep["fitted"] + sweep["wild"] + sweep["touched"] + sweep["direction_in_doubt"]


def check_chain(answer: dict[str, Any]) -> None:
    """The gains of what has changed and of the causes chain from the baseline to the extended twin."""
    rms = answer["baseline"]["heldout_rms_deg"]
    for step in (*answer["changed"], *answer["causes"]):
        assert step["heldout_rms_deg_before"] == rms
        rms = step["heldout_rms_deg_after"]
    assert answer["extended"]["heldout_rms_deg"] == rms


@pytest.mark.parametrize("name", CASES)
def test_the_three_agree(name: str) -> None:
    check(explained(name))


def test_the_cases_show_what_they_are_for() -> None:
    wild = explained("wild rows").to_dict()["sweep"]
    assert wild["wild"] == len(wild["wild_rows"]) > 0
    assert wild["rejected"] == 1
    # Those about a reversal whose direction is inferred are not fitted either.
    assert wild["direction_in_doubt"] > 0
    assert explained("single readings").to_dict()["sweep"]["touched"] > 0
    assert explained("few").to_dict()["extended"]["likeness_not_checked"]["needed"]
    assert explained("repeated").to_dict()["noise_floor_from"] == "repeated readings"
    senses, factors = (explained("wild rows").to_dict()[key] for key in ("senses", "extended"))
    # Without a quadratic term the mirrored twin reads the same: offset y and phase change their sign, nothing else.
    assert not senses["decided"]
    assert f"and {LABELS['zero_deg']} " in statements.senses_words(explained("wild rows").to_dict())
    for key, sign in (("Vx_over_Ax", 1.0), ("Vy_over_Ay", -1.0), ("gain_ratio", 1.0), ("beta_deg", -1.0)):
        told = factors["parameters"][key]
        assert senses["mirrored"][key] == pytest.approx(sign * told["value"], abs=told["high"] - told["low"])
    assert "The mirrored twin (s = -1, h = -1) fits as well" in terminal(explained("wild rows"))
    assert explained("clean").to_dict()["senses"]["decided"]
    assert explained("given twin").to_dict()["baseline"]["explained_percent"] < 0.0
    assert "makes the error larger" in terminal(explained("given twin"))
    assert explained("stopped").to_dict()["cut_short"]
    assert len(explained("several causes").causes) >= 2


def test_a_figure_that_differs_would_be_noticed() -> None:
    found = explained("a cause")
    answer = found.to_dict()
    text = terminal(found).replace(answer["sweep"]["name"], "")
    assert not list(figures_beside(text, answer))
    floor = f"{answer['noise_floor_deg']:.4f}"
    assert set(figures_beside(text.replace(floor, "0.7654"), answer)) == {"0.7654"}


FOLDERS = ("challenge", "cases", "real", "physics", "broken", "spins")
MEASURED = sorted(path for folder in FOLDERS for path in (DATA / folder).glob("*.csv"))


@pytest.mark.study
@pytest.mark.measured
@pytest.mark.parametrize("path", MEASURED, ids=lambda path: path.stem)
def test_the_three_agree_on_what_was_measured(path: Path) -> None:
    try:
        found = explain(path)
    except UserError:
        return
    check(found)
