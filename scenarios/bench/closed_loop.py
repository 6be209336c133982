"""The closed loop, the paper's Fig. 16 as one run: measure, explain, compensate, measure again."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from diagnosis.correction.compensation import Correction, correction_of
from diagnosis.correction.correction_file import to_dict
from diagnosis.thermal.recording import SMALLEST_SPAN_K
from scenarios.bench.faults import Opener
from scenarios.bench.loading import numbers
from scenarios.bench.measure import Measured, Measurement, finish, journal_of, measure
from scenarios.bench.pretreatment import errors_deg
from scenarios.bench.readings import Reading
from scenarios.bench.written import part_path, record_path
from scenarios.commands.outputs import json_text
from twin.angles import Array, wrap_deg
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.effect import Effect
from twin.errors import UserError
from twin.files import twin_text
from twin.motion import NOMINAL_C

if TYPE_CHECKING:
    from diagnosis.explanation import Explanation

SCHEMA = "halltwin.closed_loop/1"
AIM_DEG = 0.2
"""What the compensated encoder reaches over the whole turn (paper, Fig. 16)."""


@dataclass(frozen=True, eq=False)
class Loop:
    """Both measurements and what lay between them; errors are in degrees, in the shaft's sense."""

    before: Measured
    after: Measured
    answer: dict[str, Any]
    correction: Correction

    @property
    def before_deg(self) -> Array:
        """Error of each reading before, its typical value taken off: an encoder as it comes has no common zero."""
        return errors_deg(self.before.pretreated.kept)

    @property
    def after_deg(self) -> Array:
        """Error of each reading after, as it is: the correction brought the zero."""
        return direct_errors_deg(self.after.pretreated.kept)


def direct_errors_deg(readings: Sequence[Reading]) -> Array:
    """Measured minus reference [deg] (n,), nothing taken off."""
    measured = np.array([one.measured_deg for one in readings])
    return wrap_deg(measured - np.array([one.reference_deg for one in readings]))


def run_loop(
    job: Measurement,
    open_bus: Opener,
    *,
    restart: bool,
    effects: tuple[Effect, ...] = CATALOGUE,
    seed: int,
    command: str | None = None,
    say: Callable[[str], None],
) -> Loop:
    """Run the loop, the first half explained by these effects; all files lie beside ``job.output``.

    A run that was broken off goes on where it was, in whichever half. ``command``: the line that runs it again.
    """
    first, second = _half(job, "before"), _half(job, "after")
    with contextlib.closing(journal_of(first, restart=restart)) as earlier:
        # What was measured with a correction belongs to the readings that this came from.
        anew = restart or not earlier.complete
        before = measure(first, earlier, open_bus, prepare=lambda sequence: sequence.load(None), last=False)
        say(f"measured {first.output.name}: {len(before.pretreated.kept)} readings")
        found = _explained(first.output, effects, seed)
        found = replace(found, made=replace(found.made, command=command))
        answer = found.to_dict()
        correction = correction_of(found.extended, temperature_c=_temperature_c(before, found.extended, say))
        job.files.write(
            {
                part_path(job.output, "twin", ".toml"): twin_text(found.extended),
                part_path(job.output, "correction", ".toml"): _toml(to_dict(correction)),
            }
        )
        named = ", ".join(cause["name"] for cause in answer["causes"]) or "no cause beyond the paper's error model"
        say(f"{answer['verdict']}: {named}; correction of {correction.series.shape[1]} orders loaded")
        # Readings belong to the correction that was loaded when they were taken.
        second = replace(second, settings={**second.settings, "correction": numbers(correction)})
        with contextlib.closing(journal_of(second, restart=anew)) as later:
            after = measure(second, later, open_bus, prepare=lambda sequence: sequence.load(correction), last=False)
            if not all(one.corrected for one in after.pretreated.kept):
                raise UserError(
                    f"{second.output}: the Hall encoder lost its correction on the way; run again with --restart"
                )
            loop = Loop(before, after, answer, correction)
            job.files.write({part_path(job.output, "report", ".json"): json_text(summary(loop))})
            finish(second, later, after, witness=earlier)
        finish(first, earlier, before)
    return loop


def _temperature_c(measured: Measured, twin: Chain, say: Callable[[str], None]) -> float:
    """The temperature [C] that the encoder is corrected for: the mean of the readings'; where it is one of several."""
    warm = [one.temperature_c for one in measured.pretreated.kept if one.temperature_c is not None]
    if not warm:
        return NOMINAL_C
    mean_c = float(np.mean(warm))
    following = [key for key in twin.values if "temperature_c" in find(key, twin.effects).needs]
    if following and np.ptp(warm) > SMALLEST_SPAN_K:
        say(
            f"{', '.join(following)}: corrected as at {mean_c:.1f} C, the mean of the readings; the encoder takes no "
            "correction that follows the temperature"
        )
    return mean_c


def _explained(sweep: Path, effects: tuple[Effect, ...], seed: int) -> Explanation:
    from diagnosis import explain

    return explain(sweep, effects=effects, seed=seed)


def summary(loop: Loop) -> dict[str, Any]:
    """The report as plain values."""
    return {
        "schema": SCHEMA,
        **{key: loop.answer[key] for key in ("version", "date", "seed", "command")},
        "verdict": loop.answer["verdict"],
        "causes": loop.answer["causes"],
        "orders": int(loop.correction.series.shape[1]),
        "left_out": list(loop.correction.left_out),
        "before": _figures(loop.before, loop.before_deg),
        "after": _figures(loop.after, loop.after_deg),
        "aim_deg": AIM_DEG,
        "reached": bool(np.max(np.abs(loop.after_deg)) < AIM_DEG),
    }


def lines(loop: Loop) -> list[str]:
    """The report as a person reads it."""
    (rms, peak), (rms_after, peak_after) = (_size(errors) for errors in (loop.before_deg, loop.after_deg))
    reached = "reached" if peak_after < AIM_DEG else "missed"
    said = []
    for cause in loop.answer["causes"]:
        rivals = ", ".join(cause["indistinguishable_from"])
        said.append(f"cause   {cause['name']}" + (f" (or {rivals})" if rivals else ""))
    said += [
        f"before  RMS {rms:.4f} deg   largest {peak:.4f} deg   (zero taken off)",
        f"after   RMS {rms_after:.4f} deg   largest {peak_after:.4f} deg   (as read)",
        f"aim     {AIM_DEG:g} deg over the whole circle: {reached}",
    ]
    said += [f"not in the correction: {name}; one angle reading cannot tell it" for name in loop.correction.left_out]
    return said


def _half(job: Measurement, part: str) -> Measurement:
    record = None if job.record is None else record_path(job.record, part)
    return replace(job, output=part_path(job.output, part, ".csv"), record=record)


def _figures(measured: Measured, errors: Array) -> dict[str, Any]:
    rms, peak = _size(errors)
    return {
        "readings": len(measured.pretreated.kept),
        "rejected": {str(index): why for index, why in measured.pretreated.rejected.items()},
        "rms_deg": rms,
        "largest_deg": peak,
        "bus": dict(sorted(measured.counts.items())),
    }


def _size(errors: Array) -> tuple[float, float]:
    return float(np.sqrt(np.mean(errors**2))), float(np.max(np.abs(errors)))


def _toml(content: dict[str, Any]) -> str:
    import tomli_w

    return tomli_w.dumps(content)
