"""``halltwin explain --report``: the answer as one HTML page, with pictures, that needs nothing else."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from pathlib import Path
from typing import Any

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.result import Discovery
from diagnosis.report import causes as cause_pictures
from diagnosis.report import pictures as drawn
from diagnosis.report import statements, sweep_words, tables
from diagnosis.report.change_words import change_name
from diagnosis.report.data import Readings, readings, two_ways
from diagnosis.report.facts import facts
from diagnosis.report.motion import motion_words
from diagnosis.report.over_class import in_factors_words, open_words
from diagnosis.report.recordings import RMS_HEADS, recordings_notes, recordings_table, where_words
from diagnosis.report.rivals_words import rivals_words
from diagnosis.report.row_counts import explained_rows
from diagnosis.report.style import CSS
from diagnosis.report.svg import Plot
from diagnosis.report.tables import number
from diagnosis.report.word_fault_words import as_sent_words
from diagnosis.report.wording import assumed_words, minus, plain
from twin.catalogue import find
from twin.whole_file import write_beside


def write_report(path: Path, found: Discovery, answer: Mapping[str, Any]) -> None:
    """Write the report whole or not at all; its numbers are the answer's, its pictures drawn from what was found."""
    write_beside(path, page(found, answer).encode(errors="backslashreplace"))


def page(found: Discovery, answer: Mapping[str, Any]) -> str:
    """The report as HTML."""
    read = readings(found)
    said = facts(found)
    name = escape(answer["sweep"]["name"])
    body = "".join(
        [
            f"<h1>What the simulation gets wrong about {name}</h1>",
            _headline(answer),
            _motion(answer),
            _setup(answer),
            _measured(answer, said, read),
            _baseline(answer, read, found),
            _changes(answer),
            *_causes(answer, found, read),
            _chain(answer, found),
            _parameters(answer),
            _recordings(answer),
            _invisible(answer),
            _provenance(answer),
        ]
    )
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{name}: {escape(answer['verdict'])}</title><style>{CSS}</style></head>\n<body>{body}</body></html>\n"
    )


def _headline(answer: Mapping[str, Any]) -> str:
    names = [change_name(change) for change in answer["changed"]]
    names += [cause["name"].replace("_", " ") for cause in answer["causes"] if cause["name"] != "unnamed"]
    told = f" ({', '.join(names)})" if names else ""
    cards = [
        ("baseline, held-out RMS", number(answer["baseline"]["heldout_rms_deg"]), "deg"),
        ("extended twin, held-out RMS", number(answer["extended"]["heldout_rms_deg"]), "deg"),
        ("times closer on readings it never saw", number(answer["extended"]["gain"]), ""),
    ]
    if statements.floor_is_known(answer):
        cards.append(("noise floor", number(answer["noise_floor_deg"]), "deg"))
    verdict = f"Verdict: {answer['verdict']}{told}."
    return f'<p class="verdict">{escape(verdict)}</p><p>{_text(statements.verdict_words(answer))}</p>{_cards(cards)}'


def _cards(cards: list[tuple[str, str, str]]) -> str:
    items = "".join(
        f"<div><dt>{escape(name)}</dt><dd>{value} <small>{escape(unit)}</small></dd></div>"
        for name, value, unit in cards
    )
    return f'<dl class="figures">{items}</dl>'


def _motion(answer: Mapping[str, Any]) -> str:
    """How the motion was come by where no reference was recorded; empty where one was."""
    items = "".join(f"<li>{_text(words)}.</li>" for words in motion_words(answer))
    return f"<h2>Without a reference</h2><ul>{items}</ul>" if items else ""


def _setup(answer: Mapping[str, Any]) -> str:
    """What of the set-up has to be mended; empty where nothing has."""
    faults = [found for found in answer["setup"] if found["level"] == "fault"]
    items = "".join(
        f"<li><b>{_text(found['what'])}</b>: {_text(found['evidence'])}; so {_text(found['consequence'])}. "
        f"{_text(found['remedy'][:1].upper() + found['remedy'][1:])}.</li>"
        for found in faults
    )
    return f"<h2>Set-up, to be mended first</h2><ul>{items}</ul>" if faults else ""


