"""The command line: every command in the order of the help text, and what a mistake of the user's looks like."""

from __future__ import annotations

import os
import sys

import typer

from scenarios.cli.bench import bench
from scenarios.cli.effects import causes, check_effect, new_effect
from scenarios.cli.simulation import hardware, paper, simulate, spinning
from scenarios.cli.studies import design, generate, recover
from scenarios.cli.sweeps import compensate, diagnose, explain, monitor

app = typer.Typer(
    name="halltwin",
    help="A digital twin of a Hall angle sensor that says what its own simulation gets wrong, and why.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

for command in (
    explain,
    causes,
    simulate,
    diagnose,
    spinning,
    paper,
    compensate,
    monitor,
    hardware,
    bench,
    new_effect,
    check_effect,
    generate,
    design,
    recover,
):
    app.command()(command)


def main() -> None:
    """Run the command line; a mistake of the user's is one line on stderr and exit code 2."""
    # The matrices here are small: a thread of their own for each core costs more than it brings.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        app()
    except (OSError, ValueError) as error:
        # twin loads numpy, which --help need not wait for.
        from twin.errors import UserError

        if isinstance(error, OSError) and error.filename is not None:
            said = f"{error.filename}: {error.strerror}; give another path"
        elif isinstance(error, UserError):
            said = str(error)
        else:
            raise
        # Names of files and cells may hold line breaks and control characters; the message stays one line.
        line = " ".join(said.split())
        print(f"halltwin: {''.join(c if c.isprintable() else '?' for c in line)}", file=sys.stderr)
        raise SystemExit(2) from None


if __name__ == "__main__":
    main()
