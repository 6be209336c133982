"""What names, units and values of a log are guessed to mean: counts a turn, gears, channels, and what is asked back."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.untidy.__main__ import outcome
from tests.untidy.generator import COS, MEASURED_DEG, REFERENCE_DEG, ROWS, SIN, counts, table
from tests.untidy.mixed import drawn_geared
from twin.errors import SweepError
from twin.logs.read import read_log
from twin.logs.statement import parsed
from twin.logs.units import UNITS
from twin.sweep import Sweep
from twin.sweep_columns import COLUMNS

OPTION = re.compile(r'--columns "([^"]*)"')


@pytest.mark.parametrize("seed", range(12))
def test_counts_a_turn_are_found_or_asked_for(seed: int, tmp_path: Path) -> None:
    """Of encoders and sensors of any size; a number that no encoder has is never taken for one that some have."""
    rng = np.random.default_rng(seed)
    a_turn = int(rng.choice([1024, 2000, 2400, 4096, 8192, 10_000, 16_384, 36_000, 40_000]))
    odd = bool(seed % 3 == 0)
    actual = round(a_turn * float(rng.uniform(1.03, 1.07))) if odd else a_turn
    shaft = np.linspace(0.0, float(rng.uniform(400.0, 1500.0)), 300)
    error = rng.uniform(0.05, 1.5) * np.sin(np.radians(shaft + rng.uniform(0.0, 360.0)))
    sense = float(rng.choice([-1.0, 1.0]))
    log = {"enc_counts": counts(shaft, actual, wrapped=False), "angle_deg": (sense * shaft + error) % 360.0}
    path = tmp_path / "log.csv"
    path.write_text(table(log))
    if odd:
        with pytest.raises(SweepError, match=r"no two columns|values fit"):
            read_log(path)
    else:
        assert f"enc_counts*360/{a_turn}," in read_log(path).guess.text


U = np.degrees(np.unwrap(np.radians(MEASURED_DEG)))
ODD = {
    "counts": (
        {"enc_counts": counts(REFERENCE_DEG, 4301, wrapped=False), "angle_deg": MEASURED_DEG},
        "4301 counts",
        4e-3,
    ),
    "a gear at the sensor": ({"encoder_deg": REFERENCE_DEG, "hall_deg": 3.5 * U % 360.0}, "3.5 times", 4e-3),
    "a gear at the reference": ({"encoder_deg": 2.25 * REFERENCE_DEG, "hall_deg": MEASURED_DEG}, "2.25 times", 4e-3),
}


@pytest.mark.parametrize("name", ODD)
def test_an_odd_factor_is_told_roughly_and_asked_back(name: str, tmp_path: Path) -> None:
    """To a share of the turn that errors of order 1, of 0.8 deg, make in two and a half turns."""
    columns, words, share = ODD[name]
    path = tmp_path / "log.csv"
    path.write_text(table(columns))
    refused = halltwin("import", path)
    assert refused.code == 2
    assert "about" in refused.err
    (statement,) = OPTION.findall(refused.err)
    found = Sweep.read(path, columns=statement)
    for angle, true in ((found.reference_deg, REFERENCE_DEG), (found.measured_deg, MEASURED_DEG)):
        turned = np.degrees(np.unwrap(np.radians(angle)))
        assert np.ptp(turned) == pytest.approx(np.ptp(np.degrees(np.unwrap(np.radians(true)))), rel=share)
    value, unit = words.split()
    told = re.search(rf"about ([\d.]+) {unit}", refused.err)
    assert told
    assert float(told[1]) == pytest.approx(float(value), rel=share)


def test_channels_in_codes_lose_the_middle_of_their_range(tmp_path: Path) -> None:
    adc = {"sin": np.round(2048 + 900 * SIN), "cos": np.round(2048 + 900 * COS)}
    (tmp_path / "log.csv").write_text(table({"ref": REFERENCE_DEG, "sensor": MEASURED_DEG, **adc}))
    log = read_log(tmp_path / "log.csv")
    assert "vx=cos-2048, vy=sin-2048" in log.guess.text
    assert any("middle of the converter" in note for note in log.guess.notes)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_direction_of_0_and_1_is_told_by_the_reference(sense: float, tmp_path: Path) -> None:
    there = np.concatenate([REFERENCE_DEG, REFERENCE_DEG[::-1]])
    forward = np.repeat([1.0, 0.0] if sense > 0 else [0.0, 1.0], ROWS)
    both = np.concatenate([MEASURED_DEG, MEASURED_DEG[::-1]])
    (tmp_path / "log.csv").write_text(table({"ref": there, "sensor": both, "dir": forward}))
    found = read_log(tmp_path / "log.csv").columns["direction"]
    assert np.array_equal(found, np.repeat([1.0, -1.0], ROWS))


def test_every_column_of_a_sweep_can_be_said() -> None:
    text = ", ".join(f"{name}={name}" for name in COLUMNS)
    assert [column.target for column in parsed(text)] == list(COLUMNS)


@pytest.mark.parametrize("name", [name for name, unit in UNITS.items() if unit.quantity == "angle"])
def test_every_unit_of_an_angle_that_a_header_names_is_read(name: str, tmp_path: Path) -> None:
    rows = zip(REFERENCE_DEG / UNITS[name].factor, MEASURED_DEG, strict=True)
    path = tmp_path / "log.csv"
    path.write_text(f"ref [{name}];sensor [deg]\n" + "\n".join(f"{a:.9g};{b:.6f}" for a, b in rows))
    columns = read_log(path).columns
    np.testing.assert_allclose(columns["reference_deg"], REFERENCE_DEG, atol=1e-5)
    np.testing.assert_allclose(columns["measured_deg"], MEASURED_DEG, atol=1e-5)


def test_of_geared_logs_drawn_at_random_none_is_misread(tmp_path: Path) -> None:
    """Of 60; of one in twenty counts that may make a turn are asked back, as many of large steps are refused."""
    found = [outcome(seed, tmp_path, drawn_geared) for seed in range(60)]
    assert found.count("wrong") == 0
    assert found.count("asked back") <= 3
    assert found.count("right") >= 51


def test_radians_twenty_times_and_degrees_of_an_eighteenth_turn_are_asked_back(tmp_path: Path) -> None:
    """A turn of 20 times 2 pi, or 360 deg of an angle of which 18 are a turn: the same numbers, and no name tells."""
    assert outcome(3031296, tmp_path, drawn_geared) == "asked back"


def test_electrical_degrees_are_read_and_said(tmp_path: Path) -> None:
    """An electrical angle of seven pole pairs, wrapped and in radians; its errors are those of the shaft."""
    path = tmp_path / "log.csv"
    electrical = np.radians(7.0 * MEASURED_DEG % 360.0)
    path.write_text(table({"encoder_deg": REFERENCE_DEG, "theta_e [rad]": electrical}))
    log = read_log(path)
    assert log.guess.text == "reference_deg=encoder_deg, measured_deg=unwrap('theta_e [rad]':rad)/7"
    assert log.guess.notes == ("measured_deg turns 7 times in a turn of the shaft: pole pairs, or a gear",)
    off = log.columns["measured_deg"] - MEASURED_DEG
    assert np.max(np.abs((off - off[0] + 180.0) % 360.0 - 180.0)) < 1e-4


def test_a_missing_cell_of_an_electrical_angle_stays_one(tmp_path: Path) -> None:
    """And ends nothing: the rows behind it are followed from the row before it."""
    path = tmp_path / "log.csv"
    rows = table({"encoder_deg": REFERENCE_DEG, "theta_e_deg": 7.0 * MEASURED_DEG % 360.0}).splitlines()
    rows[9] = rows[9].split(",")[0] + ","
    path.write_text("\n".join(rows))
    log = read_log(path)
    assert list(np.flatnonzero(np.isnan(log.columns["measured_deg"]))) == [8]
    assert log.guess.text == "reference_deg=encoder_deg, measured_deg=unwrap(theta_e_deg)/7"


def test_geared_radians_or_degrees_of_a_short_span_are_asked_for(tmp_path: Path) -> None:
    """Two angles that span 47 and tell no unit, both alike in degrees and, over seven turns, in radians."""
    path = tmp_path / "log.csv"
    shaft = np.linspace(0.0, 7.5 * 360.0, 400)
    path.write_text(table({"ref": np.radians(shaft), "sensor": np.radians(shaft + 30.0 + np.sin(np.radians(shaft)))}))
    with pytest.raises(SweepError, match=r"two guesses fit.*measured_deg=sensor:rad"):
        read_log(path)


def test_own_names_are_told_how_an_electrical_angle_is_read(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table({"reference_deg": REFERENCE_DEG, "measured_deg": 4.0 * MEASURED_DEG % 360.0}))
    refused = halltwin("diagnose", path).err
    assert "turns 4 times as fast" in refused
    assert OPTION.findall(refused) == ["reference_deg=reference_deg, measured_deg=unwrap(measured_deg)/4"]


def test_of_logs_drawn_at_random_none_is_misread(tmp_path: Path) -> None:
    """Of 60; one in ten may be asked back, as on a single turn 4000 and 4096 counts are hardly told apart."""
    found = [outcome(seed, tmp_path) for seed in range(60)]
    assert found.count("wrong") == 0
    assert found.count("right") >= 54


@pytest.mark.parametrize(("name", "factor"), [("current_mA", 1000.0), ("current_A", 1.0), ("iq [mA]", 1000.0)])
def test_a_current_is_read_in_the_unit_of_its_name(name: str, factor: float, tmp_path: Path) -> None:
    current = np.linspace(4.0, 6.0, ROWS)
    path = tmp_path / "log.csv"
    path.write_text(table({"encoder_deg": REFERENCE_DEG, "sensor_deg": MEASURED_DEG, name: np.round(factor * current)}))
    np.testing.assert_allclose(read_log(path).columns["current_a"], np.round(factor * current) / factor)


OTHER_LANGUAGES = {
    "German": ("Zeit [s]", "Referenzwinkel [deg]", "Istwinkel [deg]"),
    "German, as set": ("Zeitstempel [s]", "Sollwert [deg]", "Messwert [deg]"),
    "French": ("Temps [s]", "Angle de référence [deg]", "Angle mesuré [deg]"),
    "Italian": ("Tempo [s]", "Angolo di riferimento [deg]", "Angolo misurato [deg]"),
    "Spanish": ("Tiempo [s]", "Ángulo de referencia [deg]", "Ángulo medido [deg]"),
}


@pytest.mark.parametrize("name", OTHER_LANGUAGES)
@pytest.mark.parametrize("swapped", [False, True])
def test_names_of_other_languages_say_which_angle_is_which(name: str, swapped: bool, tmp_path: Path) -> None:
    time, reference, measured = OTHER_LANGUAGES[name]
    columns = {time: 0.1 * np.arange(ROWS), reference: REFERENCE_DEG, measured: MEASURED_DEG}
    path = tmp_path / "log.csv"
    path.write_text(table(dict(reversed(columns.items())) if swapped else columns), encoding="utf-8")
    found = read_log(path)
    assert found.columns["reference_deg"] == pytest.approx(REFERENCE_DEG, abs=1e-3)
    assert found.columns["measured_deg"] == pytest.approx(MEASURED_DEG, abs=1e-3)
    assert "time_s" in found.columns


def test_of_two_guesses_it_is_said_in_what_they_differ(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table({"Zeit [s]": 0.1 * np.arange(ROWS), "A [deg]": REFERENCE_DEG, "B [deg]": MEASURED_DEG}))
    with pytest.raises(SweepError, match="reference_deg is the angle that is taken as true") as caught:
        read_log(path)
    # Whichever is copied, the time is not lost.
    assert str(caught.value).count("time_s='Zeit [s]'") == 2


def test_an_error_and_a_correction_are_asked_back_by_their_signs(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table({"Winkel [deg]": REFERENCE_DEG, "Korrektur [deg]": np.sin(np.radians(REFERENCE_DEG))}))
    with pytest.raises(SweepError, match="an error is the reading less the true angle"):
        read_log(path)
