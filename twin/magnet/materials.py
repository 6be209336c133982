"""Permanent magnet grades: remanence at 20 C and its reversible temperature coefficient, with where they come from."""

from __future__ import annotations

from dataclasses import dataclass

from twin.known_names import nearest
from twin.limits import OutOfRangeError
from twin.shown import shown

REFERENCE_C = 20.0
"""Temperature at which data sheets state the remanence [C]."""

_ARNOLD = "Arnold Magnetic Technologies, Neodymium Iron Boron Magnet Catalog, grades table (typical Br)"
_TYPICAL = "typical assumption for its family, not taken from a data sheet: give remanence_T where yours is known"


@dataclass(frozen=True, kw_only=True)
class Grade:
    """Remanence [T] at 20 C, its temperature coefficient [%/K], and the source of both."""

    remanence_T: float
    percent_per_K: float
    source: str


GRADES: dict[str, Grade] = {
    "N35": Grade(remanence_T=1.210, percent_per_K=-0.12, source=_ARNOLD),
    "N35H": Grade(remanence_T=1.210, percent_per_K=-0.12, source=_ARNOLD),
    "N42": Grade(remanence_T=1.315, percent_per_K=-0.12, source=_ARNOLD),
    "N52": Grade(remanence_T=1.450, percent_per_K=-0.12, source=_ARNOLD),
    "Sm2Co17": Grade(remanence_T=1.02, percent_per_K=-0.03, source=_TYPICAL),
    "SmCo5": Grade(remanence_T=0.95, percent_per_K=-0.042, source=_TYPICAL),
    "ferrite": Grade(remanence_T=0.38, percent_per_K=-0.2, source=_TYPICAL),
}


def grade(name: str) -> Grade:
    """The grade with this name. Raises OutOfRangeError with the known names."""
    try:
        return GRADES[name]
    except KeyError:
        raise OutOfRangeError(
            f"grade is {shown(name)}{nearest(name, GRADES)}; expected one of {', '.join(GRADES)}"
        ) from None
