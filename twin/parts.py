"""The hardware behind a chain apart from its magnet, as described: what is not described is an ideal part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np

from twin.concentrator import disk as disk_stage
from twin.concentrator.disk import Disk
from twin.effect import Effect
from twin.hall import plates as plate_stage
from twin.hall.spinning_current import Plate
from twin.limits import OutOfRangeError, require_within
from twin.magnet.stray_field import FIELD_MT
from twin.part import in_mirror
from twin.shown import shown
from twin.tables import UNLISTED, from_table, to_table

_IDEAL = Plate()


@dataclass(frozen=True, kw_only=True)
class Parts:
    """The nominal field at the sensor where no magnet is described, the concentrator and the Hall plates.

    Attributes
    ----------
    field_mT : float
        [mT]; not asked where the chain has a magnet.
    disk : Disk or None
        The concentrator; None: its channels are the field's components.
    plate, plate_y : Plate or None
        The Hall plates of x and of y; ``plate_y`` None: like that of x.
    mirrored : bool
        Whether the parts are seen in a mirror along x: those of a chain that counts the other way on both sides. The
        program writes it, nobody has such parts.
    """

    field_mT: float = FIELD_MT
    disk: Disk | None = None
    plate: Plate | None = None
    plate_y: Plate | None = None
    mirrored: bool = field(default=False, metadata=UNLISTED)

    def __post_init__(self) -> None:
        require_within("field_mT", self.field_mT, 1e-3, 1e4, "mT")
        if self.plate is None and self.plate_y is not None:
            raise OutOfRangeError("plate_y is described and plate is not; describe plate, the plate of x, too")

    @property
    def gain(self) -> float:
        """Vertical field at the plates over the field in the plane: 1 where there is no disk."""
        return 1.0 if self.disk is None else self.disk.gain

    @property
    def plates(self) -> tuple[Plate, Plate]:
        """Of x and y; ideal where none is described."""
        plate = self.plate or _IDEAL
        return plate, self.plate_y or plate

    @property
    def ideal(self) -> bool:
        """Whether they change no signal."""
        disk = self.disk is None or self.disk.ideal
        return disk and (self.plate is None or all(plate.ideal for plate in self.plates))

    def acting(self, nominal_mT: Any) -> tuple[Effect, ...]:
        """The parts that are not ideal as operations on channels whose amplitude 1 stands for this in-plane field [mT].

        ``nominal_mT`` may hold one number for each design (designs,).
        """
        if self.ideal:
            return ()
        return _acting_at(self, float(nominal_mT)) if np.ndim(nominal_mT) == 0 else _acting(self, nominal_mT)

    def only(self, name: str) -> Parts:
        """The parts with all but ``disk`` or ``plates`` ideal; the scale stays."""
        if name == "disk":
            return replace(self, plate=None, plate_y=None)
        return replace(self, disk=Disk(gain=self.gain))

    def in_mirror(self) -> Parts:
        """The parts of the chain that counts the other way on both sides and reads the same."""
        return self if self.ideal else replace(self, mirrored=not self.mirrored)


def _acting(parts: Parts, nominal_mT: Any) -> tuple[Effect, ...]:
    found = []
    if parts.disk is not None and not parts.disk.ideal:
        found.append(disk_stage.described(parts.disk, nominal_mT))
    if not all(plate.ideal for plate in parts.plates):
        found.append(plate_stage.described(parts.plates, parts.gain * np.asarray(nominal_mT)))
    return tuple(in_mirror(one) if parts.mirrored else one for one in found)


_acting_at = lru_cache(maxsize=64)(_acting)


def parts_from(content: Any) -> Parts:
    """The parts of a twin file's [hardware] table, with [hardware.disk], [hardware.plate] and [hardware.plate_y].

    Raises OutOfRangeError for an unknown name or a number out of range.
    """
    if not isinstance(content, Mapping):
        raise OutOfRangeError(f"hardware is {shown(content)}; expected a table")
    kinds: dict[str, type[Disk] | type[Plate]] = {"disk": Disk, "plate": Plate, "plate_y": Plate}
    described: dict[str, Any] = {
        key: from_table(kind, content[key], f"hardware.{key}") for key, kind in kinds.items() if key in content
    }
    plain = {key: value for key, value in content.items() if key not in kinds}
    return replace(from_table(Parts, plain, "hardware"), **described)


def parts_table(parts: Parts) -> dict[str, Any]:
    """The [hardware] table of a twin file: what differs from the defaults, and every part that is described."""
    described = {key: getattr(parts, key) for key in ("disk", "plate", "plate_y")}
    plain = to_table(replace(parts, disk=None, plate=None, plate_y=None))
    return {**plain, **{key: to_table(part) for key, part in described.items() if part is not None}}
