"""Code of the user's own is run so that what all the program relies on is afterwards as it was."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

_STREAMS = ("stdout", "stderr")


class StreamTakenError(RuntimeError):
    """Code has closed a standard stream, or put something else in its place: what is printed there would be lost."""


@contextlib.contextmanager
def streams_kept() -> Iterator[None]:
    """Numpy's error handling and the standard streams are as before. Raises StreamTakenError."""
    before: dict[str, Any] = {name: getattr(sys, name) for name in _STREAMS}
    with np.errstate():
        try:
            yield
        finally:
            taken = [name for name, stream in before.items() if _taken(name, stream)]
            for name in taken:
                setattr(sys, name, before[name])
        if taken:
            raise StreamTakenError(f"sys.{taken[0]} is closed or another one; leave it as it is")


def _taken(name: str, before: Any) -> bool:
    return getattr(sys, name) is not before or bool(getattr(before, "closed", False))


@contextlib.contextmanager
def undisturbed() -> Iterator[None]:
    """As :func:`streams_kept`, and the filters of warnings and the working folder are as before."""
    folder = os.getcwd()
    try:
        with streams_kept(), warnings.catch_warnings():
            yield
    finally:
        os.chdir(folder)
