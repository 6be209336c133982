"""The answer as plain values: the JSON of ``halltwin explain`` (schema halltwin.explain/1)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.intervals import (
    Deviations,
    interval_of_derived,
    intervals_95,
    parabola_95,
    standard_deviations,
    with_open_torques,
)
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.marks.row_masks import raw_residual
from diagnosis.discovery.marks.row_numbers import number_in_file
from diagnosis.discovery.proof.changes import Change
from diagnosis.discovery.proof.predictive_check import why_not_checked
from diagnosis.discovery.result import Discovery
from diagnosis.report.as_read import as_read, phase_at_first_row, values_as_read
from diagnosis.report.as_well import as_well
from diagnosis.report.beside_class import beside_each, over_all_beside
from diagnosis.report.facts import facts, recorded_columns
from diagnosis.report.fitted_rows import counts, of_baseline, rms_deg, wild
from diagnosis.report.how_read import how_read
from diagnosis.report.motion import TORQUE, motion_answer
from diagnosis.report.over_class import moved, over_class
from diagnosis.report.provenance import Provenance
from diagnosis.report.recordings import in_recordings, recordings_answer
from diagnosis.report.rounded import rounded
from diagnosis.report.row_counts import MOST_LISTED
from diagnosis.report.senses import senses
from diagnosis.setup.checks import checked_sweep
from twin.baseline import FACTORS
from twin.catalogue import base_name, find
from twin.confidence import Z95
from twin.each_recording import everywhere
from twin.files import to_dict
from twin.param import Param

SCHEMA = "halltwin.explain/1"


def to_json(found: Discovery, made: Provenance) -> dict[str, Any]:
    """The answer, with every figure rounded to seven digits: what is beyond them is no information."""
    residual = np.degrees(raw_residual(found.baseline, found.sweep))
    extended = np.degrees(raw_residual(found.fit, found.sweep))
    kept = ~found.masked if found.masked.any() and not found.masked.all() else np.ones_like(found.masked)
    unnamed = [key for cause in found.causes if cause.name == "unnamed" for key in cause.keys]
    parameters_before, parameters_after = baseline_parameters(found.baseline), _extended_parameters(found)
    answer: dict[str, Any] = rounded(
        {
            "schema": SCHEMA,
            **made.to_dict(),
            "sweep": _sweep(found),
            "baseline": {
                "parameters": over_class(parameters_before, [_by_torques(found.baseline)]),
                "rms_deg": _rms(residual[kept]),
                "rms_all_rows_deg": _rms(residual),
                "heldout_rms_deg": found.baseline_held_deg,
                **of_baseline(found),
            },
            "noise_floor_deg": found.noise_floor_deg,
            "noise_floor_from": found.noise_floor_from,
            "noise": found.fit.weighting.family.labels[found.fit.weighting.member],
            "verdict": found.verdict,
            **_checked(found),
            **_changed(found),
            "causes": [cause_entry(found, cause) for cause in found.causes],
            "unexplained": {
                "rms_deg": _rms(extended[kept]),
                "structure": [_structure(found, key) for key in unnamed],
            },
            "extended": {
                "parameters": parameters_after,
                "moved": moved(parameters_before, parameters_after),
                "rms_deg": _rms(extended[kept]),
                "fitted_rms_deg": rms_deg(found, found.fit),
                "heldout_rms_deg": found.extended_held_deg,
                "gain": found.baseline_held_deg / max(found.extended_held_deg, 1e-12),
                "likeness_p": None if found.likeness is None else found.likeness.p,
                "likeness_worst": None if found.likeness is None else found.likeness.worst,
                "likeness_not_checked": _not_checked(found),
            },
            "in_factors": list(found.in_factors),
            "not_visible": {name: list(missing) for name, missing in sorted(found.invisible.items())},
            "senses": senses(found),
            "searched": found.looked_at,
            "cut_short": _cut_short(found),
            "twin": to_dict(found.device),
        }
        | (motion_answer(found) | recordings_answer(found) | _setup(found))
    )
    return answer


def _setup(found: Discovery) -> dict[str, Any]:
    """What is wrong with the set-up."""
    return {"setup": [finding.to_dict() for finding in checked_sweep(found.sweep)]}


def _changed(found: Discovery) -> dict[str, Any]:
    """What of a given twin has changed, whether it is another device's, and what of it was fitted anew."""
    return {
        "changed": [_change(found, change) for change in found.changed],
        "other_device": found.other_device,
        "fitted_anew": found.fitted_anew,
    }


