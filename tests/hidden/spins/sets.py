"""What a study of spins draws."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from ..streams import derived_seed
from .benches import PROTOCOLS
from .frames import UNSEEN
from .generator import Drawn, draw

NAMED = (
    "saturation",
    "clipping",
    "adc_stuck_bit",
    "cordic_truncation",
    "output_quantisation",
    "stale_frames",
    "xy_skew",
    "mains_pickup",
    "reference_ripple",
    "multipole",
    "error_code",
    "magnet_harmonic",
    "bus_glitch",
    "reference_jitter",
)
"""Causes that are asked to be named without a reference."""
ON = {"latency": ("several_speeds", "both_ways"), "xy_skew": ("coast", "several_speeds")}
"""Protocols that show a cause, where not all of the usual ones do."""
USUAL = ("coast", "two_speeds", "several_speeds")
CLEAN = ("coast", "two_speeds", "one_speed", "several_speeds", "two_logs", "both_ways")


@dataclass(frozen=True)
class Job:
    """One draw, as it can be made again."""

    group: str
    label: str
    protocol: str
    seed: int
    causes: tuple[str, ...] | None = None
    usb: bool = False

    @property
    def key(self) -> str:
        """What a study knows it by."""
        return f"{self.group}/{self.label}/{self.protocol}/{self.seed}"

    def draw(self) -> Drawn:
        """Make it."""
        return draw(self.protocol, seed=self.seed, causes=self.causes, usb=self.usb)

    def record(self) -> dict[str, object]:
        """For a JSON file."""
        return asdict(self)


def of_protocols(protocols: tuple[str, ...], *, draws: int, seed: int, usb: bool = False) -> list[Job]:
    """Sensors with orders of their own on hard benches: how good a correction becomes."""
    for protocol in protocols:
        if protocol not in PROTOCOLS:
            raise ValueError(f"protocol must be one of {', '.join(PROTOCOLS)}; instead received {protocol!r}")
    group = "accuracy_usb" if usb else "accuracy"
    return [
        Job(group, protocol, protocol, derived_seed(seed, group, protocol, str(number)), usb=usb)
        for number in range(draws)
        for protocol in protocols
    ]


def of_causes(*, draws: int, seed: int, only: frozenset[str] = frozenset()) -> list[Job]:
    """One cause at a time on a mild bench: is it named?"""
    return [
        Job(
            "causes",
            name,
            _in_turn(ON.get(name, USUAL), number),
            derived_seed(seed, "causes", name, str(number)),
            (name,),
        )
        for number in range(draws)
        for name in (*NAMED, *UNSEEN)
        if not only or name in only
    ]


def clean(*, draws: int, seed: int) -> list[Job]:
    """Nothing but the paper's error model on a mild bench: is anything named?"""
    return [
        Job("clean", "clean", _in_turn(CLEAN, number), derived_seed(seed, "clean", str(number)), ())
        for number in range(draws)
    ]


def _in_turn(protocols: tuple[str, ...], number: int) -> str:
    return protocols[number % len(protocols)]
