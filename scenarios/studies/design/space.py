"""The space of designs: what is varied, how it is sampled, and the magnets and placements that follow."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, get_args

import numpy as np

from scenarios.studies.design.field import Designs
from twin.angles import TAU, Array, IntArray
from twin.errors import UserError
from twin.known_names import nearest
from twin.limits import OutOfRangeError
from twin.magnet.magnet import Magnet, Shape
from twin.magnet.materials import grade
from twin.magnet.placement import Placement
from twin.shown import shown

Sampling = Literal["grid", "lhs", "sobol"]
AXES = {
    "diameter_mm": "mm",
    "height_mm": "mm",
    "remanence_T": "T",
    "air_gap_mm": "mm",
    "off_axis_mm": "mm",
    "tilt_deg": "deg",
    "magnet_off_axis_mm": "mm",
    "magnet_tilt_deg": "deg",
    "stray_mT": "mT",
}
"""What a design is made of, in the order of its columns. Off-axis and tilt are the sensor's; for a block the diameter
is its length and width."""
TOLERANCES = {
    "off_axis": "mm",
    "tilt": "deg",
    "magnet_off_axis": "mm",
    "magnet_tilt": "deg",
    "air_gap": "mm",
    "stray": "mT",
}
"""Radius of the disk that a displacement, tilt or field is drawn from evenly; half the width for the air gap."""

MOST_DESIGNS = 10_000_000
MOUNTING_UNIFORMS = 11
"""Uniform numbers that a mounting is drawn from: two for each displacement, tilt and field, one for the air gap."""


@dataclass(frozen=True, kw_only=True)
class Space:
    """``axes``: for each of AXES the values of a grid, or what a sampling takes the lowest and highest of."""

    axes: Mapping[str, tuple[float, ...]]
    shape: Shape = "cylinder"
    grades: tuple[str, ...] = ("N35H",)
    bore_mm: float = 2.0
    sampling: Sampling = "grid"
    count: int = 0
    seed: int = 0

    def __post_init__(self) -> None:
        if self.sampling not in get_args(Sampling):
            words = get_args(Sampling)
            raise UserError(
                f"sampling is {shown(self.sampling)}{nearest(self.sampling, words)}; expected one of {', '.join(words)}"
            )
        for name in self.grades:
            grade(name)

    @property
    def designs(self) -> int:
        """How many designs there are."""
        if self.sampling != "grid":
            return self.count
        return len(self.grades) * math.prod(len(self.axes[name]) for name in AXES)

    def table(self, numbers: IntArray | None = None) -> tuple[Array, Array]:
        """Designs by number, or all of them: columns of AXES (designs, 9), and which grade (designs,)."""
        chosen = np.arange(self.designs) if numbers is None else numbers
        if self.sampling == "grid":
            sizes = (len(self.grades), *(len(self.axes[name]) for name in AXES))
            which, *places = np.unravel_index(chosen, sizes)
            columns = [np.asarray(self.axes[name])[place] for name, place in zip(AXES, places, strict=True)]
            return np.stack(columns, axis=1), which.astype(np.float64)
        from scipy.stats import qmc

        rng, dimensions = np.random.default_rng(self.seed), len(AXES) + 1
        if self.sampling == "sobol":
            # Whole powers of two: the sequence is balanced there, and its beginning does not depend on its length.
            unit = qmc.Sobol(dimensions, rng=rng).random_base2(max(self.count - 1, 1).bit_length())[: self.count]
        else:
            unit = qmc.LatinHypercube(dimensions, rng=rng).random(self.count)
        low = np.array([min(self.axes[name]) for name in AXES])
        high = np.array([max(self.axes[name]) for name in AXES])
        which = np.minimum(np.floor(unit[:, -1] * len(self.grades)), len(self.grades) - 1)
        return (low + (high - low) * unit[:, :-1])[chosen], which[chosen]

    def assemble(self, table: Array, which: Array) -> Designs:
        """The designs of these rows. A remanence of 0 stands for the grade's own."""
        columns = dict(zip(AXES, table.T, strict=True))
        stated = [grade(name) for name in self.grades]
        own = np.array([one.remanence_T for one in stated])[which.astype(int)]
        magnet = Magnet(
            shape=self.shape,
            diameter_mm=columns["diameter_mm"],
            length_mm=columns["diameter_mm"],
            width_mm=columns["diameter_mm"],
            height_mm=columns["height_mm"],
            bore_mm=self.bore_mm,
            remanence_T=np.where(columns["remanence_T"] > 0.0, columns["remanence_T"], own),
            percent_per_K=np.array([one.percent_per_K for one in stated])[which.astype(int)],
        )
        placement = Placement(
            air_gap_mm=columns["air_gap_mm"],
            sensor_x_mm=columns["off_axis_mm"],
            sensor_tilt_y_deg=columns["tilt_deg"],
            magnet_x_mm=columns["magnet_off_axis_mm"],
            magnet_tilt_y_deg=columns["magnet_tilt_deg"],
            stray_x_mT=columns["stray_mT"],
        )
        return Designs(magnet, placement)


def mounted(placement: Placement, tolerance: Mapping[str, float], uniforms: Array) -> Placement:
    """Placements (k,) with mounting errors drawn from uniform numbers (k, MOUNTING_UNIFORMS)."""
    changes: dict[str, Array] = {}
    pairs = {
        "off_axis": ("sensor_x_mm", "sensor_y_mm"),
        "tilt": ("sensor_tilt_x_deg", "sensor_tilt_y_deg"),
        "magnet_off_axis": ("magnet_x_mm", "magnet_y_mm"),
        "magnet_tilt": ("magnet_tilt_x_deg", "magnet_tilt_y_deg"),
        "stray": ("stray_x_mT", "stray_y_mT"),
    }
    for number, (key, names) in enumerate(pairs.items()):
        size = tolerance.get(key, 0.0)
        if size == 0.0:
            continue
        radius, turn = size * np.sqrt(uniforms[:, 2 * number]), TAU * uniforms[:, 2 * number + 1]
        for name, part in zip(names, (np.cos(turn), np.sin(turn)), strict=True):
            changes[name] = getattr(placement, name) + radius * part
    if tolerance.get("air_gap", 0.0) > 0.0:
        moved = np.asarray(placement.air_gap_mm) + tolerance["air_gap"] * (2.0 * uniforms[:, 10] - 1.0)
        changes["air_gap_mm"] = np.maximum(moved, 1e-3)
    return replace(placement, **changes)


def require_mountable(space: Space, tolerance: Mapping[str, float]) -> None:
    """Raise UserError where a mounting within the tolerances could lie outside what a placement may be."""
    ends = np.array([[pick(space.axes[name]) for name in AXES] for pick in (min, max)])
    # Every displacement in full along +x, +y, -x and -y; the air gap is bounded below by itself.
    corners = np.ones((4, MOUNTING_UNIFORMS))
    corners[:, 1:-1:2] = np.arange(4)[:, None] / 4.0
    uniforms = np.tile(corners, (2, 1))
    designs = space.assemble(ends, np.zeros(2))
    for name, size in tolerance.items():
        mount = partial(mounted, tolerance={name: size}, uniforms=uniforms)
        try:
            designs.spread(len(corners), mount)
        except OutOfRangeError as error:
            raise UserError(f"tolerance {name} is {size:g} {TOLERANCES[name]}, too large: {error}") from None
