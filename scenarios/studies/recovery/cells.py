"""Ground-truth recovery: a grid of conditions, and what comes back from sweeps simulated in each of them.

A cell is one cause (or ``baseline``, or ``clean``) at one noise, number of points and turns, and amplitude. Each of
its repeats draws a device, simulates a sweep and asks the diagnoser; rows of the study are repeats.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.commands.protocol import Protocol
from scenarios.studies.study_folder import StudyFolder
from scenarios.studies.training.draw import BASELINE_UNIFORMS, CAUSE_UNIFORMS, baseline_values
from twin.angles import Array
from twin.baseline import FACTORS
from twin.catalogue import find
from twin.chain import Chain
from twin.drawing import drawn
from twin.effect import Effect
from twin.hall.noise import NOISE
from twin.motion import Motion
from twin.sweep import Sweep

BASELINE, CLEAN = "baseline", "clean"
SLOTS = 6
"""Parameters a row has room for: the baseline's six, or a cause's strength in the first."""
PARAMETERS = tuple((factor.key, factor.param) for factor in FACTORS)
"""The baseline's, in the order of diagnosis.error_model.model.NAMES and in the twin's units."""
_TO_TWIN = np.array([factor.per_coordinate for factor in FACTORS])


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One condition. ``points`` readings a turn, ``turns`` turns in each direction."""

    cause: str
    noise_deg: float
    points: int
    turns: int
    amplitude_deg: float

    def motion(self) -> Motion:
        """There and back at 60 rpm: what the causes of one bench show themselves on."""
        return Protocol(
            turns=self.turns, points=self.points, both_directions=True, speeds_rpm=(60.0,), channels=False
        ).motion()


@dataclass(frozen=True, kw_only=True)
class Grid:
    """The engine's job; a chunk is one cell."""

    causes: tuple[str, ...]
    noises_deg: tuple[float, ...]
    points: tuple[int, ...]
    turns: tuple[int, ...]
    amplitudes_deg: tuple[float, ...]
    fits: int
    """Repeats of a baseline cell."""
    sweeps: int
    """Repeats of every other cell, each of which is a whole search for causes."""
    seed: int

    def cells(self) -> tuple[Cell, ...]:
        """All cells: the amplitude means something to causes alone."""
        return tuple(
            Cell(cause=cause, noise_deg=noise, points=points, turns=turns, amplitude_deg=amplitude)
            for cause in self.causes
            for noise, points, turns in itertools.product(self.noises_deg, self.points, self.turns)
            for amplitude in (self.amplitudes_deg if cause not in (BASELINE, CLEAN) else (0.0,))
        )

    def write(self, folder: StudyFolder, chunk: int) -> list[Path]:
        """See :class:`scenarios.studies.job.Job`."""
        cell = self.cells()[chunk]
        rows = self.baseline_rows(cell, chunk) if cell.cause == BASELINE else self.cause_rows(cell, chunk)
        return folder.save(chunk, {"cell": np.full(len(rows["named"]), chunk), **rows})

    def _stream(self, number: int, repeat: int) -> np.random.Generator:
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(number, repeat)))

    def baseline_rows(self, cell: Cell, number: int) -> dict[str, Array]:
        """Fit the error model to sweeps that hold nothing else."""
        from diagnosis.error_model.fit import fit_equal

        motion = cell.motion()
        drawn = [simulate(cell, motion, self._stream(number, repeat)) for repeat in range(self.fits)]
        fits = fit_equal(
            np.radians(np.stack([sweep.reference_deg for _, sweep in drawn])),
            np.radians(np.stack([sweep.measured_deg for _, sweep in drawn])),
            rng=self._stream(number, self.fits),
            senses=(1, 1),
        )
        truth = np.array([[chain.values[name][key] for name, key in PARAMETERS] for chain, _ in drawn])
        found, low, high = (
            np.array([getattr(fit, name) for fit in fits]) * _TO_TWIN for name in ("point", "low", "high")
        )
        # A zero is known up to whole turns.
        turns = 360.0 * np.round((found[:, -1] - truth[:, -1]) / 360.0)
        for values in (found, low, high):
            values[:, -1] -= turns
        bound = np.array([bounds(chain, cell, motion) for chain, _ in drawn])
        blank = np.full(self.fits, np.nan)
        return {
            "truth": truth,
            "found": found,
            "low": low,
            "high": high,
            "bound": bound,
            "named": blank,
            "extra": blank,
        }

    def cause_rows(self, cell: Cell, number: int) -> dict[str, Array]:
        """Ask ``explain`` about sweeps that hold one cause, or none."""
        rows = [self._asked(cell, self._stream(number, repeat)) for repeat in range(self.sweeps)]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    def _asked(self, cell: Cell, rng: np.random.Generator) -> dict[str, Any]:
        from diagnosis import explain

        motion = cell.motion()
        chain, sweep = simulate(cell, motion, rng)
        causes = explain(sweep).to_dict()["causes"]
        row: dict[str, Any] = {name: np.full(SLOTS, np.nan) for name in ("truth", "found", "low", "high", "bound")}
        hit = [cell.cause in (entry["name"], *entry["indistinguishable_from"]) for entry in causes]
        row |= {"named": float(any(hit)), "extra": float(len(causes) - any(hit))}
        if cell.cause == CLEAN:
            return row
        effect = find(cell.cause)
        main = effect.roles("strength")[0]
        row["truth"][0] = chain.values[cell.cause][main]
        row["bound"][0] = bounds(chain, cell, motion)[SLOTS]
        for entry in causes:
            if entry["name"] == cell.cause and main in entry["parameters"]:
                said = entry["parameters"][main]
                row["found"][0], row["low"][0], row["high"][0] = said["value"], said["low"], said["high"]
        return row