def _not_checked(found: Discovery) -> dict[str, Any] | None:
    """Why the predictive check was not made, with the readings there are and that it takes; None where it was."""
    if found.likeness is not None:
        return None
    why = why_not_checked(found.fit)
    return {"why": "it was left out", "readings": found.fit.rows, "needed": None} if why is None else why._asdict()


def _checked(found: Discovery) -> dict[str, Any]:
    """The two checks of the extended twin, None where one was not made, and what they find off."""
    like, lack = found.likeness, found.lack
    figures = lack and {"f_ratio": lack.ratio, "left_deg": lack.left_deg, "by_scatter_deg": lack.by_scatter_deg}
    return {
        "lack_of_fit_p": lack and lack.p,
        "predictive_p": like and like.p,
        "lack_of_fit": figures,
        "misfits": [vars(one) for one in found.misfits],
    }


def _cut_short(found: Discovery) -> dict[str, str] | None:
    """Where the search was stopped and what that leaves open; None where it came to its own end."""
    if found.cut_short is None:
        return None
    if not found.looked_at:
        left = "whether any cause is there: none had been searched for"
    elif not found.causes:
        left = "whether any cause is there: none had been found that stands on held-out readings"
    else:
        left = "whether there are further causes, or better ones in the place of those found"
    return {"stage": found.cut_short, "left_open": left, "by": found.cut_by or "interrupt"}


def _sweep(found: Discovery) -> dict[str, Any]:
    """What the sweep holds, and what was not used of it."""
    sweep = found.sweep
    numbers = sweep.numbers[wild(found)].tolist()
    return {
        "name": sweep.name,
        "rows": sweep.rows,
        "used": len(sweep),
        "set_aside": sweep.set_aside,
        "rejected": len(sweep.rejected),
        "rejected_rows": {str(row): why for row, why in list(sweep.rejected.items())[:MOST_LISTED]},
        "rejected_rows_left_out": max(len(sweep.rejected) - MOST_LISTED, 0),
        **counts(found),
        "turns": found.fit.observations.motion.turns,
        "columns": recorded_columns(sweep),
        **how_read(sweep),
        **facts(found),
        **_output_grid(found.bits),
        "wild": len(numbers),
        "wild_rows": numbers[:MOST_LISTED],
        "wild_rows_left_out": max(len(numbers) - MOST_LISTED, 0),
    }


def _output_grid(bits: float | None) -> dict[str, Any]:
    """The grid on which all readings lie, of a word of so many bits or of few decimals, as plain values."""
    if bits is None:
        return {"output_bits": None, "output_step_deg": None}
    return {"output_bits": int(bits) if bits.is_integer() else None, "output_step_deg": 360.0 / 2.0**bits}


def baseline_parameters(fit: Fit) -> dict[str, dict[str, Any]]:
    """The six visible parameters of the paper's model with 95 % intervals; a given twin's are taken as known."""
    return _factors(fit, intervals_95(fit))


def _factors(fit: Fit, known: Mapping[tuple[str, str], tuple[float, float]]) -> dict[str, dict[str, Any]]:
    """The six visible parameters with these intervals."""
    answer = {}
    for factor in FACTORS:
        declared = factor.effect.params[factor.param]
        value = float(fit.chain.values.get(factor.key, {}).get(factor.param, factor.null))
        ends = known.get((factor.key, factor.param), (value, value))
        middle, low, high = (figure * factor.scale for figure in (value, *ends))
        at_bound = value <= declared.lower or value >= declared.upper
        answer[factor.name] = {**_figure(middle, low, high, factor.unit), "at_bound": bool(at_bound)}
    return answer


def _extended_parameters(found: Discovery) -> dict[str, dict[str, Any]]:
    """The factors with the causes, as well known as all that explains the sweep as well leaves them."""
    # Where another explanation leaves a factor is what matters there; to follow each along its likelihood takes long.
    others = [(everywhere(name), _factors(fit, parabola_95(fit))) for name, fit in found.rival_fits]
    beside = beside_each(intervals_95(found.fit), found)
    others += [(everywhere(name), _factors(found.fit, known)) for name, known in beside.items()]
    return over_class(baseline_parameters(found.fit), [*others, _by_torques(found.fit)])


