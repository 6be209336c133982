"""Does a fit of the right cause give back the parameters that were put in?

The sweep is made by the independent generator; the twin is given the paper's error model and that one cause.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.initial_fit import senses_of_channels
from diagnosis.discovery.pipeline import State, discover
from diagnosis.error_model.fit import fit_baseline
from diagnosis.explanation import Explanation
from diagnosis.report.provenance import Provenance
from tests.hidden.coverage import common
from tests.hidden.generator import Hidden
from twin.catalogue import CATALOGUE
from twin.sweep import Sweep

SIGMA = 5.0
"""What a parameter may be off by, in its own standard errors: by chance once in two million."""
_OF_95_PERCENT = 1.96
_GRID = "output_quantisation"
_ALWAYS = (_GRID, "unnamed_burst")
"""Described of every sweep: the grid that its readings lie on, and where its noise is louder."""
_FOUND_AS = {"motor_poles": ("magnet_harmonic", "drive_ripple", "unnamed_order")}
"""Where a cause is known only by several lines together: those that its lines are found as, one by one."""


def answer_with(name: str, hidden: Hidden) -> dict[str, Any]:
    """The answer to a sweep where the only cause that is looked for is this one."""
    sweep = Sweep.from_columns(dict(hidden.columns))
    wanted = (name, *_FOUND_AS.get(name, ()), *_ALWAYS)
    effects = tuple(effect for effect in CATALOGUE if effect.baseline or effect.name in wanted)
    rng = np.random.default_rng(0)
    fit = fit_baseline(
        np.radians(sweep.reference_deg),
        np.radians(sweep.measured_deg),
        rng=rng,
        senses=senses_of_channels(sweep),
        robust=True,
    )
    state = State.of(sweep, replace(fit.chain(), effects=effects), rng=rng)
    return Explanation(discover(state), Provenance.today(seed=0)).to_dict()


@dataclass(frozen=True)
class Miss:
    """A parameter of the answer, what was put in, and how far apart they are allowed to be."""

    label: str
    value: float
    true: float
    allowed: float

    @property
    def wrong(self) -> bool:
        """Whether they are farther apart than that."""
        return not abs(self.value - self.true) <= self.allowed


def _second_order(truth: Mapping[str, Any], parameter: str) -> float:
    """The generator's ripple moves the shaft, the twin's is read by the reference: the same to first order.

    Put into one another they differ by the ripple times its own slope: by the share order x (amplitude of the line and
    its double, at most 0.4 of it, of twice the slope) of the amplitude, and as much in the phase.
    """
    own = truth["parameters"]["drive_ripple"]
    share = own["order"] * np.radians(own["amplitude_deg"]) * (1.0 + 2.0 * 0.4)
    return float(own["amplitude_deg"] * share if parameter == "amplitude_deg" else np.degrees(share))


def _edge(truth: Mapping[str, Any], parameter: str) -> float:
    """A bit's weight shows by where its edges are: the outermost one, an amplitude away, to the noise of a reading."""
    own = truth["parameters"]["adc_stuck_bit"]
    return float(own["step_percent"] * np.radians(truth["noise_deg"])) if parameter == "step_percent" else 0.0


BEYOND: dict[str, Callable[[Mapping[str, Any], str], float]] = {"drive_ripple": _second_order, "adc_stuck_bit": _edge}
"""By how much a cause's parameter may differ besides: where two readings of its definition, or the sampling, say so."""


def compared(name: str, answer: Mapping[str, Any], truth: Mapping[str, Any]) -> list[Miss]:
    """Every parameter that both the answer and the truth state of the cause; none where the answer lacks the cause.

    A grid that noise blurs is no cause; it is described with the sweep all the same.
    """
    entry = next((cause for cause in answer["causes"] if cause["name"] == name), None)
    if entry is None and name == _GRID and answer["sweep"]["output_bits"] is not None:
        bits = float(answer["sweep"]["output_bits"])
        return [Miss(f"{name}.bits", bits, truth["parameters"][name]["bits"], 0.0)]
    if entry is None:
        return []
    actual, found = common(name, entry["parameters"], truth), []
    for parameter, given in entry["parameters"].items():
        if parameter not in actual or not isinstance(given, Mapping) or given.get("low") is None:
            continue
        value, true = float(given["value"]), actual[parameter]
        if parameter.endswith("phase_deg"):
            true = value + (true - value + 180.0) % 360.0 - 180.0
        end = given["high"] if true > value else given["low"]
        allowed = SIGMA / _OF_95_PERCENT * abs(end - value) + BEYOND.get(name, lambda *_: 0.0)(truth, parameter)
        # Figures are given to seven digits.
        found.append(Miss(f"{name}.{parameter}", value, true, allowed + 1e-6 * abs(value)))
    return found
