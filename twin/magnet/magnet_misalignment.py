"""magnet_misalignment: a sensor off the shaft's axis or a tilted shaft senses a counter-rotating field component."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import Array, channels_of, radians
from twin.effect import Effect, Param, Parameters
from twin.magnet.body_field import cylinder_components
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import Motion

MAGNET = Magnet()
AIR_GAP_MM = float(Placement().air_gap_mm)
"""The cylinder that millimetres and degrees are counted against where no magnet is described."""


def tensor(off_axis_mm: Array, tilt_deg: Array) -> tuple[Array, Array]:
    """Gains along and across the displacement (any common shape) by which a centred cylinder's field is sensed.

    The field of a diametral cylinder is linear in its magnetisation: along the displacement f, across it -g, and
    h out of the plane, of which the sensor's tilt towards the displacement takes its share.
    """
    off_axis, tilt = np.broadcast_arrays(np.abs(off_axis_mm), radians(tilt_deg))
    radius, height = 0.5 * float(MAGNET.diameter_mm), float(MAGNET.height_mm)
    z = np.asarray(AIR_GAP_MM + 0.5 * height)
    f, g, h = cylinder_components(radius, height, np.concatenate([off_axis.ravel(), [0.0]]), z)
    f, g, h = f / f[-1], g / g[-1], h / f[-1]
    along = f[:-1].reshape(tilt.shape) * np.cos(tilt) - h[:-1].reshape(tilt.shape) * np.sin(tilt)
    return np.asarray(along), g[:-1].reshape(tilt.shape)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    along, across = tensor(np.asarray(values["off_axis_mm"]), np.asarray(values["tilt_deg"]))
    mean, half = 0.5 * (along + across), 0.5 * (along - across)
    twice = 2.0 * radians(values["direction_deg"])
    x, y = signal[..., :1, :], signal[..., 1:, :]
    c, s = half * np.cos(twice), half * np.sin(twice)
    return channels_of((mean + c) * x + s * y, s * x + (mean - c) * y)


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"off_axis_mm": float(shift)} for shift in np.linspace(0.1, 1.5, 15)]


MAGNET_MISALIGNMENT = Effect(
    name="magnet_misalignment",
    stage="magnet",
    acts_on="channels",
    params={
        "off_axis_mm": Param(
            unit="mm", null=0.0, lower=0.0, upper=2.0, doc="sensor off the shaft's axis", role="level", typical=0.3
        ),
        "tilt_deg": Param(
            unit="deg",
            null=0.0,
            lower=-45.0,
            upper=45.0,
            doc="sensor's normal against the shaft's axis, towards the displacement",
            role="level",
            typical=5.0,
        ),
        "direction_deg": Param(
            unit="deg",
            null=0.0,
            lower=-360.0,
            upper=360.0,
            doc="displacement's, from the sensor's x",
            role="phase",
            mirror=-1,
        ),
    },
    forward=forward,
    shapes=shapes,
    needs=frozenset({"two air gaps"}),
    source="field of a diametral cylinder off its axis: Caciagli et al., J. Magn. Magn. Mater. 456 (2018) 423; "
    "counted for 6 mm x 2.5 mm at 1.5 mm, typical assumptions",
    signature="order 2, quadratic in the displacement: the same as gain_mismatch + phase",
)
