"""Two processes on one bus: the bench in one, its sequence in the other, over UDP multicast that stays on the host."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import can
import pytest

from scenarios.bench.buses import Interface
from scenarios.bench.command import Options, run
from tests.scenarios.bench.rig import assert_same_readings, quiet_encoder
from twin.errors import UserError
from twin.files import write_twin

PORT = 43217
BUS = [f"port={PORT}"]


def why_no_multicast() -> str:
    """Empty where two buses on this machine hear one another."""
    try:
        first, second = (Interface("udp_multicast", options={"port": PORT + 1}).opener()() for _ in range(2))
    except UserError as error:
        return str(error)
    try:
        first.send(can.Message(arbitration_id=1, data=b"halltwin", is_extended_id=False))
        return "" if second.recv(1.0) is not None else "multicast does not come back on this machine"
    except can.CanError as error:
        return str(error)
    finally:
        first.shutdown()
        second.shutdown()


def test_a_sweep_between_two_processes(tmp_path: Path, undisturbed: tuple[Path, Path]) -> None:
    reason = why_no_multicast()
    if reason:
        pytest.skip(f"udp_multicast: {reason}")
    twin, sweep = tmp_path / "quiet.toml", tmp_path / "sweep.csv"
    write_twin(twin, quiet_encoder())
    options = ["--interface", "udp_multicast", "--bus-option", BUS[0], "--twin", str(twin), "--serve", "40"]
    command = [sys.executable, "-m", "scenarios.cli.main", "bench", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as nodes:
        try:
            assert nodes.stdout is not None
            assert "virtual bench is on udp_multicast" in nodes.stdout.readline()
            run(Options(output=sweep, interface="udp_multicast", bus_options=BUS, points=64, both_directions=True))
        finally:
            nodes.terminate()
    assert_same_readings(sweep, undisturbed[0])


def test_the_virtual_bus_cannot_serve_others(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="ends at this process"):
        run(Options(output=tmp_path / "sweep.csv", serve=1.0))


def test_an_interface_that_is_none_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="CAN interface nosuch") as caught:
        run(Options(output=tmp_path / "sweep.csv", interface="nosuch"))
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_an_encoder_is_not_chosen_where_the_nodes_are_elsewhere(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="for the virtual bench"):
        run(Options(output=tmp_path / "sweep.csv", interface="udp_multicast", twin="imc-14bit"))
