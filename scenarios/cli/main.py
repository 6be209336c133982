"""Where the program begins and ends: the exit code, and the one line that a mistake or an interrupt ends with.

Little is loaded before the work is watched over, so that Ctrl-C is a line at any time.
"""

from __future__ import annotations

import contextlib
import os
import sys
from typing import Any

from scenarios.cli import streams

CRASHED = 70
"""Exit code of a fault of the program's own, EX_SOFTWARE of sysexits.h: with Python's 1 it would pass for an answer."""
_BY_TYPER = 130
"""Exit code that typer makes of an interrupt before or after the command itself."""
_DAY = "SOURCE_DATE_EPOCH"
"""See ``check_day`` in ``diagnosis/report/provenance.py``, which need not be loaded where it is not set."""


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
        # An effect of the user's own may have closed it.
        with contextlib.suppress(OSError, ValueError):
            print(f"halltwin: {''.join(c if c.isprintable() else '?' for c in line)}", file=sys.stderr)
    streams.settle(sys.stderr)
    raise SystemExit(code)


def _run() -> tuple[int, str]:
    """Exit code of the command, and the line to end with; empty where nothing is to be said."""
    try:
        code = _command()
    except SystemExit as ended:
        if streams.reader_is_gone(ended.__context__):
            return streams.READER_GONE, ""
        if _by_interrupt(ended):
            return _ending(KeyboardInterrupt())
        return (ended.code if isinstance(ended.code, int) else int(ended.code is not None)), ""
    except (Exception, KeyboardInterrupt) as error:
        code, said = _ending(error)
        if code == CRASHED:
            sys.excepthook(type(error), error, error.__traceback__)
        return code, said
    return _ending(KeyboardInterrupt()) if code == _BY_TYPER else (code, "")


def _command() -> int:
    """Run what the command line asks for; its exit code."""
    if _DAY in os.environ:
        from diagnosis.report.provenance import check_day

        check_day()
    import typer

    from scenarios.cli import app

    # Else typer ends the program by itself, and draws a box about what was wrong with the options.
    try:
        code = app.app(standalone_mode=False)
    except typer.Abort:
        # Some versions of typer make this of an interrupt, others an exit code.
        code = _BY_TYPER
    return code if isinstance(code, int) else 0


def _by_interrupt(ended: BaseException | None) -> bool:
    """Whether an exit comes of an interrupt before or after the command itself, which typer has made an exit of."""
    while ended is not None and not isinstance(ended, KeyboardInterrupt):
        ended = ended.__context__
    return ended is not None


def _ending(error: Exception | KeyboardInterrupt) -> tuple[int, str]:
    """Exit code and message of what ended a command."""
    from scenarios.commands.interrupt import INTERRUPTED, NOTHING_WRITTEN, Interrupted

    if isinstance(error, KeyboardInterrupt | Interrupted):
        return INTERRUPTED, str(error) or NOTHING_WRITTEN
    # twin loads numpy, which --help need not wait for.
    from scenarios.commands.fail_on import FoundError
    from twin.errors import UserError

    if isinstance(error, FoundError | UserError):
        return (1 if isinstance(error, FoundError) else 2), str(error)
    if hasattr(error, "format_message"):
        # What typer says of options; its class stands in another module in each of typer's versions.
        return 2, _of_usage(error)
    if isinstance(error, OSError) and error.filename is not None:
        return 2, f"{error.filename}: {error.strerror}; give another path"
    # Without a buffer nothing is left to be written: whether it was standard output that failed shows in another try.
    if isinstance(error, OSError) and (unprinted := streams.settle(sys.stdout, more="\n")) is not None:
        return 2, streams.unprinted(unprinted)
    return CRASHED, "this is a fault of the program, not of the input; please report it with the lines above"


def _of_usage(error: Any) -> str:
    """What is wrong with the options, and where to read on; empty where the help was printed instead."""
    said = " ".join(str(error.format_message()).split()).rstrip(".")
    command = "" if error.ctx is None or error.ctx.parent is None else f"{error.ctx.info_name} "
    return (
        said and f"{command.replace(' ', ': ')}{said[:1].lower()}{said[1:]}; halltwin {command}-h lists what it takes"
    )


if __name__ == "__main__":
    main()
