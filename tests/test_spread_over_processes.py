"""The suite spread over processes (``pytest -n auto``): whole files, the measured ones first, a process a core."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests import conftest
from tests.pages import ROOT

CONFTEST = """
from pathlib import Path

from tests import conftest
from tests.conftest import *

conftest.DATA = Path(__file__).parent
"""
QUICK = "def test_one():\n    pass\n\n\ndef test_two():\n    pass\n\n\ndef test_three():\n    pass\n"
MEASURED = f"import pytest\n\npytestmark = pytest.mark.measured\n\n\n{QUICK}"


def test_files_stay_whole_and_the_measured_ones_come_first(tmp_path: Path) -> None:
    """Two processes, three files, of which by the names and the counts of tests any other would come first."""
    pytest.importorskip("xdist")
    (tmp_path / "conftest.py").write_text(CONFTEST)
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers = measured\n")
    for name in ("a", "b"):
        (tmp_path / f"test_{name}.py").write_text(QUICK + QUICK.replace("test_", "test_further_"))
    (tmp_path / "test_c.py").write_text(MEASURED)
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", "-v", "-n", "2", "-p", "no:zarr", "-p", "no:cacheprovider"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path]), "PYTEST_ADDOPTS": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout
    ran = re.findall(r"^\[(gw\d)\].* PASSED (test_\w)\.py", ended.stdout, re.M)
    assert len(ran) == 15
    assert len(set(ran)) == 3, ran
    process = next(process for process, file in ran if file == "test_c")
    assert next(file for other, file in ran if other == process) == "test_c"


@pytest.mark.parametrize(("allowed", "workers"), [(1, 1), (2, 2), (64, conftest.MOST_WORKERS)])
def test_a_process_for_each_core_that_may_be_used(allowed: int, workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(allowed)), raising=False)
    assert conftest.pytest_xdist_auto_num_workers() == workers
