"""A sensor on a shaft: where a physical mechanism acts in it, and how it is read, sample by sample."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..baseline import Baseline
from ..channel_causes import Channels
from ..motion import Array, Motion
from ..word_causes import Words, to_words

AngleAt = Callable[[Array], Array]
"""What the sensor's field angle is, in unwrapped degrees, where the shaft stands at so many degrees."""


@dataclass(frozen=True)
class Mechanism:
    """The stages that physics changes; a stage left out is ideal.

    Angles in degrees, channels in nominal amplitudes, arrays of shape (n,), one entry per reading in the order taken.
    """

    shaft: Callable[[Array, Motion], Array] | None = None
    """The magnet's angle from the reference's."""
    field: Callable[[Array], Channels] | None = None
    """Field on the sensor, mean amplitude 1, from the magnet's angle to the sensor's axes in radians."""
    disk: Callable[[Channels], Channels] | None = None
    """What a concentrator gathers of the field, whatever plates are below it."""
    axes: Callable[[Channels, Motion], Channels] | None = None
    """How the plates' axes lie in the field."""
    plates: Callable[[Channels], Channels] | None = None
    """What answers to the field along each channel's own axis."""
    electric: Callable[[Channels, Motion], Channels] | None = None
    """Plates and amplifiers, after offset, gain and phase."""
    convert: Callable[[Channels, Motion], Channels] | None = None
    """The converter, after the noise."""
    compute: Callable[[Channels], Array] | None = None
    """The angle of the converted channels."""
    follow: Callable[[AngleAt, Motion], Array] | None = None
    """A filter or loop on the angle; given what it follows at any position of the shaft."""
    words: Callable[[Words, int, Motion, np.random.Generator], Words] | None = None
    """The link, given the bits of a word."""
    reference: Callable[[Motion, np.random.Generator], Array] | None = None
    """Added to what the reference reads."""
    noise: Callable[[np.random.Generator, Motion], Array] | None = None
    """Noise in place of white noise, in units of the bench's noise."""


IDEAL = Mechanism()


@dataclass(frozen=True)
class Device:
    """A mechanism in a sensor of the paper's error model."""

    baseline: Baseline
    mechanism: Mechanism
    output_bits: int
    channels: bool
    """The two channels are recorded."""
    channel_step: float = 2.0**-15
    """Rounding of the recorded channels, nominal amplitudes."""

    def without(self) -> Device:
        """The same with nothing but the error model."""
        return replace(self, mechanism=IDEAL)


@dataclass(frozen=True)
class Record:
    """What the bench got, shape (n,) each."""

    reference_deg: Array
    x: Array
    y: Array
    word_deg: Array
    noise_deg: Array
    """What the noise alone did to the angle."""


def sensed(device: Device, shaft_deg: Array, motion: Motion) -> Channels:
    """The channels without noise, where the shaft stands at these angles."""
    own, acts = device.baseline, device.mechanism
    turned = shaft_deg if acts.shaft is None else acts.shaft(shaft_deg, motion)
    angle = np.radians(own.sense * turned + own.zero_deg)
    bx, by = (np.cos(angle), np.sin(angle)) if acts.field is None else acts.field(angle)
    if acts.disk is not None:
        bx, by = acts.disk((bx, by))
    beta = np.radians(own.phase_deg)
    by = by * np.cos(beta) + bx * np.sin(beta)
    if acts.axes is not None:
        bx, by = acts.axes((bx, by), motion)
    if acts.plates is not None:
        bx, by = acts.plates((bx, by))
    x = own.offset_x + own.amplitude_x * (bx + own.quadratic * bx**2)
    y = own.offset_y + own.amplitude_y * (by + own.quadratic * by**2)
    return x, y


def followed(device: Device, motion: Motion) -> Array | None:
    """By how much a loop or filter is behind, degrees; None where there is none."""
    if device.mechanism.follow is None:
        return None

    def angle_at(shaft_deg: Array) -> Array:
        x, y = sensed(replace(device, mechanism=replace(device.mechanism, shaft=None)), shaft_deg, motion)
        return np.degrees(np.unwrap(np.arctan2(y, x)))

    return device.mechanism.follow(angle_at, motion)


def electrical(device: Device, motion: Motion) -> Channels:
    """The channels ahead of the converter, without noise."""
    x, y = sensed(device, motion.shaft_deg, motion)
    return (x, y) if device.mechanism.electric is None else device.mechanism.electric((x, y), motion)


def sent_deg(device: Device, motion: Motion) -> Array:
    """The angle of each reading without noise and rounding, in degrees, as the sensor counts it."""
    channels = electrical(device, motion)
    if device.mechanism.convert is not None:
        channels = device.mechanism.convert(channels, motion)
    return _computed(device, channels, motion)


def _computed(device: Device, channels: Channels, motion: Motion) -> Array:
    """The angle of the converted channels, computed and followed."""
    compute = device.mechanism.compute
    angle = np.degrees(np.arctan2(channels[1], channels[0])) if compute is None else compute(channels)
    behind = followed(device, motion)
    return device.baseline.channel_sense * (angle if behind is None else angle + behind)


def record(device: Device, motion: Motion, noise_deg: float, rng: np.random.Generator) -> Record:
    """Read the device at every row of a motion."""
    acts, rows = device.mechanism, len(motion.time_s)
    process = acts.noise if acts.noise is not None else lambda one, moved: one.standard_normal(len(moved.time_s))
    first, second = (np.radians(noise_deg * process(rng, motion)) for _ in range(2))
    clean = electrical(device, motion)
    free = clean[0] + 1j * clean[1]
    # with channels each has its own noise; without, what the angle would have of it
    noisy = free + first + 1j * second if device.channels else free * np.exp(1j * first)
    x, y = noisy.real, noisy.imag
    if acts.convert is not None:
        x, y = acts.convert((x, y), motion)
    if device.channels:
        x, y = (np.round(one / device.channel_step) * device.channel_step for one in (x, y))
    words = to_words(_computed(device, (x, y), motion), device.output_bits)
    if acts.words is not None:
        words = acts.words(words, device.output_bits, motion, rng)
    added = np.zeros(rows) if acts.reference is None else acts.reference(motion, rng)
    return Record(
        reference_deg=motion.shaft_deg + added,
        x=x,
        y=y,
        word_deg=words * (360.0 / 2**device.output_bits),
        noise_deg=np.degrees(np.angle(noisy * np.conj(free))),
    )
