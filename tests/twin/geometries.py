"""Random magnets and placements, and magpylib called point by point through its objects as the judge."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from twin.angles import Array
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement, turned


def random_designs(
    rng: np.random.Generator, count: int, *, shape: str = "cylinder", shaft: bool = True, tilt: bool = True
) -> tuple[Magnet, Placement]:
    """Designs of the sizes that end-of-shaft sensors use; ``shaft``: magnet off the axis too; ``tilt``: both tilted."""

    def draw(low: float, high: float) -> Array:
        return rng.uniform(low, high, count)

    magnet = Magnet(
        shape=shape,  # type: ignore[arg-type]
        diameter_mm=draw(4.0, 12.0),
        bore_mm=draw(0.5, 3.0),
        length_mm=draw(4.0, 10.0),
        width_mm=draw(4.0, 10.0),
        height_mm=draw(1.0, 5.0),
        remanence_T=draw(0.2, 1.45),
    )
    place = {"air_gap_mm": draw(1.0, 5.0), "sensor_x_mm": draw(-0.8, 0.8), "sensor_y_mm": draw(-0.8, 0.8)}
    if shaft:
        place |= {"magnet_x_mm": draw(-0.5, 0.5), "magnet_y_mm": draw(-0.5, 0.5)}
    if tilt:
        place |= {f"{part}_tilt_{axis}_deg": draw(-6.0, 6.0) for part in ("magnet", "sensor") for axis in "xy"}
    return magnet, Placement(**place)


def one(part: Magnet | Placement, index: int) -> Magnet | Placement:
    """One of the designs."""
    values = {item.name: getattr(part, item.name) for item in fields(part)}
    single = {name: value[index] if isinstance(value, np.ndarray) else value for name, value in values.items()}
    return type(part)(**single)


def by_magpylib(magnet: Magnet, placement: Placement, angles: Array) -> Array:
    """Field in the sensor's axes (3, n) [mT] of one design, by magpylib's objects and scipy's rotations."""
    import magpylib
    from scipy.spatial.transform import Rotation

    polarization = (-float(magnet.remanence_at()), 0.0, 0.0)
    height = float(magnet.height_mm)
    if magnet.shape == "cylinder":
        body = magpylib.magnet.Cylinder(polarization=polarization, dimension=(float(magnet.diameter_mm), height))
    elif magnet.shape == "ring":
        inner, outer = 0.5 * float(magnet.bore_mm), 0.5 * float(magnet.diameter_mm)
        body = magpylib.magnet.CylinderSegment(polarization=polarization, dimension=(inner, outer, height, 0, 360))
    else:
        body = magpylib.magnet.Cuboid(
            polarization=polarization, dimension=(float(magnet.length_mm), float(magnet.width_mm), height)
        )
    tilts = [
        Rotation.from_euler("xy", [getattr(placement, f"{part}_tilt_{axis}_deg") for axis in "xy"], degrees=True)
        for part in ("magnet", "sensor")
    ]
    at = (placement.sensor_x_mm, placement.sensor_y_mm, float(placement.air_gap_mm) + 0.5 * height)
    sensor = magpylib.Sensor(position=at, orientation=tilts[1])
    field = []
    for angle in angles:
        shaft = Rotation.from_rotvec([0.0, 0.0, angle])
        body.position = shaft.apply([placement.magnet_x_mm, placement.magnet_y_mm, 0.0])
        body.orientation = shaft * tilts[0]
        field.append(1e3 * body.getB(sensor) + tilts[1].inv().apply(placement.stray_mT))
    return np.array(field).T


def by_quadrature(magnet: Magnet, placement: Placement, angles: Array) -> Array:
    """The same by Coulomb's law over the surface charge cos(phi) of a cylinder's or a ring's mantles: (3, n) [mT].

    Trapezia in phi and Gauss-Legendre in z, without any closed form. Both converge geometrically; a sensor 1 mm off a
    magnet of up to 12 mm leaves less than 1e-13 at these numbers of nodes.
    """
    from scipy.spatial.transform import Rotation

    phi = np.arange(256) * 2.0 * np.pi / 256
    node, weight = np.polynomial.legendre.leggauss(48)
    half = 0.5 * float(magnet.height_mm)
    tilts = [
        Rotation.from_euler("xy", [float(getattr(placement, f"{part}_tilt_{axis}_deg")) for axis in "xy"], degrees=True)
        for part in ("magnet", "sensor")
    ]
    at = np.array([placement.sensor_x_mm, placement.sensor_y_mm, float(placement.air_gap_mm) + half], dtype=np.float64)
    centre = np.array([placement.magnet_x_mm, placement.magnet_y_mm, 0.0], dtype=np.float64)
    mantles = [(0.5 * float(magnet.diameter_mm), 1.0)]
    if magnet.shape == "ring":
        mantles.append((0.5 * float(magnet.bore_mm), -1.0))
    field = []
    for angle in angles:
        shaft = Rotation.from_rotvec([0.0, 0.0, angle])
        point = (shaft * tilts[0]).inv().apply(at - shaft.apply(centre))
        total = np.zeros(3)
        for radius, sign in mantles:
            # Charge per area -J cos(phi): the polarisation points along -x.
            dx, dy = point[0] - radius * np.cos(phi)[:, None], point[1] - radius * np.sin(phi)[:, None]
            dz = point[2] - half * node
            density = -np.cos(phi)[:, None] * weight * half * radius * (2.0 * np.pi / 256) / (4.0 * np.pi)
            pull = sign * density / (dx * dx + dy * dy + dz * dz) ** 1.5
            total += [np.sum(pull * dx), np.sum(pull * dy), np.sum(pull * dz)]
        stator = 1e3 * float(magnet.remanence_at()) * (shaft * tilts[0]).apply(total) + placement.stray_mT
        field.append(tilts[1].inv().apply(stator))
    return np.array(field).T


def axis_distance(magnet: Magnet, placement: Placement, angles: Array) -> Array:
    """Distance (n,) of one design's sensor from its magnet's axis, in radii."""
    points = turned(placement.sensor_mm(magnet), -angles) - placement.magnet_mm
    return np.asarray(np.hypot(*(points @ placement.magnet_axes)[:, :2].T) * 2.0 / float(magnet.diameter_mm))


def largest_difference(
    magnet: Magnet, placement: Placement, field: Array, angles: Array, *, beyond: float = 0.0
) -> float:
    """The largest |difference| of ``field`` (designs, 3, n) from magpylib, relative to |B| at the same point.

    Only points at least ``beyond`` radii off the magnet's axis count.
    """
    worst = 0.0
    for index, ours in enumerate(field):
        design: tuple[Any, Any] = one(magnet, index), one(placement, index)
        theirs = by_magpylib(*design, angles)
        share = np.linalg.norm(ours - theirs, axis=0) / np.linalg.norm(theirs, axis=0)
        worst = max(worst, float(np.max(share, where=axis_distance(*design, angles) >= beyond, initial=0.0)))
    return worst
