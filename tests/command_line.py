"""Run ``halltwin`` inside the test's own process, and sweeps to run it on."""

from __future__ import annotations

import contextlib
import io
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from numpy.typing import NDArray

from scenarios.cli.main import CRASHED, main

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Ended:
    """How a command ended."""

    code: int
    out: str
    err: str


def halltwin(*arguments: str | Path) -> Ended:
    """Run a command; one that ends in a traceback fails the test."""
    out, err = io.StringIO(), io.StringIO()
    code = 0
    with (
        mock.patch.object(sys, "argv", ["halltwin", *map(str, arguments)]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as ended:
            code = int(ended.code or 0)
    assert code != CRASHED, err.getvalue()
    return Ended(code, out.getvalue(), err.getvalue())


def explained(sweep: Path, *options: str | Path) -> dict[str, Any]:
    """The JSON answer of ``halltwin explain`` to a sweep; the command must succeed and say nothing on stderr."""
    written = sweep.parent / f"{sweep.name}.answer.json"
    ended = halltwin("explain", sweep, "--json", written, *options)
    assert ended.code == 0, ended.err
    assert ended.err == ""
    answer: dict[str, Any] = json.loads(written.read_text(encoding="utf-8"), parse_constant=_no_constant)
    return answer


def _no_constant(name: str) -> float:
    raise AssertionError(f"{name} is no JSON")


def sweep_angles(reference_deg: Array, *, noise_deg: float = 0.02, seed: int = 0) -> Array:
    """Readings (n,) [deg] of a sensor with offsets, unequal gains and saturation at these angles."""
    angle = np.radians(reference_deg + 33.0)
    x, y = 0.006 + np.cos(angle), -0.004 + 1.008 * np.sin(angle)
    noise = noise_deg * np.random.default_rng(seed).standard_normal(reference_deg.size)
    reading: Array = np.degrees(np.arctan2(y - 0.008 * y**3, x - 0.008 * x**3)) + noise
    return reading % 360.0


def csv_text(columns: dict[str, Array], *, delimiter: str = ",", line_end: str = "\n") -> str:
    """Columns (n,) as the text of a sweep file; what is not a number is an empty cell."""
    rows = zip(*columns.values(), strict=True)
    lines = [delimiter.join("" if np.isnan(v) else f"{v:.6f}" for v in row) for row in rows]
    return line_end.join([delimiter.join(columns), *lines, ""])
