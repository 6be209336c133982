"""Accuracy and speed of the magnet stage against magpylib: ``python -m tests.benchmarks.field``."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from tests.twin.geometries import axis_distance, by_magpylib, by_quadrature, one, random_designs
from twin.angles import Array
from twin.magnet.field import field_mT
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement, turned

CASES = {
    "untilted, sensor off the axis": {"shaft": False, "tilt": False},
    "untilted, both off the axis": {"shaft": True, "tilt": False},
    "tilted, both off the axis": {"shaft": True, "tilt": True},
}


def best(run: Callable[[], object], repeats: int) -> float:
    """The shortest of several runs [s]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def one_vectorised_call(magnet: Magnet, placement: Placement, angles: Array) -> Array:
    """magpylib's own cylinder function over all points of all designs at once, in the magnet's frame (designs, n, 3).

    The geometry is left out of the timing's favour: only the points are formed here, the field is not turned back.
    """
    from magpylib.func import cylinder_field

    at = turned(placement.sensor_mm(magnet)[:, None, :], -angles)
    points = ((at - placement.magnet_mm[..., None, :]) @ placement.magnet_axes).reshape(-1, 3)
    size = np.stack([magnet.diameter_mm, magnet.height_mm], axis=-1)
    return np.asarray(
        cylinder_field(
            "B",
            points,
            np.repeat(size, angles.size, axis=0),
            np.repeat(np.outer(magnet.remanence_at(), [-1.0, 0.0, 0.0]), angles.size, axis=0),
        )
    )


def differences(magnet: Magnet, placement: Placement, field: Array, angles: Array) -> Array:
    """Largest |difference| over |B| (4,): of ours from magpylib, the same from 0.05 radii off the axis on, of ours from

    a quadrature, of magpylib from it. Nearer to the axis magpylib takes three terms of a series; the quadrature tells
    who is right there.
    """
    worst = np.zeros(4)
    for index, ours in enumerate(field):
        design: tuple[Any, Any] = one(magnet, index), one(placement, index)
        theirs, summed = by_magpylib(*design, angles), by_quadrature(*design, angles)
        size = np.linalg.norm(summed, axis=0)
        share = [np.linalg.norm(a - b, axis=0) / size for a, b in ((ours, theirs), (ours, summed), (theirs, summed))]
        off = np.max(share[0], where=axis_distance(*design, angles) >= 0.05, initial=0.0)
        worst = np.maximum(worst, [share[0].max(), off, share[1].max(), share[2].max()])
    return worst


def main() -> None:
    """Print three lines a case: largest differences over 1,000 geometries, times over 10,000 designs x 360 angles."""
    angles = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
    for name, options in CASES.items():
        magnet, placement = random_designs(np.random.default_rng(1), 1000, **options)
        few = np.random.default_rng(2).uniform(0.0, 2.0 * np.pi, 6)
        worst = differences(magnet, placement, field_mT(magnet, placement, few), few)
        magnet, placement = random_designs(np.random.default_rng(3), 10_000, **options)
        out = np.empty((10_000, 3, angles.size))
        ours = best(lambda m=magnet, p=placement, o=out: field_mT(m, p, angles, out=o), 5)  # type: ignore[misc]
        fresh = best(lambda m=magnet, p=placement: field_mT(m, p, angles), 3)  # type: ignore[misc]
        theirs = best(lambda m=magnet, p=placement: one_vectorised_call(m, p, angles), 1)  # type: ignore[misc]
        print(
            f"{name}: largest difference from magpylib {worst[0]:.1e}, {worst[1]:.1e} without the points within "
            f"0.05 radii of the axis;\n    from a quadrature {worst[2]:.1e}, magpylib's own from it {worst[3]:.1e}\n"
            f"    {ours * 1e3:.1f} ms ({fresh * 1e3:.0f} ms into fresh memory) against {theirs:.2f} s: "
            f"{theirs / ours:.0f} times ({theirs / fresh:.0f} times)"
        )


if __name__ == "__main__":
    main()
