"""Tables of firmwares are read to the angles that they store, or asked back with the statement that reads them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.untidy.__main__ import outcome
from tests.untidy.drawn_tables import drawn_table
from tests.untidy.generator import Array, table
from tests.untidy.tables import Stored, reading_of, stored, true_of
from twin.errors import SweepError
from twin.logs.asked_back import OpenGuess
from twin.logs.read import Log, read_log
from twin.sweep import Sweep

STORED = stored()
READ = [name for name, one in STORED.items() if not one.asked]
ASKED = [name for name, one in STORED.items() if one.asked]


def written(one: Stored, folder: Path) -> Path:
    path = folder / "table.txt"
    path.write_text(one.text, encoding="utf-8")
    return path


def check_same(sweep: Sweep, one: Stored) -> None:
    """Row by row the angles that the table stores."""
    for found, expected in ((sweep.reference_deg, one.reference_deg), (sweep.measured_deg, one.measured_deg)):
        assert np.max(np.abs((found - expected + 180.0) % 360.0 - 180.0)) <= one.resolution_deg


def told(log: Log) -> str:
    return " ".join([log.guess.text, *log.guess.notes, *log.guess.unused, *log.table.notes, *log.table.left])


@pytest.mark.parametrize("name", READ)
def test_a_table_is_read_to_the_angles_that_it_stores(name: str, tmp_path: Path) -> None:
    """Its guess, said by ``--columns``, reads the same; the sweep knows that its readings are the table's index."""
    one = STORED[name]
    path = written(one, tmp_path)
    log = read_log(path)
    for word in one.told:
        assert word in told(log)
    sweep = Sweep.read(path, columns=log.guess.text)
    check_same(sweep, one)
    assert np.array_equal(sweep.reference_deg, log.columns["reference_deg"])
    if one.grid_deg is not None:
        assert sweep.reading_grid_deg == pytest.approx(one.grid_deg)


@pytest.mark.parametrize("name", ASKED)
def test_a_table_that_fits_several_ways_is_asked_back(name: str, tmp_path: Path) -> None:
    """With the right one told first."""
    one = STORED[name]
    path = written(one, tmp_path)
    with pytest.raises(OpenGuess, match="guesses fit") as caught:
        read_log(path)
    check_same(Sweep.read(path, columns=caught.value.options[0]), one)


