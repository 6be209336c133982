"""Drawing: matplotlib where it is installed, one line where it is not."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from twin.errors import UserError
from twin.sweep_file import write_beside

FORMATS = (".png", ".svg", ".pdf")


def style(path: Path) -> Any:
    """matplotlib's pyplot, set up to draw files alone. Raises UserError without matplotlib or for another format."""
    if path.suffix not in FORMATS:
        raise UserError(f"{path.name}: pictures end in {', '.join(FORMATS)}; found '{path.suffix}'")
    try:
        import matplotlib
    except ImportError:
        raise UserError("drawing needs matplotlib; pip install 'halltwin[plot]'") from None
    matplotlib.use("Agg")
    # Text stays text and ids are fixed, so that the same data gives the same bytes.
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "halltwin", "font.size": 9.0})
    import matplotlib.pyplot as plt

    return plt


def save(figure: Any, *paths: Path) -> None:
    """Write the figure under each name, whole or not at all, and close it."""
    import matplotlib.pyplot as plt

    for path in paths:
        kind = path.suffix.removeprefix(".")
        stamp = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}[kind]
        out = io.BytesIO()
        figure.savefig(out, format=kind, dpi=150, metadata=stamp)
        write_beside(path, out.getvalue())
    plt.close(figure)
