"""magnet_eccentricity: magnet and sensor are both off the shaft's axis, so the sensor goes round in an uneven field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from twin.angles import Array, channels_of, radians
from twin.effect import Effect, Param, Parameters
from twin.magnet.assembly import Assembly
from twin.magnet.placement import Placement
from twin.magnet.uneven_field import Pose, UnevenField
from twin.motion import Motion

TOLERANCE_DEG = 2.0
"""Standard deviation of a tilt before anything is known of it: a mounting that is off by more is seen."""
WITHIN = 3.0
"""Sensor and magnet are placed alike: neither is further off than the other by more than this, two times of three."""


@dataclass(frozen=True, eq=False)
class Misplaced:
    """What the displacements add to the channels in one magnet's field."""

    field: UnevenField

    def __call__(self, signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        x, y = signal[..., :1, :], signal[..., 1:, :]
        turn = (x + 1j * y) / np.maximum(np.hypot(x, y), 1e-300)
        own = pose_of(self.field.assembly.placement)
        # Tilts alone turn no angle that offset, gain and phase do not: only what they do with a displacement counts.
        tilted, moved = poses(values)
        added = self.field.of(turn, own + tilted + moved) - self.field.of(turn, own + tilted)
        return signal + channels_of(added.real, added.imag)


def pose_of(placement: Placement) -> Pose:
    """Where a placement has sensor and magnet."""
    tilts = {
        name: (np.radians(getattr(placement, f"{name}_x_deg")), np.radians(getattr(placement, f"{name}_y_deg")))
        for name in ("sensor_tilt", "magnet_tilt")
    }
    sensor = complex(placement.sensor_x_mm, placement.sensor_y_mm)
    return Pose(sensor, complex(placement.magnet_x_mm, placement.magnet_y_mm), **tilts)


def poses(values: Parameters) -> tuple[Pose, Pose]:
    """The tilts and the displacements of the effect's parameters."""
    tilt = {
        name: (radians(values.get(f"{name}_x_deg", 0.0)), radians(values.get(f"{name}_y_deg", 0.0)))
        for name in ("sensor_tilt", "magnet_tilt")
    }
    product, ratio = np.asarray(values["product_mm2"]), np.exp(np.asarray(values["log_ratio"]))
    azimuth = radians(values["azimuth_deg"])
    sensor = np.sqrt(np.abs(product) * ratio) * np.exp(1j * azimuth)
    # A product below zero is one above it half a turn on.
    magnet = np.sign(product) * np.sqrt(np.abs(product) / ratio) * np.exp(1j * (radians(values["phase_deg"]) - azimuth))
    return Pose(**tilt), Pose(sensor, magnet)


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    # Half a turn of both displacements changes nothing.
    return [
        {"azimuth_deg": float(azimuth), "log_ratio": float(np.log(ratio))}
        for ratio in (0.5, 1.0, 2.0)
        for azimuth in np.arange(-90.0, 90.0, 30.0)
    ]


def at_magnet(assembly: Assembly) -> Effect:
    """The effect in the field of a described magnet; a block's field has no such series, and the usual one is kept."""
    if assembly.magnet.shape == "block":
        return MAGNET_ECCENTRICITY
    return replace(MAGNET_ECCENTRICITY, forward=Misplaced(UnevenField(assembly)))


def _tilt(doc: str, *, mirror: bool) -> Param:
    return Param(
        unit="deg",
        null=0.0,
        lower=-30.0,
        upper=30.0,
        doc=doc,
        role="shape",
        typical=2.0,
        prior_sd=TOLERANCE_DEG,
        mirror=-1 if mirror else 1,
    )


MAGNET_ECCENTRICITY = Effect(
    name="magnet_eccentricity",
    stage="magnet",
    acts_on="channels",
    params={
        "product_mm2": Param(
            unit="mm2",
            null=0.0,
            lower=0.0,
            upper=2.0,
            doc="sensor's times magnet's displacement off the shaft's axis",
            typical=0.05,
            # In an angle the plain part is an offset's: what is left is of higher order in the displacements.
            trial=0.25,
        ),
        "phase_deg": Param(
            unit="deg",
            null=0.0,
            lower=-360.0,
            upper=360.0,
            doc="sum of both displacements' directions",
            role="phase",
            mirror=-1,
        ),
        "azimuth_deg": Param(
            unit="deg",
            null=0.0,
            lower=-360.0,
            upper=360.0,
            doc="direction of the sensor's",
            role="shape",
            typical=30.0,
            prior_sd=180.0 / float(np.sqrt(12.0)),
            mirror=-1,
        ),
        "log_ratio": Param(
            unit="1",
            null=0.0,
            lower=-4.0,
            upper=4.0,
            doc="log of the sensor's over the magnet's",
            role="shape",
            prior_sd=float(np.log(WITHIN)),
        ),
        "sensor_tilt_x_deg": _tilt("sensor's tilt about x", mirror=True),
        "sensor_tilt_y_deg": _tilt("sensor's tilt about y", mirror=False),
        "magnet_tilt_x_deg": _tilt("magnet's tilt about x of the shaft", mirror=True),
        "magnet_tilt_y_deg": _tilt("magnet's tilt about y of the shaft", mirror=False),
    },
    forward=Misplaced(UnevenField(Assembly())),
    needs=frozenset({"one turn"}),
    shapes=shapes,
    fitted_shapes=(
        *("azimuth_deg", "log_ratio"),
        *("sensor_tilt_x_deg", "sensor_tilt_y_deg", "magnet_tilt_x_deg", "magnet_tilt_y_deg"),
    ),
    at_magnet=at_magnet,
    source="the field of a round magnet off its axis: Jackson, Classical Electrodynamics, 3rd ed., section 3.7; "
    "counted for 6 mm x 2.5 mm at 1.5 mm where no magnet is described",
    signature="order 1, with the product of both displacements: the same as reference_eccentricity and offset",
)
