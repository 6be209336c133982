"""Frames a second without loss, and what limits them: ``python -m tests.benchmarks.bus``.

Three transports of the same frames (HallAngle, numbered by Sequence): coding alone, the virtual bus in one process,
UDP multicast between two processes on this machine; then a measurement of the virtual bench with its parts timed.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

import can
import numpy as np

from scenarios.bench.buses import Interface
from scenarios.bench.faults import Bus, FaultyBus, Opener
from scenarios.bench.hall_node import HallNode
from scenarios.bench.hidden import hidden_encoder
from scenarios.bench.measure import Measurement, journal_of, measure
from scenarios.bench.messages import SEQUENCES, messages
from scenarios.bench.plan import Plan
from scenarios.bench.virtual import Setup, running
from scenarios.bench.world import World
from scenarios.bench.written import files_of_measurement
from twin.errors import UserError

FRAMES = 20_000
UDP_RATES = (1000, 2000, 4000, 8000, 16000)
UDP_SECONDS = 3.0
PORT = 43219
CAN_500K_FRAMES = 500_000 / 135
"""A classic frame of 8 bytes has up to 135 bits on the wire with stuffing and interframe space (ISO 11898-1)."""


def frame(number: int) -> can.Message:
    """The numbered frame."""
    values = {"Sequence": number % SEQUENCES, "Angle": 0.0, "Bits": 14, "Corrected": 0, "SpiFault": 0}
    return messages().encode("HallAngle", values, number)


def receive(bus: Bus, count: int, quiet_s: float = 1.0) -> tuple[int, float]:
    """Frames that arrived sound and in their order, up to ``count`` or until it is quiet; the seconds they took."""
    good, expected, start, last = 0, 0, 0.0, 0.0
    while good < count:
        message = bus.recv(quiet_s if good else 10.0)
        if message is None:
            break
        decoded = messages().decode(message)
        assert decoded is not None
        last = time.perf_counter()
        start = start or last
        if decoded.sound and decoded.values["Sequence"] >= expected % SEQUENCES:
            good += 1
            expected = int(decoded.values["Sequence"]) + 1
    return good, last - start


def each_us(action: Callable[[], object], repeats: int = 2000) -> float:
    """Time of one call [us]."""
    start = time.perf_counter()
    for _ in range(repeats):
        action()
    return (time.perf_counter() - start) / repeats * 1e6


def virtual(listeners: int) -> tuple[int, float]:
    """Frames received and frames a second, one sender and one decoding receiver, others that only hold the frames."""
    open_bus = Interface().opener()
    sender, receiver, *others = [open_bus() for _ in range(2 + listeners)]
    numbered = [frame(number) for number in range(FRAMES)]

    def send() -> None:
        for message in numbered:
            sender.send(message)

    thread = threading.Thread(target=send)
    thread.start()
    good, seconds = receive(receiver, FRAMES)
    thread.join()
    for bus in (sender, receiver, *others):
        bus.shutdown()
    return good, good / seconds


def send_paced(rate: int) -> None:
    """The other process: frames at a rate, in bursts of a millisecond."""
    bus = udp()()
    count = int(rate * UDP_SECONDS)
    numbered = [frame(number) for number in range(count)]
    start = time.perf_counter()
    for number, message in enumerate(numbered):
        if number % max(rate // 1000, 1) == 0:
            time.sleep(max(start + number / rate - time.perf_counter(), 0.0))
        bus.send(message)
    print(f"{count / (time.perf_counter() - start):.0f}")
    bus.shutdown()


def udp() -> Opener:
    """Multicast that stays on this machine."""
    return Interface("udp_multicast", options={"port": PORT}).opener()


def udp_at(rate: int) -> tuple[int, int, float]:
    """Frames sent, frames received, and the rate that the sender really had."""
    bus = udp()()
    command = [sys.executable, "-m", "tests.benchmarks.bus", str(rate)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as sender:
        good, _ = receive(bus, int(rate * UDP_SECONDS))
        assert sender.stdout is not None
        achieved = float(sender.stdout.read())
    bus.shutdown()
    return int(rate * UDP_SECONDS), good, achieved


def whole_bench() -> tuple[int, int, float]:
    """Readings, frames and seconds of one circle there and back."""
    open_bus, plan = Interface().opener(), Plan(points=360, both_directions=True)
    with tempfile.TemporaryDirectory() as folder, running(Setup(chain=hidden_encoder(None, ())), open_bus):
        output = Path(folder) / "sweep.csv"
        job = Measurement(plan=plan, output=output, files=files_of_measurement(output))
        journal = journal_of(job, restart=True)
        start = time.perf_counter()
        found = measure(job, journal, open_bus)
        seconds = time.perf_counter() - start
    assert set(found.counts) == {"frames"}
    return len(found.pretreated.kept), found.counts["frames"], seconds


def hall_us() -> float:
    """Time of one reading of the virtual Hall encoder [us]."""
    bus = FaultyBus(Interface().opener(), (), np.random.default_rng(0))
    node = HallNode(bus, World(), hidden_encoder(None, ()), (0,))
    sync = messages().decode(
        messages().encode("Sync", {"Sequence": 1, "Index": 0, "Turn": 0, "Backwards": 0, "Speed": 0.0})
    )
    assert sync is not None
    taken = each_us(lambda: node.handlers()["Sync"](sync), 300)
    bus.shutdown()
    return taken


def main() -> None:
    """Print the figures."""
    message = frame(1)
    encode, decode = each_us(lambda: frame(1)), each_us(lambda: messages().decode(message))
    print(f"encode {encode:.0f} us, decode {decode:.0f} us a frame")
    for listeners in (0, 3):
        good, rate = virtual(listeners)
        print(f"virtual, {2 + listeners} participants: {good} of {FRAMES} frames received, {rate:.0f} frames/s")
    try:
        for rate in UDP_RATES:
            sent, good, achieved = udp_at(rate)
            print(f"udp_multicast, two processes, {achieved:.0f} frames/s: {sent - good} of {sent} lost")
    except UserError as error:
        print(f"udp_multicast: {error}")
    readings, frames, seconds = whole_bench()
    print(
        f"bench, a circle there and back: {readings} readings, {frames} frames in {seconds:.2f} s, "
        f"{frames / seconds:.0f} frames/s, none lost; {seconds / readings * 1e3:.2f} ms a reading, "
        f"of which the Hall encoder's twin and its two frames {hall_us() / 1e3:.2f} ms"
    )
    print(f"a real bus of 500 kbit/s carries at most {CAN_500K_FRAMES:.0f} such frames/s")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        send_paced(int(sys.argv[1]))
    else:
        main()
