"""What is known of a design: field, margin, error by cause, stray-field error, resolution, yield; the engine's job."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.commands.protocol import Protocol
from scenarios.studies.design.field import Designs, cause_errors, errors_deg
from scenarios.studies.design.space import MOUNTING_UNIFORMS, Space, mounted
from scenarios.studies.study_folder import StudyFolder
from twin.angles import TAU, Array, IntArray
from twin.chain import Chain
from twin.effect import BoolArray
from twin.extensions import effects_with
from twin.files import from_dict
from twin.hall.noise import NOISE
from twin.motion import NOMINAL_C, Motion

POINTS, MOUNTED_POINTS = 72, 36
"""Angles a turn and direction: of a design, and of each of its mountings."""
_ROUNDING = float(np.sqrt(12.0))


@dataclass(frozen=True, kw_only=True)
class Demand:
    """What a design has to keep: error [deg] and field [mT] over temperature [C], for ``tolerance`` of mounting."""

    max_error_deg: float
    window_mT: tuple[float, float]
    temperature_c: tuple[float, float]
    tolerance: Mapping[str, float]
    mountings: int = 200
    min_yield: float = 0.99

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Lowest, that of the calibration, highest."""
        return tuple(sorted({self.temperature_c[0], NOMINAL_C, self.temperature_c[1]}))

    def motion(self, points: int) -> Motion:
        """A turn there and back at each temperature, in steps."""
        return Protocol(points=points, both_directions=True, temperatures_c=self.temperatures).motion()


@dataclass(frozen=True, kw_only=True)
class DesignStudy:
    """The engine's job. ``twin`` is a twin file's content with a magnet."""

    twin: Mapping[str, Any]
    space: Space
    demand: Demand
    chunk: int
    seed: int

    @cached_property
    def chain(self) -> Chain:
        """The sensor."""
        return from_dict(self.twin, effects=effects_with())

    def __getstate__(self) -> dict[str, Any]:
        """Without the chain, which does not pickle."""
        return {name: value for name, value in self.__dict__.items() if name != "chain"}

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return -(-self.space.designs // self.chunk)

    def write(self, folder: StudyFolder, chunk: int) -> list[Path]:
        """See :class:`scenarios.studies.job.Job`."""
        numbers = np.arange(chunk * self.chunk, min((chunk + 1) * self.chunk, self.space.designs))
        table, which = self.space.table(numbers)
        designs = self.space.assemble(table, which)
        return folder.save(chunk, {"design": table, "grade": which, **self.figures(designs, numbers)})

    def figures(self, designs: Designs, numbers: IntArray) -> dict[str, Array]:
        """Columns (designs,) by name; ``numbers`` (designs,) are what the mounting errors are drawn from."""
        demand, motion = self.demand, self.demand.motion(POINTS)
        low, high = field_span(designs, demand)
        figures = {
            "field_mT": designs.nominal_mT,
            "field_low_mT": low,
            "field_high_mT": high,
            "margin_mT": np.minimum(low - demand.window_mT[0], demand.window_mT[1] - high),
            "error_deg": np.max(np.abs(errors_deg(self.chain, designs, motion)), axis=1),
            "stray_error_deg": stray_error_deg(low),
            "resolution_bits": resolution_bits(noise_deg(self.chain, low)),
        }
        for cause, error in cause_errors(self.chain, designs, motion):
            figures[f"error_deg.{cause}"] = np.max(np.abs(error), axis=1)
        return {**figures, **self.over_mountings(designs, numbers)}

    def over_mountings(self, designs: Designs, numbers: IntArray) -> dict[str, Array]:
        """Yield and 95th percentile of the error over mountings, which are drawn anew for each number (designs,)."""
        demand, count = self.demand, self.demand.mountings
        streams = [np.random.SeedSequence(self.seed, spawn_key=(int(k),)) for k in numbers]
        uniforms = np.concatenate([np.random.default_rng(s).random((count, MOUNTING_UNIFORMS)) for s in streams])
        parts = designs.spread(count, lambda placement: mounted(placement, demand.tolerance, uniforms))
        error = np.max(np.abs(errors_deg(self.chain, parts, demand.motion(MOUNTED_POINTS))), axis=1)
        low, high = field_span(parts, demand)
        good = (error <= demand.max_error_deg) & (low >= demand.window_mT[0]) & (high <= demand.window_mT[1])
        return {
            "yield": good.reshape(-1, count).mean(axis=1),
            "error_p95_deg": np.quantile(error.reshape(-1, count), 0.95, axis=1),
        }


def noise_deg(chain: Chain, low_mT: Array) -> Array:
    """RMS of the noise in the angle [deg] where the field is weakest (designs,) [mT]: there the signal is, too."""
    assert chain.magnet is not None
    weakest = low_mT / chain.magnet.nominal_mT
    return np.asarray(chain.values.get(NOISE.name, {}).get("rms_deg", 0.0) / weakest)


def stray_error_deg(low_mT: Array) -> Array:
    """The most that a stray field of 1 mT turns a field of this strength (designs,) [mT] by [deg]."""
    return np.asarray(np.degrees(np.arcsin(np.minimum(1.0 / low_mT, 1.0))))


def resolution_bits(noise: Array) -> Array:
    """Bits of the grid of a turn whose rounding scatters as much as this noise (designs,) [deg RMS]."""
    return np.asarray(np.log2(360.0 / (_ROUNDING * np.maximum(noise, 1e-9))))


def field_span(designs: Designs, demand: Demand) -> tuple[Array, Array]:
    """Lowest and highest in-plane field (designs,) [mT] over the turn and the temperatures."""
    field = designs.in_plane_mT(np.arange(POINTS) * TAU / POINTS)
    warm = designs.warm(np.asarray(demand.temperatures))
    return field.min(axis=1) * warm.min(axis=1), field.max(axis=1) * warm.max(axis=1)


def feasible(figures: Mapping[str, Array], demand: Demand) -> BoolArray:
    """Which designs (designs,) keep the demand in enough of their mountings."""
    return np.asarray(figures["yield"] >= demand.min_yield)


def ranking(figures: Mapping[str, Array], demand: Demand) -> IntArray:
    """Numbers of the designs, best first: those that keep the demand, by yield, then by error over mountings."""
    return np.lexsort((figures["error_p95_deg"], -figures["yield"], ~feasible(figures, demand)))
