"""Faults on the bus: each is noticed, nothing is recorded wrongly, and no more is lost than the frames concerned."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scenarios.bench import link
from scenarios.bench.faults import parse
from scenarios.bench.journal import finished_path, running_path
from scenarios.bench.sequence import Patience
from tests.scenarios.bench.rig import assert_same_readings, run_bench
from twin.errors import UserError

SHORT = Patience(timeout_s=0.05, attempts=15)


@pytest.mark.parametrize(
    ("fault", "noticed"),
    [
        ("lost=0.03", "asked again"),
        ("duplicated=0.05", "duplicated"),
        ("checksum=0.03", "checksum"),
        ("spi:hall=0.05", "fault flag"),
        ("stuck:hall=6", "counter stands still"),
        ("stuck:stepper=4", "counter stands still"),
        ("silent:hall=1", "asked again"),
        ("silent:stepper=1", "asked again"),
        ("bus_off:hall=0.3", "asked again"),
        ("bus_off:bench=0.3", "bus off"),
    ],
)
def test_what_a_passing_fault_concerns_is_asked_for_again(
    fault: str, noticed: str, tmp_path: Path, undisturbed: tuple[Path, Path]
) -> None:
    outcome = run_bench(tmp_path / "sweep.csv", faults=[fault])
    kind = parse(fault)[0].kind
    # The faults of the bench's own bus are seen from what the bench noticed.
    assert fault.startswith("bus_off:bench") or sum(done[kind] for done in outcome.faults.values()) > 0
    assert outcome.measured.counts[noticed] > 0
    if kind == "stuck":
        assert outcome.measured.counts[noticed] == sum(done[kind] for done in outcome.faults.values())
    assert not outcome.measured.pretreated.rejected
    assert_same_readings(tmp_path / "sweep.csv", undisturbed[0])


@pytest.mark.parametrize(
    ("fault", "words", "at_least"),
    [
        ("gone:hall=220", "the Hall encoder did not answer: Sync", 109),
        ("gone:reference=100", "the reference encoder did not answer: Sync", 49),
        ("gone:stepper=150", "the stepper's controller did not answer: MotionCommand", 70),
        ("stuck:hall=100000", "counter stands still", 99),
    ],
)
def test_a_fault_for_good_ends_the_run_and_the_run_goes_on_when_it_is_mended(
    fault: str, words: str, at_least: int, tmp_path: Path, undisturbed: tuple[Path, Path]
) -> None:
    sweep = tmp_path / "sweep.csv"
    with pytest.raises(UserError, match=words) as caught:
        run_bench(sweep, faults=[fault], patience=SHORT)
    assert "\n" not in str(caught.value)
    assert not sweep.exists()
    kept = sum('"reading"' in line for line in running_path(sweep).read_text().splitlines())
    assert kept >= at_least
    outcome = run_bench(sweep)
    assert outcome.measured.continued == kept
    assert_same_readings(sweep, undisturbed[0])


def test_wild_readings_are_rejected_counted_and_kept_in_the_log(tmp_path: Path, undisturbed: tuple[Path, Path]) -> None:
    sweep = tmp_path / "sweep.csv"
    outcome = run_bench(sweep, faults=["wild:hall=0.05"])
    rejected = outcome.measured.pretreated.rejected
    assert len(rejected) == outcome.faults["hall"]["wild"] > 0
    assert all("off the typical error" in why for why in rejected.values())
    assert_same_readings(sweep, undisturbed[0], without=list(rejected))
    entries = [json.loads(line) for line in finished_path(sweep).read_text().splitlines()]
    assert entries[-1]["summary"]["rejected"] == {str(index): why for index, why in rejected.items()}
    assert sum("reading" in entry for entry in entries) == 128


def test_every_refused_frame_is_in_the_log(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.csv"
    outcome = run_bench(sweep, faults=["checksum:hall=0.05"])
    kinds = [
        entry["event"]["kind"]
        for entry in map(json.loads, finished_path(sweep).read_text().splitlines())
        if "event" in entry
    ]
    assert kinds.count("checksum") == outcome.measured.counts["checksum"] == outcome.faults["hall"]["checksum"]


def test_a_bus_that_stays_off_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link, "RECOVERIES", 3)
    with pytest.raises(UserError, match="the bus stays off after 3 attempts"):
        run_bench(tmp_path / "sweep.csv", faults=["bus_off:bench=1000"])


@pytest.mark.parametrize(
    "text", ["nonsense", "lost:nobody", "gone", "wild:stepper", "lost=x", "lost=2", "silent:bench", "lost=nan"]
)
def test_faults_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(UserError):
        parse(text)