def simulate(cell: Cell, motion: Motion, rng: np.random.Generator) -> tuple[Chain, Sweep]:
    """A device of the cell, and a sweep of it."""
    chain = Chain().with_effect(NOISE.name, rms_deg=cell.noise_deg)
    baseline = baseline_values(rng.random((1, BASELINE_UNIFORMS)), chain)
    chain = chain.with_values(_single(baseline))
    if cell.cause not in (BASELINE, CLEAN):
        uniform = rng.random((1, CAUSE_UNIFORMS))
        params = drawn(find(cell.cause), np.array([cell.amplitude_deg]), uniform, motion)
        chain = chain.with_effect(cell.cause, **{name: float(value[0]) for name, value in params.items()})
    return chain, chain.simulate(motion, seed=int(rng.integers(2**31)))


def _single(values: Mapping[str, Mapping[str, Array]]) -> dict[str, dict[str, float]]:
    return {name: {key: float(value[0]) for key, value in params.items()} for name, params in values.items()}


def bounds(chain: Chain, cell: Cell, motion: Motion) -> Array:
    """Cramer-Rao bounds on the standard errors of PARAMETERS, then of the cause's, in their own units.

    From derivatives of the expected reading by central differences; the noise is white with 1/r^2, and r is 1 here
    to within a per cent.
    """
    free = [*PARAMETERS, *_free(cell)]
    slopes = []
    for name, key in free:
        step = 1e-3 * find(name).params[key].typical
        here = chain.values[name][key]
        moved = [chain.with_values({name: {**chain.values[name], key: here + way * step}}) for way in (1.0, -1.0)]
        difference = moved[0].error(motion) - moved[1].error(motion)
        slopes.append(np.degrees((difference + np.pi) % (2.0 * np.pi) - np.pi) / (2.0 * step))
    jacobian = np.array(slopes)
    size = np.linalg.norm(jacobian, axis=1)
    information = (jacobian / size[:, None]) @ (jacobian / size[:, None]).T
    return np.asarray(cell.noise_deg * np.sqrt(np.diagonal(np.linalg.inv(information))) / size)


def _free(cell: Cell) -> list[tuple[str, str]]:
    """What a fit of the cause moves smoothly: its strengths and phases, and the shapes that it climbs in."""
    if cell.cause in (BASELINE, CLEAN):
        return []
    effect: Effect = find(cell.cause)
    along = () if effect.line is None else (effect.line.param,)
    names = dict.fromkeys([*effect.roles("strength"), *effect.roles("phase"), *effect.fitted_shapes, *along])
    return [(effect.name, name) for name in names if not effect.params[name].counts]
