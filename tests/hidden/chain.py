"""One reading after another through mechanics, magnet, concentrator, Hall, converter, CORDIC and link."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from . import channel_causes as channel
from . import current_causes as current
from . import period_causes as periods
from . import shaft_causes as shaft
from . import structures
from . import word_causes as word
from .baseline import Baseline, Injected
from .motion import Array, Motion
from .noise import Noise

# in each stage the order of the entries is the physical order
SHAFT: dict[str, Callable[[Array, Motion, Injected], Array]] = {
    "latency": shaft.latency,
    "time_jitter": shaft.time_jitter,
    "drive_ripple": shaft.drive_ripple,
    "motor_poles": periods.motor_poles,
    "cardan_coupling": shaft.cardan_coupling,
    "load_torsion": current.load_torsion,
    "backlash": shaft.backlash,
    "bearing_wobble": shaft.bearing_wobble,
    "zero_drift": shaft.zero_drift,
    "magnet_harmonic": shaft.magnet_harmonic,
    "hysteresis": shaft.hysteresis,
}
REFERENCE: dict[str, Callable[[Motion, Injected], Array]] = {
    "reference_eccentricity": shaft.reference_eccentricity,
    "reference_rezero": shaft.reference_rezero,
    "index_slip": shaft.index_slip,
}
PHASE: dict[str, Callable[[Motion, Baseline, Injected], Array]] = {
    "phase_drift": channel.phase_drift,
    "xy_skew": channel.xy_skew,
}
HALL: dict[str, Callable[[channel.Channels, Motion, Injected], channel.Channels]] = {
    "gain_drift": channel.gain_drift,
    "offset_drift": channel.offset_drift,
    "mains_pickup": channel.mains_pickup,
}
CONVERTER: dict[str, Callable[[channel.Channels, Motion, Injected], channel.Channels]] = {
    "reference_ripple": channel.reference_ripple,
    "reference_jitter": channel.reference_jitter,
    "clipping": channel.clipping,
    "adc_stuck_bit": channel.adc_stuck_bit,
}


@dataclass(frozen=True)
class Bench:
    """All of a draw but its causes."""

    motion: Motion
    baseline: Baseline
    noise: Noise
    output_bits: int
    channels: bool
    """The two channels are recorded."""
    channel_scale: float
    """Recorded unit over nominal amplitude."""
    channel_step: float
    """Rounding of the recorded channels, in the recorded unit."""


@dataclass(frozen=True)
class Readings:
    """What the bench got, shape (n,) each."""

    reference_deg: Array
    """Unwrapped."""
    x: Array
    y: Array
    """As recorded."""
    exact_deg: Array
    """m before CORDIC, rounding and link: h atan2(y, x)."""
    word_deg: Array
    """m as sent."""
    noise_deg: Array
    """What the noise alone did to the angle."""


def noise_parts(bench: Bench, rng: np.random.Generator, causes: Sequence[Injected]) -> tuple[Array, Array]:
    """Noise of two equal processes in degrees, shape (n,) each."""
    rows = len(bench.motion.time_s)
    factor = np.ones(rows)
    for injected in causes:
        if injected.name in structures.STRUCTURES:
            factor = factor * structures.noise_factor(rows, injected)
    return factor * bench.noise.sample(rng, rows), factor * bench.noise.sample(rng, rows)


def field_channels(bench: Bench, causes: Sequence[Injected]) -> channel.Channels:
    """The channels up to and with the Hall stage, without noise."""
    motion, own = bench.motion, bench.baseline
    by_name = {injected.name: injected for injected in causes}
    turned = motion.shaft_deg
    for name, bend in SHAFT.items():
        if name in by_name:
            turned = bend(turned, motion, by_name[name])
    for name in structures.STRUCTURES:
        if name in by_name:
            turned = turned + structures.added(motion, by_name[name])

    extra_deg = np.full_like(turned, own.phase_deg)
    for name, ahead in PHASE.items():
        if name in by_name:
            extra_deg = extra_deg + ahead(motion, own, by_name[name])
    angle = _told(np.radians(own.sense * turned + own.zero_deg), by_name)
    cosine, sine = current.motor_field((np.cos(angle), np.sin(angle + np.radians(extra_deg))), by_name)
    if "saturation" in by_name:
        cosine = channel.saturation(cosine, by_name["saturation"])
        sine = channel.saturation(sine, by_name["saturation"])
    x = own.offset_x + own.amplitude_x * (cosine + own.quadratic * cosine**2)
    y = own.offset_y + own.amplitude_y * (sine + own.quadratic * sine**2)
    for name, change in HALL.items():
        if name in by_name:
            x, y = change((x, y), motion, by_name[name])
    return x, y


def _told(angle: Array, by_name: Mapping[str, Injected]) -> Array:
    """The field's angle as a sensor of one period would have it to read what one of several periods does."""
    return periods.multipole(angle, by_name["multipole"]) if "multipole" in by_name else angle


def reference(bench: Bench, causes: Sequence[Injected]) -> Array:
    """The reference's reading, unwrapped, degrees."""
    read = bench.motion.shaft_deg
    for injected in causes:
        if injected.name in REFERENCE:
            read = read + REFERENCE[injected.name](bench.motion, injected)
    return read


def convert(bench: Bench, channels: channel.Channels, causes: Sequence[Injected]) -> channel.Channels:
    """The converter's causes on the channels."""
    by_name = {injected.name: injected for injected in causes}
    for name, change in CONVERTER.items():
        if name in by_name:
            channels = change(channels, bench.motion, by_name[name])
    return channels


def sample(bench: Bench, causes: Sequence[Injected], rng: np.random.Generator) -> Readings:
    """A recorded sweep."""
    by_name = {injected.name: injected for injected in causes}
    clean = field_channels(bench, causes)
    first, second = noise_parts(bench, rng, causes)
    free = clean[0] + 1j * clean[1]
    if bench.channels:
        # every channel has its own noise, the same in both
        size = 0.5 * (bench.baseline.amplitude_x + bench.baseline.amplitude_y)
        noisy = free + size * (np.radians(first) + 1j * np.radians(second))
    else:
        noisy = free * np.exp(1j * np.radians(first))
    noise_deg = np.degrees(np.angle(noisy * np.conj(free)))
    x, y = convert(bench, (noisy.real, noisy.imag), causes)

    shown_x, shown_y = x * bench.channel_scale, y * bench.channel_scale
    if bench.channels:
        step = bench.channel_step
        shown_x, shown_y = np.round(shown_x / step) * step, np.round(shown_y / step) * step
        x, y = shown_x, shown_y

    sense = bench.baseline.channel_sense
    exact = sense * np.degrees(np.arctan2(y, x))
    angle = exact
    if "cordic_truncation" in by_name:
        iterations = int(by_name["cordic_truncation"].parameters["iterations"])
        angle = sense * word.cordic((x, y), iterations)

    words = word.to_words(angle, bench.output_bits)
    if "stale_frames" in by_name:
        stale = by_name["stale_frames"]
        words = word.repeat_frames(words, stale).astype(np.int64)
        if stale.hidden["whole_frame"][0]:
            shown_x = word.repeat_frames(shown_x, stale).astype(np.float64)
            shown_y = word.repeat_frames(shown_y, stale).astype(np.float64)
    if "bus_glitch" in by_name:
        words = word.flip_bits(words, bench.output_bits, by_name["bus_glitch"])
    return Readings(
        reference_deg=reference(bench, causes),
        x=shown_x,
        y=shown_y,
        exact_deg=exact,
        word_deg=words * (360.0 / 2**bench.output_bits),
        noise_deg=noise_deg,
    )
