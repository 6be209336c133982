"""What one page works on, and what the server answers to it."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, get_args

import numpy as np

from diagnosis.report.provenance import version
from scenarios.lab import sweeps, twins
from scenarios.lab.bench_run import BenchRun, loop_of
from scenarios.lab.design import (
    Asked,
    alone,
    asked_of,
    at_once,
    command_of,
    error_map,
    over_tolerances,
    sizes_of,
    study_of,
    yield_map,
)
from scenarios.lab.dropped import emptied
from scenarios.lab.explain_worker import ANSWER, EXTENDED, REPORT
from scenarios.lab.explaining import Explaining, question_of
from scenarios.lab.server import Reply, Routes, Upload
from scenarios.lab.sweeps import Recording
from scenarios.lab.twins import Sensor
from scenarios.studies.design.space import TOLERANCES
from twin.angles import Array
from twin.catalogue import find
from twin.errors import UserError
from twin.magnet.magnet import SMALLEST_MM, Shape
from twin.magnet.materials import GRADES
from twin.presets import preset_names
from twin.shown import shown

_MAP = 24
"""Sizes and air gaps of the map."""
_YIELD_MAP, _MAP_MOUNTINGS = 12, 50
"""Of the map of the yield, and the mountings drawn for each of its designs: it takes about a second."""
_SIZES_MM, _GAPS_MM = (3.0, 12.0), (0.4, 5.0)
_KINDS = {ANSWER: "application/json", REPORT: "text/html; charset=utf-8", EXTENDED: "application/toml"}
"""Files of an answer; each is saved, none is shown: a report has styles of its own, which the page's policy forbids."""
_WALL = 0.95
"""The widest bore of a ring, in diameters: see ``twin/magnet/magnet.py``."""


