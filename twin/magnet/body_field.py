"""The field of one magnet in its own frame, at points outside it, for a unit remanence: magpylib's closed forms."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import BoolArray
from twin.magnet.magnet import Magnet, Number


def cylinder_components(radius_mm: Number, height_mm: Number, rho_mm: Array, z_mm: Array) -> tuple[Array, Array, Array]:
    """f, g, h of a diametral cylinder at (rho, z) in its own frame, for a unit remanence; any common shape.

    With phi the azimuth from the magnetisation: B_rho = f cos phi, B_phi = g sin phi, B_z = h cos phi, exactly,
    because the surface charge goes with cos phi. One evaluation at phi = 45 deg gives all three.
    Source: Caciagli et al., J. Magn. Magn. Mater. 456 (2018) 423, as implemented in magpylib.
    """
    from magpylib.core import magnet_cylinder_diametral_Hfield

    radius, height, rho, z = np.broadcast_arrays(radius_mm, height_mm, rho_mm, z_mm)
    components = magnet_cylinder_diametral_Hfield(
        z0=np.ravel(0.5 * height / radius),
        r=np.ravel(rho / radius),
        z=np.ravel(z / radius),
        phi=np.full(rho.size, 0.25 * np.pi),
    )
    f, g, h = (np.sqrt(2.0) * np.reshape(part, rho.shape) for part in components)
    return f, g, h


def round_components(magnet: Magnet, rho_mm: Array, z_mm: Array) -> tuple[Array, Array, Array]:
    """f, g, h (see above) of a cylinder or a ring, whose bore is a cylinder taken away; rho, z (designs..., points)."""
    outer = cylinder_components(_column(magnet.diameter_mm) * 0.5, _column(magnet.height_mm), rho_mm, z_mm)
    bore = np.asarray(magnet.bore_mm, dtype=np.float64)
    if magnet.shape != "ring" or not np.any(bore > 0.0):
        return outer
    # A vanishing bore takes nothing away; the closed form wants a radius, so it gets a harmless one.
    radius = _column(np.where(bore > 0.0, bore, 1.0)) * 0.5
    inner = cylinder_components(radius, _column(magnet.height_mm), rho_mm, z_mm)
    f, g, h = (a - np.where(_column(bore) > 0.0, b, 0.0) for a, b in zip(outer, inner, strict=True))
    return f, g, h


def body_field(magnet: Magnet, points_mm: Array) -> Array:
    """Field (designs..., points, 3) at points of that shape [mm], magnetised along +x, as a share of the remanence."""
    if magnet.shape == "block":
        return _block_field(magnet, points_mm)
    x, y, z = points_mm[..., 0], points_mm[..., 1], points_mm[..., 2]
    rho = np.hypot(x, y)
    f, g, h = round_components(magnet, rho, z)
    # On the axis the azimuth is free: there f = -g, and any choice gives the same vector.
    c = np.divide(x, rho, out=np.ones_like(rho), where=rho > 0.0)
    s = np.divide(y, rho, out=np.zeros_like(rho), where=rho > 0.0)
    return np.stack([f * c * c - g * s * s, (f + g) * s * c, h * c], axis=-1)


def _block_field(magnet: Magnet, points_mm: Array) -> Array:
    from magpylib.core import magnet_cuboid_Bfield

    size = np.stack(np.broadcast_arrays(magnet.length_mm, magnet.width_mm, magnet.height_mm), axis=-1)
    flat = points_mm.reshape(-1, 3)
    field = magnet_cuboid_Bfield(
        observers=flat,
        dimensions=np.ascontiguousarray(np.broadcast_to(size[..., None, :], points_mm.shape)).reshape(-1, 3),
        polarizations=np.broadcast_to([1.0, 0.0, 0.0], flat.shape),
    )
    return np.asarray(field, dtype=np.float64).reshape(points_mm.shape)


def inside(magnet: Magnet, points_mm: Array) -> BoolArray:
    """Whether points (designs..., points, 3) [mm] of the magnet's frame lie in or on its body."""
    x, y, z = points_mm[..., 0], points_mm[..., 1], points_mm[..., 2]
    level = np.abs(z) <= 0.5 * _column(magnet.height_mm)
    if magnet.shape == "block":
        across = (np.abs(x) <= 0.5 * _column(magnet.length_mm)) & (np.abs(y) <= 0.5 * _column(magnet.width_mm))
        return np.asarray(level & across)
    rho = np.hypot(x, y)
    hole = rho < 0.5 * _column(magnet.bore_mm) if magnet.shape == "ring" else np.zeros(rho.shape, dtype=bool)
    return np.asarray(level & (rho <= 0.5 * _column(magnet.diameter_mm)) & ~hole)


def _column(value: Number) -> Array:
    return np.asarray(value, dtype=np.float64)[..., None]
