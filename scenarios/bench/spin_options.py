"""What the options of the bench ask of a spin, and which of them are of a sweep with a reference."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from twin.errors import UserError
from twin.known_names import nearest
from twin.shown import shown

if TYPE_CHECKING:
    from scenarios.bench.command import Options
    from scenarios.bench.faults import Fault
    from scenarios.bench.spin import SpinPlan

COAST, STEADY = "coast", "steady"
_HOW = (COAST, STEADY)


def refuse_without_spin(spin_time_s: float | None, rate_Hz: float | None) -> None:
    """Figures of a spin where there is none. Raises UserError."""
    for name, given in (("--spin-time", spin_time_s), ("--rate", rate_Hz)):
        if given is not None:
            raise UserError(f"{name} is of a spin; add --spin coast or --spin steady, or leave it out")


def check_spin(options: Options, faults: Sequence[Fault]) -> None:
    """Raise UserError for what a spin is not, or has not."""
    from twin.limits import require_within

    if options.spin not in _HOW:
        raise UserError(
            f"--spin {shown(options.spin)}: unknown{nearest(str(options.spin), _HOW)}; expected coast or steady"
        )
    of_sweeps = {
        "--closed-loop": options.closed_loop,
        "--plot": options.plot is not None,
        "--points": options.points != type(options).points,
        "--turns": options.turns != type(options).turns,
        "--temperatures": bool(options.temperatures),
        "--settle": options.settle_s != type(options).settle_s,
        "--restart": options.restart,
    }
    for name, given in of_sweeps.items():
        if given:
            raise UserError(f"{name} is of a sweep with a reference, and --spin has none; leave one of them out")
    for fault in faults:
        if fault.node == "reference" and options.interface == "virtual" and _asked_of_one(fault, faults):
            raise UserError(f"--fault {fault.kind}:reference: no reference is on the bus of a spin; leave it out")
    require_within("timeout", options.timeout_s, 1e-3, 3600.0, "s")
    require_within("attempts", options.attempts, 1, 1e6, whole=True)


def _asked_of_one(fault: Fault, faults: Sequence[Fault]) -> bool:
    """Whether a fault was asked of its node alone, and not of all."""
    return sum(one.kind == fault.kind for one in faults) == 1


def plan_of(options: Options) -> SpinPlan:
    """The plan of a spin. Raises UserError."""
    from scenarios.bench.spin import SpinPlan

    given: dict[str, Any] = {"time_s": options.spin_time_s, "rate_Hz": options.rate_Hz}
    if tuple(options.speeds_rpm) != type(options).speeds_rpm:
        given["speeds_rpm"] = tuple(options.speeds_rpm)
    return SpinPlan(
        coast=options.spin == COAST,
        both_directions=options.both_directions,
        **{name: value for name, value in given.items() if value is not None},
    )
