"""magnet_misalignment: sensor and magnet off the shaft's axis, or tilted, so that the sensor sees an uneven field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from twin.angles import Array, channels_of, radians
from twin.effect import Effect, Param, Parameters
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.magnet.third_moment import third_moment_per_mm2
from twin.magnet.uneven_field import Pose, UnevenField
from twin.motion import Motion

USUAL = UnevenField(Assembly())
"""The field of the cylinder that millimetres and degrees are counted against where no magnet is described."""
TOLERANCE_DEG = 2.0
"""Standard deviation of a tilt before anything is known of it: a mounting that is off by more is seen."""
WITHIN = 3.0
"""Sensor and magnet are placed alike: neither is further off than the other by more than this, two times of three."""
MOMENTS = SENSOR_ALONE, OFF_CENTRE, NOT_ROUND = 1.0, 2.0, 3.0
"""Moments of the magnet about the shaft that a sensor off the axis sees. Every magnet has the first, whose field turns
against the shaft there. One off the axis, or stronger on one side, has the second, a block or a chipped one the third:
their fields turn twice and three times as fast as the shaft."""


@dataclass(frozen=True, eq=False)
class Misplaced:
    """What the channels see of one magnet's field where sensor and magnet are off the axis."""

    field: UnevenField
    described: bool = False
    """Whether it is the field of a described magnet, which weakens with the heat."""

    def __call__(self, signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        if self.poses(values)[1].centred:
            return signal
        x, y = signal[..., :1, :], signal[..., 1:, :]
        warm = self.field.assembly.warm(motion.temperature_c) if self.described else 1.0
        # Not made of unit length reading by reading: where the plates are not at right angles, that would bend it.
        turn = (x + 1j * y) / warm
        moment, added = np.asarray(values.get("moment", OFF_CENTRE)), np.zeros_like(turn)
        for number in MOMENTS:
            # In a batch each entry has its own moment.
            if np.any(moment == number):
                added = np.where(moment == number, self._of(number, turn, values), added)
        return np.asarray(signal + channels_of(warm * added.real, warm * added.imag))

    def _of(self, moment: float, turn: Array, values: Parameters) -> Array:
        """What is seen of a moment; of the second what displacements do as they are, the rest to leading order."""
        if moment != OFF_CENTRE:
            return self._leading(moment, turn, values)
        uneven, product = np.asarray(values.get("uneven", 0.0)), np.asarray(values["product_mm2"])
        still, moved = self.poses({**values, "product_mm2": (1.0 - uneven) * product})
        # Tilts alone turn no angle that offset, gain and phase do not: only what they do with a displacement counts.
        still = pose_of(self.field.assembly.placement) + still
        added = self.field.of(turn, still + moved) - self.field.of(turn, still)
        return added + uneven * self._leading(moment, turn, values) if np.any(uneven) else added

    def _leading(self, moment: float, turn: Array, values: Parameters) -> Array:
        """The field of a moment about the sensor's place, to leading order in its displacement."""
        share = self._per_mm2[moment] * np.asarray(values["product_mm2"])
        phase = np.exp(-1j * radians(values["phase_deg"]))
        return np.asarray(share * (np.conj(phase * turn) if moment == SENSOR_ALONE else phase * turn ** int(moment)))

    @cached_property
    def _per_mm2(self) -> Mapping[float, float]:
        """Field of each moment over that on the axis; the third of a block, else of the square about the magnet."""
        magnet, distance = self.field.assembly.magnet, float(self.field.assembly.distance_mm)
        side = magnet.diameter_mm
        square = Magnet(shape="block", length_mm=side, width_mm=side, height_mm=magnet.height_mm)
        third = third_moment_per_mm2(magnet if magnet.shape == "block" else square, distance)
        second = self.field.second_per_mm2
        return {SENSOR_ALONE: -0.5 * second, OFF_CENTRE: second, NOT_ROUND: third}

    def displaces(self, values: Parameters) -> bool:
        """Whether it is the displacements of a round magnet, which have a pose."""
        return bool(np.all(np.asarray(values.get("moment", OFF_CENTRE)) == OFF_CENTRE))

    def poses(self, values: Parameters) -> tuple[Pose, Pose]:
        """The tilts that stand beside the displacements, and what is added where sensor, or both, are off the axis."""
        return _poses(values, self.field.shift_of_tilt_mm)


def pose_of(placement: Placement) -> Pose:
    """Where a placement has sensor and magnet."""
    tilts = {
        name: (np.radians(getattr(placement, f"{name}_x_deg")), np.radians(getattr(placement, f"{name}_y_deg")))
        for name in ("sensor_tilt", "magnet_tilt")
    }
    sensor = complex(placement.sensor_x_mm, placement.sensor_y_mm)
    return Pose(sensor, complex(placement.magnet_x_mm, placement.magnet_y_mm), **tilts)


def _poses(values: Parameters, shift_of_tilt_mm: tuple[complex, complex]) -> tuple[Pose, Pose]:
    """The tilts that stand beside the displacements; and what is added where sensor, or both, are off the axis.

    The magnet's displacement is that of its field at the sensor, which a tilt displaces too: so a tilt leaves the
    product of the displacements alone, which is what a sweep shows.
    """
    tilts = {
        name: (radians(values.get(f"{name}_x_deg", 0.0)), radians(values.get(f"{name}_y_deg", 0.0)))
        for name in ("sensor_tilt", "magnet_tilt")
    }
    product, ratio = np.asarray(values["product_mm2"]), np.exp(np.asarray(values["log_ratio"]))
    direction = radians(values["direction_deg"])
    towards = np.exp(1j * direction)
    # A product below zero is one above it half a turn on.
    away = np.exp(1j * (direction - radians(values["phase_deg"]))) * np.sign(product)
    size = np.sqrt(np.abs(product))
    tilted = sum(shift * tilt for shift, tilt in zip(shift_of_tilt_mm, tilts["magnet_tilt"], strict=True))
    sensor = np.asarray(values["off_axis_mm"]) + size * np.sqrt(ratio)
    lean = radians(values["tilt_deg"]) * towards
    return Pose(magnet=-tilted, **tilts), Pose(sensor * towards, size / np.sqrt(ratio) * away, lean=lean)


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [*shapes_of_round(motion), *_of_moment(NOT_ROUND, motion)]


def shapes_of_round(motion: Motion) -> Sequence[Mapping[str, float]]:
    """Those that a round magnet has."""
    # Half a turn of both displacements changes nothing.
    both = [
        {"moment": OFF_CENTRE, "direction_deg": float(direction), "log_ratio": float(np.log(ratio))}
        for ratio in (0.5, 1.0, 2.0)
        for direction in np.arange(-90.0, 90.0, 30.0)
    ]
    return [*both, *_of_moment(SENSOR_ALONE, motion)]


def _of_moment(moment: float, motion: Motion) -> Sequence[Mapping[str, float]]:
    """The one shape of a moment that in an angle alone, at one gap, does what gain and phase do."""
    shown = not motion.provides.isdisjoint({"vx", "two air gaps"})
    return [{"moment": moment, "direction_deg": 0.0, "log_ratio": 0.0}] if shown else []


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Both displaced, alike, by what turns the field by the strength."""
    return {
        "moment": np.full(strength_deg.size, OFF_CENTRE),
        "uneven": np.zeros(strength_deg.size),
        "off_axis_mm": np.zeros(strength_deg.size),
        "tilt_deg": np.zeros(strength_deg.size),
        "product_mm2": np.minimum(radians(strength_deg) / USUAL.turn_per_mm2, 1.0),
    }


def derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    """The displacements: of the sensor, and where it is off too, of the magnet's field at the sensor, and their mean.

    The mean is the geometric one.
    """
    mean = float(np.sqrt(np.abs(values["product_mm2"])))
    if values.get("moment", OFF_CENTRE) != OFF_CENTRE:
        return {"sensor_displacement_mm": (mean, mean, mean, "mm")}
    share = float(np.exp(0.5 * values["log_ratio"]))
    figures = {
        "displacement_mm": mean,
        "sensor_displacement_mm": float(values["off_axis_mm"]) + mean * share,
        "field_displacement_mm": mean / share,
    }
    return {name: (value, value, value, "mm") for name, value in figures.items()}


def at_magnet(assembly: Assembly) -> Effect:
    """The effect in the field of a described magnet."""
    forward = Misplaced(UnevenField(assembly), described=True)
    own = shapes if assembly.magnet.shape == "block" else shapes_of_round
    return replace(MAGNET_MISALIGNMENT, forward=forward, shapes=own, assumes="")


def _shape(unit: str, bound: float, doc: str, **about: Any) -> Param:
    return Param(unit=unit, null=0.0, lower=-bound, upper=bound, doc=doc, role="shape", aside=True, **about)


def _tilt(doc: str, *, mirror: Any) -> Param:
    return _shape("deg", 30.0, doc, typical=2.0, prior_sd=TOLERANCE_DEG, prior_mean=0.0, mirror=mirror)


MAGNET_MISALIGNMENT = Effect(
    name="magnet_misalignment",
    stage="magnet",
    acts_on="channels",
    params={
        "moment": Param(
            unit="1",
            null=OFF_CENTRE,
            lower=SENSOR_ALONE,
            upper=NOT_ROUND,
            doc="of the magnet about the shaft; 1: of any, 2: it is off the axis too, 3: it is not round",
            role="shape",
            counts=True,
            typical=1.0,
            aside=True,
        ),
        "uneven": Param(
            unit="1",
            null=0.0,
            lower=0.0,
            upper=1.0,
            doc="share of moment 2 that one side's strength has, not a displacement",
            role="shape",
            typical=0.5,
            # Either may be most of it.
            prior_mean=0.5,
            prior_sd=0.5,
            aside=True,
        ),
        "off_axis_mm": Param(
            unit="mm",
            null=0.0,
            lower=0.0,
            upper=2.0,
            doc="sensor off the shaft's axis",
            role="level",
            typical=0.3,
            aside=True,
        ),
        "tilt_deg": Param(
            unit="deg",
            null=0.0,
            lower=-45.0,
            upper=45.0,
            doc="sensor's normal against the shaft's axis, towards the displacement",
            role="level",
            typical=5.0,
            aside=True,
        ),
        "direction_deg": _shape(
            "deg",
            360.0,
            "displacement's, from the sensor's x",
            typical=30.0,
            prior_sd=180.0 / float(np.sqrt(12.0)),
            mirror=-1,
        ),
        "product_mm2": Param(
            unit="mm2",
            null=0.0,
            lower=0.0,
            upper=4.0,
            doc="sensor's displacement times that of the magnet's field, where both are off the axis; of moments 1 "
            "and 3 the sensor's, squared",
            typical=0.05,
        ),
        "phase_deg": Param(
            unit="deg",
            null=0.0,
            lower=-360.0,
            upper=360.0,
            doc="from the direction of the magnet's displacement to that of the sensor's; of moments 1 and 3 "
            "twice that of the sensor's, of 3 from the magnet's sides",
            role="phase",
            mirror=-1,
        ),
        "log_ratio": _shape(
            "1", 2.0, "log of the sensor's over the magnet's displacement", prior_sd=np.log(WITHIN), prior_mean=0.0
        ),
        "sensor_tilt_x_deg": _tilt("sensor's tilt about x, beside it", mirror=-1),
        "sensor_tilt_y_deg": _tilt("sensor's tilt about y, beside it", mirror=1),
        "magnet_tilt_x_deg": _tilt("magnet's tilt about x of the shaft", mirror=-1),
        "magnet_tilt_y_deg": _tilt("magnet's tilt about y of the shaft", mirror=1),
    },
    forward=Misplaced(USUAL),
    # In an angle alone its order 1 is an offset's, and of its higher orders so little is left that they fit anything.
    needs=frozenset({"vx|two air gaps", "one turn"}),
    shapes=shapes,
    fitted_shapes=(
        *("direction_deg", "log_ratio", "uneven"),
        *("sensor_tilt_x_deg", "sensor_tilt_y_deg", "magnet_tilt_x_deg", "magnet_tilt_y_deg"),
    ),
    repeatable=True,
    drawing=drawing,
    derived=derived,
    at_magnet=at_magnet,
    assumes="a cylinder of 6 mm x 2.5 mm at an air gap of 1.5 mm",
    source="field of a diametral cylinder off its axis: Caciagli et al., J. Magn. Magn. Mater. 456 (2018) 423; its "
    "series: Jackson, Classical Electrodynamics, 3rd ed., section 3.7; counted for 6 mm x 2.5 mm at 1.5 mm where no "
    "magnet is described, typical assumptions",
    signature="sensor alone: order 2, quadratic in the displacement, the same as gain_mismatch + phase; with the "
    "magnet: order 1, with the product of both, the same as offset + reference_eccentricity; before a magnet that is "
    "not round: order 2, quadratic, the same as gain_mismatch + phase + cardan_coupling",
)
