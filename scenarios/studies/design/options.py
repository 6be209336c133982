"""The options of ``halltwin design`` as people write them, as a space and a demand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast, get_args

from scenarios.commands.intervals import interval, values, with_units
from scenarios.commands.once import check_once
from scenarios.studies.design.space import AXES, MOST_DESIGNS, TOLERANCES, Sampling, Space
from scenarios.studies.design.study import Demand
from twin.errors import UserError
from twin.known_names import nearest
from twin.limits import require_within
from twin.magnet.magnet import Shape
from twin.shown import shown

OPTIONS = {
    "demand.max_error_deg": "--max-error",
    "demand.window_mT": "--window",
    "demand.temperature_c": "--temperature",
    "demand.tolerance": "--tolerance",
    "demand.mountings": "--mountings",
    "demand.min_yield": "--min-yield",
    **{f"space.axes.{name}": f"--{name.removesuffix(f'_{unit}').replace('_', '-')}" for name, unit in AXES.items()},
    "space.grades": "--grade",
    "space.shape": "--shape",
    "space.bore_mm": "--bore",
    "space.sampling": "--sampling",
    "space.count": "--count",
    # The sampling's seed is the study's.
    "space.seed": "--seed",
    "twin": "the twin's",
}
"""What the settings of a study are called by who gives them."""


def space_of(
    axes: Mapping[str, str],
    *,
    shape: str,
    grades: tuple[str, ...],
    bore_mm: float,
    sampling: str,
    count: int,
    seed: int,
) -> Space:
    """The space. Raises UserError."""
    if shape not in get_args(Shape):
        shapes = get_args(Shape)
        raise UserError(f"shape is {shown(shape)}{nearest(shape, shapes)}; expected one of {', '.join(shapes)}")
    check_once("--grade", grades)
    require_within("count", count, 1, MOST_DESIGNS, whole=True)
    return Space(
        axes={name: values(name, text) for name, text in axes.items()},
        shape=cast(Shape, shape),
        grades=grades,
        bore_mm=bore_mm,
        sampling=cast(Sampling, sampling),
        count=count,
        seed=seed,
    )


def demand_of(
    *, max_error_deg: float, window: str, temperature: str, tolerance: str, mountings: int, min_yield: float
) -> Demand:
    """The demand. Raises UserError."""
    return Demand(
        max_error_deg=max_error_deg,
        window_mT=interval("window", window, example="30:90"),
        temperature_c=interval("temperature", temperature, example="-40:125"),
        tolerance=with_units("tolerance", tolerance, TOLERANCES),
        mountings=mountings,
        min_yield=min_yield,
    )
