"""Simulate each preset and explain it, with many seeds: ``python -m tests.hardware_causes.presets``.

A name is false where neither it nor anything it cannot be told from is held by the preset; a cause is missed where it
stands clear of the noise on this protocol and no name stands for it.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from rich.console import Console
from rich.table import Table

from diagnosis import explain
from scenarios.commands.protocol import Protocol
from twin.catalogue import base_name, find
from twin.chain import Chain
from twin.presets import preset_names, read_preset

PROTOCOLS = {"turn": Protocol(), "both": Protocol(turns=2, both_directions=True)}
CLEAR: dict[str, tuple[frozenset[str], frozenset[str], frozenset[str]]] = {
    "imc-14bit": (frozenset({"saturation"}), frozenset({"hysteresis"}), frozenset({"magnet_misalignment"})),
    "paper-encoder": (frozenset(), frozenset({"hysteresis"}), frozenset()),
    "hall-misaligned": (frozenset(), frozenset(), frozenset({"magnet_misalignment"})),
    "hall-12bit": (frozenset(), frozenset(), frozenset()),
}
"""What stands clear of the noise: in any record, in one of both directions, in one with vx and vy."""


@dataclass(frozen=True)
class Answer:
    """The classes named for one simulated sweep, each by its name first."""

    named: tuple[tuple[str, ...], ...]

    def false(self, held: frozenset[str]) -> bool:
        """Whether a class holds nothing that the preset does."""
        return any(not held & set(one) for one in self.named)

    def missed(self, clear: frozenset[str]) -> frozenset[str]:
        """Causes that no class stands for."""
        return clear - {name for one in self.named for name in one}


def held(chain: Chain) -> frozenset[str]:
    """Names of what the preset has beyond the error model: its effects, a disk that saturates, a misplaced magnet."""
    names = {base_name(key) for key in chain.values if not find(key, chain.effects).baseline}
    if chain.parts.disk is not None and not chain.parts.disk.ideal:
        names.add("saturation")
    if chain.magnet is not None:
        names.add("magnet_misalignment")
    return frozenset(names)


def clear(name: str, protocol: str, *, channels: bool) -> frozenset[str]:
    """What stands clear of the noise of this preset in such a record."""
    always, both_ways, with_channels = CLEAR[name]
    return always | (both_ways if protocol == "both" else frozenset()) | (with_channels if channels else frozenset())


def asked(chain: Chain, protocol: str, seed: int, *, channels: bool) -> Answer:
    """What is named for one simulated sweep."""
    motion = replace(PROTOCOLS[protocol], channels=channels).motion()
    causes = explain(chain.simulate(motion, seed=seed)).to_dict()["causes"]
    return Answer(tuple((one["name"], *sorted(one["indistinguishable_from"])) for one in causes))


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line as each preset is done, and the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.hardware_causes.presets", description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--protocol", choices=list(PROTOCOLS), default="both")
    parser.add_argument("--only", choices=preset_names(), action="append")
    given = parser.parse_args(arguments)
    console = Console(width=130, highlight=False)
    table = Table("preset", "vx, vy", "a false name", "one missed", "named")
    for name in given.only or preset_names():
        chain = read_preset(name)
        for channels in (True, False):
            wanted = clear(name, given.protocol, channels=channels)
            seeds = range(given.first, given.first + given.seeds)
            answers = [asked(chain, given.protocol, seed, channels=channels) for seed in seeds]
            counts = Counter(" or ".join(one) for answer in answers for one in answer.named)
            table.add_row(
                name,
                "yes" if channels else "no",
                f"{sum(one.false(held(chain)) for one in answers)} of {len(answers)}",
                f"{sum(bool(one.missed(wanted)) for one in answers)} of {len(answers)}",
                "; ".join(f"{said} {count}" for said, count in counts.most_common()) or "nothing",
            )
            console.print(f"{name}, {'with' if channels else 'without'} channels: {len(answers)} done")
    console.print(table)


if __name__ == "__main__":
    main()
