"""``halltwin causes``: the catalogue, as a table in the terminal or as Markdown for the guide."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from diagnosis.report.wording import unit_shown
from twin.catalogue import CATALOGUE, unnamed
from twin.effect import Effect
from twin.extensions import effects_with

FOOTPRINTS = {
    "mean": "expected reading",
    "spread": "spread of readings",
    "values": "values a reading can take",
    "sequence": "single readings",
}
"""Where a cause leaves its mark, in words."""


def groups(effects: Sequence[Effect] = CATALOGUE) -> Iterator[tuple[str, list[Effect]]]:
    """The catalogue in three parts: always fitted, searched for, and carriers of structure without a name."""
    empirical = [effect for effect in effects if unnamed(effect.name)]
    baseline = [effect for effect in effects if effect.baseline]
    yield "Baseline: always fitted", baseline
    yield "Hidden causes: searched for", [e for e in effects if e not in baseline and e not in empirical]
    yield "Structure without a name: described and carried along", empirical


def parameters(effect: Effect) -> str:
    """An effect's parameters with their units."""
    said = []
    for name, param in effect.params.items():
        unit = unit_shown(param.unit)
        # The unit ends most names already.
        told = not unit or name.endswith((f"_{unit}", "_percent", "_per_K", "percent_rms"))
        said.append(name if told else f"{name} ({unit})")
    return ", ".join(said)


def owners(effect: Effect) -> str:
    """Whose its parameters are: the word of most of them, and which are another's."""
    by_owner: dict[str, list[str]] = {}
    for name in effect.params:
        by_owner.setdefault(effect.owner(name), []).append(name)
    most, *others = sorted(by_owner, key=lambda owner: -len(by_owner[owner]))
    return "; ".join([most, *(f"{owner}: {', '.join(by_owner[owner])}" for owner in others)])


def needs(effect: Effect) -> str:
    """What a sweep must hold for the effect to be visible."""
    return ", ".join(sorted(need.replace("|", " or ") for need in effect.needs)) or "any sweep"


def row(effect: Effect) -> tuple[str, ...]:
    """Name, stage, parameters, needs, signature, footprint, owner, source."""
    return (
        effect.name,
        effect.stage,
        parameters(effect),
        needs(effect),
        effect.signature,
        FOOTPRINTS[effect.footprint],
        owners(effect),
        effect.source,
    )


HEADS = ("cause", "stage", "parameters", "needs", "signature in the error", "shows in", "belongs to", "source")


def as_markdown(effects: Sequence[Effect] = CATALOGUE) -> str:
    """The catalogue as GitHub tables."""
    lines: list[str] = []
    for title, part in groups(effects):
        lines += [f"**{title}**", "", f"| {' | '.join(HEADS)} |", f"|{'---|' * len(HEADS)}"]
        for effect in part:
            name, *rest = (cell.replace("|", "\\|") for cell in row(effect))
            lines.append(f"| `{name}` | {' | '.join(rest)} |")
        lines.append("")
    return "\n".join(lines).rstrip()


def run(*, markdown: bool, effect_files: Sequence[Path] = ()) -> None:
    """The command."""
    effects = effects_with(effect_files)
    if markdown:
        print(as_markdown(effects))
        return
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False)
    # What does not fit beside the rest is left to wider terminals and to --markdown.
    shown = (0, 2, 4) if console.width < 100 else (0, 1, 2, 3, 4) if console.width < 150 else range(len(HEADS))
    for title, part in groups(effects):
        table = Table(title=title, title_justify="left", title_style="bold", box=None, padding=(0, 2, 0, 0))
        for place in shown:
            table.add_column(HEADS[place], no_wrap=place == 0)
        for effect in part:
            cells = row(effect)
            table.add_row(*(Text(cells[place]) for place in shown))
        console.print(table)
        console.print()
