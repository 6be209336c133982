"""What stands for a reader's own files where the guide's commands are run: made by the program's own twins."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tests.command_line import halltwin
from tests.diagnosis.setup.test_page import motor_log
from tests.pages import ROOT

BENCH = ROOT / "scenarios" / "data" / "bench_twin.toml"
WARM = ROOT / "scenarios" / "data" / "warm_twin.toml"

CLEAN = """schema = "halltwin.twin/1"
[effects.offset]
x_percent = 0.5
[effects.noise]
rms_deg = 0.02
"""


def simulated(path: Path, twin: str | Path, *options: str) -> None:
    """A sweep of a twin, there and back."""
    path.parent.mkdir(exist_ok=True)
    assert halltwin("simulate", twin, "-o", path, "--both-directions", *options).code == 0


def clean_sweep(folder: Path) -> None:
    """A device that has nothing beyond the paper's factors."""
    (folder / "device.toml").write_text(CLEAN)
    simulated(folder / "sweep.csv", folder / "device.toml", "--points", "120", "--no-channels")


def its_twin(folder: Path) -> None:
    """A sweep, and the twin that it was simulated from."""
    simulated(folder / "sweep.csv", BENCH, "--points", "120", "--no-channels")
    (folder / "extended.toml").write_bytes(BENCH.read_bytes())


def batch(folder: Path) -> None:
    """Devices of a line."""
    for unit in range(8):
        simulated(folder / "line3" / f"unit{unit}.csv", BENCH, "--points", "90", "--no-channels", f"--seed={unit}")


def own_log(folder: Path) -> None:
    """A sweep under names and units of its own."""
    simulated(folder / "sweep.csv", BENCH, "--points", "120", "--no-channels")
    with (folder / "sweep.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    (folder / "sweep.csv").unlink()
    lines = [f"{row['reference_deg']};{np.radians(float(row['measured_deg'])):.6f}" for row in rows]
    (folder / "log.csv").write_text("\n".join(["encoder [deg];hall [rad]", *lines]) + "\n")


def recordings(folder: Path) -> None:
    """One device at two gaps, and mounted in two ways."""
    gaps = {"near": "1.5", "far": "3.0"}
    for name, gap in gaps.items():
        simulated(folder / f"{name}.csv", "imc-14bit", "--points", "45", f"--air-gap={gap}", f"--seed={gap[0]}")
    for seed in (1, 2):
        simulated(folder / "recordings" / f"{seed}.csv", BENCH, "--points", "60", "--no-channels", f"--seed={seed}")


def ring(folder: Path) -> None:
    """The log of a motor, and a sweep over a ring of twelve pole pairs."""
    motor_log(folder)
    simulated(folder / "ring.csv", "paper-encoder", "--points", "240", "--no-channels")


def temperatures(folder: Path) -> None:
    """One device at one temperature each, and a further recording to check the correction on."""
    for name, degrees in {"cold": -40, "room": 25, "hot": 85, "other": 60}.items():
        options = ("--points", "90", "--no-channels", f"--temperatures={degrees}", f"--seed={degrees + 50}")
        simulated(folder / f"{name}.csv", WARM, *options)


STAND_FOR: dict[str, Callable[[Path], object]] = {
    "fleet": batch,
    "lab": its_twin,
    "logs": own_log,
    "scripts": lambda folder: (clean_sweep(folder), batch(folder)),
    "setup": ring,
    "several_recordings": recordings,
    "temperature": temperatures,
}
"""By the page whose commands read them."""
