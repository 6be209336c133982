"""What may be handed in as a sweep, and what is said about what may not."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis.input_checks import as_sweep
from tests.command_line import Array, sweep_angles
from twin.errors import SweepError, UserError
from twin.sweep import Sweep

pd = pytest.importorskip("pandas")
xr = pytest.importorskip("xarray")

REFERENCE = np.arange(0.0, 360.0, 2.0)
COLUMNS: dict[str, Array] = {
    "reference_deg": REFERENCE,
    "measured_deg": sweep_angles(REFERENCE),
    "time_s": 0.5 * np.arange(REFERENCE.size),
    "temperature_c": np.where(np.arange(REFERENCE.size) % 3, 25.0, np.nan),
}
FRAME = pd.DataFrame({"note": ["a"] * REFERENCE.size, **COLUMNS})


def with_cell(value: Any) -> dict[str, Any]:
    """The columns with this in the seventh row of ``measured_deg``."""
    cells: list[Any] = COLUMNS["measured_deg"].tolist()
    cells[6] = value
    return {**COLUMNS, "measured_deg": cells}


def written(folder: Path) -> Path:
    """The columns as a file that loses nothing."""
    path = folder / "sweep.csv"
    rows = zip(*COLUMNS.values(), strict=True)
    lines = [",".join(COLUMNS), *(",".join("" if np.isnan(v) else repr(float(v)) for v in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


ACCEPTED: dict[str, Any] = {
    "dict of arrays": COLUMNS,
    "dict of lists": {name: values.tolist() for name, values in COLUMNS.items()},
    "single precision": {**COLUMNS, "time_s": COLUMNS["time_s"].astype(np.float32)},
    "whole numbers": {**COLUMNS, "reference_deg": REFERENCE.astype(int)},
    "decimals": {**COLUMNS, "reference_deg": [Decimal(str(v)) for v in REFERENCE]},
    "DataFrame": FRAME,
    "DataFrame, time as index": FRAME.set_index("time_s"),
    "DataFrame, two levels of index": FRAME.set_index(["note", "reference_deg"]),
    "DataFrame of pandas' own types": FRAME.convert_dtypes(),
    "DataFrame of objects": FRAME.astype(object),
    "Dataset": xr.Dataset({name: ("row", values) for name, values in COLUMNS.items()}),
    "Dataset, time as coordinate": xr.Dataset.from_dataframe(FRAME.set_index("time_s")),
}


@pytest.mark.parametrize("source", ACCEPTED.values(), ids=ACCEPTED)
def test_each_kind_gives_the_sweep_of_the_file(source: Any, tmp_path: Path) -> None:
    wanted = Sweep.read(written(tmp_path)).columns
    found = as_sweep(source).columns
    assert list(found) == list(wanted)
    for name, values in wanted.items():
        np.testing.assert_array_equal(found[name], values)


def test_a_path_is_read_and_a_sweep_taken_as_it_is(tmp_path: Path) -> None:
    path = written(tmp_path)
    for given in (path, str(path)):
        assert as_sweep(given).name == "sweep.csv"
    sweep = Sweep.read(path)
    assert as_sweep(sweep) is sweep


MISSING = {"None": None, "NaN": np.nan, "pandas' NA": pd.NA, "pandas' NaT": pd.NaT, "infinite": np.inf}


@pytest.mark.parametrize("cell", MISSING.values(), ids=MISSING)
def test_a_missing_cell_rejects_its_row(cell: Any) -> None:
    for source in (with_cell(cell), pd.DataFrame(with_cell(cell))):
        sweep = as_sweep(source)
        assert sweep.rejected == {7: "measured_deg missing or not finite"}
        assert len(sweep) == REFERENCE.size - 1


def test_a_masked_cell_is_missing() -> None:
    values = np.ma.MaskedArray(COLUMNS["measured_deg"], mask=np.arange(REFERENCE.size) == 6)
    assert set(as_sweep({**COLUMNS, "measured_deg": values}).rejected) == {7}


SQUARE = {name: (("turn", "angle"), values.reshape(2, -1)) for name, values in COLUMNS.items()}
REFUSED: dict[str, tuple[Any, tuple[str, ...]]] = {
    "nothing": (None, ("NoneType", "a path, a Sweep, or columns")),
    "a list": ([1.0, 2.0], ("type list", "a path, a Sweep, or columns")),
    "an array": (np.zeros((9, 2)), ("type ndarray", "columns by name")),
    "a missing column": (
        FRAME.rename(columns={"measured_deg": "angle"}),
        ("DataFrame: column measured_deg is missing", "note, reference_deg, angle", "rename"),
    ),
    "no column": ({}, ("dict: column reference_deg is missing", "found no column")),
    "words": (with_cell("banana"), ("dict: column measured_deg, row 7", "'banana'", "expected a number")),
    "numbers as text": (FRAME.astype(str), ("DataFrame: column", "row 1", "(str)", "convert the column")),
    "truth values": (with_cell(True), ("column measured_deg, row 7", "True (bool)", "expected a number")),
    "a number of many digits": (with_cell(10**400), ("column measured_deg, row 7", "1000", "expected a number")),
    "a signalling NaN": (with_cell(Decimal("sNaN")), ("column measured_deg, row 7", "sNaN", "expected a number")),
    "a name that no file can bear": ("a\0b.csv", ("is no name of a file",)),
    "complex numbers": (with_cell(1j), ("column measured_deg, row 7", "1j (complex)", "expected a number")),
    "points in time": (
        FRAME.assign(time_s=pd.to_datetime(FRAME["time_s"], unit="s")),
        ("DataFrame: column time_s", "datetime64", "convert to seconds"),
    ),
    "a short column": (
        {**COLUMNS, "time_s": COLUMNS["time_s"][:-1]},
        ("dict: column time_s holds 179 values and reference_deg 180", "one for each reading"),
    ),
    "a single value": ({**COLUMNS, "time_s": 3.0}, ("dict: column time_s has the shape ()", "one number for each")),
    "two dimensions": (xr.Dataset(SQUARE), ("Dataset: column", "has the shape (2, 90)", "in one dimension")),
    "a column twice": (
        pd.concat([FRAME, FRAME[["measured_deg"]]], axis=1),
        ("DataFrame: column measured_deg has the shape (180, 2)", "in one dimension"),
    ),
    "what no bench can mean": (with_cell(1e12), ("dict: row 7, column measured_deg", "found 1e+12", "expected")),
    "too few rows": (FRAME[:5], ("DataFrame: 5 usable rows", "at least 8")),
    "no such file": ("nowhere.csv", ("nowhere.csv: no such file",)),
}


@pytest.mark.parametrize(("source", "words"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_used_is_said_in_one_line(source: Any, words: tuple[str, ...]) -> None:
    with pytest.raises(SweepError) as caught:
        as_sweep(source)
    assert isinstance(caught.value, UserError)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message
