"""The engine of studies: the same bytes whoever does the work, resumed where it was killed, other studies refused."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from scenarios.studies import identity as identities
from scenarios.studies import progress
from scenarios.studies.machines import Machines
from scenarios.studies.progress import Course
from scenarios.studies.study_folder import StudyFolder
from tests.scenarios.study_jobs import CHUNKS, Draws, FillsDisk, KillsItsWorker, content, identity, run, study
from twin.errors import UserError

ROOT = Path(__file__).parents[2]


def test_bytes_do_not_depend_on_the_number_of_workers(tmp_path: Path) -> None:
    study(tmp_path / "one", machines=Machines(workers=1))
    study(tmp_path / "two", machines=Machines(workers=2))
    assert content(tmp_path / "one") == content(tmp_path / "two")
    assert len(study(tmp_path / "one").load(CHUNKS)["value"]) == 1000 * CHUNKS


def test_killed_at_random_moments_and_resumed_is_as_undisturbed(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    command = [sys.executable, "-m", "tests.scenarios.study_jobs", str(tmp_path / "killed"), "0.05"]
    for _ in range(3):
        process = subprocess.Popen(command, cwd=ROOT)
        time.sleep(rng.uniform(0.3, 1.6))
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    subprocess.run(command, cwd=ROOT, check=True)
    study(tmp_path / "calm")
    assert content(tmp_path / "killed") == content(tmp_path / "calm")


def test_only_missing_chunks_are_done_again(tmp_path: Path) -> None:
    folder = study(tmp_path / "s")
    before = content(tmp_path / "s")
    (folder.path / "done" / "000004").unlink()
    (folder.path / "chunks" / "000004.npz").unlink()
    untouched = (folder.path / "chunks" / "000003.npz").stat().st_mtime_ns
    study(tmp_path / "s")
    assert content(tmp_path / "s") == before
    assert (folder.path / "chunks" / "000003.npz").stat().st_mtime_ns == untouched


def test_another_seed_version_or_setting_is_refused_and_nothing_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study(tmp_path / "s")
    before = content(tmp_path / "s")
    with pytest.raises(UserError, match="begun with --seed 0, now 5; give another folder"):
        study(tmp_path / "s", seed=5)
    with pytest.raises(UserError, match="begun with --chunks 12, now 13; give"):
        run(Draws(0), tmp_path / "s", chunks=13)
    with (
        pytest.raises(UserError, match="begun with the study draws, now others;"),
        StudyFolder.opened(tmp_path / "s", identity(study="others")),
    ):
        pass
    here = identities.version()
    monkeypatch.setattr(identities, "version", lambda: "99.0")
    with pytest.raises(UserError, match=f"begun with halltwin {re.escape(here)}, now 99.0;"):
        study(tmp_path / "s")
    assert content(tmp_path / "s") == before


RECORD = '{"study": "draws", "version": "1", "seed": 0, "settings": '
DEEP = RECORD + '{"a": ' * 980 + "1" + "}" * 981
DIGITS = RECORD + '{"a": ' + "1" * 5000 + "}}"
SOMEBODYS = json.dumps({"settings": {"theme": "dark"}})


@pytest.mark.parametrize("text", ["", "{", "[]", json.dumps({"seed": 0}), SOMEBODYS, DEEP, DIGITS])
def test_a_broken_record_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "study.json").write_text(text)
    with pytest.raises(UserError, match=r"study\.json: is damaged or no record of a study"):
        study(tmp_path)
    assert content(tmp_path) == {"study.json": text.encode()}


def test_a_folder_that_is_no_study_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "precious.txt").write_text("mine")
    with pytest.raises(UserError, match="is no study"):
        study(tmp_path)
    assert content(tmp_path) == {"precious.txt": b"mine"}


def test_a_full_disk_stops_with_a_line_and_keeps_what_is_done(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"the disk is full; \d of 12 chunks are complete and kept"):
        run(FillsDisk(), tmp_path / "s")
    folder = StudyFolder(tmp_path / "s")
    assert [folder.is_done(chunk) for chunk in range(4)] == [True, True, True, False]


def test_a_killed_worker_of_the_pool_is_a_line(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="a worker process was killed"):
        run(KillsItsWorker(0), tmp_path / "s")
    folder = run(KillsItsWorker(0), tmp_path / "s")
    assert all(folder.is_done(chunk) for chunk in range(12))


def test_a_dask_cluster_that_loses_a_worker_gives_the_same_bytes(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="needs the extra 'sweeps'")
    run(KillsItsWorker(0), tmp_path / "s", machines=Machines(workers=2, scheduler="local"))
    assert (tmp_path / "died").exists()
    study(tmp_path / "calm")
    assert content(tmp_path / "s") == content(tmp_path / "calm")


def test_no_scheduler_at_an_address_is_a_line(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="needs the extra 'sweeps'")
    with pytest.raises(UserError, match="--scheduler nowhere"):
        study(tmp_path / "s", machines=Machines(scheduler="nowhere"))


def test_a_line_says_how_far_a_study_is_and_when_it_will_end() -> None:
    course = Course(chunks=10, before=4, items=1000, unit="sweeps")
    assert course.line(20.0) == "halltwin: after 20 s: 400 of 1,000 sweeps"
    course.done = 2
    assert course.line(20.0) == "halltwin: after 20 s: 600 of 1,000 sweeps, 10 sweeps/s, 40 s left"


def test_without_a_terminal_lines_come_while_a_chunk_is_computed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "FIRST_S", 0.01)
    said = ""
    with progress.progress(chunks=2, done=0, items=2, unit="cells") as step:
        step()
        while said.count("1 of 2 cells") < 2:
            said += capsys.readouterr().err
