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
from typing import Any

from rich.table import Table

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
        "output_quantisation.bits",
        "output_quantisation.step_deg",
    }
)
"""Whole numbers, or one of a few values: smallest and largest not excluded, so they hold the truth more often."""
OF_A_POPULATION = frozenset({"reference_rezero.spread_deg", "stale_frames.fraction_percent"})
"""Intervals of a rate or a scatter, where the truth is what this very sweep drew from it."""
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


def held(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> dict[str, bool]:
    """For "cause.parameter" of every cause named as it is: does its interval hold the truth?

    Phases are compared on the circle. Parameters that only one side gives are passed over. What an angle alone does
    not tell carries ", angle only" behind its name.
    """
    found = {}
    for entry in answer["causes"]:
        name = entry["name"]
        if name not in truth["parameters"]:
            continue
        actual = common(name, entry.get("parameters", {}), truth)
        for parameter, given in entry.get("parameters", {}).items():
            if parameter not in actual or not isinstance(given, Mapping):
                continue
            low, high = given.get("low"), given.get("high")
            if low is None or high is None:
                continue
            value = actual[parameter]
            if parameter.endswith("phase_deg"):
                middle = 0.5 * (low + high)
                value = middle + (value - middle + 180.0) % 360.0 - 180.0
            label = f"{name}.{parameter}"
            if label in ANGLE_ONLY and not truth["channels"]:
                label += ", angle only"
            # the file itself is rounded at the sixth digit
            found[label] = bool(low - 1e-6 * abs(low) <= value <= high + 1e-6 * abs(high))
    return found


def measured(label: str) -> bool:
    """A continuous parameter that the sweep shows: of its intervals 95 % should hold the truth, no more and no less."""
    return label not in WHOLE | OF_A_POPULATION and not label.endswith("angle only")


def chance(hits: int, total: int, share: float = 0.95) -> float:
    """Probability of so few hits or fewer if each comes with this probability."""
    log = math.log
    ways = (math.lgamma(total + 1) - math.lgamma(k + 1) - math.lgamma(total - k + 1) for k in range(hits + 1))
    terms = (math.exp(w + k * log(share) + (total - k) * log(1.0 - share)) for k, w in enumerate(ways))
    return min(sum(terms), 1.0)


def counted(records: Iterable[Mapping[str, bool]]) -> dict[str, tuple[int, int]]:
    """Hits and intervals of each parameter, and of all that are measured together ("all measured")."""
    counts: dict[str, tuple[int, int]] = {}
    for record in records:
        for label, inside in record.items():
            for name in (label, "all measured") if measured(label) else (label,):
                hits, total = counts.get(name, (0, 0))
                counts[name] = (hits + inside, total + 1)
    return counts


def table(records: Iterable[Mapping[str, bool]]) -> Table:
    """Share of intervals that held the truth, by cause and parameter, and the chance of so few at 95 %."""
    counts = counted(records)
    pooled = counts.pop("all measured", None)
    made = Table(title="95 % intervals that hold the truth, answers that were right", title_justify="left")
    made.add_column("parameter", no_wrap=True)
    for heading in ("held", "share", "chance of so few"):
        made.add_column(heading, justify="right")
    ordered = sorted(counts.items(), key=lambda item: (not measured(item[0]), item[0]))
    rows = [item for item in ordered if measured(item[0])]
    rows += [("all measured", pooled)] if pooled is not None else []
    for name, (hits, total) in [*rows, *(item for item in ordered if not measured(item[0]))]:
        if name == "all measured":
            made.add_section()
        odds = f"{chance(hits, total):.2g}" if measured(name) else ""
        made.add_row(name, f"{hits}/{total}", f"{hits / total:.2f}", odds)
        if name == "all measured":
            made.add_section()
    return made
