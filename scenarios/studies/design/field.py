"""Many designs through one chain: magnets and placements as arrays, the sensor's effects scaled to each one's field."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from twin.air_gap import ratios_of, restated
from twin.angles import Array, channels_of
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import BoolArray, Effect
from twin.magnet.assembly import Assembly
from twin.magnet.field import Series, basis, series_by_group
from twin.magnet.magnet_misalignment import Misplaced
from twin.magnet.placement import Placement, designs_of
from twin.magnet.uneven_field import Pose
from twin.mechanics.zero import ZERO
from twin.motion import NOMINAL_C, Motion
from twin.parts import Parts

TOLERANCE = 1e-7
"""Of the field's series, relative to the smallest |B|: 6e-6 deg."""
_CONVERTER = frozenset({"adc", "cordic"})
"""Stage of the effects that are counted in the converter's range."""


@dataclass(frozen=True, eq=False)
class Designs(Assembly):
    """An assembly whose magnet and placement hold (designs,) numbers each; signals become (designs, 2, n)."""

    def __post_init__(self) -> None:
        """Many designs are what this is for."""

    @cached_property
    def count(self) -> int:
        """How many designs there are."""
        return int(np.prod(designs_of(self.magnet, self.placement)))

    @cached_property
    def groups(self) -> tuple[tuple[BoolArray, Series], ...]:
        """Designs of equal cost: a mask (designs,) and their series at 25 C [mT], stray field included."""
        return tuple(series_by_group(self.magnet, self.placement, temperature_c=NOMINAL_C, tolerance=TOLERANCE))

    @cached_property
    def nominal_mT(self) -> Any:
        """Field (designs,) [mT] on the axis, untilted, without stray field, at 25 C."""
        ideal = Placement(air_gap_mm=np.broadcast_to(self.placement.air_gap_mm, (self.count,)))
        out = np.empty(self.count)
        for rows, series in series_by_group(self.magnet, ideal, temperature_c=NOMINAL_C):
            out[rows] = series.coefficients[:, 0, 1]
        return out

    @cached_property
    def stray_in_sensor_mT(self) -> Array:
        """The stray field in the sensor's axes (designs, 3) [mT]."""
        axes = self.placement.sensor_axes
        seen = np.einsum("...j,...jk->...k", self.placement.stray_mT, axes)
        return np.broadcast_to(seen, (self.count, 3))

    def warm(self, temperature_c: Array) -> Array:
        """Magnetisation at these temperatures (n,) over that at 25 C: (designs, n)."""
        columns: dict[str, Any] = {
            name: None if (value := getattr(self.magnet, name)) is None else np.asarray(value)[..., None]
            for name in ("remanence_T", "percent_per_K")
        }
        magnet = replace(self.magnet, **columns)
        share = magnet.remanence_at(temperature_c) / magnet.remanence_at(NOMINAL_C)
        return np.broadcast_to(share, (self.count, np.size(temperature_c)))

    def channels(self, angle_rad: Array, motion: Motion) -> Array:
        """x and y (designs, 2, n) of nominal amplitude 1 at field angles [rad] (2, n) or (designs, 2, n)."""
        angle = np.broadcast_to(angle_rad, (self.count, *angle_rad.shape[-2:]))
        warm, stray = self.warm(motion.temperature_c), self.stray_in_sensor_mT[:, :, None]
        out = np.empty(angle.shape)
        for rows, series in self.groups:
            for axis in (0, 1):
                out[rows, axis] = _along(series.coefficients[:, axis], angle[rows, axis])
        out = (out - stray[:, :2]) * warm[:, None] + stray[:, :2]
        amplitude: Array = self.nominal_mT[:, None, None]
        return channels_of(out[:, :1], out[:, 1:]) / amplitude

    def in_plane_mT(self, angle_rad: Array) -> Array:
        """The magnet's own in-plane field (designs, n) [mT] at 25 C over shaft angles (n,)."""
        out = np.empty((self.count, angle_rad.size))
        for rows, series in self.groups:
            own = series.coefficients[:, :2].copy()
            own[:, :, 0] -= self.stray_in_sensor_mT[rows, :2]
            out[rows] = np.linalg.norm(own @ basis(angle_rad, series.orders), axis=1)
        return out

    def spread(self, count: int, change: Callable[[Placement], Placement]) -> Designs:
        """Each design ``count`` times in a row, then with its placement changed."""
        return Designs(_each(self.magnet, count, self.count), change(_each(self.placement, count, self.count)))


@dataclass(frozen=True, eq=False)
class Misplacing(Designs):
    """Designs in which sensor and magnet sit off their place by ``moved``, beside the tilts of ``still``.

    The tilts by themselves act as the twin's own offset, gain and phase: see :class:`Misplaced`.
    """

    still: Pose = field(default_factory=Pose)
    moved: Pose = field(default_factory=Pose)

    def channels(self, angle_rad: Array, motion: Motion) -> Array:
        """See :meth:`Designs.channels`."""
        there, back = (
            Designs(self.magnet, moved_by(self.placement, pose)) for pose in (self.still + self.moved, self.still)
        )
        added = there.channels(angle_rad, motion) - back.channels(angle_rad, motion)
        return super().channels(angle_rad, motion) + added


