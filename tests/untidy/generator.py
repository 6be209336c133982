"""One known sweep written in many untidy ways, by code that knows nothing of the reader.

Each way says what it keeps of the sweep: to what resolution, and what must be said where it cannot be read unasked.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROWS = 360
TIME_S = 0.05 * np.arange(ROWS)
REFERENCE_DEG = np.arange(ROWS) * 2.5 + 7.25
"""Two and a half turns, not wrapped."""
MEASURED_DEG = (REFERENCE_DEG + 41.0 + 0.8 * np.sin(np.radians(REFERENCE_DEG + 20.0))) % 360.0
TEMPERATURE_C = 24.0 + 0.01 * np.arange(ROWS)
SIN, COS = np.sin(np.radians(MEASURED_DEG)), np.cos(np.radians(MEASURED_DEG))
ANGLES = {"reference_deg": REFERENCE_DEG, "measured_deg": MEASURED_DEG}


@dataclass(frozen=True)
class Way:
    """A file, to which resolution it holds which columns, and what is said of it where it is not read unasked."""

    content: bytes
    resolution: dict[str, float]
    refused: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    ending: str = ".csv"
    others: dict[str, Array] = field(default_factory=dict)


def counts(angle_deg: Array, a_turn: int, *, wrapped: bool = True) -> Array:
    """An angle as whole counts."""
    whole = np.round(angle_deg * a_turn / 360.0)
    return whole % a_turn if wrapped else whole


def table(
    columns: dict[str, Array],
    *,
    sep: str = ",",
    digits: int = 6,
    header: bool = True,
    decimal: str = ".",
    end: str = "\n",
) -> str:
    """Columns as text, whole numbers without a point."""

    def cell(value: float, whole: bool) -> str:
        text = f"{value:.0f}" if whole else f"{value:.{digits}f}"
        return text.replace(".", decimal)

    wholes = [bool(np.all(values == np.round(values))) for values in columns.values()]
    rows = [
        sep.join(cell(float(v), whole) for v, whole in zip(row, wholes, strict=True))
        for row in zip(*columns.values(), strict=True)
    ]
    return end.join([*([sep.join(columns)] if header else []), *rows, ""])


FINE = {"reference_deg": 2e-6, "measured_deg": 2e-6}
"""Six digits behind the point."""
FINE_RADIANS = {"reference_deg": 6e-5, "measured_deg": 6e-5}
PLAIN = table({"reference_deg": REFERENCE_DEG, "measured_deg": MEASURED_DEG})
R, M, T = REFERENCE_DEG, MEASURED_DEG, TIME_S


def _step(a_turn: int) -> float:
    return 180.0 / a_turn + 1e-9


def _text() -> dict[str, Way]:
    """The same names and units in other dialects of text."""
    timed = {"Time [s]": T, "Reference [deg]": R, "Sensor [deg]": M}
    time = {"others": {"time_s": T}}

    def way(text: str, encoding: str = "utf-8", **more: Any) -> Way:
        return Way(text.encode(encoding), FINE, **{**time, **more})

    return {
        "semicolons and decimal commas": way(table(timed, sep=";", decimal=",")),
        "tabs and decimal commas": way(table(timed, sep="\t", decimal=",")),
        "tabs": way(table(timed, sep="\t")),
        "blanks": way(table(timed, sep="   ")),
        "bars": way(table(timed, sep=" | ")),
        "wrong case": way(table({"TIME_S": T, "REFERENCE_DEG": R, "Measured_Deg": M})),
        "columns the other way round": way(table({"measured_deg": M, "reference_deg": R, "time_s": T})),
        "Latin-1": way(table({"Zeit (s)": T, "Referenz (°)": R, "Sensor (°)": M}), "latin-1"),
        "byte order mark and line ends of Windows": way(table(timed, end="\r\n"), "utf-8-sig"),
        "UTF-16": way(table(timed, sep="\t"), "utf-16"),
        "UTF-16 without its mark": way(table(timed, sep="\t"), "utf-16-le"),
        "lines that end with the separator": way(table(timed, sep=";").replace("\n", ";\n")),
        "remarks above the header": way("Logger 3.1\nSerial,0017\nDate: 3 May\n\n" + table(timed)),
        "a comment as header": way("# t [s] ref meas\n" + table(timed, sep=" ", header=False)),
        "a row of units": way(
            table({"t": T, "ref": R, "sensor": M}).replace("t,ref,sensor\n", "t,ref,sensor\ns,deg,deg\n")
        ),
        "quoted names": way(table(timed).replace("Reference [deg]", '"Reference [deg]"')),
    }


def _units() -> dict[str, Way]:
    """Other units, in brackets, as endings, or not told at all."""
    fine_count, coarse = _step(40_000), _step(4096)
    return {
        "radians in brackets": Way(
            table({"Ref [rad]": np.radians(R), "Angle [rad]": np.radians(M)}).encode(), FINE_RADIANS
        ),
        "radians as ending": Way(table({"ref_rad": np.radians(R), "sensor_rad": np.radians(M)}).encode(), FINE_RADIANS),
        "radians not told": Way(table({"reference": np.radians(R), "sensor": np.radians(M)}).encode(), FINE_RADIANS),
        "turns": Way(
            table({"ref (rev)": R / 360.0, "sensor (turns)": M / 360.0}, digits=9).encode(),
            {"reference_deg": 1e-6, "measured_deg": 1e-6},
        ),
        "counts of an encoder": Way(
            table({"enc_counts": counts(R, 40_000, wrapped=False), "angle [rad]": np.radians(M)}).encode(),
            {"reference_deg": fine_count, "measured_deg": 6e-5},
        ),
        "counts of the sensor": Way(
            table({"ref_deg": R, "AS5600 raw": counts(M, 4096)}).encode(),
            {"reference_deg": 2e-6, "measured_deg": coarse},
        ),
        "counts not told": Way(
            table({"encoder": counts(R, 2400), "hall_angle": counts(M, 16_384)}).encode(),
            {"reference_deg": _step(2400), "measured_deg": _step(16_384)},
        ),
        "milliseconds": Way(
            table({"time_ms": 1000.0 * T, "reference_deg": R, "measured_deg": M}).encode(), FINE, others={"time_s": T}
        ),
        "microseconds": Way(table({"micros": 1e6 * T, "ref": R, "sensor": M}).encode(), FINE, others={"time_s": T}),
        "time without a unit": Way(
            table({"timestamp": 1000.0 * T, "ref": R, "sensor": M}).encode(), FINE, unused=("timestamp", "s, ms or us")
        ),
        "words, numbers of rows and a status": Way(
            table({"sample": np.arange(ROWS) + 1.0, "ref": R, "sensor": M, "status": 0.0 * R}).encode(),
            FINE,
            others={"status": 0.0 * R},
            unused=("sample",),
        ),
        "a current and what the sensor says of itself": Way(
            table(
                {
                    "current_angle": M,
                    "ref": R,
                    "motor_current [mA]": 1000.0 * TEMPERATURE_C,
                    "AGC": 0.0 * R + 128.0,
                    "field magnitude": 0.0 * R + 1800.0,
                    "frame counter": np.arange(ROWS) % 256.0,
                }
            ).encode(),
            FINE,
            others={
                "current_a": TEMPERATURE_C,
                "agc": 0.0 * R + 128.0,
                "magnitude": 0.0 * R + 1800.0,
                "frame": np.arange(ROWS) % 256.0,
            },
        ),
        "kelvin": Way(
            table({"ref": R, "sensor": M, "temp_K": TEMPERATURE_C + 273.15}).encode(),
            FINE,
            others={"temperature_c": TEMPERATURE_C},
        ),
        "sine and cosine beside the angle": Way(
            table({"ref": R, "angle": M, "sin": SIN, "cos": COS}).encode(), FINE, others={"vx": COS, "vy": SIN}
        ),
        "sine and cosine alone": Way(
            table({"encoder_deg": R, "Sin [V]": SIN, "Cos [V]": COS}).encode(),
            {"reference_deg": 2e-6, "measured_deg": 1e-4},
            others={"vx": COS, "vy": SIN},
        ),
    }


def _asked() -> dict[str, Way]:
    """What is asked back, or cannot be read; where ``resolution`` is not empty, the first option told reads it."""
    repeated = table({"a": R, "b": M}, digits=3, decimal=",")
    return {
        "no header": Way(table(ANGLES, header=False).encode(), FINE, ("two guesses fit", "#2")),
        "names that tell nothing": Way(table({"ch1": R, "ch2": M}).encode(), FINE, ("two guesses fit", "ch2")),
        "whole numbers on less than a turn": Way(
            table({"ref": counts(0.3 * R, 4096, wrapped=False), "sensor": counts(0.3 * R + 5.0, 4096)}).encode(),
            {},
            ("two guesses fit", "ref*360/4096"),
        ),
        "two sensors": Way(
            table({"ref": R, "sensor_a": M, "sensor_b": M + 3.0}).encode(),
            FINE,
            ("two guesses fit", "sensor_a", "sensor_b"),
        ),
        "counts under _deg": Way(
            table({"reference_deg": R, "measured_deg": counts(M, 4096)}).encode(),
            {"reference_deg": 2e-6, "measured_deg": _step(4096)},
            ("measured_deg is named in deg", "4096 counts"),
        ),
        "radians under _deg": Way(
            table({"reference_deg": np.radians(R), "measured_deg": np.radians(M)}).encode(),
            FINE_RADIANS,
            ("values fit rad",),
        ),
        "decimal commas between commas": Way(
            repeated.encode(), {}, ("line 2 has 4 cells under 2 names", "decimal points, or semicolons")
        ),
        "a word among the readings": Way(
            PLAIN.replace("reference_deg,measured_deg", "ref,sensor").replace("\n12.250000,", "\noops,").encode(),
            {},
            ("line 4, column ref: 'oops' is not a number",),
        ),
        "a row too short": Way(PLAIN.replace("\n12.250000,", "\n").encode(), {}, ("line 4 has 1 cells", "expected 2")),
        "one column": Way(table({"angle": M}).encode(), {}, ("two or more numbers",)),
        "unrelated": Way(
            table({"ref": R, "sensor": M[::-1] * np.arange(ROWS) % 360.0}).encode(),
            {},
            ("no two columns are angles that follow each other",),
        ),
    }


def files(name: str) -> Way:
    """A file of another program: its library is asked for only where it is wanted."""
    made: dict[str, tuple[Callable[[], bytes], str, tuple[str, ...]]] = {
        "workbook": (_workbook, ".xlsx", ("remark", "sheet 'Cover' is not used")),
        "MAT": (_matlab, ".mat", ("fs", "who")),
        "NPZ": (_numpy, ".npz", ("rate",)),
        "HDF5": (_hdf5, ".h5", ()),
        "Parquet": (_parquet, ".parquet", ("who",)),
    }
    make, ending, unused = made[name]
    exact = {"reference_deg": 1e-9, "measured_deg": 1e-9}
    return Way(make(), exact, unused=unused, ending=ending, others={"time_s": T})


def _workbook() -> bytes:
    from openpyxl import Workbook

    book, out = Workbook(), io.BytesIO()
    book.active.title = "Cover"
    book.active.append(["Bench 3"])
    sheet = book.create_sheet("Data")
    sheet.append(["measured on the second stage"])
    sheet.append(["t [ms]", "Reference [deg]", "Sensor [deg]", "remark"])
    for row in zip(1000.0 * T, R, M, strict=True):
        sheet.append([*map(float, row), None])
    sheet.cell(5, 4, "restarted")
    book.save(out)
    return out.getvalue()


def _matlab() -> bytes:
    from scipy.io import savemat

    out = io.BytesIO()
    savemat(out, {"log": {"time_s": T[:, None], "ref_rad": np.radians(R), "sensor_deg": M}, "fs": 20.0, "who": "me"})
    return out.getvalue()


def _numpy() -> bytes:
    out = io.BytesIO()
    np.savez(out, t_s=T, encoder_deg=R, hall_rad=np.radians(M), rate=20.0)
    return out.getvalue()


def _parquet() -> bytes:
    import pyarrow
    from pyarrow import parquet

    out = pyarrow.BufferOutputStream()
    columns = {"t [ms]": 1000.0 * T, "encoder [rad]": np.radians(R), "hall": M, "who": ["me"] * ROWS}
    parquet.write_table(pyarrow.table(columns), out)
    return bytes(out.getvalue())


def _hdf5() -> bytes:
    import h5py

    out = io.BytesIO()
    with h5py.File(out, "w") as store:
        group = store.create_group("run1")
        for name, values, unit in (("time", T, "s"), ("reference", R, "deg"), ("sensor", np.radians(M), "rad")):
            group.create_dataset(name, data=values).attrs["units"] = unit
    return out.getvalue()


def ways() -> dict[str, Way]:
    """Every way by its name."""
    return {**_text(), **_units(), **_asked()}
