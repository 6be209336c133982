"""What the options of the bench ask of a spin, and which of them are of a sweep with a reference."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from twin.errors import UserError
from twin.known_names import nearest
from twin.shown import shown

if TYPE_CHECKING:
    from scenarios.bench.faults import Fault

COAST, STEADY = "coast", "steady"
_HOW = (COAST, STEADY)


def check_spin(how: str | None, figures: Mapping[str, float | None]) -> None:
    """What is asked of a spin, by the names of its options. Raises UserError for figures of a spin without one."""
    if how is None:
        for name, given in figures.items():
            if given is not None:
                raise UserError(f"{name} is of a spin; add --spin coast or --spin steady, or leave it out")
    elif how not in _HOW:
        raise UserError(f"--spin {shown(how)}: unknown{nearest(how, _HOW)}; expected coast or steady")


def refuse_sweeps(asked: Mapping[str, bool]) -> None:
    """Raise UserError for the first of these options that was given: a spin has no reference."""
    for name, given in asked.items():
        if given:
            raise UserError(f"{name} is of a sweep with a reference, and --spin has none; leave one of them out")


def refuse_reference(faults: Sequence[Fault]) -> None:
    """Raise UserError for a fault that is asked of the reference alone, and not of all nodes."""
    for fault in faults:
        alone = sum(one.kind == fault.kind for one in faults) == 1
        if fault.node == "reference" and alone:
            raise UserError(f"--fault {fault.kind}:reference: no reference is on the bus of a spin; leave it out")
