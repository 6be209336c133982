"""``halltwin diagnose``: the paper's error factors of one or many sweeps, with what each figure is worth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from diagnosis import diagnose_many
from scenarios.commands.inputs import sweep_paths
from scenarios.commands.outputs import JSON, PICTURE, OutputFiles, json_text
from scenarios.commands.progress import ended_by_interrupt, progress_line


def run(
    names: Sequence[str],
    *,
    json_path: Path | None = None,
    plot: Path | None = None,
    convergence: Path | None = None,
    force: bool = False,
    seed: int = 0,
) -> None:
    """Diagnose what the names stand for; print the answer; write JSON and pictures where asked."""
    paths = sweep_paths(names)
    files = OutputFiles.checked([(json_path, JSON), (plot, PICTURE), (convergence, PICTURE)], inputs=paths, force=force)
    with ended_by_interrupt(), progress_line() as listener:
        found = diagnose_many(paths, seed=seed, progress=listener)
    print(found.summary())
    files.write(
        {
            json_path: lambda: json_text(found.to_dict()),
            plot: found.plot,
            convergence: found.plot_convergence,
        }
    )
    for written in files.formats:
        print(f"wrote {written}")
