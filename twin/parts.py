"""The hardware behind a chain apart from its magnet, as described: what is not described is an ideal part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np

from twin.adc import sampled as converter_stage
from twin.adc.converter import Converter
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
    """The nominal field at the sensor where no magnet is described, the concentrator, the Hall plates, the converter.

    Attributes
    ----------
    field_mT : float
        [mT]; not asked where the chain has a magnet.
    disk : Disk or None
        The concentrator; None: its channels are the field's components.
    converter : Converter or None
        The converter; None: as the effects of its stage describe it. Its range is in nominal amplitudes.
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
    converter: Converter | None = None
    mirrored: bool = field(default=False, metadata=UNLISTED)

    def __post_init__(self) -> None:
        require_within("field_mT", self.field_mT, 1e-3, 1e4, "mT")
        if self.plate is None and self.plate_y is not None:
            raise OutOfRangeError("plate_y is described and plate is not; describe plate, the plate of x, too")
        if self.converter is not None and self.converter.stuck_bit is not None:
            raise OutOfRangeError("converter has a stuck_bit; give it as [effects.adc_stuck_bit], with its weight")

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
        plates = self.plate is None or all(plate.ideal for plate in self.plates)
        return disk and plates and self.converter is None

    def acting(self, nominal_mT: Any) -> tuple[Effect, ...]:
        """The parts that are not ideal as operations on channels whose amplitude 1 stands for this in-plane field [mT].

        ``nominal_mT`` may hold one number for each design (designs,).
        """
        if self.ideal:
            return ()
        return _acting_at(self, float(nominal_mT)) if np.ndim(nominal_mT) == 0 else _acting(self, nominal_mT)

    def only(self, name: str) -> Parts:
        """The parts with all but one ideal, by the name of its operation; the scale stays."""
        return replace(
            self,
            disk=self.disk if name == "disk" else Disk(gain=self.gain),
            plate=self.plate if name == "plates" else None,
            plate_y=self.plate_y if name == "plates" else None,
            converter=self.converter if name in ("sampling", "converter") else None,
        )

    def without(self, name: str) -> Parts:
        """The parts with one of them ideal, by the name of its operation; the scale stays."""
        plates, converter = name == "plates", name in ("sampling", "converter")
        return replace(
            self,
            disk=Disk(gain=self.gain) if name == "disk" else self.disk,
            plate=None if plates else self.plate,
            plate_y=None if plates else self.plate_y,
            converter=None if converter else self.converter,
        )

    def in_mirror(self) -> Parts:
        """The parts of the chain that counts the other way on both sides and reads the same."""
        return self if self.ideal else replace(self, mirrored=not self.mirrored)


def _acting(parts: Parts, nominal_mT: Any) -> tuple[Effect, ...]:
    found = []
    if parts.disk is not None and not parts.disk.ideal:
        found.append(disk_stage.described(parts.disk, nominal_mT))
    if not all(plate.ideal for plate in parts.plates):
        found.append(plate_stage.described(parts.plates, parts.gain * np.asarray(nominal_mT)))
    if parts.converter is not None:
        found += converter_stage.described(parts.converter)
    return tuple(in_mirror(one) if parts.mirrored else one for one in found)


_acting_at = lru_cache(maxsize=64)(_acting)


def parts_from(content: Any) -> Parts:
    """The parts of a twin file's [hardware] table, with those of disk, plate, plate_y and converter in it.

    Raises OutOfRangeError for an unknown name or a number out of range.
    """
    if not isinstance(content, Mapping):
        raise OutOfRangeError(f"hardware is {shown(content)}; expected a table")
    kinds: dict[str, type[Any]] = {"disk": Disk, "plate": Plate, "plate_y": Plate, "converter": Converter}
    described: dict[str, Any] = {
        key: from_table(kind, content[key], f"hardware.{key}") for key, kind in kinds.items() if key in content
    }
    plain = {key: value for key, value in content.items() if key not in kinds}
    return replace(from_table(Parts, plain, "hardware"), **described)


def parts_table(parts: Parts) -> dict[str, Any]:
    """The [hardware] table of a twin file: what differs from the defaults, and every part that is described."""
    described = {key: getattr(parts, key) for key in ("disk", "plate", "plate_y", "converter")}
    plain = to_table(replace(parts, disk=None, plate=None, plate_y=None, converter=None))
    return {**plain, **{key: to_table(part) for key, part in described.items() if part is not None}}
