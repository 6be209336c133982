"""What is known of a sensor before its sweeps are diagnosed: its twin, its output's sense, its magnet, its air gaps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from scenarios.commands.protocol import numbers
from twin.errors import UserError
from twin.shown import shown

if TYPE_CHECKING:
    from diagnosis import Mounting
    from twin.chain import Chain
    from twin.magnet.magnet import Magnet


@dataclass(frozen=True, kw_only=True)
class Known:
    """As the command line has it; None where it says nothing."""

    twin: str | None = None
    output_sense: int | None = None
    magnet: str | None = None
    air_gap: str | None = None
    air_gap_error_mm: float | None = None
    turned: str | None = None

    def arguments(self) -> dict[str, Any]:
        """The arguments of :func:`diagnosis.diagnose_many`. Raises UserError for what cannot be meant."""
        from twin.presets import read_twin_or_preset

        twin = None if self.twin is None else read_twin_or_preset(self.twin)
        return {"twin": twin, "output_sense": self.output_sense, "mounting": self._mounting(twin)}

    def mounting(self) -> Mounting | None:
        """The magnet, air gaps and turns of the sensor that are given; None: none is.

        Raises UserError for what cannot be meant.
        """
        return None if self.magnet is None and self.air_gap is None and self.turned is None else self._mounting(None)

    def _mounting(self, twin: Chain | None) -> Mounting:
        """The magnet and the air gaps: those given, else the twin's, else assumed ones."""
        from diagnosis import Mounting
        from diagnosis.factors.mounting import GAP_ERROR_MM

        given = Mounting.unstated() if twin is None or twin.magnet is None else Mounting.of(twin.magnet)
        if self.magnet is not None:
            given = Mounting.unstated(magnet_of(self.magnet))
        if self.air_gap is not None:
            given = replace(given, air_gap_mm=tuple(numbers("air_gap", self.air_gap)), gap_error_mm=GAP_ERROR_MM)
        if self.turned is not None:
            turned_deg = tuple(numbers("mounting", self.turned))
            if not turned_deg:
                raise UserError(f"mounting is {shown(self.turned)}; expected the sensor's turn in each, e.g. 0,90")
            given = replace(given, turned_deg=turned_deg)
        return given if self.air_gap_error_mm is None else replace(given, gap_error_mm=self.air_gap_error_mm)


def magnet_of(text: str) -> Magnet:
    """The magnet of a text such as ``shape=ring,diameter_mm=10,bore_mm=4,height_mm=3``. Raises UserError."""
    from twin.magnet.magnet import Magnet
    from twin.tables import from_table

    table: dict[str, Any] = {}
    for part in filter(None, (one.strip() for one in text.split(","))):
        name, equals, value = (one.strip() for one in part.partition("="))
        if not equals or not name or not value:
            raise UserError(f"magnet has {part!r}; expected NAME=VALUE with commas between, e.g. diameter_mm=6")
        try:
            table[name] = float(value)
        except ValueError:
            table[name] = value
    if not table:
        raise UserError(f"magnet is {text!r}; expected NAME=VALUE with commas between, e.g. diameter_mm=6")
    return from_table(Magnet, table, "magnet")