def _measured(answer: Mapping[str, Any], said: Mapping[str, Any], read: Readings) -> str:
    sweep = answer["sweep"]
    cards = [
        ("readings fitted", number(sweep["fitted"]), f"of {sweep['rows']}"),
        ("turns travelled", number(sweep["turns"], sweep_words.turns_shown(sweep["turns"])), ""),
        ("directions", str(said["directions"]), ""),
        ("between readings", sweep_words.step_shown(sweep), "deg"),
    ]
    for key, unit in (("speed_rpm", "rpm"), ("temperature_c", "°C")):
        if key in said:
            low, high = (plain(value) for value in said[key])
            cards.append((key.partition("_")[0], low if low == high else f"{low} to {high}", unit))
    if sweep["output_bits"] is not None:
        cards.append(("grid of the output", number(sweep["output_bits"]), "bits"))
    elif sweep["output_step_deg"] is not None:
        cards.append(("grid of the output", plain(sweep["output_step_deg"]), "deg"))
    columns = ", ".join(f"<code>{escape(column)}</code>" for column in sweep["columns"])
    facts_said = f"{', '.join(sweep_words.sweep_facts(sweep))}; {explained_rows(sweep)}"
    words = (
        f"<p>{_text(facts_said)}.</p>"
        f"<p>Columns: {columns}. The noise is best described as {escape(answer['noise'])}.</p>"
    )
    plots = _plots([("The shaft at each reading", "", drawn.protocol(read))])
    return f'<h2>What was measured</h2><div class="beside"><div>{_cards(cards)}{words}</div>{plots}</div>'


def _baseline(answer: Mapping[str, Any], read: Readings, found: Discovery) -> str:
    words = (
        f"<p>{_text(statements.baseline_words(answer))}. What stands above the noise, the simulation gets wrong "
        f"({_text(statements.floor_words(answer))}).</p>"
    )
    limits = drawn.residual_limits(read)
    decoded = " The readings are the decoded ones." if as_sent_words(answer["baseline"])[0] else ""
    pictures = [
        ("The error, and the baseline's prediction", f"The zero is removed.{decoded}", drawn.error(read)),
        ("What the baseline leaves", "", drawn.residual(read, read.before_deg, limits=limits)),
    ]
    if statements.extends(answer):
        left = drawn.residual(read, read.after_deg, limits=limits)
        pictures.append(("What the extended twin leaves", "On the scale of the picture before.", left))
    pictures.append(("In the order of the readings", "", drawn.over_clock(read)))
    pictures += [(title, "", plot) for title, plot in drawn.conditions(read)]
    note = "What stands far above the dashed line is no noise."
    if two_ways(read.motion):
        note += " At order 0: half of the step between the directions."
    pictures.append(("Spectrum of the residual", note, drawn.spectra(read, _orders(found))))
    return f"<h2>What the baseline gets wrong</h2>{words}{_plots(pictures)}"


def _orders(found: Discovery) -> list[float]:
    """Orders of the lines that were found, so that the spectrum reaches them."""
    values = found.fit.chain.values
    keys = [key for cause in found.causes for key in cause.keys]
    return [float(values[key]["order"]) for key in keys if "order" in values.get(key, {})]


def _changes(answer: Mapping[str, Any]) -> str:
    """What has changed of a given twin; nothing where none was given."""
    if not statements.held_fixed(answer):
        return ""
    words = f"<p>{statements.sentence(_text(statements.moved_words(answer)))}</p>"
    told = tables.changes(answer) if answer["changed"] else ""
    return f"<h2>What has changed since the twin</h2>{told}{words}"


def _causes(answer: Mapping[str, Any], found: Discovery, read: Readings) -> Iterator[str]:
    if not answer["causes"]:
        yield "<h2>What explains it</h2><p>Nothing is left to explain: no cause and no structure above the noise.</p>"
        return
    yield "<h2>What explains it</h2>"
    yield (
        "<p>Each cause was fitted together with the baseline and judged on readings that neither fit nor selection "
        "had seen. The chance of a false alarm counts everything that was searched. In signatures, "
        "a is the angle in the sensor's own axes, d the direction, w the speed, T the temperature, t the time.</p>"
    )
    yield tables.summary(answer["causes"])
    for place, (cause, named) in enumerate(zip(answer["causes"], found.causes, strict=True), 1):
        yield _cause(cause, named, place=place, answer=answer, found=found, read=read)


def _cause(
    cause: Mapping[str, Any],
    named: Finding,
    *,
    place: int,
    answer: Mapping[str, Any],
    found: Discovery,
    read: Readings,
) -> str:
    effect = find(named.keys[0], found.fit.chain.effects)
    head = f'<h3 id="cause-{place}">{place}. <span class="name">{escape(cause["name"])}</span></h3>'
    if cause["name"] == "unnamed":
        words = (
            "<p>No cause of the catalogue explains this structure. The extended twin carries it as it is, "
            f"so that the gain is had all the same:</p>{tables.structure(statements.structure_lines(answer))}"
        )
    else:
        words = f"<p>Stage: {escape(effect.stage)}. Signature in the error: {escape(minus(effect.signature))}.</p>"
    said = filter(None, (assumed_words(cause), where_words(cause)))
    where = "".join(f"<p>{statements.sentence(_text(words))}</p>" for words in said)
    gain = (
        f"{where}<p>RMS on held-out readings, without it and with it: {_text(statements.held_words(cause))} deg. "
        f"{statements.sentence(_text(statements.single_rows_words(cause)))}</p>"
    )
    pictures = [
        (f"Isolated: {effect_name}", caption, plot)
        for effect_name, (caption, plot) in zip(
            _picture_names(named), cause_pictures.pictures(found, read, named), strict=False
        )
    ]
    return (
        f'<section>{head}<div class="beside"><div>{words}{gain}{_rivals(cause)}'
        f"{tables.parameters(cause, effect)}</div>{_plots(pictures)}</div></section>"
    )


