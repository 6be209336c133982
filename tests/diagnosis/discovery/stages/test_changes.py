"""Changes: of a given twin what has moved is named, and all else goes back to the twin's values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.fitting.free_parameters import value_of
from diagnosis.discovery.stages.changes import changes
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.stages.initial_fit import initial_fit
from diagnosis.discovery.stages.observe import observe
from diagnosis.discovery.stages.own_parameters import own_parameters
from diagnosis.discovery.stages.own_shapes import own_shapes
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from diagnosis.report.explain_plot import residual_figure
from tests.diagnosis.discovery.sweeps import Made, bench_of, start_of, through, truth_of
from twin.air_gap import at_air_gap
from twin.chain import Chain
from twin.magnet.assembly import Assembly
from twin.magnet.placement import Placement
from twin.motion import Motion

HARMONIC = Made(causes=(("magnet_harmonic", 0.1),), points=180, turns=2)
PLAIN = Made(points=180, turns=2)


def twin_of(made: Made) -> Chain:
    """The device of a sweep as the generator made it, its zero apart: it was mounted otherwise."""
    own = bench_of(made).baseline
    chain = (
        Chain()
        .with_effect("zero", zero_deg=-70.0)
        .with_effect("offset", x_percent=100.0 * own.offset_x / own.amplitude_x)
        .with_effect("offset", y_percent=100.0 * own.offset_y / own.amplitude_y)
        .with_effect("gain_mismatch", ratio=own.amplitude_y / own.amplitude_x)
        .with_effect("phase", beta_deg=own.phase_deg)
        .with_effect("quadratic_nonlinearity", q_percent=100.0 * own.quadratic)
    )
    for name, _ in made.causes:
        chain = chain.with_effect(name, **truth_of(made, name))
    return chain


def asked(made: Made, twin: Chain) -> State:
    """What is known once the twin has been asked."""
    state = replace(start_of(made), start=twin, given=twin)
    stages = (observe, initial_fit, own_parameters, stepwise, own_shapes, held_out_selection, changes)
    return through(state, *stages)


@dataclass(frozen=True, kw_only=True)
class Case:
    """What the twin says that is not so, and which parameters are then named; ``other``: as another device's."""

    twin: Callable[[Chain], Chain]
    changed: set[str]
    made: Made = PLAIN
    other: bool = False


CASES = {
    "nothing": Case(twin=lambda chain: chain, changed=set()),
    "one factor": Case(twin=lambda c: c.with_effect("offset", x_percent=0.5), changed={"offset.x_percent"}),
    "two factors": Case(
        twin=lambda c: c.with_effect("phase", beta_deg=0.1).with_effect("gain_mismatch", ratio=1.02),
        changed={"phase.beta_deg", "gain_mismatch.ratio"},
    ),
    # 0.1 deg in 360 readings with 0.02 deg of noise is known to 0.0015 deg.
    "a cause": Case(
        made=HARMONIC,
        twin=lambda c: c.with_effect("magnet_harmonic", amplitude_deg=0.05),
        changed={"magnet_harmonic.amplitude_deg"},
    ),
    "an event of the recording": Case(
        twin=lambda c: c.with_effect("index_slip", step_deg=1.0, time_s=60.0), changed=set()
    ),
    "another device": Case(
        twin=lambda c: (
            c.with_effect("phase", beta_deg=-0.4)
            .with_effect("offset", x_percent=0.0, y_percent=0.5)
            .with_effect("gain_mismatch", ratio=0.99)
        ),
        changed={"phase.beta_deg", "offset.x_percent", "offset.y_percent", "gain_mismatch.ratio"},
        other=True,
    ),
    "wired otherwise": Case(twin=lambda c: replace(c, output_sense=-1), changed=set(), other=True),
}


