"""The least non-linear distance of a magnet: where what depends on the field's size errs least.

Near the magnet the concentrator saturates and the quadratic term grows with the field; far from it offset and
hysteresis, which are fields of their own, weigh more against it. Between lies a distance of least error, as the paper's
conclusion has it. What does not depend on the field (gain, phase, converter) and what a displacement does are left out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from scenarios.commands.protocol import Protocol
from scenarios.studies.design.field import cause_errors, errors_deg, followed
from scenarios.studies.design.space import AXES
from scenarios.studies.design.study import POINTS, DesignStudy
from twin.angles import Array, IntArray
from twin.catalogue import find
from twin.chain import Chain

_GAP = list(AXES).index("air_gap_mm")
_BODY = ("diameter_mm", "height_mm", "remanence_T")
_STEPS = 401
_ROUNDING_DEG = 1e-9
_NEAR = 1.1
"""Errors up to this many times the least count as near it."""


@dataclass(frozen=True, eq=False)
class Distance:
    """One magnet over distance: air gaps [mm] (n,), field on the axis [mT] (n,), largest errors over a turn [deg].

    ``error_deg`` (n,) is of all causes together, ``causes_deg`` of each alone.
    """

    grade: str
    body: Mapping[str, float]
    air_gap_mm: Array
    field_mT: Array
    error_deg: Array
    causes_deg: Mapping[str, Array]

    @property
    def name(self) -> str:
        """The magnet in words."""
        own = f", {self.body['remanence_T']:g} T" if "remanence_T" in self.body else ""
        return f"{self.grade} {self.body['diameter_mm']:.3g} x {self.body['height_mm']:.3g} mm{own}"

    @property
    def least(self) -> int:
        """Place of the least error."""
        return int(np.argmin(self.error_deg))

    @property
    def at_end(self) -> Literal["nearest", "farthest"] | None:
        """Which end of the distances the least error stands at: there a distance beyond may be better still."""
        return {0: "nearest", len(self.error_deg) - 1: "farthest"}.get(self.least)  # type: ignore[return-value]

    @property
    def near_mm(self) -> tuple[float, float]:
        """Between these air gaps, about the least, the error is at most a tenth larger."""
        beyond = np.flatnonzero(self.error_deg > _NEAR * self.error_deg[self.least])
        first = np.max(beyond[beyond < self.least], initial=-1) + 1
        last = np.min(beyond[beyond > self.least], initial=len(self.error_deg)) - 1
        return float(self.air_gap_mm[first]), float(self.air_gap_mm[last])

    def to_dict(self) -> dict[str, Any]:
        """The answer as plain values."""
        low, high = self.near_mm
        return {
            "grade": self.grade,
            **self.body,
            "air_gap_mm": float(self.air_gap_mm[self.least]),
            "field_mT": float(self.field_mT[self.least]),
            "error_deg": float(self.error_deg[self.least]),
            "near_mm": [low, high],
            "at_end": self.at_end,
        }

    def words(self) -> str:
        """The answer as a person reads it."""
        low, high = self.near_mm
        found = self.to_dict()
        said = (
            f"{self.name}: {found['air_gap_mm']:.2f} mm ({found['field_mT']:.0f} mT), error {found['error_deg']:.3f} "
            f"deg; at most a tenth more from {low:.2f} to {high:.2f} mm"
        )
        return said if self.at_end is None else f"{said}; the {self.at_end} distance asked, beyond it may be less"


def distances(study: DesignStudy, table: Array, grades: IntArray) -> tuple[Distance, ...]:
    """Each different magnet among these designs (rows of AXES, number of the grade), over the distances of the space.

    Empty where nothing in the twin depends on the field.
    """
    chain = only_with_field(study.chain)
    magnets = dict.fromkeys((int(which), tuple(map(float, row[:3]))) for row, which in zip(table, grades, strict=True))
    found = [_distance(study, chain, which, body) for which, body in magnets]
    return tuple(one for one in found if np.any(one.error_deg > _ROUNDING_DEG))


def only_with_field(chain: Chain) -> Chain:
    """The chain with the effects alone whose parameters follow the field or the distance, and a disk in its place.

    What shift and rough edge of a disk do is the same at every field; its saturation is not.
    """
    disk = chain.parts.disk
    centred = None if disk is None else replace(disk, shift_x_um=0.0, shift_y_um=0.0, roughness_um=0.0)
    chain = replace(chain, parts=replace(chain.parts, disk=centred))
    kept = {key: params for key, params in chain.values.items() if followed(find(key, chain.effects))}
    random = [key for key in kept if find(key, chain.effects).footprint == "spread"]
    return replace(chain, values=kept).without(*random)


def _distance(study: DesignStudy, chain: Chain, which: int, body: Sequence[float]) -> Distance:
    space = study.space
    gaps = _gaps(space.axes["air_gap_mm"])
    rows = np.zeros((gaps.size, len(AXES)))
    rows[:, :3], rows[:, _GAP] = body, gaps
    designs = space.assemble(rows, np.full(gaps.size, float(which)))
    motion = Protocol(points=POINTS, both_directions=True).motion()
    causes = {
        name: np.max(np.abs(error), axis=1) for name, error in cause_errors(chain, designs, motion) if name != "field"
    }
    names = _BODY if body[2] > 0.0 else _BODY[:2]
    return Distance(
        grade=space.grades[which],
        body=dict(zip(names, body, strict=False)),
        air_gap_mm=gaps,
        field_mT=np.asarray(designs.nominal_mT),
        error_deg=np.max(np.abs(errors_deg(chain, designs, motion)), axis=1),
        causes_deg={name: error for name, error in causes.items() if np.any(error > _ROUNDING_DEG)},
    )


def _gaps(asked: Sequence[float]) -> Array:
    """Air gaps from the smallest to the largest asked; about a single one from half of it to twice as much."""
    low, high = min(asked), max(asked)
    low, high = (0.5 * low, 2.0 * high) if low == high else (low, high)
    return np.linspace(low, high, _STEPS)


def distance_csv(found: Sequence[Distance]) -> str:
    """All magnets over distance as CSV, one row a magnet and distance."""
    names = list(dict.fromkeys(name for one in found for name in one.causes_deg))
    lines = [",".join(["magnet", "air_gap_mm", "field_mT", "error_deg", *(f"error_deg.{name}" for name in names)])]
    for one in found:
        nothing = np.zeros(one.air_gap_mm.size)
        columns = [one.air_gap_mm, one.field_mT, one.error_deg, *(one.causes_deg.get(name, nothing) for name in names)]
        lines += [",".join([f'"{one.name}"', *(f"{value:.6g}" for value in row)]) for row in zip(*columns, strict=True)]
    return "\n".join(lines) + "\n"
