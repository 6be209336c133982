"""A reader that needs a library which may not be there, and which raises what it will at a damaged file."""

from __future__ import annotations

from collections.abc import Callable

from twin.errors import SweepError
from twin.logs.table import Table


def by_library(read: Callable[[], Table], word: str, *, extra: str, file: str) -> Table:
    """What a reader of a format, called ``word``, returns. Raises SweepError with the extra that holds its library."""
    try:
        return read()
    except SweepError:
        raise
    except ImportError as error:
        needs = f"needs {error.name}; pip install '.[{extra}]' in the checkout, or save as CSV"
        raise SweepError(f"{file}: reading {word} {needs}") from None
    except Exception as error:
        said = " ".join(str(error).split())[:200]
        raise SweepError(f"{file}: cannot be read as {word} ({said}); expected a whole file: save it again") from None
