"""``halltwin generate``: labelled training sweeps of a twin, as many as asked for, in a Zarr store."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from diagnosis.report.provenance import version
from scenarios.studies.engine import run_study
from scenarios.studies.identity import Identity
from scenarios.studies.machines import Machines
from scenarios.studies.study_folder import StudyFolder
from scenarios.studies.training.job import OPTIONS, Training, settings_of
from scenarios.studies.training.recipe import Recipe, parameter_names
from scenarios.studies.training.store import STORE, create, tools
from twin.limits import require_within
from twin.motion import Motion

SPLITS = ("train", "validation", "test")


def generate(job: Training, output: Path, machines: Machines) -> None:
    """Write the store, or finish one that was begun. Raises UserError."""
    tools()
    settings = settings_of(job)
    one = job.arrays_of(range(1))
    identity = Identity(study="training", seed=job.recipe.seed, settings=settings, options=OPTIONS)
    with StudyFolder.opened(output, identity, stores=(STORE,)) as folder:
        create(
            folder,
            one,
            sweeps=job.sweeps,
            chunk=job.chunk,
            coordinates=_coordinates(job.recipe.motion),
            attributes=_attributes(job.recipe, settings),
        )
        run_study(job, folder, chunks=job.chunks, items=job.sweeps, unit="sweeps", machines=machines)


def _coordinates(motion: Motion) -> dict[str, np.ndarray[Any, Any]]:
    """What the shaft does at each reading, each (n,)."""
    return {
        "shaft_deg": np.degrees(motion.shaft_rad),
        "time_s": motion.time_s,
        "direction": motion.direction,
        "speed_rpm": motion.speed_rad_s * 30.0 / np.pi,
        "turn": motion.turn,
        "temperature_c": motion.temperature_c,
    }


def _attributes(recipe: Recipe, settings: Mapping[str, Any]) -> dict[str, Any]:
    """What the store says about itself: the settings, and the names along its axes."""
    return {
        "schema": "halltwin.training/1",
        "version": version(),
        "seed": recipe.seed,
        "twin_toml": tomli_w.dumps(settings["twin"]),
        "protocol": settings["protocol"],
        "ranges": settings["ranges"],
        "causes": list(recipe.causes),
        "parameters": [f"{name}.{key}" for name, key in parameter_names(recipe)],
        "splits": list(SPLITS),
    }


def run(job: Training, output: Path, machines: Machines) -> None:
    """The command: write the store and say what it holds. Raises UserError."""
    require_within("sweeps", job.sweeps, 1, 1e9, whole=True)
    require_within("chunk", job.chunk, 1, 1e6, whole=True)
    start = time.perf_counter()
    generate(job, output, machines)
    took = time.perf_counter() - start
    size = sum(item.stat().st_size for item in (output / STORE).rglob("*") if item.is_file())
    recipe = job.recipe
    print(
        f"wrote {output / STORE}: {job.sweeps} sweeps of {len(recipe.motion)} readings, {len(recipe.causes)} causes, "
        f"{size / job.sweeps:.0f} bytes a sweep, {took:.1f} s"
    )
