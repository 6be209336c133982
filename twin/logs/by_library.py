"""A reader that needs a library which may not be there, and which raises and tells what it will at a damaged file."""

from __future__ import annotations

import importlib
import logging
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from twin.errors import SweepError
from twin.logs.table import Table


def by_library(read: Callable[[], Table], word: str, *, library: str, extra: str, file: str) -> Table:
    """What a reader of a format, called ``word``, returns, with what its library tells of places that it leaves out.

    Raises SweepError, with the ``extra`` that holds the library where it is missing.
    """
    try:
        importlib.import_module(library)
        with _heard(library) as said:
            table = read()
    except SweepError:
        raise
    except ImportError as error:
        needs = f"needs {error.name}; pip install '.[{extra}]' in the checkout, or save as CSV"
        raise SweepError(f"{file}: reading {word} {needs}") from None
    except Exception as error:
        text = " ".join(str(error).split())[:200]
        raise SweepError(f"{file}: cannot be read as {word} ({text}); expected a whole file: save it again") from None
    if not said:
        return table
    places = "1 place" if len(said) == 1 else f"{len(said)} places"
    return replace(table, left=(*table.left, f"{places} of the file ({said[0]})"))


@contextmanager
def _heard(library: str) -> Iterator[list[str]]:
    """What a library tells its loggers, a line each, which it would print on standard error."""
    said: list[str] = []

    class Listener(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            said.append(" ".join(record.getMessage().split())[:120])

    names = [name for name in logging.root.manager.loggerDict if name.split(".")[0] == library]
    loggers = [logging.getLogger(name) for name in {library, *names}]
    before = [(one.handlers, one.propagate) for one in loggers]
    listener = Listener(logging.WARNING)
    try:
        for one in loggers:
            one.handlers, one.propagate = [listener], False
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield said
    finally:
        for one, (handlers, propagate) in zip(loggers, before, strict=True):
            one.handlers, one.propagate = handlers, propagate
