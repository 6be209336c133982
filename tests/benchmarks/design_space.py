"""100,000 designs through field and error at 72 angles, against magpylib: ``python -m tests.benchmarks.design_space``.

Half of the designs are untilted with the sensor off the axis, half have magnet and sensor off the axis and tilted.
"""

from __future__ import annotations

import time
from dataclasses import fields, replace
from typing import Any

import numpy as np

from scenarios.studies.design.field import Designs
from tests.twin.geometries import one, random_designs
from twin.angles import TAU, Array, wrap
from twin.magnet.field import basis
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement

HALF, ANGLES, SAMPLE, TOGETHER = 50_000, 72, 200, 1000


def errors(designs: Designs, angles: Array) -> tuple[Array, Array]:
    """In-plane field [mT] and angle error [deg], both (designs, angles), of the field alone at 25 C."""
    series = np.empty((designs.count, 2, angles.size))
    for rows, group in designs.groups:
        series[rows] = group.coefficients[:, :2] @ basis(angles, group.orders)
    return np.hypot(series[:, 0], series[:, 1]), np.degrees(wrap(np.arctan2(series[:, 1], series[:, 0]) - angles))


def looped(magnet: Magnet, placement: Placement, angles: Array) -> Array:
    """In-plane field [mT] (angles,) of one design at 25 C: one call of magpylib's objects, the turn as its path."""
    import magpylib
    from scipy.spatial.transform import Rotation

    magnet_tilt, sensor_tilt = (
        Rotation.from_euler("xy", [getattr(placement, f"{part}_tilt_{axis}_deg") for axis in "xy"], degrees=True)
        for part in ("magnet", "sensor")
    )
    shaft = Rotation.from_rotvec(np.outer(angles, [0.0, 0.0, 1.0]))
    body = magpylib.magnet.Cylinder(
        polarization=(-float(magnet.remanence_at(25.0)), 0.0, 0.0),
        dimension=(float(magnet.diameter_mm), float(magnet.height_mm)),
        position=shaft.apply([placement.magnet_x_mm, placement.magnet_y_mm, 0.0]),
        orientation=shaft * magnet_tilt,
    )
    sensor = magpylib.Sensor(position=placement.sensor_mm(magnet), orientation=sensor_tilt)
    field = 1e3 * body.getB(sensor)
    return np.hypot(field[:, 0], field[:, 1])


def main() -> None:
    """One line a half, and the whole."""
    angles = np.arange(ANGLES) * TAU / ANGLES
    whole = loop_whole = 0.0
    for name, tilt in (("untilted", False), ("tilted", True)):
        magnet, placement = random_designs(np.random.default_rng(1), HALF, shaft=tilt, tilt=tilt)
        start = time.perf_counter()
        worst = 0.0
        first: list[Array] = []
        for at in range(0, HALF, TOGETHER):
            rows = slice(at, at + TOGETHER)
            field, error = errors(Designs(_part(magnet, rows), _part(placement, rows)), angles)
            worst = max(worst, float(np.max(np.abs(error))))
            if not first:
                first.append(field)
        took = time.perf_counter() - start
        start = time.perf_counter()
        reference = np.stack(
            [
                looped(one(magnet, row), one(placement, row), angles)
                for row in range(SAMPLE)  # type: ignore[arg-type]
            ]
        )
        loop = (time.perf_counter() - start) / SAMPLE * HALF
        difference = np.max(np.abs(first[0][:SAMPLE] / reference - 1.0))
        print(
            f"{HALF} {name} designs x {ANGLES} angles: {took:.2f} s; magpylib in a loop {loop:.0f} s "
            f"(from {SAMPLE} designs): {loop / took:.0f} times; largest relative difference {difference:.1e}"
        )
        whole, loop_whole = whole + took, loop_whole + loop
    print(f"all {2 * HALF}: {whole:.2f} s, {loop_whole / whole:.0f} times")


def _part(part: Any, rows: slice) -> Any:
    values = {item.name: getattr(part, item.name) for item in fields(part)}
    return replace(part, **{name: value[rows] for name, value in values.items() if np.ndim(value)})


if __name__ == "__main__":
    main()