@pytest.mark.parametrize("name", CASES)
def test_what_has_changed_is_named_and_the_rest_stays(name: str) -> None:
    case = CASES[name]
    twin = case.twin(twin_of(case.made))
    state = asked(case.made, twin)
    assert {change.name for change in state.changed} == case.changed
    assert state.other_device == case.other
    assert state.keys == ()
    moved = {change.free for change in state.changed}
    assert {free for free in state.own if free in state.fit.free} == moved
    assert state.given is not None
    for free in set(state.own) - moved:
        assert value_of(state.fit.chain, free) == value_of(state.given, free)


def test_a_slip_of_another_recording_is_gone_from_the_twin() -> None:
    case = CASES["an event of the recording"]
    assert "index_slip" not in asked(case.made, case.twin(twin_of(case.made))).fit.chain.values


def test_whose_it_is_and_what_it_was() -> None:
    case = CASES["one factor"]
    (change,) = asked(case.made, case.twin(twin_of(case.made))).changed
    assert (change.owner, change.was) == ("device", 0.5)


def test_a_magnet_that_was_moved_is_named_by_the_number_of_its_placement() -> None:
    """What it does, an offset and a gain do together: one number of the mounting in place of two of the device.

    The number is known to some micrometres by 720 readings of 0.03 deg of noise.
    """
    device = Chain().with_magnet(Assembly(placement=Placement(sensor_x_mm=0.3, magnet_y_mm=0.2)))
    device = device.with_effect("offset", x_percent=0.3, y_percent=-0.2).with_effect("noise", rms_deg=0.03)
    sweep = device.simulate(Motion.from_angle(np.radians(np.arange(0.0, 1440.0, 2.0))), seed=3)
    twin = device.with_magnet(Assembly(placement=Placement(sensor_x_mm=0.4, magnet_y_mm=0.2)))
    found = explain(sweep, twin=twin)
    (change,) = found.to_dict()["changed"]
    assert (change["parameter"], change["was"], change["owner"]) == ("magnet.placement.sensor_x_mm", 0.4, "mounting")
    assert change["is"] == pytest.approx(0.3, abs=0.01)
    assert change["low"] < change["is"] < change["high"]
    assert change["heldout_rms_deg_after"] < 0.04 < change["heldout_rms_deg_before"]
    assert found.causes == ()
    assert "magnet.placement sensor x" in (title := residual_figure(found.discovery).get_suptitle())
    assert "no cause" not in title
    # The extended twin is one whose magnet is described where it is.
    assert found.extended.magnet is not None
    assert float(found.extended.magnet.placement.sensor_x_mm) == pytest.approx(change["is"], rel=1e-6)
    assert set(found.extended.values) <= {*twin.values, "gain_mismatch", "phase", "quadratic_nonlinearity", "zero"}


@pytest.mark.parametrize(("name", "value", "known_to"), [("sensor_tilt_y_deg", 8.0, 0.1), ("air_gap_mm", 2.2, 0.1)])
def test_a_magnet_moved_by_much_is_no_other_device(name: str, value: float, known_to: float) -> None:
    """It moves offset, gain and phase together, as another device would; ``known_to``: some standard deviations."""
    place = Placement(air_gap_mm=1.5, sensor_x_mm=0.4, sensor_y_mm=0.2, magnet_y_mm=0.2, sensor_tilt_y_deg=3.0)
    twin = Chain().with_magnet(Assembly(placement=place)).with_effect("offset", x_percent=0.3, y_percent=-0.2)
    twin = twin.with_effect("noise", rms_deg=0.03)
    there = replace(place, **{name: value})
    device = at_air_gap(twin, value) if name == "air_gap_mm" else twin.with_magnet(Assembly(placement=there))
    sweep = device.simulate(Motion.from_angle(np.radians(np.arange(0.0, 720.0, 2.0))), seed=3)
    answer = explain(sweep, twin=twin).to_dict()
    assert not answer["other_device"]
    (change,) = answer["changed"]
    assert change["parameter"] == f"magnet.placement.{name}"
    assert change["is"] == pytest.approx(value, abs=known_to)
    assert answer["causes"] == []
