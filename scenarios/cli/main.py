"""The command line: every command in the order of the help text, and what a mistake of the user's looks like."""

from __future__ import annotations

import contextlib
import os
import sys
from typing import Annotated

import typer

from scenarios.cli import streams
from scenarios.cli.bench import bench
from scenarios.cli.effects import causes, check_effect, new_effect
from scenarios.cli.simulation import hardware, paper, simulate, spinning
from scenarios.cli.studies import design, generate, recover
from scenarios.cli.sweeps import compensate, diagnose, explain, monitor
from scenarios.cli.verbosity import with_verbosity

app = typer.Typer(
    name="halltwin",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)


def _tell_version(asked: bool) -> None:
    if asked:
        from diagnosis.report.provenance import version

        print(f"halltwin {version()}")
        raise typer.Exit


@app.callback()
def halltwin(
    version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """A digital twin of a Hall angle sensor that says what its own simulation gets wrong, and why.

    Exit code 0: answered. 1: answered, and what --fail-on names was found, or some of the files could not be used.
    2: the input cannot be used.
    """


CRASHED = 70
"""Exit code of a fault of the program's own, EX_SOFTWARE of sysexits.h: with Python's 1 it would pass for an answer."""

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
    app.command()(with_verbosity(command))


def main() -> None:
    """Run the command line; a mistake of the user's is one line on stderr and exit code 2, a finding asked for is 1."""
    # The matrices here are small: a thread of their own for each core costs more than it brings.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    streams.prepare()
    code, said = _run()
    unprinted = streams.settle(sys.stdout)
    if unprinted is not None and code in (0, 1):
        gone = streams.reader_is_gone(unprinted)
        code, said = (streams.READER_GONE, "") if gone else (2, streams.unprinted(unprinted))
    if said:
        # Names of files and cells may hold line breaks and control characters; the message stays one line.
        line = " ".join(said.split())
        with contextlib.suppress(OSError):
            print(f"halltwin: {''.join(c if c.isprintable() else '?' for c in line)}", file=sys.stderr)
    streams.settle(sys.stderr)
    raise SystemExit(code)


def _run() -> tuple[int, str]:
    """Exit code of the command, and the line to end with; empty where nothing is to be said."""
    try:
        app()
    except SystemExit as ended:
        if streams.reader_is_gone(ended.__context__):
            return streams.READER_GONE, ""
        return (ended.code if isinstance(ended.code, int) else int(ended.code is not None)), ""
    except Exception as error:
        code, said = _ending(error)
        if code == CRASHED:
            sys.excepthook(type(error), error, error.__traceback__)
        return code, said
    return 0, ""


def _ending(error: Exception) -> tuple[int, str]:
    """Exit code and message of what ended a command."""
    # twin loads numpy, which --help need not wait for.
    from scenarios.commands.fail_on import FoundError
    from twin.errors import UserError

    if isinstance(error, FoundError):
        return 1, str(error)
    if isinstance(error, UserError):
        return 2, str(error)
    if isinstance(error, OSError) and error.filename is not None:
        return 2, f"{error.filename}: {error.strerror}; give another path"
    # Without a buffer nothing is left to be written: whether it was standard output that failed shows in another try.
    if isinstance(error, OSError) and (unprinted := streams.settle(sys.stdout, more="\n")) is not None:
        return 2, streams.unprinted(unprinted)
    return CRASHED, "this is a fault of the program, not of the input; please report it with the lines above"


if __name__ == "__main__":
    main()
