"""Buses of python-can by name: the virtual one in this process, or any other that python-can knows."""

from __future__ import annotations

import uuid
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

from scenarios.bench.faults import Bus, Fault, FaultyBus, Opener
from scenarios.commands.once import check_once
from twin.errors import UserError
from twin.shown import shown

_OWN_DEFAULTS: dict[str, dict[str, Any]] = {
    # Not past this machine, unless the user says so: a bench in one process and its sequence in another.
    "udp_multicast": {"channel": "239.74.163.2", "hop_limit": 0, "fd": False},
}


@dataclass(frozen=True)
class Interface:
    """Interface, channel and further options as python-can names them."""

    name: str = "virtual"
    channel: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)

    def opener(self) -> Opener:
        """A function that opens a bus; each call is another participant. Raises UserError when it cannot."""
        options = {**_OWN_DEFAULTS.get(self.name, {}), **self.options}
        if self.channel is not None:
            options["channel"] = self.channel
        elif self.name == "virtual":
            # A channel of its own, so that two benches in one process do not hear one another. Its name ends with no
            # digits: log formats take those for the channel's number, and have 16 bits for it.
            options["channel"] = f"halltwin-{uuid.uuid4().hex}-bus"
        return lambda: _opened(self.name, options)


def parse_options(pairs: Sequence[str]) -> dict[str, Any]:
    """KEY=VALUE pairs; numbers and true/false become such. Raises UserError."""
    found: dict[str, Any] = {}
    for pair in pairs:
        key, sign, value = pair.partition("=")
        if not sign or not key:
            raise UserError(f"bus option {shown(pair)}: expected KEY=VALUE, e.g. bitrate=500000")
        check_once("--bus-option", [*found, key])
        found[key] = _plain(value)
    return found


def with_bench_faults(open_bus: Opener, faults: Sequence[Fault], seed: int) -> Opener:
    """The bench's own bus, with the faults that are the bench's."""
    own = [fault for fault in faults if fault.node == "bench"]
    if not own:
        return open_bus
    import numpy as np

    return lambda: FaultyBus(open_bus, own, np.random.default_rng((seed, 4)))


def _opened(name: str, options: Mapping[str, Any]) -> Bus:
    import can

    try:
        return cast(Bus, can.Bus(interface=name, **options))
    # The interfaces raise what their drivers raise: ImportError, OSError, ValueError, TypeError and python-can's own.
    except Exception as error:
        said = " ".join(str(error).split()) or type(error).__name__
        raise UserError(f"CAN interface {name} ({_shown(options)}): cannot be opened: {said}") from None


def _shown(options: Mapping[str, Any]) -> str:
    return ", ".join(f"{key}={value}" for key, value in options.items()) or "no options"


def _plain(text: str) -> Any:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (lambda value: int(value, 0), float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
