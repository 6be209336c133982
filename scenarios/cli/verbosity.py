"""``--quiet`` and ``--verbose``, which every command has: less or more than the answer on the terminal."""

from __future__ import annotations

import functools
import inspect
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import Annotated, Any

import typer

from scenarios.cli.options import RUNNING

_QUIET = Annotated[
    bool,
    typer.Option("--quiet", "-q", help="Print nothing but errors; files are written.", rich_help_panel=RUNNING),
]
_VERBOSE = Annotated[
    bool,
    typer.Option(
        "--verbose",
        "-v",
        help="Say on stderr what is read, with which settings and seed, each stage and the time.",
        rich_help_panel=RUNNING,
    ),
]


def with_verbosity(command: Callable[..., None]) -> Callable[..., None]:
    """The command with the options ``--quiet`` and ``--verbose`` behind its own."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    own = [one.replace(kind=keyword) for one in inspect.signature(command, eval_str=True).parameters.values()]
    both = [
        inspect.Parameter(name, keyword, default=False, annotation=annotation)
        for name, annotation in (("quiet", _QUIET), ("verbose", _VERBOSE))
    ]

    @functools.wraps(command)
    def run(*, quiet: bool, verbose: bool, **options: Any) -> None:
        if quiet and verbose:
            raise typer.BadParameter("--quiet and --verbose exclude each other; give one of them")
        from scenarios.commands.interrupt import interruptible

        with interruptible(), _silence() if quiet else _told() if verbose else _as_is():
            command(**options)

    # typer asks a function for its signature and its annotations, and gives each parameter by name.
    run.__signature__ = inspect.Signature([*own, *both])  # type: ignore[attr-defined]
    run.__annotations__ = {one.name: one.annotation for one in (*own, *both)}
    return run


@contextmanager
def _as_is() -> Iterator[None]:
    yield


@contextmanager
def _silence() -> Iterator[None]:
    """What is printed goes nowhere. Errors are raised, and told where the command line ends."""
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere), redirect_stderr(nowhere):
        yield


@contextmanager
def _told() -> Iterator[None]:
    """What the packages log goes to stderr, each line with the time since the start."""
    import logging
    import platform
    import shlex
    import time

    from twin.log import LOG

    start = time.monotonic()
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("%(relativeCreated)8.0f ms  %(message)s"))
    level = LOG.level
    LOG.addHandler(handler)
    LOG.setLevel(logging.INFO)
    try:
        from diagnosis.report.provenance import version

        LOG.info("halltwin %s, Python %s", version(), platform.python_version())
        LOG.info("command: %s", shlex.join(["halltwin", *sys.argv[1:]]))
        yield
        LOG.info("done in %.2f s", time.monotonic() - start)
    finally:
        LOG.removeHandler(handler)
        LOG.setLevel(level)
