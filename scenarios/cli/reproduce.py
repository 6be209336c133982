"""The command line that makes an answer again: the inputs and what decides the answer, without the outputs."""

from __future__ import annotations

from typing import Any

import typer

from scenarios.cli.options import OUTPUTS, RUNNING


def command_line(context: typer.Context) -> str:
    """The command as it was given, less what is written and how it is run; the seed always.

    Files are named as they were on the command line: of two with one name in two folders, each is meant.
    """
    words = ["halltwin", str(context.info_name)]
    for param in context.command.params:
        value = context.params.get(str(param.name))
        if param.name != "seed" and value in (None, (), [], "", param.default):
            continue
        if getattr(param, "rich_help_panel", None) in (OUTPUTS, RUNNING):
            continue
        words += _words(param, value)
    import shlex

    return shlex.join(words)


def _words(param: Any, value: Any) -> list[str]:
    """One parameter as it is typed."""
    from twin.shown_name import shown_path

    values = [shown_path(str(item)) for item in (value if isinstance(value, list | tuple) else [value])]
    if param.param_type_name == "argument":
        # What begins with a hyphen would be taken for an option.
        return [f"./{name}" if name.startswith("-") else name for name in values]
    if isinstance(value, bool):
        return [param.opts[0] if value else param.secondary_opts[0]]
    return [word for item in values for word in (param.opts[0], item)]
