"""The command line. Each command lives in a file of its own and is imported when it is called."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

import typer

app = typer.Typer(
    name="halltwin",
    help="A digital twin of a Hall angle sensor that says what its own simulation gets wrong, and why.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def later(module: str, function: str) -> Callable[..., Any]:
    """A function of the project that is imported only when it is called, so that ``--help`` answers at once."""

    def call(*args: Any, **kwargs: Any) -> Any:
        return getattr(import_module(module), function)(*args, **kwargs)

    return call


def main() -> None:
    """Run the command line; a mistake of the user's is one line on stderr and exit code 2."""
    # The commands are declared in scenarios.commands: one function each, with its options.
    from scenarios import commands  # noqa: F401
    from twin.errors import UserError

    try:
        app()
    except UserError as error:
        print(f"halltwin: {error}", file=sys.stderr)
        raise SystemExit(2) from None


if __name__ == "__main__":
    main()
