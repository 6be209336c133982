"""A sensor of a known number of periods a turn: what may turn as often, what is told of it, what is refused.

The records are made by channels of their own, not by the twin's effect.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.input_checks import as_sweep
from diagnosis.setup.checks import checked
from diagnosis.setup.of_log import read_record, with_pole_pairs
from tests.command_line import halltwin
from twin import Chain, Sweep
from twin.errors import SweepError, UserError
from twin.logs.guess import guessed
from twin.logs.read import read_table

X, Y, GAIN, PHASE_DEG = 0.02, -0.03, 1.04, 2.0
"""Offsets and gain ratio of the channels' amplitude, and their phase, within each period."""


def record(periods: int, *, points: int = 180, sense: int = 1, channel_sense: int = 1) -> dict[str, np.ndarray]:
    """Two turns of a ring, with its channels, and the angle of the shaft that a perfect count of periods gives."""
    rng = np.random.default_rng(periods)
    shaft = np.radians(np.arange(2 * points) * 360.0 / points)
    field = sense * shaft + 0.3
    vx = np.cos(periods * field) + X
    vy = GAIN * (np.sin(periods * field + np.radians(PHASE_DEG)) + Y)
    period = channel_sense * np.arctan2(vy, vx)
    true = channel_sense * periods * field
    measured = (true + np.angle(np.exp(1j * (period - true)))) / periods
    measured += np.radians(0.01) * rng.normal(size=shaft.size) + np.radians(0.1) * np.cos(shaft)
    return {
        "reference_deg": np.degrees(shaft) % 360.0,
        "measured_deg": np.degrees(measured) % 360.0,
        "period_deg": np.degrees(periods * measured) % 360.0,
        "vx": vx,
        "vy": vy,
    }


def once(periods: int, **bench: int) -> dict[str, np.ndarray]:
    """Both angles in degrees of the shaft."""
    made = record(periods, **bench)
    return {name: made[name] for name in ("reference_deg", "measured_deg")}


def of_period(periods: int, **bench: int) -> dict[str, np.ndarray]:
    """A reading that begins anew with each period."""
    made = record(periods, **bench)
    return {"reference_deg": made["reference_deg"], "measured_deg": made["period_deg"]}


def with_channels(periods: int, **bench: int) -> dict[str, np.ndarray]:
    """A reading of the shaft beside channels that turn with each period."""
    made = record(periods, **bench)
    return {name: made[name] for name in ("reference_deg", "measured_deg", "vx", "vy")}


@pytest.mark.parametrize("columns", [once, of_period])
@pytest.mark.parametrize("periods", [2, 4, 23, 50])
def test_offset_gain_and_phase_of_a_period_are_told(columns, periods: int) -> None:  # type: ignore[no-untyped-def]
    found = explain(columns(periods, points=360), pole_pairs=periods)
    assert [cause.name for cause in found.causes] == ["multipole"]
    values = found.extended.values["multipole"]
    assert values["periods"] == periods
    assert values["x_percent"] == pytest.approx(100.0 * X, abs=0.15)
    # Angles alone do not tell who counts which way, and the mirrored sensor has both of these turned over.
    assert abs(float(values["y_percent"])) == pytest.approx(100.0 * abs(Y), abs=0.15)
    assert abs(float(values["beta_deg"])) == pytest.approx(PHASE_DEG, abs=0.15)
    assert values["ratio"] == pytest.approx(GAIN, abs=0.002)
    assert found.to_dict()["extended"]["rms_deg"] < 0.012


