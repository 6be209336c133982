"""``halltwin diagnose``: the paper's error factors of one or many sweeps, with what each figure is worth."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from diagnosis import diagnose_many
from diagnosis.report.plotting import check_format, write_figure
from scenarios.commands.inputs import sweep_paths
from twin.whole_file import write_beside


def run(
    names: Sequence[str],
    *,
    json_path: Path | None = None,
    plot: Path | None = None,
    convergence: Path | None = None,
    seed: int = 0,
) -> None:
    """Diagnose what the names stand for; print the answer; write JSON and pictures where asked."""
    for picture in (plot, convergence):
        if picture is not None:
            check_format(picture)
    found = diagnose_many(sweep_paths(names), seed=seed)
    print(found.summary())
    if json_path is not None:
        write_beside(json_path, (json.dumps(found.to_dict(), indent=1, allow_nan=False) + "\n").encode())
        print(f"wrote {json_path}")
    if plot is not None:
        write_figure(found.plot(), plot)
        print(f"wrote {plot}")
    if convergence is not None:
        write_figure(found.plot_convergence(), convergence)
        print(f"wrote {convergence}")
