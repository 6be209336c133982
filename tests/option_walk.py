"""Every option of every command, found by walking over the functions of the command line themselves."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from typer.models import OptionInfo

from scenarios.cli.app import app

ODD = ("nan", "inf", "-inf", "-1", "0", "1e308", "36.9", "")
"""What a number may be by mistake."""


@dataclass(frozen=True)
class Option:
    """One option of one command: its longest name, and what it takes: number, path, flag or text."""

    command: str
    name: str
    kind: str


def options() -> Iterator[Option]:
    """Every option, in the order of the help; arguments are none."""
    for registered in app.registered_commands:
        assert registered.callback is not None
        command = registered.name or registered.callback.__name__.replace("_", "-")
        for name, parameter in inspect.signature(registered.callback, eval_str=True).parameters.items():
            kind, *more = get_args(parameter.annotation) or (parameter.annotation,)
            info = next((one for one in more if isinstance(one, OptionInfo)), None)
            if info is not None:
                names = info.param_decls or (f"--{name.replace('_', '-')}",)
                yield Option(command, max(names, key=len), _kind(kind))


def _kind(hint: Any) -> str:
    kinds = {hint, *get_args(hint), *(inner for part in get_args(hint) for inner in get_args(part))}
    found = (("flag", bool), ("path", Path), ("number", int), ("number", float))
    return next((name for name, kind in found if kind in kinds), "text")
