"""Do the 95 % intervals of an answer hold what was put in?

The catalogue leaves some conventions open, and some figures no sweep can show. There truth and answer are brought to
common ground before they are compared (`common`); the generator's own conventions stay as they are:

* A common scale of both channels is never visible. The answer counts in amplitudes of x, the generator in nominal
  ones: levels, steps and additive signals are divided by the generator's amplitude of x.
* An offset and its drift stand ahead of the channel's gain in the answer, behind it in the generator: those of y are
  counted in amplitudes of y.
* One phase and an amplitude for each channel: (x, y, phase) is the same hum as (-x, -y, phase + 180 deg).
* Phases in time: the generator counts time as the file does, the answer from the first reading.
* The phase of an order that is no whole number depends on which turn is the first: the generator counts the shaft from
  the first reading, the answer from the reference's zero in the turn of that reading.
* A first-order drift: the generator gives the asymptote, the answer what was covered during the record.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

IN_AMPLITUDES = {
    "clipping": ("level_percent",),
    "adc_stuck_bit": ("step_percent",),
    "mains_pickup": ("x_percent", "y_percent"),
    "offset_drift": ("x_percent_per_K", "y_percent_per_K"),
}
"""Counted in amplitudes of x."""
WHOLE = frozenset(
    {
        "adc_stuck_bit.bit",
        "adc_stuck_bit.level",
        "bus_glitch.count",
        "cordic_truncation.iterations",
        "drive_ripple.order",
        "magnet_harmonic.order",
        "motor_poles.poles",
        "motor_poles.slots",
        "multipole.periods",
        "output_quantisation.bits",
        "output_quantisation.step_deg",
    }
)
"""Whole numbers, or one of a few values: smallest and largest not excluded, so they hold the truth more often."""
OF_A_POPULATION = frozenset({"reference_rezero.spread_deg", "stale_frames.fraction_percent"})
"""Intervals of a rate or a scatter, where the truth is what this very sweep drew from it."""
OFFSETS = frozenset({"Vx_over_Ax", "Vy_over_Ay"})
ANGLE_ONLY = frozenset(f"reference_ripple.{name}" for name in ("amplitude_percent", "delay_us", "phase_deg"))
"""Not told apart by an angle: the interval is then all that the others may make up for."""


def common(name: str, given: Mapping[str, Any], truth: Mapping[str, Any]) -> dict[str, float]:
    """The true parameters of a cause in the answer's conventions; `given` are the answer's parameters of it.

    Not every parameter has a truth: physics that is no formula defines some of them alone.
    """
    actual = {key: float(value) for key, value in truth["parameters"].get(name, {}).items()}
    frame = truth["frame"]
    for key in actual.keys() & IN_AMPLITUDES.get(name, ()):
        actual[key] /= frame["amplitude_x"]
    if "y_percent_per_K" in actual:
        actual["y_percent_per_K"] /= truth["baseline"]["gain_ratio"]
    if "x_percent" in actual and name == "mains_pickup":
        along = sum(actual[key] * float(given[key]["value"]) for key in ("x_percent", "y_percent"))
        if along < 0.0:
            actual |= {"x_percent": -actual["x_percent"], "y_percent": -actual["y_percent"]}
            actual["phase_deg"] += 180.0
    if "phase_deg" in actual and name in ("mains_pickup", "reference_ripple"):
        actual["phase_deg"] += 360.0 * actual["frequency_Hz"] * frame["first_time_s"]
    if "phase_deg" in actual and name == "bearing_wobble":
        actual["phase_deg"] -= actual["order"] * frame["first_reference_deg"]
    if name == "zero_drift" and "time_constant_s" in actual:
        actual["amplitude_deg"] *= -math.expm1(-frame["duration_s"] / actual["time_constant_s"])
    return actual


@dataclass(frozen=True)
class Interval:
    """A 95 % interval of an answer and the truth that it is held against, in the unit of the parameter."""

    truth: float
    value: float
    low: float
    high: float

    @property
    def miss(self) -> int:
        """0 where the interval holds the truth, else -1 or 1 as the truth lies below or above it."""
        # the file itself is rounded at the sixth digit
        slack = 1e-6 * max(abs(self.low), abs(self.high))
        return int(self.truth > self.high + slack) - int(self.truth < self.low - slack)

    @property
    def half_width(self) -> float:
        """Half the width."""
        return 0.5 * (self.high - self.low)

    def record(self) -> dict[str, float]:
        """For a JSON file."""
        return asdict(self)


def held(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> dict[str, Interval]:
    """The interval of every "cause.parameter" of the causes named as they are, and of every "baseline.factor".

    Parameters that only one side gives are passed over. What an angle alone does not tell carries ", angle only" behind
    its name; ", sense open" all of an answer that counts the other way round and says that the readings leave it open.
    """
    found = {**_of_causes(answer, truth), **_of_baseline(answer, truth)}
    behind = ", sense open" if _sense_open(answer, truth) else ""
    return {label + behind: interval for label, interval in found.items()}


def _of_causes(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> dict[str, Interval]:
    found = {}
    for entry in answer["causes"]:
        name = entry["name"]
        if name not in truth["parameters"]:
            continue
        actual = common(name, entry.get("parameters", {}), truth)
        for parameter, given in entry.get("parameters", {}).items():
            label = f"{name}.{parameter}"
            if label in ANGLE_ONLY and not truth["channels"]:
                label += ", angle only"
            interval = _interval(given, actual.get(parameter), turns=parameter.endswith("phase_deg"))
            if interval is not None:
                found[label] = interval
    return found


def _of_baseline(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> dict[str, Interval]:
    """The factors of the extended twin; none where a mechanism is no formula: it may do what factors do."""
    if "kind" in truth:
        return {}
    found = {}
    # the mean of what a stuck bit does, half a step, is an offset or the bit's, as one likes
    free = OFFSETS if "adc_stuck_bit" in truth["parameters"] else frozenset()
    for name, given in answer.get("extended", {}).get("parameters", {}).items():
        if name in free:
            continue
        interval = _interval(given, truth["baseline"].get(name), turns=name == "zero_deg")
        if interval is not None:
            found[f"baseline.{name}"] = interval
    return found


def _interval(given: Any, truth: float | None, *, turns: bool) -> Interval | None:
    """One figure of an answer against the truth, which is compared on the circle where it ``turns``."""
    if truth is None or not isinstance(given, Mapping) or given.get("low") is None or given.get("high") is None:
        return None
    low, high = float(given["low"]), float(given["high"])
    if turns:
        middle = 0.5 * (low + high)
        truth = middle + (truth - middle + 180.0) % 360.0 - 180.0
    return Interval(float(truth), float(given["value"]), low, high)


def _sense_open(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> bool:
    """Whether an answer counts the other way round than the truth and says that it may."""
    told, own = answer.get("senses"), truth["baseline"]
    if told is None or told["decided"]:
        return False
    return bool(
        (told["sensor"], told["output"]) != (own.get("sense", told["sensor"]), own.get("channel_sense", told["output"]))
    )


def measured(label: str) -> bool:
    """A continuous parameter that the sweep shows: of its intervals 95 % should hold the truth, no more and no less."""
    return label not in WHOLE | OF_A_POPULATION and not label.endswith(("angle only", "sense open"))


def chance(hits: int, total: int, share: float = 0.95) -> float:
    """Probability of so few hits or fewer if each comes with this probability."""
    log = math.log
    ways = (math.lgamma(total + 1) - math.lgamma(k + 1) - math.lgamma(total - k + 1) for k in range(hits + 1))
    terms = (math.exp(w + k * log(share) + (total - k) * log(1.0 - share)) for k, w in enumerate(ways))
    return min(sum(terms), 1.0)


def pooled(records: Iterable[Mapping[str, Interval]]) -> dict[str, list[Interval]]:
    """The intervals of each parameter; of all that are measured together ("all measured")."""
    found: dict[str, list[Interval]] = {}
    for record in records:
        for label, interval in record.items():
            for name in (label, "all measured") if measured(label) else (label,):
                found.setdefault(name, []).append(interval)
    return found