@pytest.mark.parametrize(("sense", "channel_sense"), [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_channels_of_a_period_tell_who_counts_which_way(sense: int, channel_sense: int) -> None:
    found = explain(with_channels(5, sense=sense, channel_sense=channel_sense), pole_pairs=5)
    assert (found.extended.sensor_sense, found.extended.output_sense) == (sense, channel_sense)
    assert found.to_dict()["senses"]["decided"]
    values = found.extended.values["multipole"]
    assert values["y_percent"] == pytest.approx(100.0 * Y, abs=0.15)
    assert values["beta_deg"] == pytest.approx(PHASE_DEG, abs=0.15)


def test_gain_and_phase_of_one_period_are_none_of_a_sensor_of_two() -> None:
    two = explain(once(2), pole_pairs=2)
    assert {"gain_mismatch", "phase"}.isdisjoint(two.extended.values)
    assert {"gain_mismatch", "phase"} <= set(explain(once(3), pole_pairs=3).extended.values)


def test_either_angle_is_counted_on_by_the_other() -> None:
    made = record(7, sense=-1)
    swapped = {"reference_deg": made["period_deg"], "measured_deg": made["reference_deg"]}
    for columns, name in ((of_period(7, sense=-1), "measured_deg"), (swapped, "reference_deg")):
        sweep = as_sweep(columns, pole_pairs=7)
        off = np.mod(7.0 * sweep.columns[name] - columns[name] + 180.0, 360.0) - 180.0
        assert np.abs(off).max() < 1e-9
        follows = sweep.columns["measured_deg"] + sweep.columns["reference_deg"]
        assert np.ptp(np.unwrap(follows, period=360.0)) < 5.0


def test_a_sweep_that_is_handed_in_is_taken_alike() -> None:
    sweep = Sweep(**with_channels(4))
    assert as_sweep(sweep) is sweep
    made = as_sweep(sweep, pole_pairs=4)
    assert made.vx is None
    assert made.senses == (1, 1)
    assert as_sweep(sweep, pole_pairs=1) is sweep


@pytest.mark.parametrize("columns", [of_period, with_channels])
def test_without_the_number_it_is_asked_for(columns) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(SweepError, match=r"turns 23 times as fast.*--pole-pairs 23"):
        explain(columns(23, points=360))


def test_another_number_is_told() -> None:
    with pytest.raises(SweepError, match=r"turns 4 times as fast as reference_deg; expected once or 5 times.*give 4"):
        explain(of_period(4), pole_pairs=5)


@pytest.mark.parametrize("periods", [60, 90])
def test_angles_that_show_no_line_of_a_period_are_refused(periods: int) -> None:
    with pytest.raises(SweepError, match=f"its 180 different angles do not show.*more than {4 * periods} points"):
        explain(once(4), pole_pairs=periods)


@pytest.mark.parametrize("number", [0, -3, 2.5, True, 1001, "4"])
def test_what_is_no_number_of_periods_is_refused(number: object) -> None:
    with pytest.raises(UserError, match=r"pole_pairs is .*expected a whole number from 1 to 1000"):
        explain(once(4), pole_pairs=number)  # type: ignore[arg-type]


def test_a_twin_of_another_number_is_refused() -> None:
    twin = Chain().with_effect("multipole", periods=6.0, x_percent=1.0)
    with pytest.raises(UserError, match=r"has 6 periods a turn, and .* is 4"):
        explain(once(4), twin=twin, pole_pairs=4)


def written(path: Path, columns: dict[str, np.ndarray]) -> str:
    np.savetxt(path, np.stack(list(columns.values()), axis=1), delimiter=",", header=",".join(columns), comments="")
    return str(path)


def test_channels_alone_are_read_as_an_angle_of_the_shaft(tmp_path: Path) -> None:
    made = record(4)
    path = written(tmp_path / "raw.csv", {"ref_deg": made["reference_deg"], "cos": made["vx"], "sin": made["vy"]})
    guess = guessed(read_table(Path(path)))
    assert guess.text == "reference_deg=ref_deg, measured_deg=unwrap(atan2(sin, cos))/4"
    sweep = Sweep.read(path, columns=guess.text)
    off = np.mod(sweep.measured_deg - made["measured_deg"], 90.0)
    assert np.ptp(np.minimum(off, 90.0 - off)) < 1.0


def test_doctor_takes_the_known_number_for_no_fault(tmp_path: Path) -> None:
    path = Path(written(tmp_path / "log.csv", of_period(7)))
    read = read_record(path, name="log")
    kinds = {known: [f.kind for f in checked(r.record, r.findings).findings] for known, r in _known(read).items()}
    assert kinds == {None: ["pole_pairs"], 7: [], 6: ["pole_pairs"]}


def _known(read):  # type: ignore[no-untyped-def]
    return {None: read, 7: with_pole_pairs(read, 7), 6: with_pole_pairs(read, 6)}


def test_the_command_takes_it(tmp_path: Path) -> None:
    path = written(tmp_path / "ring.csv", of_period(7))
    told = halltwin("explain", path, "--pole-pairs", "7")
    assert "periods 7 /turn" in told.out
    assert halltwin("doctor", path, "--pole-pairs", "7", "--fail-on", "pole_pairs").code == 0
    assert halltwin("doctor", path, "--fail-on", "pole_pairs").code == 1
    refused = halltwin("explain", path, "--pole-pairs", "0")
    assert refused.code == 2
    assert refused.err.count("\n") <= 1


def test_teeth_make_the_lines_of_periods_that_nobody_has_counted() -> None:
    """Orders p and 2p, as of offset and gain within a period: a gear of p teeth too, unless the periods are known."""
    angle = np.arange(0.0, 360.0, 0.5)
    wave = 0.2 * np.cos(np.radians(12.0 * angle)) + 0.08 * np.sin(np.radians(24.0 * angle))
    noise = 0.02 * np.random.default_rng(2).standard_normal(angle.size)
    sweep = {"reference_deg": angle, "measured_deg": angle + wave + noise}
    (found,) = explain(sweep).causes
    assert found.name == "multipole"
    assert "mechanics" in found.indistinguishable_from
    (known,) = explain(sweep, pole_pairs=12).causes
    assert known.name == "multipole"
    assert "mechanics" not in known.indistinguishable_from