def _by_torques(fit: Fit) -> tuple[str, dict[str, dict[str, Any]]]:
    """The same as far as torques leave them open that no speed tells from the sensor."""
    return TORQUE, _factors(fit, with_open_torques(fit, intervals_95(fit)))


def _change(found: Discovery, change: Change) -> dict[str, Any]:
    """One parameter of a given twin that has moved: what it was, and is with its 95 % interval."""
    fit, free = found.fit, change.free
    effect = find(free.key, fit.chain.effects)
    value = float(fit.chain.values[free.key][free.name])
    ends = over_all_beside(found).get((free.key, free.name), (value, value))
    low, high = ends
    return {
        "parameter": change.name,
        "effect": base_name(free.key),
        "stage": effect.stage,
        "owner": change.owner,
        "was": change.was,
        "is": value,
        "low": low,
        "high": high,
        "unit": effect.params[free.name].unit,
        **_as_named(fit, free.key, free.name, ends),
        "p": change.false_alarm_probability,
        "heldout_rms_deg_before": change.before_deg,
        "heldout_rms_deg_after": change.after_deg,
        "indistinguishable_from": list(change.rivals),
    }


def cause_entry(found: Discovery, cause: Finding) -> dict[str, Any]:
    """One cause with its parameters and held-out figures."""
    fit = found.fit
    effect = find(cause.keys[0], fit.chain.effects)
    answer: dict[str, Any] = {
        "name": cause.name,
        "stage": effect.stage,
        "parameters": parameters(found, cause),
        "assumed": effect.assumes or None,
        "false_alarm_probability": cause.false_alarm_probability,
        "heldout_rms_deg_before": cause.before_deg,
        "heldout_rms_deg_after": cause.after_deg,
        **as_well(found, cause),
    }
    if effect.footprint == "sequence":
        touched = np.degrees(raw_residual(fit, found.sweep))[list(cause.rows)]
        answer["rows_rms_deg"] = _rms(touched) if cause.rows_off_deg is None else cause.rows_off_deg
        if any(way is not None and way.rows_listed for way in (effect.marks, effect.in_words)):
            answer["rows"] = found.sweep.numbers[list(cause.rows)].tolist()
    return answer | in_recordings(found, cause.keys)


def parameters(found: Discovery, cause: Finding) -> dict[str, dict[str, Any]]:
    """Every parameter of a cause's instances with its interval; further instances carry their number."""
    deviation, chain = standard_deviations(found.fit), found.fit.chain
    answer: dict[str, dict[str, Any]] = {}
    for number, key in enumerate(cause.keys):
        suffix = "" if number == 0 else f"_{number + 1}"
        figures = _instance(found, key, deviation) | _row_numbers(found, key)
        for (instance, name), (low, high) in cause.intervals.items():
            if instance == key:
                figures[name] |= {"low": low, "high": high}
        figures = as_read(find(key, chain.effects), figures, output_sense=chain.output_sense)
        answer.update({name + suffix: figure for name, figure in figures.items()})
    return answer | _counted(found, cause)


def _instance(found: Discovery, key: str, deviation: Deviations) -> dict[str, dict[str, Any]]:
    """The parameters of one instance of an effect, each with its 95 % interval."""
    fit = found.fit
    effect = find(key, fit.chain.effects)
    values = {**effect.null(), **fit.chain.values.get(key, {}), **found.words.get(key, {})}
    derived, known = effect.derived(values), over_all_beside(found)
    figures: dict[str, dict[str, Any]] = {}
    for name, param in effect.params.items():
        if param.role == "per turn" or name not in values or np.ndim(values[name]):
            continue
        if param.role == "random" and name in derived:
            continue
        if param.aside and values[name] == param.null:
            continue
        value = float(values[name])
        low, high = known.get((key, name), (value, value))
        if param.role == "phase":
            # Of a phase no less can be known than nothing.
            low, high = max(low, value - 180.0), min(high, value + 180.0)
        figures[name] = _figure(value, low, high, param.unit)
        figures[name] |= _as_named(fit, key, name, (low, high))
        figures[name] |= _marks(param, value, deviation.get((key, name), 0.0))
        if param.unit == "s" and name in effect.zoomed and (key, name) not in deviation:
            figures[name] |= _between_readings(fit, value)
    if effect.line is not None and effect.line.clock == "time":
        name = effect.roles("phase")[0]
        figures[name] |= phase_at_first_row(
            fit,
            figures[name],
            frequency_Hz=float(values[effect.line.param]),
            deviation_Hz=deviation.get((key, effect.line.param), 0.0),
        )
    if fit.observations.observables == 1:
        for name, (low, high) in effect.angle_only(values).items():
            told, value = figures[name], float(values[name])
            told |= {"low": told["low"] + min(low - value, 0.0), "high": told["high"] + max(high - value, 0.0)}
    figures.update({name: _derived(fit, key, name, figure) for name, figure in derived.items()})
    return figures


