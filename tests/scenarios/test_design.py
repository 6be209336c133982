"""Design studies: known relations, the winner by other means, and the same bytes whoever does the work."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis.report.provenance import day, version
from scenarios.studies.design.check import check_design, design_twin, magpylib_mT
from scenarios.studies.design.options import demand_of, space_of
from scenarios.studies.design.plot import map_figure
from scenarios.studies.design.run import Results, explore, folder_of, run, study_of
from scenarios.studies.design.space import AXES
from scenarios.studies.design.study import Demand, DesignStudy, ranking
from scenarios.studies.machines import Machines
from tests.command_line import halltwin
from tests.scenarios.study_jobs import content
from twin.angles import TAU
from twin.chain import Chain
from twin.errors import UserError
from twin.files import write_twin
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import NOMINAL_C, Motion

DEFAULT = {"diameter_mm": "6", "height_mm": "2.5", "air_gap_mm": "2"}


def study(*, sampling: str = "grid", count: int = 1, shape: str = "cylinder", **axes: str) -> DesignStudy:
    whole = {name: axes.get(name, DEFAULT.get(name, "0")) for name in AXES}
    space = space_of(whole, shape=shape, grades=("N35H",), bore_mm=2.0, sampling=sampling, count=count, seed=0)
    return study_of("imc-14bit", space, demand(), seed=0)


def demand(*, window: str = "30:90", tolerance: str = "off_axis=0.3mm, tilt=1deg") -> Demand:
    return demand_of(
        max_error_deg=0.5, window=window, temperature="-40:125", tolerance=tolerance, mountings=20, min_yield=0.9
    )


def figures(chosen: DesignStudy) -> dict[str, Any]:
    table, which = chosen.space.table()
    return chosen.figures(chosen.space.assemble(table, which), np.arange(len(table)))


def test_the_fields_error_grows_with_the_square_of_the_off_axis() -> None:
    found = figures(study(off_axis_mm="0.05,0.1,0.2,0.4"))
    slope = np.diff(np.log(found["error_deg.field"])) / np.log(2.0)
    np.testing.assert_allclose(slope, 2.0, atol=0.03)


@pytest.mark.parametrize("shape", ["cylinder", "ring", "block"])
def test_the_field_falls_with_the_gap_as_magpylib_says(shape: Any) -> None:
    found = figures(study(shape=shape, air_gap_mm="0.5:4:0.5"))
    for gap, field in zip(np.arange(0.5, 4.1, 0.5), found["field_mT"], strict=True):
        magnet = Magnet(shape=shape)
        assert field == pytest.approx(magpylib_mT(magnet, Placement(air_gap_mm=float(gap))), rel=1e-6)
    if shape != "ring":
        # In front of a ring's bore the field rises first.
        assert np.all(np.diff(found["field_mT"]) < 0)


def test_the_stray_fields_error_goes_inversely_with_the_field() -> None:
    found = figures(study(air_gap_mm="0.5:3:0.5"))
    product = found["stray_error_deg"] * found["field_low_mT"]
    np.testing.assert_allclose(product, np.degrees(1.0), rtol=1e-3)
    # Through the chain too: a stray field of 1 mT adds what the figure says, to its square.
    bare, with_stray = (hot_field_error(study(stray_mT=one)) for one in ("0", "1"))
    assert bare == pytest.approx(0.0, abs=1e-6)
    assert with_stray == pytest.approx(float(found["stray_error_deg"][3]), rel=0.05)


@pytest.mark.parametrize("stray", ["0", "1.5"])
def test_designs_are_driven_as_one_assembly_is(stray: str) -> None:
    """Many designs at once give each one's own channels, hot or cold: the stray field keeps, the magnet's follows."""
    chosen = study(air_gap_mm="1,3", off_axis_mm="0.2", stray_mT=stray)
    table, which = chosen.space.table()
    designs = chosen.space.assemble(table, which)
    angle = np.linspace(0.0, TAU, 25)
    motion = Motion.from_angle(angle, temperature_c=np.linspace(-40.0, 125.0, 25))
    together = designs.channels(np.stack([angle, angle]), motion)
    for number, channels in enumerate(together):
        alone = Assembly(*(picked(part, number) for part in (designs.magnet, designs.placement)))
        np.testing.assert_allclose(channels, alone.channels(np.stack([angle, angle]), motion), atol=1e-6)


def picked(part: Any, number: int) -> Any:
    """One design of a magnet or placement that holds many."""
    columns = {item.name: getattr(part, item.name) for item in fields(part)}
    return type(part)(**{k: v[number] if isinstance(v, np.ndarray) else v for k, v in columns.items()})


def hot_field_error(chosen: DesignStudy) -> float:
    """Largest error [deg] of the field alone at the highest temperature, where the field is weakest."""
    hot = replace(chosen.demand, temperature_c=(25.0, 125.0))
    return float(figures(replace(chosen, demand=hot))["error_deg.field"][0])


@pytest.mark.parametrize(
    ("cause", "power"),
    [
        ("disk", 2.0),
        ("saturation", 2.0),
        ("quadratic_nonlinearity", 1.0),
        ("offset", -1.0),
        ("offset_drift", -1.0),
        ("hysteresis", -1.0),
    ],
)
def test_a_causes_error_goes_with_its_power_of_the_field(cause: str, power: float) -> None:
    """A response V = a B + b B^2 + c B^3 + V0, divided by the signal a B: the square term leaves a share that grows

    with B, the cube one with B^2, a constant one that falls with B. So does a remanence, which is a constant field.
    The error is proportional to the share but for its square: the largest here is half a percent.
    """
    chosen = study(air_gap_mm="1:4:0.5")
    # The preset's disk saturates by its description; the effect is a deviation from it.
    effects = {**chosen.twin["effects"], "saturation": {"k_percent": 0.15}}
    found = figures(replace(chosen, twin={**chosen.twin, "effects": effects}))
    error, field = found[f"error_deg.{cause}"], found["field_mT"]
    assert np.ptp(np.log(field)) > 1.0
    slope = np.polyfit(np.log(field), np.log(error), 1)[0]
    assert slope == pytest.approx(power, abs=0.01)


@pytest.mark.parametrize("shape", ["ring", "block"])
def test_a_twin_misplaced_by_its_effect_is_designed_with(shape: Any, tmp_path: Path) -> None:
    magnet = Assembly(Magnet(shape=shape), Placement(air_gap_mm=2.0, sensor_x_mm=0.1))
    numbers = {"off_axis_mm": 0.1, "tilt_deg": 3.0, "direction_deg": 50.0, "product_mm2": 0.05, "phase_deg": 30.0}
    twin = Chain().with_magnet(magnet).with_effect("magnet_misalignment", sensor_tilt_x_deg=2.0, **numbers)
    write_twin(tmp_path / "twin.toml", twin)
    axes = {**dict.fromkeys(AXES, "0"), **DEFAULT, "air_gap_mm": "2,4", "off_axis_mm": "0.1"}
    space = space_of(axes, shape=shape, grades=("N35H",), bore_mm=2.0, sampling="grid", count=1, seed=0)
    chosen = study_of(str(tmp_path / "twin.toml"), space, demand(), seed=0)
    found, motion = figures(chosen), chosen.demand.motion(360)
    table, which = space.table()
    for row, error_deg in enumerate(found["error_deg"]):
        own = np.degrees(design_twin(chosen, table[row], which[row]).error(motion))
        own -= own[motion.temperature_c == NOMINAL_C].mean()
        # The effect counts the field's direction from the channels of its own place, which are up to 0.1 deg off: two
        # thousandths of what it does, order by order. Two small tilts, one after the other, are no lean to 1e-3.
        assert error_deg == pytest.approx(np.max(np.abs(own)), rel=0.01)
    assert np.min(found["error_deg.magnet_misalignment"]) > 0.1


def test_noise_limited_bits_follow_the_field() -> None:
    found = figures(study(air_gap_mm="1,2,3"))
    np.testing.assert_allclose(np.diff(found["resolution_bits"]), np.diff(np.log2(found["field_low_mT"])), rtol=1e-9)


@pytest.mark.parametrize(
    "axes", [{}, {"off_axis_mm": "0.3", "tilt_deg": "2"}, {"magnet_tilt_deg": "2", "shape": "ring"}]
)
def test_a_design_is_its_own_twin_simulated(axes: dict[str, str]) -> None:
    chosen = study(**axes)  # type: ignore[arg-type]
    table, which = chosen.space.table()
    check = check_design(chosen, table[0], which[0])
    # What is left are the converter's rounding and the noise, averaged over 16 records and at its largest.
    assert check.simulated_error_deg == pytest.approx(check.error_deg, abs=0.03)
    assert check.field_mT == pytest.approx(check.magpylib_mT, rel=1e-6)


@pytest.mark.parametrize("sampling", ["grid", "lhs", "sobol"])
def test_a_design_does_not_depend_on_which_others_are_asked_for(sampling: str) -> None:
    space = study(sampling=sampling, count=40, diameter_mm="4:9:1", air_gap_mm="1:3:0.5", height_mm="2,3").space
    numbers = np.array([33, 5, 17])
    for some, every in zip(space.table(numbers), space.table(), strict=True):
        assert np.array_equal(some, every[numbers])
    if sampling == "grid":
        # The last axis that is varied, the air gap, runs fastest.
        assert space.table()[0][:6, 3].tolist() == [1.0, 1.5, 2.0, 2.5, 3.0, 1.0]


def test_the_study_gives_the_same_bytes_with_one_and_two_workers(tmp_path: Path) -> None:
    chosen = study(sampling="sobol", count=33, diameter_mm="4,10", air_gap_mm="1,3", magnet_tilt_deg="0,2")
    for count, name in ((2, "two"), (1, "one")):
        with folder_of(chosen, tmp_path / name) as folder:
            found = explore(chosen, folder, Machines(workers=count))
    assert content(tmp_path / "one") == content(tmp_path / "two")
    assert len(found["yield"]) == 33
    order = ranking(found, chosen.demand)
    assert np.all(np.diff(found["yield"][order]) <= 0)


def test_the_command_lists_draws_and_checks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    chosen = study(diameter_mm="6,8", air_gap_mm="2,2.5")
    asked = {"space": chosen.space, "demand": chosen.demand, "machines": Machines(workers=1), "seed": 0}
    run("imc-14bit", tmp_path / "s", results=Results(best=3, command="again"), **asked)
    answer = json.loads((tmp_path / "s/best.json").read_text())
    assert [answer[key] for key in ("version", "date", "seed", "command")] == [version(), day(), 0, "again"]
    out = capsys.readouterr().out
    assert "of 4 designs keep 0.5 deg" in " ".join(out.split())
    assert "with the sensor of imc-14bit" in " ".join(out.split())
    assert "take N35H 8 x 2.5 mm at 2.50 mm: of those that keep the demand" in " ".join(out.split())
    assert "magpylib has" in " ".join(out.split())
    for name in ("map.png", "designs.csv", "best.json", "best.toml"):
        assert (tmp_path / "s" / name).stat().st_size > 0
    # What was edited since is not replaced unasked.
    twin = tmp_path / "s" / "best.toml"
    written = twin.read_bytes()
    twin.write_bytes(written + b"# chosen\n")
    with pytest.raises(UserError, match="--force"):
        run("imc-14bit", tmp_path / "s", results=Results(), **asked)
    assert twin.read_bytes() == written + b"# chosen\n"
    run("imc-14bit", tmp_path / "s", results=Results(force=True, plot=False), **asked)
    assert twin.read_bytes() == written


def test_a_demand_that_no_design_keeps_is_no_offer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    chosen = study(diameter_mm="6", air_gap_mm="2,2.5")
    hopeless = replace(chosen.demand, max_error_deg=1e-3)
    results, machines = Results(plot=False), Machines(workers=1)
    run("imc-14bit", tmp_path, space=chosen.space, demand=hopeless, results=results, machines=machines, seed=0)
    assert "take none; N35H 6 x 2.5 mm at" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("limit", "words"),
    [(0.5, ("keeps error", "best: N35H, 8 mm")), (1e-3, ("nowhere:", "closest, which does not keep it:"))],
)
def test_the_map_names_the_design_that_it_marks(tmp_path: Path, limit: float, words: tuple[str, str]) -> None:
    pytest.importorskip("matplotlib")
    chosen = study(diameter_mm="6,8", air_gap_mm="2,2.5", height_mm="2,2.5")
    chosen = replace(chosen, demand=replace(chosen.demand, max_error_deg=limit))
    with folder_of(chosen, tmp_path / "s") as folder:
        figure = map_figure(explore(chosen, folder, Machines(workers=1)), chosen)
    said = [text.get_text() for text in figure.legends[0].get_texts()]
    for line, word in zip(said, words, strict=True):
        assert line.startswith(word)
    marks = [line.get_marker() for line in figure.axes[0].lines if line.get_marker() != "None"]
    assert marks == (["*"] if limit == 0.5 else ["X"])
    assert figure.get_suptitle() == "Each place shows the best over height"


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(UserError, match="has no"):
        demand(tolerance="offaxis=0.3mm")
    with pytest.raises(UserError, match="low:high"):
        demand(window="90:30")
    with pytest.raises(UserError, match="has no \\[magnet\\]"):
        study_of("paper-encoder", study().space, study().demand, seed=0)
    with pytest.raises(UserError, match="air_gap_mm is 0 mm"):
        study(air_gap_mm="0")
    with pytest.raises(UserError, match="remanence is -1 T; expected from 0 to 2 T"):
        study(remanence_T="-1")


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--best", "0", "best is 0; expected a whole number from 1"),
        ("--tolerance", "off_axis=1e9mm", "tolerance off_axis is 1e+09 mm, too large: sensor_x_mm is"),
        ("--tolerance", "tilt=90deg", "tolerance tilt is 90 deg, too large: sensor_tilt_"),
        ("--tolerance", "air_gap=400mm", "tolerance air_gap is 400 mm, too large: air_gap_mm is"),
        ("--mountings", "0", "mountings is 0"),
        ("--count", "0", "count is 0"),
        ("--max-error", "nan", "max-error is nan deg"),
    ],
)
def test_a_mistake_in_an_option_is_one_line_and_makes_no_folder(
    tmp_path: Path, option: str, value: str, said: str
) -> None:
    ended = halltwin("design", "-o", tmp_path / "s", "--sampling", "lhs", option, value)
    assert ended.code == 2
    assert said in ended.err
    assert ended.err.count("\n") == 1
    assert not list(tmp_path.iterdir())