def test_of_two_sources_one_is_asked_for(tmp_path: Path) -> None:
    text = STORED["moteus"].text
    both = written(Stored(text + text.replace("sources.0", "sources.2"), *[np.zeros(1)] * 2, 0.0), tmp_path)
    with pytest.raises(OpenGuess, match=r"two guesses fit.*sources\.0.*sources\.2"):
        read_log(both)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f'{{"axis0": {{"cogging_map": {np.round(0.1 * np.sin(np.arange(24) / 4.0), 4).tolist()}}}}}', "holds torques"),
        (
            "<?xml version='1.0'?><MCConfiguration><foc_encoder_ratio>7</foc_encoder_ratio></MCConfiguration>",
            "settings",
        ),
        ("float calibrationLut[8] = {0, 0, 0, 0, 0, 0, 0, 0};", "all entries of calibrationLut are 0"),
        ("int16_t sine[16] = {0,12539,23170,30273,32767,30273,23170,12539,0,-9,-7,-3,-2,-3,-7,-9};", "neither angles"),
        ("\n".join(f"{k * k % 97}" for k in range(40)), "two or more numbers in each line"),
        (f'{{"entry": [{"1, " * 20}1{"0" * 400}]}}', "entry[20] is inf; expected numbers"),
        (f'{{"entry": [{"1, " * 20}-1{"0" * 400}]}}', "entry[20] is -inf"),
        (f'{{"entry": [{"NaN, " * 20}NaN]}}', "entry[0] is nan"),
        (f'{{"a": {{"\u00b2": 1}}, "entry": [{"NaN, " * 20}NaN]}}', "entry[0] is nan"),
        (f'{{"A_SHIFT": 9999, "a_entry": [{"1, " * 20}2]}}', "all entries of a_entry are 0"),
        (f"int lookup[21] = {{{'1, ' * 20}0x{'f' * 400}}};", "lookup[20] is inf"),
        (f"float calibrationLut[21] = {{{'1e400, ' * 20}1e400}};", "calibrationLut[0] is inf"),
        (f"float calibrationLut[21] = {{{'1e300, ' * 20}1e308}}; int lookup[21] = {{{'1, ' * 20}0}};", "is 1e+300"),
        ("\n".join(["1e400"] * 40), "entry[0] is inf"),
    ],
)
def test_what_is_no_table_of_angles_is_refused_with_the_reason(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "table.txt"
    path.write_text(text)
    ended = halltwin("import", path)
    assert ended.code == 2
    assert words in ended.err
    assert ended.err.count("\n") == 1


@pytest.mark.parametrize("line", ["firmware 1.2.3", "address 10.0.0.7", "firmware .", f"motor.table.{'9' * 5000} 1"])
def test_a_line_of_a_configuration_that_holds_no_number_is_passed_over(line: str, tmp_path: Path) -> None:
    name = "motor_position.sources.0.compensation_table"
    plain, mixed = tmp_path / "plain.cfg", tmp_path / "mixed.cfg"
    first, _, rest = STORED["moteus"].text.partition("\n")
    plain.write_text(f"{first}\n{rest}")
    mixed.write_text(f"{first}\n{line}\n{rest}")
    assert name in read_log(plain).guess.text
    assert read_log(mixed).guess == read_log(plain).guess


EVEN_DEG = np.arange(0.0, 360.0, 5.0)
READ_DEG, TRUE_DEG = reading_of(EVEN_DEG), true_of(EVEN_DEG)
CODES = 2.8125 * np.arange(128)
TRUE_OF_CODES = true_of(CODES)
OF_REFERENCE, OF_SENSOR = (EVEN_DEG, READ_DEG), (TRUE_DEG, EVEN_DEG)
LISTED: dict[str, tuple[dict[str, Array], tuple[Array, Array], float, bool]] = {
    "errors of a bench": ({"reference_deg": EVEN_DEG, "error_deg": READ_DEG - EVEN_DEG}, OF_REFERENCE, 1e-6, False),
    "errors in arc minutes": (
        {"Reference [deg]": EVEN_DEG, "Abweichung [arcmin]": 60.0 * (READ_DEG - EVEN_DEG)},
        OF_REFERENCE,
        1e-6,
        False,
    ),
    "errors without units": ({"stage": EVEN_DEG, "err": READ_DEG - EVEN_DEG}, OF_REFERENCE, 1e-6, False),
    "corrections of readings": (
        {"sensor_deg": EVEN_DEG, "correction_deg": TRUE_DEG - EVEN_DEG},
        OF_SENSOR,
        1e-6,
        False,
    ),
    "corrections in counts": (
        {"AS5600 raw": 32.0 * np.arange(128.0), "correction": np.round((TRUE_OF_CODES - CODES) * 4096 / 360)},
        (TRUE_OF_CODES, CODES),
        0.0441,
        False,
    ),
    "an angle of either side": ({"angle": EVEN_DEG, "error": EVEN_DEG - TRUE_DEG}, OF_SENSOR, 1e-6, True),
    "an index": ({"index": np.arange(72.0), "error [rad]": np.radians(EVEN_DEG - TRUE_DEG)}, OF_SENSOR, 6e-5, True),
}


@pytest.mark.parametrize("name", LISTED)
def test_errors_listed_beside_an_angle_are_read(name: str, tmp_path: Path) -> None:
    """On the axis of either angle, by the sign that the words have; where the axis is not told, that is asked."""
    columns, angles, resolution_deg, asked = LISTED[name]
    path = tmp_path / "log.csv"
    path.write_text(table(columns))
    one = Stored("", *angles, resolution_deg)
    if asked:
        with pytest.raises(OpenGuess, match="two guesses fit") as caught:
            read_log(path)
        check_same(Sweep.read(path, columns=caught.value.options[0]), one)
    else:
        log = read_log(path)
        assert "an error is the reading less the true angle" in told(log)
        check_same(Sweep.read(path, columns=log.guess.text), one)


def test_of_tables_drawn_at_random_none_is_misread(tmp_path: Path) -> None:
    """Of 100; what half of them hold is open by name and values, as the sign of a table called ``lut``."""
    found = [outcome(seed, tmp_path, drawn_table) for seed in range(100)]
    assert found.count("wrong") == 0
    assert found.count("right") >= 40


def test_a_table_is_diagnosed_by_its_statement(tmp_path: Path) -> None:
    """Where explain refuses it, its message ends with the statement that diagnose takes."""
    path = written(STORED["SimpleFOC"], tmp_path)
    refused = halltwin("diagnose", path)
    statement = "reference_deg=index*360/200-calibrationLut:rad, measured_deg=index*360/200"
    assert f'--columns "{statement}"' in refused.err
    assert halltwin("diagnose", path, "--columns", statement).code == 0


def test_the_sign_of_a_second_column_is_that_of_arithmetic(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("a,b,c\n" + "".join(f"{k},{k % 7},{k}\n" for k in range(0, 360, 2)))
    rows = np.arange(0.0, 360.0, 2.0)
    sweep = Sweep.read(path, columns="reference_deg=a*2+5-b*3/2:mrad, measured_deg=a*2")
    np.testing.assert_allclose(sweep.reference_deg, 2.0 * rows + 5.0 - np.degrees(1.5e-3 * (rows % 7.0)), atol=1e-9)
    with pytest.raises(SweepError, match="no column 'd'"):
        Sweep.read(path, columns="reference_deg=a+d, measured_deg=c")