def _as_named(fit: Fit, key: str, name: str, ends: tuple[float, float]) -> dict[str, Any]:
    """The interval of a parameter if nothing of it is a torque's or of an effect beside, where that widens its ends."""
    own = intervals_95(fit).get((key, name), ends)
    return {"as_named": list(own)} if own[1] - own[0] < ends[1] - ends[0] else {}


def _derived(fit: Fit, key: str, name: str, figure: tuple[float, float, float, str]) -> dict[str, Any]:
    """A figure that follows from the parameters, with the interval that theirs make where it has none of its own."""
    value, low, high, unit = figure
    if low == value == high and any(one.key == key for one in fit.free):
        low, high = interval_of_derived(fit, key, name)
    return _figure(value, low, high, unit)


def _marks(param: Param, value: float, deviation: float) -> dict[str, Any]:
    """Marks of a fitted parameter.

    It keeps more than half of the variance that was known before the sweep; it is at the limit of the model.
    """
    marks = {"hardly_told": True} if 0.0 < param.prior_sd < np.sqrt(2.0) * deviation else {}
    at_bound = deviation > 0.0 and value != param.null and value in (param.lower, param.upper)
    return {**marks, "at_bound": True} if at_bound else marks


def _row_numbers(found: Discovery, key: str) -> dict[str, dict[str, Any]]:
    """Parameters that count rows, by the numbers that the rows have in the file."""
    effect = find(key, found.fit.chain.effects)
    values = found.fit.chain.values.get(key, {})
    figures = {}
    for name, param in effect.params.items():
        if param.unit == "row" and name in values:
            number = number_in_file(found.sweep, int(values[name]))
            figures[name] = _figure(number, number, number, param.unit)
    return figures


def _figure(value: float, low: float, high: float, unit: str) -> dict[str, Any]:
    return {"value": value, "low": low, "high": high, "unit": unit}


def _between_readings(fit: Fit, value_s: float) -> dict[str, float]:
    """Limits of a step's instant, which lies between two readings."""
    clock = fit.observations.motion.time_s
    place = int(np.searchsorted(clock, value_s))
    return {
        "low": float(min(clock[max(place - 2, 0)], value_s)),
        "high": float(max(clock[min(place + 1, clock.size - 1)], value_s)),
    }


def _counted(found: Discovery, cause: Finding) -> dict[str, dict[str, Any]]:
    """Figures of causes that touch single rows: how many, or which share of them."""
    effect = find(cause.keys[0], found.fit.chain.effects)
    if effect.marks is None:
        return {}
    figures = {}
    for name, (value, deviation) in effect.marks.told(len(cause.rows), len(found.sweep)).items():
        param, half = effect.params[name], Z95 * deviation
        figures[name] = _figure(value, max(value - half, param.lower), min(value + half, param.upper), param.unit)
    return figures


def _structure(found: Discovery, key: str) -> dict[str, Any]:
    chain = found.fit.chain
    effect = find(key, chain.effects)
    values = values_as_read(effect, chain.values[key], output_sense=chain.output_sense)
    own = {name: float(value) for name, value in values.items() if np.ndim(value) == 0}
    rows = {name: figure["value"] for name, figure in _row_numbers(found, key).items()}
    return {"kind": effect.kind, **own, **effect.figures(values), **rows}


def _rms(values: Any) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if np.size(values) else float("nan")
