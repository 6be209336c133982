"""The known sweep of ``generator`` in the files of measurement systems, each written by the library of its format."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tests.untidy.generator import MEASURED_DEG, REFERENCE_DEG, ROWS, TEMPERATURE_C, TIME_S, Array

DBC = """VERSION ""
BS_:
BU_: Bench Dut
BO_ 256 Bench: 8 Bench
 SG_ stage_angle : 0|32@1- (0.001,0) [-1000|2000] "deg" Dut
BO_ 257 Sensor: 8 Dut
 SG_ hall_angle : 0|16@1+ (0.005493164,0) [0|360] "deg" Bench
 SG_ die_temperature : 16|16@1- (0.01,0) [-40|150] "C" Bench
"""
LATE_S = 0.01
"""By how much later the sensor's frames come than those of the bench."""


def mdf(path: Path, *, late_s: float = 0.0) -> None:
    """MDF of version 4: reference and sensor in groups of their own, the sensor later by a part of a step."""
    from asammdf import MDF, Signal

    def signal(name: str, unit: str, values: Array, later_s: float) -> Any:
        return Signal(samples=values, timestamps=TIME_S + later_s, name=name, unit=unit)

    store = MDF(version="4.10")
    store.append([signal("stage_angle", "deg", REFERENCE_DEG, 0.0)], common_timebase=True)
    store.append(
        [
            signal("hall_angle", "rad", np.radians(MEASURED_DEG), late_s),
            signal("die_temperature", "°C", TEMPERATURE_C, late_s),
        ],
        common_timebase=True,
    )
    store.save(path, overwrite=True)
    store.close()


def tdms(path: Path, *, clock: bool) -> None:
    """TDMS: one group, its channels with or without a clock of their own."""
    from nptdms import ChannelObject, TdmsWriter

    timing = {"wf_increment": 0.05, "wf_start_offset": 0.0} if clock else {}
    columns = {
        "stage angle": (REFERENCE_DEG, "deg"),
        "hall angle": (np.radians(MEASURED_DEG), "rad"),
        "remark": (np.array(["ok"] * ROWS), ""),
    }
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [
                ChannelObject("run 1", name, values, properties={"unit_string": unit, **timing} if unit else timing)
                for name, (values, unit) in columns.items()
            ]
        )


def bus(path: Path) -> None:
    """A log of python-can in the format of the path's ending, with its DBC beside it and a frame that this lacks."""
    import can
    import cantools

    path.with_suffix(".dbc").write_text(DBC)
    database: Any = cantools.database.load_string(DBC)
    start = 1.7e9
    with can.Logger(str(path)) as log:
        for k in range(ROWS):
            sent = (
                ("Bench", {"stage_angle": REFERENCE_DEG[k]}, 0.0),
                ("Sensor", {"hall_angle": MEASURED_DEG[k], "die_temperature": TEMPERATURE_C[k]}, LATE_S),
            )
            for name, signals, late_s in sent:
                message = database.get_message_by_name(name)
                data = message.encode(signals)
                log(_frame(can, message.frame_id, data, start + TIME_S[k] + late_s))
            log(_frame(can, 0x7AB, bytes(3), start + TIME_S[k] + 0.02))


def _frame(can: Any, number: int, data: bytes, time_s: float) -> Any:
    return can.Message(arbitration_id=number, data=data, timestamp=time_s, is_extended_id=False)
