"""The virtual bench: its nodes, each a task on the bus, around one shaft."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from scenarios.bench.faults import Fault, FaultyBus, Opener
from scenarios.bench.hall_node import HallNode, check_playable
from scenarios.bench.node import POLL_S, Node
from scenarios.bench.nodes import ChamberNode, ReferenceNode, StepperNode
from scenarios.bench.stepper import Stepper
from scenarios.bench.world import World
from twin.chain import Chain
from twin.reference.encoder import Encoder

HIGH_PRECISION = Encoder(lines=5000, interpolation=50, index_deg=0.0)
"""The paper's high-precision reference: 10^6 counts a turn, a typical assumption."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Setup:
    """What stands on the virtual bench, with a ``reference`` or without.

    ``seed`` is of everything random; a continued run adds where it starts.
    """

    chain: Chain
    drive: Stepper = field(default_factory=Stepper)
    encoder: Encoder = HIGH_PRECISION
    faults: Sequence[Fault] = ()
    seed: tuple[int, ...] = (0,)
    real_time: bool = False
    reference: bool = True


@contextmanager
def running(setup: Setup, open_bus: Opener) -> Iterator[dict[str, Counter[str]]]:
    """Run the nodes; yields the faults done so far, by node. Raises what a node failed with."""
    check_playable(setup.chain)
    done: dict[str, Counter[str]] = {}

    def bus(name: str) -> FaultyBus:
        rng = np.random.default_rng((*setup.seed, 3, *name.encode()))
        made = FaultyBus(open_bus, [fault for fault in setup.faults if fault.node == name], rng)
        done[name] = made.done
        return made

    world = World(real_time=setup.real_time)
    spi = sum(fault.value for fault in setup.faults if fault.kind == "spi")
    nodes: list[Node] = [
        StepperNode(bus("stepper"), world, setup.drive),
        HallNode(bus("hall"), world, setup.chain, setup.seed, spi_faults=spi),
        ChamberNode(bus("chamber"), world),
    ]
    if setup.reference:
        nodes.append(ReferenceNode(bus("reference"), world, setup.chain, setup.encoder, setup.seed))
    for node in nodes:
        node.start()
    try:
        yield done
    finally:
        for node in nodes:
            node.stop()
        for node in nodes:
            node.join(timeout=20.0 * POLL_S)
        # Instead of the silence that a node's own mistake led to.
        for node in nodes:
            if node.failure is not None:
                raise node.failure
