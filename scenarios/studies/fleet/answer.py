"""A batch's answer as plain values, the content of its JSON."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp
from typing import Any

import numpy as np

from diagnosis.population.apart import Apart
from diagnosis.population.changes import ChangeOfBatch
from diagnosis.population.pooled import FALSE_SHARE
from diagnosis.population.spread import CauseOfBatch, FactorOfBatch
from scenarios.studies.fleet.job import ANSWERS, answer_name
from scenarios.studies.fleet.result import Result

SCHEMA = "halltwin.fleet/1"
FLEET = ("apart", "change", "cause")
"""What ``--fail-on`` may ask for, beside the name of a cause."""
_SMALLEST = -700.0
"""Log of the smallest probability that a number can hold; smaller ones are given as this."""


def answer_of(found: Result, order: str) -> dict[str, Any]:
    """The answer, without what says how it came to be."""
    population = found.population
    batch = population.batch
    return {
        "schema": SCHEMA,
        "devices": {
            "files": len(found.names),
            "used": len(batch),
            "order": order,
            "unusable": [{"file": name, "reason": reason} for name, reason in found.reasons.items()],
        },
        "output_sense": {
            "sense": batch.question.output_sense,
            "by": found.template.sense_by,
            "decided": found.template.decided,
        },
        "asked": {
            "candidates": len(batch.question.candidates),
            "causes": list(dict.fromkeys(one.effect for one in batch.question.candidates)),
            "looks": found.looks,
            "ended": found.ended,
            "false_share": FALSE_SHARE,
        },
        "factors": [_factor(one, found) for one in population.factors],
        "residual": _residual(found),
        "causes": [_cause(one) for one in population.causes],
        "apart": [_apart(one, found) for one in population.apart],
        "changes": [_change(one, found) for one in population.changes],
        "corrections": [vars(one) for one in population.corrections],
    }


def in_answer(answer: Mapping[str, Any]) -> dict[str, str]:
    """What the answer holds, for ``--fail-on``."""
    found: dict[str, str] = {}
    for cause in answer["causes"]:
        found[cause["name"]] = cause["name"]
        for rival in cause["indistinguishable_from"]:
            found.setdefault(rival, f"cannot be told from {cause['name']}")
    if answer["causes"]:
        found["cause"] = ", ".join(dict.fromkeys(cause["name"] for cause in answer["causes"]))
    if answer["apart"]:
        count = len(answer["apart"])
        found["apart"] = f"{count} device{'s' * (count > 1)}, {answer['apart'][0]['file']} the farthest"
    if answer["changes"]:
        first = answer["changes"][0]
        found["change"] = f"{first['figure']} from {first['file']} on"
    return found


def chance(log_p: float) -> float:
    """A probability from its log; one that no number can hold as the smallest that one can."""
    return exp(max(log_p, _SMALLEST))


def _factor(one: FactorOfBatch, found: Result) -> dict[str, Any]:
    place = [factor.factor.name for factor in found.population.factors].index(one.factor.name)
    own = np.sqrt(one.inflation) * np.median(found.population.batch.arrays["fitted_error"][:, place])
    effects = one.found
    return {
        "name": one.factor.param,
        "label": one.factor.label,
        "unit": one.factor.effect.params[one.factor.param].unit,
        "mean": effects.mean,
        "low": effects.low,
        "high": effects.high,
        "spread": effects.spread,
        "spread_low": effects.spread_low,
        "spread_high": effects.spread_high,
        "own_error": float(own),
        "error_inflation": float(np.sqrt(one.inflation)),
        "devices": effects.devices,
    }


def _residual(found: Result) -> dict[str, Any]:
    rms = found.population.batch.arrays["own_rms_deg"]
    low, middle, high = (float(value) for value in np.quantile(rms, (0.05, 0.5, 0.95)))
    return {"median_deg": middle, "low_deg": low, "high_deg": high}


def _cause(one: CauseOfBatch) -> dict[str, Any]:
    return {
        "name": one.name,
        "shape": dict(one.shape),
        "parameter": one.parameter,
        "unit": one.unit,
        "false_alarm_probability": chance(one.log_p),
        "phase": "own" if one.own_phase else "shared" if one.phase_from else None,
        "phase_counts_from": list(one.phase_from),
        "size": one.amplitude,
        "low": one.low,
        "high": one.high,
        "phase_deg": one.phase_deg,
        "spread": one.spread,
        "standard_errors_on_one_device": one.on_one,
        "devices": one.devices,
        "indistinguishable_from": list(one.not_told_from),
    }


def _apart(one: Apart, found: Result) -> dict[str, Any]:
    device = int(found.population.batch.arrays["device"][one.device])
    return {
        "file": found.population.batch.names[one.device],
        "place": found.numbers[found.population.batch.names[one.device]],
        "chance": chance(one.log_p),
        "distance": one.distance,
        "figures": list(one.figures),
        "explained": explained(device, found),
    }


def explained(device: int, found: Result) -> dict[str, Any] | None:
    """What ``explain`` says of a device, in short; None where it was not asked."""
    answer = found.explained.get(device)
    if answer is None:
        return None
    if "reason" in answer:
        return {"reason": answer["reason"], "answer": f"{ANSWERS}/{answer_name(device)}"}
    causes = [
        {
            "name": cause["name"],
            "parameters": {name: told["value"] for name, told in cause["parameters"].items()},
            "heldout_rms_deg_before": cause["heldout_rms_deg_before"],
            "heldout_rms_deg_after": cause["heldout_rms_deg_after"],
        }
        for cause in answer["causes"]
    ]
    return {"verdict": answer["verdict"], "causes": causes, "answer": f"{ANSWERS}/{answer_name(device)}"}


def _change(one: ChangeOfBatch, found: Result) -> dict[str, Any]:
    names = found.population.batch.names
    numbers = found.numbers
    return {
        "figure": one.figure,
        "unit": one.unit,
        "chance": chance(one.log_p),
        "kind": one.change.shape,
        "file": names[one.change.first],
        "place": numbers[names[one.change.first]],
        "low": numbers[names[one.change.low]],
        "high": numbers[names[one.change.high]],
        "size": one.change.size,
    }