def _picture_names(named: Finding) -> list[str]:
    if named.name != "unnamed":
        return [named.name]
    return [f"structure {k}" for k in range(1, len(named.keys) + 1)]


def _rivals(cause: Mapping[str, Any]) -> str:
    rivals = cause["indistinguishable_from"]
    if not cause.get("rivals_sought", True) or cause.get("same_words"):
        return f"<p>{statements.sentence(_text(rivals_words(cause)))}</p>"
    if not rivals:
        return "" if cause["name"] == "unnamed" else "<p>Nothing else that was searched explains the same readings.</p>"
    names = ", ".join(f'<span class="name">{escape(rival)}</span>' for rival in rivals)
    todo = f"<br><b>To tell them apart:</b> {escape(cause['to_tell_apart'])}." if cause["to_tell_apart"] else ""
    return f'<p class="told"><b>These readings cannot tell it from:</b> {names}.{todo}</p>'


def _chain(answer: Mapping[str, Any], found: Discovery) -> str:
    new = {key: place for place, named in enumerate(found.causes, 1) for key in named.keys}
    keys = dict.fromkeys([*found.fit.chain.values, *new])
    words = (
        "<p>The signal's way from the shaft to the angle word, and the reference that reads the same shaft beside it. "
        + ("Highlighted: what the search added.</p>" if new else "Nothing had to be added.</p>")
    )
    return f"<h2>The extended twin</h2>{words}{tables.chain(keys, new, found.fit.chain.effects)}"


def _parameters(answer: Mapping[str, Any]) -> str:
    sense = answer["senses"]["sensor"] * answer["senses"]["output"]
    counting = "the same way as" if sense > 0 else "the other way round than"
    said = (statements.moved_words(answer), open_words(answer), statements.senses_words(answer))
    words = (
        "<p>Offsets in percent of their channel's amplitude; only the ratio of the amplitudes is visible in an angle. "
        f"The sensor counts {counting} the reference. "
        f"{' '.join(statements.sentence(_text(words)) for words in said)}</p>"
    )
    return f"<h2>The factors of the error model</h2>{words}{tables.factors(answer)}"


def _recordings(answer: Mapping[str, Any]) -> str:
    """Several recordings side by side; nothing for a single one."""
    heads, told = recordings_table(answer)
    rows = [[escape(cell) for cell in row] for row in told]
    if not rows:
        return ""
    notes = "".join(f"<p>{statements.sentence(_text(note))}</p>" for note in recordings_notes(answer))
    heads = [f"{head}, RMS deg" if head in RMS_HEADS else head for head in heads]
    return f"<h2>The recordings side by side</h2>{tables.table(heads, rows, numbers=range(1, len(heads)))}{notes}"


def _invisible(answer: Mapping[str, Any]) -> str:
    if not answer["not_visible"]:
        return ""
    where = statements.recordings_shown(answer)
    words = f"<p>These causes were not searched for, because {where} could not have shown them."
    words = f"{words} {statements.sentence(_text(in_factors_words(answer)))}</p>"
    return f"<h2>Not visible in {where}</h2>{words}{tables.invisible(answer['not_visible'], where)}"


def _provenance(answer: Mapping[str, Any]) -> str:
    """What made the answer, and how to make it again."""
    made = f"Made by halltwin {escape(answer['version'])} on {escape(answer['date'])} (UTC) with seed {answer['seed']}"
    if answer["command"] is None:
        return f"<footer><p>{made}, called from Python.</p></footer>"
    return f"<footer><p>{made}. The same again: <code>{escape(answer['command'])}</code></p></footer>"


def _text(words: str) -> str:
    """Words as HTML, with arrows and minus signs as such."""
    return escape(minus(words.replace("->", "→")))


def _plots(pictures: list[tuple[str, str, Plot]]) -> str:
    items = "".join(
        f"<figure><figcaption><b>{escape(title)}.</b> {escape(note)}</figcaption>{plot.legend()}{plot.svg()}</figure>"
        for title, note, plot in pictures
    )
    return f'<div class="plots">{items}</div>'