class Session:
    """The sensor and the sweep that the page works on; requests come from several threads at once."""

    def __init__(self, sensor: Sensor, folder: Path, *, sweep: Recording | None = None, held: bool = False) -> None:
        self._folder = folder
        self._lock, self._at_hand = threading.Lock(), threading.Lock()
        self._sensor, self._sweep, self._held = sensor, sweep, held
        self._explaining, self._bench = Explaining(), BenchRun()

    def close(self) -> None:
        """End whatever still runs."""
        self._explaining.close()
        self._bench.close()

    def routes(self) -> Routes:
        """What the server answers."""
        return Routes(
            gets={
                "start": lambda: Reply.of(self.start()),
                "explain": lambda: Reply.of(self._explaining.stand()),
                "bench": lambda: Reply.of(self._bench.stand()),
                **{f"explain/{name}": partial(self._file, name) for name in _KINDS},
            },
            asks={
                "design/at-once": self._at_once,
                "design/causes": self._causes,
                "design/study": self._over_tolerances,
                "design/map": self._map,
                "design/yield-map": self._yield_map,
                "twin/preset": self._preset,
                "twin/save": self._save,
                "sweep/save": self._save_sweep,
                "bench/begin": self._begin_bench,
                "bench/stop": self._stop_bench,
                "sweep/example": self._open_example,
                "explain/begin": self._begin,
                "explain/stop": self._stop,
                "explain/look": lambda content: Reply.of(self._explaining.look(content)),
            },
            uploads={"twin/open": self._open_twin, "sweep/open": self._open_sweep},
        )

    def start(self) -> dict[str, Any]:
        """What the page begins with."""
        return {
            "version": version(),
            "presets": list(preset_names()),
            "shapes": list(get_args(Shape)),
            "grades": {
                name: {"remanence_T": one.remanence_T, "percent_per_K": one.percent_per_K, "source": one.source}
                for name, one in GRADES.items()
            },
            "tolerances": dict(TOLERANCES),
            "twin": self._told(),
            "sweep": None if self._sweep is None else self._sweep.name,
            "held": self._held,
        }

    def _told(self) -> dict[str, Any]:
        """The sensor, with the causes in it and what each is in words."""
        chain = self._sensor.chain
        named = {key: find(key, chain.effects).signature for key in chain.values}
        return {**self._sensor.told(), "causes": named}

    def _asked(self, content: Any) -> tuple[Sensor, Asked]:
        """The sensor as it is, and the design that is asked about. Raises UserError."""
        sensor = self._sensor
        sensor.begins()
        return sensor, asked_of(content)

    def _at_once(self, content: Any) -> Reply:
        sensor, asked = self._asked(content)
        # Two that share the time would both be late: what was asked first is answered first.
        with self._at_hand:
            told = at_once(sensor.chain, asked)
        return Reply.of(
            {**told, "command": command_of(asked, sensor=sensor.name), "sweep_command": twins.sweep_command(asked)}
        )

    def _causes(self, content: Any) -> Reply:
        sensor, asked = self._asked(content)
        return Reply.of({"alone_deg": alone(sensor.chain, asked)})

    def _over_tolerances(self, content: Any) -> Reply:
        sensor, asked = self._asked(content)
        return Reply.of(over_tolerances(study_of(sensor.chain, asked.demand), asked))

    def _map(self, content: Any) -> Reply:
        sensor, asked = self._asked(content)
        sizes, gaps = _spans(asked, _MAP)
        return Reply.of(error_map(sensor.chain, asked, sizes, gaps))

    def _yield_map(self, content: Any) -> Reply:
        sensor, asked = self._asked(content)
        sizes, gaps = _spans(asked, _YIELD_MAP)
        demand = replace(asked.demand, mountings=min(asked.demand.mountings, _MAP_MOUNTINGS))
        return Reply.of(yield_map(study_of(sensor.chain, demand), asked, sizes, gaps))

    def _preset(self, content: Any) -> Reply:
        return self._take(twins.preset(content.get("name") if isinstance(content, Mapping) else content))

    def _open_twin(self, upload: Upload) -> Reply:
        with self._lock:
            return self._take(twins.dropped(upload, self._folder))

    def _take(self, sensor: Sensor) -> Reply:
        self._sensor = sensor
        return Reply.of(self._told())

    def _save(self, content: Any) -> Reply:
        sensor, asked = self._asked(content)
        return Reply(twins.saved(sensor, asked), "application/toml", download="twin.toml")

    def _save_sweep(self, content: Any) -> Reply:
        sensor, asked = self._asked(content)
        return Reply(twins.simulated(sensor, asked), "text/csv; charset=utf-8", download="sweep.csv")

    # ---- the sweep -----------------------------------------------------------------------------------------------

    def _open_sweep(self, upload: Upload) -> Reply:
        with self._lock:
            # What explains the sweep before reads the file that the new one takes the place of.
            self._explaining.close()
            self._sweep = sweeps.dropped(upload, self._folder)
        return Reply.of({"name": self._sweep.name})

    def _open_example(self, content: Any) -> Reply:
        with self._lock:
            self._sweep = sweeps.example()
        return Reply.of({"name": self._sweep.name})

    def _begin(self, content: Any) -> Reply:
        """Explain the sweep, held against the sensor's twin or not. Raises UserError."""
        if not isinstance(content, Mapping) or not isinstance(content.get("held"), bool):
            raise UserError(f"a question is {shown(content)}; expected held, true or false")
        with self._lock:
            sweep, sensor = self._sweep, self._sensor
            if sweep is None:
                raise UserError("there is no sweep; open one first")
            twin = (sensor.source, sensor.name) if content["held"] else None
            folder = emptied(self._folder / "answer")
            self._explaining.begin(question_of(sweep.path, sweep.name, shown=sweep.shown, twin=twin, folder=folder))
        return Reply.of(self._explaining.stand())

    def _stop(self, content: Any) -> Reply:
        self._explaining.stop()
        return Reply.of(self._explaining.stand())

    # ---- the bench -----------------------------------------------------------------------------------------------

    def _begin_bench(self, content: Any) -> Reply:
        """Close the loop on the virtual bench, with the sensor's twin as the encoder. Raises UserError."""
        with self._lock:
            sensor = self._sensor
            # What runs there writes into the folder that is emptied.
            self._bench.close()
            loop = loop_of(content, twin=(sensor.source, sensor.name), folder=emptied(self._folder / "bench"))
            self._bench.begin(loop)
        return Reply.of({**self._bench.stand(), "command": loop.command})

    def _stop_bench(self, content: Any) -> Reply:
        self._bench.stop()
        return Reply.of(self._bench.stand())

    def _file(self, name: str) -> Reply:
        content, download = self._explaining.file(name)
        return Reply(content, _KINDS[name], download=download)


def _spans(asked: Asked, count: int) -> tuple[Array, Array]:
    """So many sizes and air gaps [mm] of a map that holds the design. Raises UserError where there is none."""
    size = float(np.asarray(getattr(asked.magnet, sizes_of(asked.magnet)[0])))
    gap = float(np.asarray(asked.placement.air_gap_mm))
    smallest = float(asked.magnet.bore_mm) / _WALL if asked.magnet.shape == "ring" else SMALLEST_MM
    low, high = max(min(_SIZES_MM[0], size), smallest), max(_SIZES_MM[1], size, 2.0 * smallest)
    if not low < high:
        raise UserError(f"magnet of {size:g} mm has no others beside it on a map; expected a smaller bore")
    return np.linspace(low, high, count), np.linspace(min(_GAPS_MM[0], gap), max(_GAPS_MM[1], gap), count)
