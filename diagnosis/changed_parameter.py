"""One parameter of a given twin that has moved, as :func:`diagnosis.explain` answers it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class ChangedParameter:
    """A parameter of the given twin that stands elsewhere in the sweep. Figures are those of the answer.

    Attributes
    ----------
    parameter : str
        Effect and parameter, as a twin file names them, such as ``"offset.x_percent"``.
    owner : str
        Whose it is: ``"device"``, ``"mounting"`` or ``"bench"``.
    was, value : float
        Its value in the twin, and in this sweep.
    low, high : float
        Ends of the 95 % interval of the latter; infinite where the sweep sets none.
    unit : str
        Unit of the four, ``"1"`` for a pure number.
    false_alarm_probability : float
        Probability that chance alone moves any parameter as far.
    heldout_rms_deg_before, heldout_rms_deg_after : float
        RMS error [deg] without and with the change, on readings that no fit has seen; NaN where none was held out.
    indistinguishable_from : tuple of str
        Other parameters, or causes that the twin lacks, that would do as well.
    """

    parameter: str
    owner: str
    was: float
    value: float
    low: float
    high: float
    unit: str
    false_alarm_probability: float
    heldout_rms_deg_before: float
    heldout_rms_deg_after: float
    indistinguishable_from: tuple[str, ...]

    @classmethod
    def of(cls, entry: Mapping[str, Any]) -> ChangedParameter:
        """The change that an entry of ``changed`` in the JSON answer describes."""
        return cls(
            parameter=entry["parameter"],
            owner=entry["owner"],
            was=float(entry["was"]),
            value=number_or(entry["is"], float("nan")),
            low=number_or(entry["low"], float("-inf")),
            high=number_or(entry["high"], float("inf")),
            unit=entry["unit"],
            false_alarm_probability=number_or(entry["p"], float("nan")),
            heldout_rms_deg_before=number_or(entry["heldout_rms_deg_before"], float("nan")),
            heldout_rms_deg_after=number_or(entry["heldout_rms_deg_after"], float("nan")),
            indistinguishable_from=tuple(entry["indistinguishable_from"]),
        )


def number_or(value: float | None, where_none: float = float("nan")) -> float:
    """A figure of the JSON answer, in which there is no infinity and no NaN."""
    return where_none if value is None else float(value)
