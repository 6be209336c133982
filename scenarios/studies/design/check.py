"""A design checked by other means: its own twin simulated reading by reading, and its field by magpylib alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from scenarios.studies.design.field import scaled_values
from scenarios.studies.design.study import POINTS, DesignStudy
from twin.angles import Array, wrap_deg
from twin.chain import Chain
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.materials import grade
from twin.magnet.placement import Placement
from twin.motion import NOMINAL_C

_AVERAGED = 16
"""Simulated records that are averaged, so that the noise does not count as error."""


@dataclass(frozen=True, kw_only=True)
class Check:
    """Largest error [deg] of the study and of the simulated twin (noise averaged), field [mT] of both and magpylib."""

    error_deg: float
    simulated_error_deg: float
    field_mT: float
    magpylib_mT: float


def design_twin(study: DesignStudy, row: Array, which: float) -> Chain:
    """The twin of one design: its magnet in its place, the sensor's effects at its field."""
    chain = study.chain
    assert chain.magnet is not None
    designs = study.space.assemble(row[None], np.array([which]))
    magnet, place = designs.magnet, designs.placement
    body = {"diameter_mm": row[0], "length_mm": row[0], "width_mm": row[0], "height_mm": row[1]}
    used = ("length_mm", "width_mm", "height_mm") if magnet.shape == "block" else ("diameter_mm", "height_mm")
    own = {name: float(body[name]) for name in used}
    if magnet.shape == "ring":
        own["bore_mm"] = float(np.asarray(magnet.bore_mm))
    if row[2] > 0.0:
        own["remanence_T"] = float(row[2])
    name = study.space.grades[int(which)]
    assembly = Assembly(
        Magnet(shape=magnet.shape, grade=name, **own),
        Placement(**{key: float(np.ravel(value)[0]) for key, value in vars(place).items() if np.ndim(value)}),
    )
    return twin_at(chain, assembly)


def twin_at(chain: Chain, assembly: Assembly) -> Chain:
    """The twin of the chain's sensor at another magnet: its effects as they are at that one's field."""
    values = {
        key: {name: float(value) for name, value in params.items()}
        for key, params in scaled_values(chain, assembly).items()
    }
    return replace(chain, values=values).with_magnet(assembly)


def check_design(study: DesignStudy, row: Array, which: float) -> Check:
    """Simulate the design's own twin with noise and all, and ask magpylib's objects for its field."""
    twin = design_twin(study, row, which)
    assert twin.magnet is not None
    motion = study.demand.motion(POINTS)
    slope = twin.sensor_sense * twin.output_sense
    total = np.zeros(len(motion))
    for seed in range(_AVERAGED):
        sweep = twin.simulate(motion, seed=seed)
        error = wrap_deg(sweep.measured_deg - slope * sweep.reference_deg)
        calibrated = np.degrees(np.angle(np.mean(np.exp(1j * np.radians(error[motion.temperature_c == NOMINAL_C])))))
        total += wrap_deg(error - calibrated)
    designs = study.space.assemble(row[None], np.array([which]))
    figures = study.figures(designs, np.array([0]))
    return Check(
        error_deg=float(figures["error_deg"][0]),
        simulated_error_deg=float(np.max(np.abs(total / _AVERAGED))),
        field_mT=float(figures["field_mT"][0]),
        magpylib_mT=magpylib_mT(twin.magnet.magnet, twin.magnet.placement),
    )


def magpylib_mT(magnet: Magnet, placement: Placement) -> float:
    """|B| [mT] at 25 C on the axis of an untilted magnet, from magpylib's objects and nothing of the twin's."""
    import magpylib

    stated = grade(magnet.grade)
    remanence = stated.remanence_T if magnet.remanence_T is None else float(np.asarray(magnet.remanence_T))
    strength = remanence * (1.0 + 0.01 * stated.percent_per_K * (NOMINAL_C - 20.0))
    polarization = (-strength, 0.0, 0.0)
    bodies: Any = magpylib.magnet
    tall = float(np.asarray(magnet.height_mm)) * 1e-3
    if magnet.shape == "block":
        size = (float(np.asarray(magnet.length_mm)) * 1e-3, float(np.asarray(magnet.width_mm)) * 1e-3, tall)
        body = bodies.Cuboid(dimension=size, polarization=polarization)
    elif magnet.shape == "ring":
        radii = (0.5e-3 * float(np.asarray(magnet.bore_mm)), 0.5e-3 * float(np.asarray(magnet.diameter_mm)))
        body = bodies.CylinderSegment(dimension=(*radii, tall, 0, 360), polarization=polarization)
    else:
        body = bodies.Cylinder(
            dimension=(float(np.asarray(magnet.diameter_mm)) * 1e-3, tall), polarization=polarization
        )
    at = (0.0, 0.0, float(np.asarray(placement.air_gap_mm)) * 1e-3 + 0.5 * tall)
    return float(1e3 * np.linalg.norm(body.getB(at)))
