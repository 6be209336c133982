"""Drawing: matplotlib where it is installed, one line where it is not."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from twin.ending import ending_of
from twin.errors import UserError
from twin.whole_file import write_beside

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = (".png", ".svg", ".pdf")
DIRECTIONS = ((1.0, "#0072B2", ".", "forward"), (-1.0, "#D55E00", "x", "backward"))
"""Sense, colour, symbol and name of the directions, in every picture of an error."""
CURVE = "#222222"
STYLE = {"svg.fonttype": "none", "svg.hashsalt": "halltwin", "font.size": 9.0}
"""Text stays text and ids are fixed, so that the same data gives the same bytes."""


@contextmanager
def drawing() -> Iterator[Callable[..., Figure]]:
    """matplotlib's ``Figure``, to be called within: the style holds as long, and pyplot knows of nothing.

    Raises UserError without matplotlib.
    """
    matplotlib = _matplotlib()
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        yield Figure


def check_format(path: Path) -> None:
    """Raise UserError where a picture of this name cannot be drawn: its format is another, or matplotlib is absent."""
    if ending_of(path) not in FORMATS:
        raise UserError(f"{path.name}: pictures end in {', '.join(FORMATS)}; found '{ending_of(path)}'")
    _matplotlib()


def style(path: Path | None = None) -> Any:
    """matplotlib's pyplot, set up to draw files alone. Raises UserError without matplotlib or for another format."""
    if path is not None:
        check_format(path)
    matplotlib = _matplotlib()
    matplotlib.use("Agg")
    matplotlib.rcParams.update(STYLE)
    import matplotlib.pyplot as plt

    return plt


def save(figure: Any, *paths: Path) -> None:
    """Write a figure of pyplot's under each name, whole or not at all, and close it."""
    import matplotlib.pyplot as plt

    write_figure(figure, *paths)
    plt.close(figure)


def write_figure(figure: Any, *paths: Path) -> None:
    """Write the figure under each name, whole or not at all; the same figure gives the same bytes."""
    for path in paths:
        write_beside(path, figure_bytes(figure, ending_of(path)))


def figure_bytes(figure: Any, ending: str) -> bytes:
    """The figure in the format that an ending (``.png``, ``.svg``, ``.pdf``) stands for."""
    kind = ending.removeprefix(".")
    stamp = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}[kind]
    out = io.BytesIO()
    with _matplotlib().rc_context(STYLE):
        figure.savefig(out, format=kind, dpi=150, metadata=stamp)
    return out.getvalue()


def _matplotlib() -> Any:
    try:
        import matplotlib
    except ImportError:
        raise UserError("drawing needs matplotlib; pip install '.[plot]' in the checkout") from None
    return matplotlib
