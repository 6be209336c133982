"""A log replayed gives the same bytes, and no mangled log gives a wrong reading."""

from __future__ import annotations

from pathlib import Path

import can
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios.bench.command import Options, run
from scenarios.bench.readings import Assembler, Reading
from scenarios.bench.replay import replay
from tests.scenarios.bench.rig import Plan, run_bench
from twin.errors import UserError

SHORT = Plan(points=24, both_directions=True)


@pytest.mark.parametrize("suffix", [".asc", ".blf", ".csv", ".db", ".log", ".trc"])
def test_replay_gives_the_same_bytes(suffix: str, tmp_path: Path) -> None:
    log = tmp_path / f"bus{suffix}"
    outcome = run_bench(
        tmp_path / "live.csv", plan=SHORT, record=log, faults=["lost=0.02", "checksum=0.02", "duplicated=0.02"]
    )
    found = replay(log, tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "live.csv").read_bytes()
    live = outcome.measured.counts
    assert {k: found.counts[k] for k in found.counts} == {k: n for k, n in live.items() if k != "asked again"}


def test_wild_readings_are_rejected_in_the_replay_too(tmp_path: Path) -> None:
    log = tmp_path / "bus.log"
    outcome = run_bench(tmp_path / "live.csv", plan=SHORT, record=log, faults=["wild:hall=0.1"])
    found = replay(log, tmp_path / "again.csv")
    assert found.pretreated.rejected == outcome.measured.pretreated.rejected != {}
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "live.csv").read_bytes()


def test_a_log_is_not_written_over(tmp_path: Path) -> None:
    log = tmp_path / "bus.log"
    log.write_text("")
    with pytest.raises(UserError, match="not written over"):
        run_bench(tmp_path / "sweep.csv", plan=SHORT, record=log)
    assert [path.name for path in tmp_path.iterdir()] == ["bus.log"]


@pytest.mark.parametrize("name", ["missing.log", "empty.log", "odd.txt", "broken.blf"])
def test_logs_that_are_none_are_one_line(name: str, tmp_path: Path) -> None:
    (tmp_path / "empty.log").write_text("")
    (tmp_path / "broken.blf").write_bytes(b"LOGG" + b"\x00" * 20)
    with pytest.raises(UserError) as caught:
        run(Options(output=tmp_path / "sweep.csv", replay=tmp_path / name))
    assert "\n" not in str(caught.value)


@pytest.fixture(scope="module")
def frames(undisturbed: tuple[Path, Path]) -> list[can.Message]:
    """The frames of the first readings."""
    with can.LogReader(str(undisturbed[1])) as reader:
        return list(reader)[:300]


def assembled(messages: list[can.Message]) -> dict[int, Reading]:
    assembler = Assembler()
    for message in messages:
        assembler.feed(message)
    return {reading.index: reading for reading in assembler.readings}


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.sampled_from(["lose", "repeat", "flip", "delay"]),
            st.integers(0, 299),
            st.integers(0, 63),
            st.integers(1, 40),
        ),
        max_size=40,
    )
)
def test_no_mangled_stream_gives_a_wrong_reading(
    frames: list[can.Message], mangled: list[tuple[str, int, int, int]]
) -> None:
    truth = assembled(frames)
    stream: list[can.Message | None] = list(frames)
    late: list[tuple[float, can.Message]] = [(float(k), message) for k, message in enumerate(frames)]
    for what, place, bit, distance in mangled:
        message = stream[place]
        if message is None:
            continue
        if what == "flip":
            data = bytearray(frames[place].data)
            data[bit // 8] ^= 1 << bit % 8
            late[place] = (
                late[place][0],
                can.Message(arbitration_id=message.arbitration_id, data=data, is_extended_id=False),
            )
        elif what == "delay":
            late[place] = (place + distance + 0.5, late[place][1])
        elif what == "repeat":
            late.append((place + distance + 0.25, late[place][1]))
        else:
            stream[place] = None
            late[place] = (-1.0, late[place][1])
    found = assembled([message for when, message in sorted(late, key=lambda pair: pair[0]) if when >= 0.0])
    assert len(truth) > 25
    for index, reading in found.items():
        assert reading == truth[index]
