"""A batch's answer as a person reads it in a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from diagnosis.population.apart import FEWEST_DEVICES as APART_FROM
from diagnosis.population.changes import FEWEST_DEVICES as CHANGE_FROM
from diagnosis.report.wording import chance, figure, label, listed, plain, unit_shown, with_unit
from twin.catalogue import find

MOST_APART, MOST_UNUSABLE = 20, 10
"""Devices that are listed one by one in the terminal; the JSON, the page and the table of all hold the rest."""
_PHASE_FROM = {"reference": "the reference's zero", "sensor": "the sensor's zero"}
CORRECTIONS = {
    "none": "none (each device's own zero)",
    "common factors": "common to all: factors",
    "common factors and causes": "common to all: factors and causes",
    "own factors": "each device's own: factors",
    "own factors and causes": "each device's own: factors and causes",
}


def show(answer: Mapping[str, Any], console: Console | None = None) -> None:
    """Print the answer."""
    console = console or Console(highlight=False)
    for line in head(answer):
        console.print(Text(line))
    console.print()
    console.print(factors(answer))
    console.print()
    for line in (*causes(answer), "", *apart(answer), "", *changes(answer), ""):
        console.print(Text(line))
    console.print(_corrections(answer))
    unusable = answer["devices"]["unusable"]
    for one in unusable[:MOST_UNUSABLE]:
        console.print(Text(f"not used: {one['file']}: {one['reason']}"))
    if len(unusable) > MOST_UNUSABLE:
        console.print(Text(f"not used: {len(unusable) - MOST_UNUSABLE} more, which --json and --table list"))


def head(answer: Mapping[str, Any]) -> Iterator[str]:
    """How many devices there are, and how they were asked."""
    devices, asked, residual = answer["devices"], answer["asked"], answer["residual"]
    order = {"name": "the numbers in their names", "given": "the order given"}.get(devices["order"], devices["order"])
    left = devices["files"] - devices["used"]
    yield (
        f"{devices['used']:,} devices, in the order of {order}"
        + (f"; {left:,} of {devices['files']:,} files not used" if left else "")
    )
    yield (
        f"each fitted with the paper's factors; {asked['candidates']} candidates of {len(asked['causes'])} causes "
        f"asked of every one, in {asked['looks']} look{'s' * (asked['looks'] > 1)}"
    )
    yield (
        f"left on each device: {plain(residual['median_deg'])} deg RMS in the median, "
        f"{plain(residual['low_deg'])} to {plain(residual['high_deg'])} in 90 % of them"
    )
    sense = answer["output_sense"]
    if not sense["decided"]:
        yield (
            "which way the outputs count is left open by the quadratic term: give --output-sense, or the signs of "
            "offset y and phase may be the other ones"
        )
    if not asked["ended"]:
        yield "the batch showed yet more causes when the last look was done: more may be in it"


def factors(answer: Mapping[str, Any]) -> Table:
    table = _table("factor", "mean", "spread (95 %)", "error of one")
    for one in answer["factors"]:
        unit = unit_shown(one["unit"])
        ends = f"({plain(one['spread_low'], 2)} to {plain(one['spread_high'], 2)})"
        mean = {"value": one["mean"], "low": one["low"], "high": one["high"]}
        table.add_row(
            one["label"],
            f"{' '.join(figure(mean))} {unit}".rstrip(),
            f"{plain(one['spread'], 2)} {ends}",
            plain(one["own_error"], 2),
        )
    return table


def causes(answer: Mapping[str, Any]) -> Iterator[str]:
    """What the devices share beside the factors."""
    if not answer["causes"]:
        yield "No cause is common to the devices."
        return
    yield "Common to the devices, beside the factors:"
    for number, one in enumerate(answer["causes"], 1):
        yield f"  {number}  {cause_words(one)}"
        yield (
            f"     {plain(one['standard_errors_on_one_device'], 2)} standard errors on one device; chance of a false "
            f"alarm {chance(one['false_alarm_probability'])}"
        )
        if one["indistinguishable_from"]:
            yield f"     cannot be told from: {listed(one['indistinguishable_from'], 'or')}"


def cause_words(one: Mapping[str, Any]) -> str:
    """A shared cause in words."""
    size = {"value": one["size"], "low": one["low"], "high": one["high"], "unit": one["unit"]}
    units = {name: unit_shown(param.unit) for name, param in find(one["name"]).params.items()}
    shape = ", ".join(f"{label(k)} {plain(v)} {units[k]}".rstrip() for k, v in one["shape"].items() if v)
    words = f"{one['name']}{f' ({shape})' if shape else ''}: {label(one['parameter'])} {with_unit(size)}"
    if one["phase"] == "own":
        return f"{words} RMS, each device at a phase of its own"
    spread = f"spread {plain(one['spread'], 2)} {unit_shown(one['unit'])}".rstrip()
    if one["phase"] is None:
        return f"{words}, {spread}"
    return f"{words}, {spread}; one phase for all, counted from {from_words(one['phase_counts_from'])}"


def from_words(places: Sequence[str]) -> str:
    """From where a phase is counted that all devices share, and whose the cause then is."""
    if len(places) > 1:
        return "either zero, which are alike here: the bench's or the design's"
    return f"{_PHASE_FROM[places[0]]}: {'the bench' if places[0] == 'reference' else 'the design'} makes it"


def apart(answer: Mapping[str, Any]) -> Iterator[str]:
    """The devices that stand apart."""
    found = answer["apart"]
    if not found:
        few = answer["devices"]["used"] < APART_FROM
        yield f"Which devices stand apart shows from {APART_FROM} devices on." if few else "No device stands apart."
        return
    count = len(found)
    yield f"{count} device{'s stand' if count > 1 else ' stands'} apart:"
    for one in found[:MOST_APART]:
        yield (
            f"  {one['file']} (number {one['place']}): {listed(one['figures'])}, {plain(one['distance'])} standard "
            f"deviations off{explained_words(one['explained'])}"
        )
    if count > MOST_APART:
        yield f"  and {count - MOST_APART} more, which --json, --report and --table list"


def explained_words(told: Mapping[str, Any] | None) -> str:
    """What ``explain`` says of a device, in a few words."""
    if told is None:
        return ""
    if "reason" in told:
        return f"; explain: {told['reason']}"
    named = listed([one["name"] for one in told["causes"]]) if told["causes"] else "no cause"
    return f"; explain: {told['verdict']}, {named}"


def changes(answer: Mapping[str, Any]) -> Iterator[str]:
    """What changes in the order of production."""
    if not answer["changes"]:
        few = answer["devices"]["used"] < CHANGE_FROM
        yield (
            f"Whether anything changes over their order shows from {CHANGE_FROM} devices on."
            if few
            else "Nothing changes over the order of the devices."
        )
        return
    yield "Changes over the order of the devices:"
    for one in answer["changes"]:
        size = f"{'+' if one['size'] > 0 else ''}{plain(one['size'])} {unit_shown(one['unit'])}".rstrip()
        kind = "a step" if one["kind"] == "step" else "a drift up to the last"
        yield (
            f"  {one['figure']}: {kind} of {size} from {one['file']} on (number {one['place']}; 95 %: {one['low']} to "
            f"{one['high']}), chance {chance(one['chance'])}"
        )


def _corrections(answer: Mapping[str, Any]) -> Table:
    table = _table("correction", "error left, deg RMS", "95 % of the devices below")
    for one in answer["corrections"]:
        table.add_row(CORRECTIONS[one["name"]], plain(one["rms_deg"]), plain(one["largest_deg"]))
    return table


def _table(first: str, *columns: str) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column(first)
    for name in columns:
        table.add_column(name, justify="right")
    return table
