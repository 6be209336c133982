"""The JSON's figures of rows: by the numbers that the rows have in the file, however they were averaged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.factors.mounting import Mounting
from diagnosis.report.answer import parameters
from diagnosis.report.wording import parameter_line
from scenarios.commands.protocol import Protocol
from twin.catalogue import find
from twin.chain import Chain
from twin.magnet.assembly import Assembly
from twin.magnet.placement import Placement
from twin.motion import Motion
from twin.sweep import Sweep

REPEATS, ANGLES, MISSING = 5, 120, 7


def loud_stretch() -> tuple[dict[str, np.ndarray], int, int]:
    """Columns of readings repeated at each angle, seven of them missing, and first and last number of a loud stretch.

    It scatters by 0.5 deg among others that scatter by 0.02 deg.
    """
    angle = np.radians(np.repeat(np.arange(ANGLES) * 3.0, REPEATS))
    sweep = Chain().with_effect("noise", rms_deg=0.02).simulate(Motion.from_angle(angle), seed=4)
    measured = sweep.measured_deg.copy()
    first, last = 200, 349
    measured[first : last + 1] += 0.5 * np.random.default_rng(5).standard_normal(last - first + 1)
    measured[10 : 10 + MISSING] = np.nan
    return {"reference_deg": sweep.reference_deg, "measured_deg": measured}, first + 1, last + 1


def test_a_noisy_stretch_is_told_by_the_rows_of_the_file() -> None:
    columns, first, last = loud_stretch()
    found = explain(Sweep.from_columns(columns))
    answer = found.to_dict()
    (structure,) = answer["unexplained"]["structure"]
    assert structure["kind"] == "noise"
    # To within six angles of five readings: lengths are tried in steps of 30 %, here of 25 and 33 angles for 30.
    assert structure["first_row"] == pytest.approx(first, abs=6 * REPEATS)
    assert structure["last_row"] == pytest.approx(last, abs=6 * REPEATS)
    assert answer["causes"][0]["parameters"]["first_row"]["value"] == structure["first_row"]
    assert f"rows {structure['first_row']} to {structure['last_row']} scatter" in found.summary(200)
    # The twin counts the rows that it simulates from 0, without those that cannot be read.
    assert found.extended.values["unnamed_burst"]["first_row"] == structure["first_row"] - 1 - MISSING
    again = found.extended.simulate(Sweep.from_columns(columns).motion(), seed=1)
    error = np.remainder(again.measured_deg - again.reference_deg + 180.0, 360.0) - 180.0
    loud = np.flatnonzero(np.abs(error) > 0.2) + 1 + MISSING
    assert structure["first_row"] <= loud.min() < loud.max() <= structure["last_row"]


def test_what_touches_single_readings_says_how_far_off_they_are() -> None:
    motion = Motion.from_angle(np.radians(np.arange(0.0, 720.0, 2.0)))
    sweep = Chain().with_effect("noise", rms_deg=0.02).simulate(motion, seed=4)
    measured = sweep.measured_deg.copy()
    measured[[40, 200]] += (22.5, -22.5)
    answer = explain({"reference_deg": sweep.reference_deg, "measured_deg": measured}).to_dict()
    (cause,) = answer["causes"]
    assert (cause["name"], cause["rows"]) == ("bus_glitch", [41, 201])
    assert cause["rows_rms_deg"] == pytest.approx(22.5, abs=0.05)
    assert cause["heldout_rms_deg_before"] == cause["heldout_rms_deg_after"] == answer["extended"]["heldout_rms_deg"]


def test_what_the_sweep_hardly_tells_is_marked_and_named_without_a_figure() -> None:
    """Of a magnet a little off, one sweep shows the product of the displacements, and neither tilts nor shares."""
    place = Placement(sensor_x_mm=0.3, magnet_y_mm=0.2)
    chain = Chain(magnet=Assembly(placement=place)).with_effect("noise", rms_deg=0.02)
    found = explain(chain.simulate(Protocol(turns=2).motion(), seed=1))
    (cause,) = found.to_dict()["causes"]
    assert cause["name"] == "magnet_misalignment"
    told = {name for name, one in cause["parameters"].items() if not one.get("hardly_told")}
    assert {"product_mm2", "phase_deg"} <= told
    assert "sensor_tilt_x_deg" not in told
    product = cause["parameters"]["product_mm2"]
    assert product["low"] < 0.06 < product["high"]
    said = " ".join(found.summary(width=400).split())
    assert "hardly told by this sweep: " in said
    # The displacements themselves, counted for a magnet that nobody has described; of 0.3 and 0.2 mm.
    for name, truth in (("", 0.06**0.5), ("sensor_", 0.3), ("field_", 0.2)):
        figure = cause["parameters"][f"{name}displacement_mm"]
        assert figure["low"] < truth < figure["high"], name
    assert "cylinder of 6 mm x 2.5 mm" in cause["assumed"]
    assert "assumed, as no magnet is described (--magnet, --twin): a cylinder of 6 mm x 2.5 mm" in said


def test_an_air_gap_that_is_stated_counts_for_the_assumed_magnet() -> None:
    """Twice as far away the same turn of the field is that of larger displacements."""
    place = Placement(sensor_x_mm=0.5, magnet_y_mm=0.4, air_gap_mm=3.0)
    device = Chain(magnet=Assembly(placement=place)).with_effect("noise", rms_deg=0.02)
    sweep = device.simulate(Protocol(turns=2).motion(), seed=1)
    (cause,) = explain(sweep, mounting=replace(Mounting.unstated(), air_gap_mm=(3.0,))).to_dict()["causes"]
    assert cause["assumed"] == "a cylinder of 6 mm x 2.5 mm at an air gap of 3 mm"
    figure = cause["parameters"]["displacement_mm"]
    assert figure["low"] < 0.2**0.5 < figure["high"]


def test_a_shape_at_the_limit_of_the_model_is_said_to_be_there() -> None:
    chain = Chain().with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0).with_effect("noise", rms_deg=0.02)
    found = explain(chain.simulate(Protocol(turns=2, both_directions=True).motion(), seed=1)).discovery
    (cause,) = found.causes
    assert "limit" not in parameter_line(parameters(found, cause))
    least = find("hysteresis").params["memory_deg"].lower
    fit = found.fit
    there = fit.chain.with_values({"hysteresis": {**fit.chain.values["hysteresis"], "memory_deg": least}})
    told = parameters(replace(found, fit=evaluate(there, fit.free, fit.observations, fit.weighting)), cause)
    assert told["memory_deg"]["at_bound"]
    assert "(at its limit)" in parameter_line(told)
