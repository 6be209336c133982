"""What a person sees while the bench runs: how far it is, and the error curve building up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from scenarios.bench.pretreatment import errors_deg
from scenarios.bench.readings import Reading
from twin.angles import Array

WIDTH, HEIGHT = 72, 8
"""Characters of the curve; each holds 2 x 4 dots."""
_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
_EVERY = 8


def curve(angle_deg: Array, error_deg: Array, *, width: int = WIDTH, height: int = HEIGHT) -> tuple[str, float]:
    """Points (n,) over one turn as lines of Braille dots, and the error [deg] at the upper edge."""
    edge = max(float(np.max(np.abs(error_deg), initial=0.0)), 1e-3)
    across = np.minimum((np.remainder(angle_deg, 360.0) / 360.0 * 2 * width).astype(int), 2 * width - 1)
    down = np.minimum(((1.0 - error_deg / edge) / 2.0 * 4 * height).astype(int), 4 * height - 1)
    cells = np.zeros((height, width), dtype=int)
    for x, y in zip(across, down, strict=True):
        cells[y // 4, x // 2] |= _DOTS[y % 4][x % 2]
    return "\n".join("".join(chr(0x2800 + cell) for cell in row) for row in cells), edge


class Progress:
    """Draws now and then; without a terminal it does nothing."""

    def __init__(self, live: Any, total: int, counts: Mapping[str, int], title: str) -> None:
        self._live, self._total, self._counts, self._title = live, total, counts, title

    def show(self, readings: Sequence[Reading]) -> None:
        """Show the state after another reading."""
        if self._live is None or (len(readings) % _EVERY and len(readings) < self._total):
            return
        from rich.text import Text

        last = readings[-1]
        drawn, edge = curve(np.array([one.reference_deg for one in readings]), errors_deg(readings))
        faults = {kind: count for kind, count in self._counts.items() if kind != "frames"}
        said = ", ".join(f"{count} {kind}" for kind, count in sorted(faults.items())) or "no faults"
        head = f"{self._title}: {len(readings)} of {self._total}   {last.reference_deg:.1f} deg, turn {last.turn}"
        foot = f"error +-{edge:.3f} deg over 0 to 360 deg   bus: {self._counts['frames']} frames, {said}"
        self._live.update(Text(f"{head}\n{drawn}\n{foot}"))


@contextmanager
def progress(total: int, counts: Mapping[str, int], title: str) -> Iterator[Progress]:
    """A live display on a terminal."""
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        yield Progress(None, total, counts, title)
        return
    from rich.live import Live

    with Live(console=console, refresh_per_second=5) as live:
        yield Progress(live, total, counts, title)
