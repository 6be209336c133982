"""One undisturbed run for all tests."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("can", reason="python-can is not installed: pip install '.[bench]' in the checkout")
pytest.importorskip("cantools", reason="cantools is not installed: pip install '.[bench]' in the checkout")

from scenarios.bench.sequence import Patience
from tests.scenarios.bench.rig import run_bench


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Sweep and bus log of a run without faults."""
    folder = tmp_path_factory.mktemp("bench")
    sweep, log = folder / "sweep.csv", folder / "bus.log"
    outcome = run_bench(sweep, record=log, patience=Patience(timeout_s=5.0))
    assert len(outcome.measured.pretreated.kept) == 128
    assert set(outcome.measured.counts) == {"frames"}
    return sweep, log
