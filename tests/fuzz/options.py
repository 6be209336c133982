"""Command lines drawn at random: commands on small inputs, with options right, odd and combined."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path

import numpy as np

from tests.command_line import halltwin
from tests.option_walk import ODD, options

Generator = np.random.Generator

BASE: dict[str, tuple[str, ...]] = {
    "explain": ("short.csv",),
    "diagnose": ("short.csv",),
    "compensate": ("short.csv",),
    "export": ("short.csv", "--for=lut"),
    "monitor": ("series",),
    "simulate": ("--points=24",),
    "causes": (),
    "bench": ("--points=8",),
    "hardware": ("-o", "hardware"),
    "new-effect": ("gear_wear",),
}
"""Arguments of the commands that are combined; studies have worker processes, and tests of their own."""
TEXTS = (
    *("imc-14bit", "paper-encoder", "nothing.toml", "short.csv", "series", "*.csv", ".", "", "25,60", "off_axis=1mm"),
    *("saturation:k_percent=2", "saturation:k_percent=nan", "lost=0.02", "silent:hall", "x" * 300, "\u00e9\u0000"),
)
PATHS = (
    "out.json",
    "out.csv",
    "out.png",
    "out.toml",
    "out.html",
    "short.csv",
    "/dev/null",
    ".",
    "no/where",
    "\u00e9.json",
)
_ENDLESS = frozenset({"--serve", "--real-time", "--interface", "--bus-option", "--channel"})
"""Options that wait for the world outside."""


def drawn(rng: Generator) -> bytes:
    """The arguments of a command line, as JSON."""
    command = str(rng.choice(list(BASE)))
    known = [one for one in options() if one.command == command and one.name not in _ENDLESS]
    line = [command, *BASE[command]]
    for place in rng.integers(0, len(known), int(rng.integers(0, 5))) if known else ():
        one = known[int(place)]
        if one.kind == "flag":
            line.append(one.name)
        elif one.kind == "number":
            line.append(f"{one.name}={rng.choice([*ODD, '8', '12', '100'])}")
        else:
            line.append(f"{one.name}={rng.choice(TEXTS if one.kind == 'text' else PATHS)}")
    return json.dumps(line).encode()


def run(path: Path) -> None:
    """Run the command line of a file in a fresh folder: exit code 0 to 2, and errors in one line."""
    line = [argument.replace("\u0000", "") for argument in json.loads(path.read_bytes())]
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            halltwin("simulate", "-o", "short.csv", "--points", "36")
            Path("series").mkdir()
            for number in range(8):
                halltwin("simulate", "-o", f"series/{number}.csv", "--points", "16", "--seed", str(number))
            ended = halltwin(*line)
        finally:
            os.chdir(before)
    assert ended.code in (0, 1, 2), ended
    assert "Traceback" not in ended.err, ended.err
    if ended.code == 2:
        # Beside what --verbose says, and the box in which a misuse of the command line is said.
        last = ended.err.rstrip("\n").rpartition("\n")[2]
        assert "Invalid value" in ended.err or "Usage" in ended.err or last.startswith("halltwin: "), ended.err