def moved_by(placement: Placement, pose: Pose) -> Placement:
    """Placements with sensor and magnet off by a pose of single numbers."""
    sensor, magnet, lean = (complex(part) for part in (pose.sensor, pose.magnet, pose.lean))
    changes = {"sensor_x_mm": sensor.real, "sensor_y_mm": sensor.imag}
    changes |= {"magnet_x_mm": magnet.real, "magnet_y_mm": magnet.imag}
    # A normal leans towards x by a turn about y.
    own = (pose.sensor_tilt[0] - lean.imag, pose.sensor_tilt[1] + lean.real)
    for name, tilt in (("sensor_tilt", own), ("magnet_tilt", pose.magnet_tilt)):
        changes |= {f"{name}_{axis}_deg": float(np.degrees(part)) for axis, part in zip("xy", tilt, strict=True)}
    return replace(placement, **{name: getattr(placement, name) + change for name, change in changes.items()})


def misplaced(chain: Chain, designs: Designs) -> tuple[Designs, frozenset[str]]:
    """The designs with what the chain's effects displace, and the keys of these effects."""
    for key, params in chain.values.items():
        effect = find(key, chain.effects)
        if isinstance(effect.forward, Misplaced) and effect.forward.displaces(params) and not effect.is_null(params):
            still, moved = effect.forward.poses({**effect.null(), **params})
            return Misplacing(designs.magnet, designs.placement, still, moved), frozenset({key})
    return designs, frozenset()


def _along(terms: Array, angle: Array) -> Array:
    """One component (designs, n) of series (designs, 2 orders + 1) at each design's own angles (designs, n)."""
    # Horner's rule in exp(i theta), as Series.component has it for one design.
    z = np.exp(1j * angle)
    total = np.zeros(angle.shape, dtype=np.complex128)
    for order in range((terms.shape[1] - 1) // 2, 0, -1):
        total = (total + (terms[:, 2 * order - 1] - 1j * terms[:, 2 * order])[:, None]) * z
    return np.asarray(terms[:, :1] + total.real)


def _each(part: Any, count: int, designs: int) -> Any:
    changes = {}
    for item in fields(part):
        value = getattr(part, item.name)
        if value is not None and not isinstance(value, str):
            changes[item.name] = np.repeat(np.broadcast_to(np.asarray(value, dtype=np.float64), (designs,)), count)
    return replace(part, **changes)


def scaled_values(chain: Chain, magnet: Assembly) -> dict[str, dict[str, Any]]:
    """The chain's parameters, stated at its own magnet, at the field and distance of another or of many (designs,).

    They go with both as their effects declare. The converter's range alone is taken to follow the signal: its gain is
    set for the field, by hand or by itself.
    """
    assert chain.magnet is not None
    ratios = ratios_of(magnet, chain.magnet)
    scaled: dict[str, dict[str, Any]] = {}
    for key, params in chain.values.items():
        effect = find(key, chain.effects)
        # What is not stated is at the twin's own magnet, too: the field that a stray one is counted against.
        scaled[key] = restated(effect, params, names=followed(effect), ratios=ratios)
    return scaled


def followed(effect: Effect) -> tuple[str, ...]:
    """The parameters of an effect that follow the field or the distance; the converter's range follows the signal."""
    return () if effect.stage in _CONVERTER else effect.follow_field


def errors_deg(chain: Chain, designs: Designs, motion: Motion) -> Array:
    """Expected angle error (designs, n) [deg] of the chain with each design's magnet, its zero set at 25 C."""
    return zeroed_deg(in_designs(chain, designs).error(motion), motion)


def in_designs(chain: Chain, designs: Designs) -> Chain:
    """The chain with each design's magnet, its effects at that one's field.

    ``chain`` has a magnet: its nominal field is what the chain's parameters are stated at.
    """
    placed, keys = misplaced(chain, designs)
    return replace(chain, values=scaled_values(chain.without(*keys), designs), magnet=placed)


def cause_errors(chain: Chain, designs: Designs, motion: Motion) -> Iterator[tuple[str, Array]]:
    """Cause and its error alone (designs, n) [deg]: the magnet's field first, then each effect on an ideal field."""
    bare = replace(chain, values={}, magnet=designs, parts=Parts())
    yield "field", zeroed_deg(bare.error(motion), motion)
    for name in [part.name for part in chain.described]:
        described = replace(chain, values={}, magnet=designs, parts=chain.parts.only(name))
        yield name, zeroed_deg(described.error(motion) - bare.error(motion), motion)
    placed, keys = misplaced(chain, designs)
    for key in keys:
        yield key, zeroed_deg(replace(bare, magnet=placed).error(motion) - bare.error(motion), motion)
    for key, params in scaled_values(chain.without(*keys), designs).items():
        effect = find(key, chain.effects)
        # Taken off like the zero, or no part of an expected reading.
        if effect is ZERO or effect.footprint == "spread":
            continue
        alone = replace(chain, values={key: params}, magnet=None, parts=Parts())
        error = np.broadcast_to(alone.error(motion), (designs.count, len(motion)))
        yield key, zeroed_deg(error, motion)


def zeroed_deg(error_rad: Array, motion: Motion) -> Array:
    """Errors (designs, n) [rad] in degrees, without their mean over the readings at 25 C: that is calibrated away."""
    calibrated = np.abs(motion.temperature_c - NOMINAL_C) < 1e-9
    mean = np.angle(np.mean(np.exp(1j * error_rad[..., calibrated]), axis=-1, keepdims=True))
    return np.asarray(np.degrees((error_rad - mean + np.pi) % (2.0 * np.pi) - np.pi))
