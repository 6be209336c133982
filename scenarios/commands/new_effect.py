"""``halltwin new-effect`` and ``halltwin check-effect``: write an effect of one's own, and hold it to the contract."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from diagnosis.report.answer import SCHEMA
from diagnosis.report.wording import structure_words
from scenarios.commands.effect_skeleton import skeleton
from scenarios.commands.outputs import PYTHON, OutputFiles
from twin.bounded_input import whole
from twin.catalogue import find
from twin.contract import check
from twin.declaration import NAME
from twin.effect import Effect
from twin.errors import UserError
from twin.extensions import RESERVED, effects_of, effects_with, unfit
from twin.shown import shown

_PLAIN = "structure of your own: a line of order 5 in the shaft angle, to begin with"


@dataclass(frozen=True)
class Origin:
    """What a skeleton is shaped after: a structure, the facts of its sweep, and both in words."""

    structure: Mapping[str, Any] | None = None
    sweep: Mapping[str, Any] = field(default_factory=dict)
    words: str = _PLAIN


def run(name: str, *, output: Path | None, answer: Path | None, force: bool = False) -> None:
    """Write the skeleton. Raises UserError for a name or a file that is taken, and for an answer that is none."""
    path = output if output is not None else Path(f"{name}.py")
    _check_name(name)
    files = OutputFiles.checked([(path, PYTHON)], inputs=[answer], force=force)
    origin = origin_of(answer) if answer is not None else Origin()
    text = skeleton(
        name,
        file=path.name,
        structure=origin.structure,
        sweep=origin.sweep,
        found=f"Written by halltwin new-effect, for {origin.words}.",
    )
    files.write({path: text})
    files.tell_written({path: f"for {origin.words}"})


def _check_name(name: str) -> None:
    if not NAME.fullmatch(name):
        raise UserError(f"{name}: is no name for an effect; give lower-case words joined by underscores: gear_mesh")
    if name.startswith(RESERVED):
        raise UserError(f"{name}: names that begin with '{RESERVED}' are for structure without a name; give another")
    try:
        taken = find(name, effects_with())
    except KeyError:
        return
    raise UserError(f"{name}: is in the catalogue already ({taken.signature}); give another name")


def origin_of(path: Path) -> Origin:
    """The strongest structure that an answer of ``halltwin explain`` leaves without a name. Raises UserError."""
    try:
        answer = json.loads(whole(path, expected="what explain --json wrote"))
        if answer["schema"] != SCHEMA:
            raise UserError(f"{path.name}: schema is {shown(answer['schema'])}; expected {SCHEMA!r}")
        structures = [_figures(item) for item in answer["unexplained"]["structure"]]
        ranked = sorted(structures, key=_size_deg, reverse=True)
        words = structure_words(ranked[0]) if ranked else ""
        sweep = dict(answer["sweep"])
    # What is no answer may hold numbers of any length, and lists in lists.
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError, RecursionError) as error:
        if isinstance(error, UserError):
            raise
        raise UserError(f"{path.name}: is no answer of halltwin explain; give what explain --json wrote") from None
    if not ranked:
        raise UserError(f"{path.name}: leaves no structure without a name (verdict: {answer.get('verdict')})")
    # The words go into a docstring: a file's name may hold anything.
    name = re.sub(r"[^\w .,()+-]", "?", str(sweep.get("name", "")))
    others = f", the strongest of {len(ranked)} structures" if len(ranked) > 1 else ""
    return Origin(ranked[0], sweep, f"what {name} shows: {words}{others}")


def _figures(structure: Mapping[str, Any]) -> dict[str, Any]:
    """The kind of a structure and those of its figures that are known."""
    known = {name: float(v) for name, v in structure.items() if isinstance(v, int | float) and math.isfinite(v)}
    return {"kind": str(structure["kind"]), **known}


def _size_deg(structure: Mapping[str, Any]) -> float:
    """Largest amplitude [deg] among a structure's figures; places, widths and phases are none."""
    beside = ("phase_deg", "centre_deg", "width_deg")
    return max(
        (abs(float(value)) for name, value in structure.items() if name.endswith("_deg") and name not in beside),
        default=0.0,
    )


# ---- checking ---------------------------------------------------------------------------------------------------


def check_run(path: Path) -> None:
    """Show how each effect of a file keeps each promise. Raises UserError where one is broken."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    effects = effects_of(path)
    console = Console(highlight=False)
    broken = []
    for effect in effects:
        table = Table(title=str(effect.name), title_justify="left", title_style="bold", box=None, padding=(0, 2, 0, 0))
        for head in ("promise", "", ""):
            table.add_column(head, no_wrap=head == "promise")
        for promise, kept, said in _results(effect):
            word = {True: ("kept", "green"), False: ("BROKEN", "red"), None: ("not asked", "dim")}[kept]
            table.add_row(promise, Text(*word), Text(said))
            broken += [str(effect.name)] if kept is False else []
        console.print(table)
        console.print()
    if broken:
        names = ", ".join(dict.fromkeys(broken))
        raise UserError(f"{path.name}: {len(broken)} broken in {names}; mend what the table says")
    # What is kept by each alone may still clash with the catalogue and with installed effects.
    effects_with([path])
    print(f"All kept. Use it: halltwin explain SWEEP --effects {path}")


def _results(effect: Effect) -> list[tuple[str, bool | None, str]]:
    said = unfit(effect)
    first = ("may be loaded", not said, said)
    return [first, *((result.promise, result.kept, result.said) for result in check(effect))]
