"""The hardware behind a chain apart from its magnet: concentrator and Hall plates, with typical figures as defaults."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from twin.concentrator.disk import Disk
from twin.hall.spinning_current import Plate
from twin.limits import OutOfRangeError, require_within
from twin.magnet.stray_field import FIELD_MT
from twin.shown import shown
from twin.tables import from_table, to_table


@dataclass(frozen=True, kw_only=True)
class Parts:
    """The nominal field at the sensor [mT] where no magnet is described, the concentrator and the Hall plates.

    The chain's own figures (offset, gain, saturation, ...) stay those of its effects; these set the scale.
    """

    field_mT: float = FIELD_MT
    disk: Disk = field(default_factory=Disk)
    plate: Plate = field(default_factory=Plate)

    def __post_init__(self) -> None:
        require_within("field_mT", self.field_mT, 1e-3, 1e4, "mT")


def parts_from(content: Any) -> Parts:
    """The parts of a twin file's [hardware] table, with [hardware.disk] and [hardware.plate].

    Raises OutOfRangeError for an unknown name or a number out of range.
    """
    if not isinstance(content, Mapping):
        raise OutOfRangeError(f"hardware is {shown(content)}; expected a table")
    kinds: dict[str, type[Disk] | type[Plate]] = {"disk": Disk, "plate": Plate}
    values = {
        key: from_table(kinds[key], value, f"hardware.{key}") if key in kinds else value
        for key, value in content.items()
    }
    return from_table(Parts, values, "hardware")


def parts_table(parts: Parts) -> dict[str, Any]:
    """The [hardware] table of a twin file: what differs from the defaults."""
    tables = {"disk": to_table(parts.disk), "plate": to_table(parts.plate)}
    own = {} if parts.field_mT == FIELD_MT else {"field_mT": parts.field_mT}
    return {**own, **{key: table for key, table in tables.items() if table}}
