"""A short look at what ``python -m tests.kill_study`` tries at length, and that it notices a loss."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.kill_study.__main__ import main
from tests.kill_study.kills import kill
from tests.kill_study.pairs import pair
from tests.kill_study.trials import BENCH, Command, Trial, files, write_inputs


def test_generate_killed_while_its_store_is_made_is_as_undisturbed(tmp_path: Path) -> None:
    pytest.importorskip("zarr", reason="needs the extra 'sweeps'")
    command = Command("generate", ("generate", "-n", "20", "--chunk", "10"), workers=1)
    trials: list[Trial] = []
    calm = tmp_path / "calm"
    assert command.run(calm).code == 0
    kill(command, tmp_path, calm, number=0, seconds=1.0, tell=trials.append)
    assert [trial.outcome for trial in trials] == ["resumed, equal"]
    for lost in (next(iter(files(calm))), "study/done/000001"):
        (calm / lost).rename(calm / "elsewhere")
        assert command.difference(calm, tmp_path / "none")
        (calm / "elsewhere").rename(calm / lost)


def test_two_benches_at_once_leave_one_sweep(tmp_path: Path) -> None:
    pytest.importorskip("can", reason="needs the extra 'bench'")
    pytest.importorskip("cantools", reason="needs the extra 'bench'")
    write_inputs(tmp_path)
    command = Command("bench", (*BENCH[:1], "--points", "300"), study=False)
    trials: list[Trial] = []
    assert command.run(tmp_path / "calm").code == 0
    pair(command, tmp_path, tmp_path / "calm", number=1, tell=trials.append)
    assert [trial.outcome for trial in trials] == ["1 refused, equal"]


@pytest.mark.study
def test_nothing_is_lost_or_ruined() -> None:
    assert main(["--kills", "4", "--disks", "5", "--pairs", "2"]) == 0
