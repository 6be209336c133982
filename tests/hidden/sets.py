"""The sets of draws that a study is made of."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from .catalogue import CAUSES
from .generator import Hidden, draw
from .streams import derived_seed
from .structures import STRUCTURES

PAIRS = (
    ("saturation", "hysteresis"),
    ("saturation", "drive_ripple"),
    ("saturation", "output_quantisation"),
    ("magnet_harmonic", "backlash"),
    ("magnet_harmonic", "bearing_wobble"),
    ("magnet_harmonic", "clipping"),
    ("cardan_coupling", "reference_eccentricity"),
    ("latency", "xy_skew"),
    ("latency", "hysteresis"),
    ("offset_drift", "phase_drift"),
    ("gain_drift", "hysteresis"),
    ("mains_pickup", "latency"),
    ("reference_ripple", "magnet_harmonic"),
    ("reference_rezero", "saturation"),
    ("zero_drift", "bus_glitch"),
    ("index_slip", "drive_ripple"),
    ("stale_frames", "bearing_wobble"),
    ("reference_jitter", "magnet_harmonic"),
    ("adc_stuck_bit", "hysteresis"),
    ("cordic_truncation", "saturation"),
    ("reference_eccentricity", "saturation"),
    ("zero_drift", "hysteresis"),
)
TRIPLES = (
    ("saturation", "hysteresis", "drive_ripple"),
    ("saturation", "hysteresis", "bus_glitch"),
    ("saturation", "latency", "xy_skew"),
    ("cardan_coupling", "reference_eccentricity", "saturation"),
    ("offset_drift", "gain_drift", "phase_drift"),
    ("offset_drift", "hysteresis", "saturation"),
    ("magnet_harmonic", "bearing_wobble", "reference_rezero"),
    ("magnet_harmonic", "backlash", "zero_drift"),
    ("magnet_harmonic", "mains_pickup", "latency"),
    ("reference_ripple", "latency", "hysteresis"),
    ("drive_ripple", "zero_drift", "bus_glitch"),
    ("index_slip", "drive_ripple", "saturation"),
    ("reference_jitter", "saturation", "bearing_wobble"),
    ("clipping", "magnet_harmonic", "hysteresis"),
    ("adc_stuck_bit", "magnet_harmonic", "stale_frames"),
    ("output_quantisation", "saturation", "hysteresis"),
)
BESIDE = (
    ("order_9_to_19", "saturation"),
    ("order_9_to_19", "hysteresis"),
    ("non_integer_order", "saturation"),
    ("non_integer_order", "index_slip"),
    ("local_bump", "magnet_harmonic"),
    ("local_bump", "drive_ripple"),
    ("direction_times_order", "hysteresis"),
    ("direction_times_order", "saturation"),
    ("temperature_times_order", "offset_drift"),
    ("temperature_times_order", "saturation"),
    ("time_frequency", "latency"),
    ("time_frequency", "magnet_harmonic"),
    ("noise_burst", "saturation"),
    ("noise_burst", "drive_ripple"),
    ("speed_squared_lag", "xy_skew"),
    ("speed_squared_lag", "saturation"),
)
"""A structure outside the catalogue and a cause beside it."""


@dataclass(frozen=True)
class Job:
    """One draw, as it can be made again."""

    group: str
    """The set."""
    label: str
    causes: tuple[str, ...]
    seed: int
    bench: str = "easy"
    strength: str = "normal"
    protocol: str | None = None
    structure: str | None = None

    def draw(self) -> Hidden:
        """Make it."""
        return draw(
            self.causes,
            seed=self.seed,
            bench=self.bench,
            strength=self.strength,
            protocol=self.protocol,
            structure=self.structure,
        )

    def command(self) -> str:
        """Options of the study command that write this draw to a file."""
        words = ["--make", "+".join(self.causes) or "clean", "--seed", str(self.seed)]
        words += ["--bench", self.bench, "--strength", self.strength]
        words += ["--protocol", self.protocol] if self.protocol else []
        words += ["--structure", self.structure] if self.structure else []
        return " ".join(words)

    def record(self) -> dict[str, object]:
        """For a JSON file."""
        return asdict(self)


@dataclass(frozen=True)
class Group:
    """A set: what is drawn under each label, and on which bench."""

    entries: tuple[tuple[tuple[str, ...], str | None], ...]
    """Causes and structure."""
    bench: str = "easy"
    strength: str = "normal"


ALONE: tuple[tuple[tuple[str, ...], str | None], ...] = tuple(((name,), None) for name in CAUSES)
GROUPS: dict[str, Group] = {
    "clean_easy": Group((((), None),)),
    "clean_hard": Group((((), None),), bench="hard"),
    "single": Group(ALONE),
    "weak": Group(ALONE, strength="weak"),
    "single_hard": Group(ALONE, bench="hard"),
    "pairs": Group(tuple((pair, None) for pair in PAIRS)),
    "triples": Group(tuple((triple, None) for triple in TRIPLES)),
    "unnamed": Group(tuple(((), name) for name in STRUCTURES)),
    "unnamed_with_cause": Group(tuple(((cause,), name) for name, cause in BESIDE)),
}


def jobs(group: str, *, draws: int, seed: int, only: frozenset[str] = frozenset()) -> list[Job]:
    """`draws` jobs for every label of a set, or for the labels that are all or hold one of `only`."""
    chosen = GROUPS[group]
    made = []
    for causes, structure in chosen.entries:
        parts = [*causes, *([structure] if structure else [])]
        label = " + ".join(parts) or "clean"
        if only and not only & {*parts, label}:
            continue
        made += [
            Job(
                group=group,
                label=label,
                causes=causes,
                seed=derived_seed(seed, group, label, str(number)),
                bench=chosen.bench,
                strength=chosen.strength,
                structure=structure,
            )
            for number in range(draws)
        ]
    return made
