"""The twin that the page works on: from the command line, a preset, or a file that was dropped; and saved again."""

from __future__ import annotations

import shlex
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenarios.commands.marks import marked
from scenarios.commands.protocol import Protocol
from scenarios.lab.design import Asked, asked_at
from scenarios.lab.dropped import as_called, kept
from scenarios.lab.server import Upload
from scenarios.studies.design.check import twin_at
from twin.chain import Chain
from twin.errors import UserError
from twin.extensions import effects_with
from twin.files import from_dict, read_twin, twin_text
from twin.magnet.assembly import Assembly
from twin.presets import read_preset, read_twin_or_preset
from twin.sweep_file import csv_text

DEFAULT = "imc-14bit"
"""As ``halltwin design`` has it."""
LARGEST_TWIN_BYTES = 2_000_000
"""A twin of a thousand turns takes 0.1 MB."""
_POINTS = 360


@dataclass(frozen=True, eq=False)
class Sensor:
    """A twin, the name or path that the command line knows it by, and where it is read from."""

    name: str
    chain: Chain
    source: str

    def begins(self) -> Asked:
        """The design that the page begins with. Raises UserError where there is no magnet."""
        if self.chain.magnet is None:
            raise UserError(
                f"{self.name}: has no [magnet], so its figures are stated at no field; give a twin that has one"
            )
        return asked_at(self.chain.magnet)

    def told(self) -> dict[str, Any]:
        """What the page says of it; ``design`` is where it begins, or ``no_design`` why there is none."""
        try:
            begun: dict[str, Any] = {"design": self.begins().to_dict()}
        except UserError as error:
            begun = {"design": None, "no_design": str(error)}
        return {"name": self.name, **begun}


def named(name: str) -> Sensor:
    """A preset, or a twin file of the command line's. Raises TwinError."""
    return Sensor(name, read_twin_or_preset(name, effects=effects_with()), name)


def preset(name: Any) -> Sensor:
    """A preset that was chosen on the page: a name alone, never a path. Raises TwinError."""
    return Sensor(str(name), read_preset(str(name), effects=effects_with()), str(name))


def dropped(upload: Upload, folder: Path) -> Sensor:
    """A twin file that was dropped on the page. Raises TwinError."""
    path, name = kept(upload, folder, stem="twin", endings=(".toml",), most=LARGEST_TWIN_BYTES)
    try:
        return Sensor(name, read_twin(path, effects=effects_with()), str(path))
    except UserError as error:
        raise as_called(error, path, name) from None


def saved(sensor: Sensor, asked: Asked) -> bytes:
    """The twin file of a design: the sensor with that magnet in that place."""
    text = twin_text(twin_at(sensor.chain, Assembly(asked.magnet, asked.placement)))
    return marked(Path("twin.toml"), text.encode())


def simulated(sensor: Sensor, asked: Asked) -> bytes:
    """The sweep that a design gives there and back at its temperature and speed: what the command makes of its file."""
    chain = from_dict(tomllib.loads(saved(sensor, asked).decode()), effects=effects_with())
    protocol = Protocol(
        points=_POINTS, both_directions=True, speeds_rpm=(asked.speed_rpm,), temperatures_c=(asked.temperature_c,)
    )
    return csv_text(chain.simulate(protocol.motion(), seed=0).columns).encode()


def sweep_command(asked: Asked) -> str:
    """The command line that makes that sweep of the saved twin."""
    words = ["halltwin", "simulate", "twin.toml", "--points", str(_POINTS), "--both-directions"]
    words += [f"--speed-rpm={asked.speed_rpm!r}", f"--temperatures={asked.temperature_c!r}", "-o", "sweep.csv"]
    return shlex.join(words)
