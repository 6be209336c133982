"""Training sweeps: sweep k depends on seed and k alone, labels say what acts, one store whoever writes it."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenarios.commands.protocol import Protocol
from scenarios.studies.machines import Machines
from scenarios.studies.training.draw import Ranges, uniforms_needed
from scenarios.studies.training.job import Training
from scenarios.studies.training.recipe import parameter_names, recipe_of, simulate_block
from scenarios.studies.training.run import generate
from tests.scenarios.study_jobs import content
from twin.drawing import YARDSTICK_DEG
from twin.errors import UserError

BENCH = Protocol(turns=2, points=40, both_directions=True, speeds_rpm=(60.0,))


def training(
    seed: int = 0, *, causes: tuple[str, ...] = (), chunk: int = 16, sweeps: int = 64, **ranges: object
) -> Training:
    recipe = recipe_of("paper-encoder", protocol=BENCH, ranges=replace(Ranges(), **ranges), causes=causes, seed=seed)
    return Training(recipe=recipe, sweeps=sweeps, chunk=chunk, channels=True)


def test_a_sweep_depends_on_seed_and_number_alone() -> None:
    by_16, by_5 = training(), training(chunk=5, sweeps=1000)
    whole = by_16.arrays(1)
    for chunk, first in ((4, 20), (5, 25)):
        part = by_5.arrays(chunk)
        for name, values in whole.items():
            assert values[first - 16 : first - 11].tobytes() == part[name].tobytes(), name
    assert not np.array_equal(training(1).arrays(0)["error_deg"], training(0).arrays(0)["error_deg"])


NOISY_PLATES = """
schema = "halltwin.twin/1"
[reference]
lines = 500
[hardware.disk]
shift_x_um = 1.0
[hardware.plate]
offset_uV = 1000.0
asymmetry = 0.002
white_nV = 2000.0
[effects.adc_quantisation]
bits = 12
[effects.cordic_truncation]
iterations = 10
word_bits = 12
angle_bits = 14
[effects.output_quantisation]
bits = 12
"""


def test_a_training_sweep_is_what_the_same_twin_records(tmp_path: Path) -> None:
    (tmp_path / "twin.toml").write_text(NOISY_PLATES)
    recipe = recipe_of(str(tmp_path / "twin.toml"), protocol=BENCH, ranges=Ranges(), seed=3)
    block = simulate_block(recipe, range(40))
    names, whole = parameter_names(recipe), {"iterations", "bits"}
    drawn_iterations = set()
    for k in range(40):
        stream = np.random.default_rng(np.random.SeedSequence(3, spawn_key=(k,)))
        stream.random(uniforms_needed(recipe.causes))
        chain = recipe.chain
        for effect, param in names:
            value = float(block.draw.values[effect][param][k])
            chain = chain.with_effect(effect, **{param: int(value) if param in whole else value})
        drawn_iterations.add(chain.values["cordic_truncation"]["iterations"])
        steps = list(chain.steps(recipe.motion, stream))
        reference = chain.recorded_reference(recipe.motion, stream)
        error = np.angle(np.exp(1j * (steps[-1].after[0] - reference)))
        found = np.radians(block.error_deg[k] + block.mean_deg[k])
        # The same run but for the rounding of the mean that is taken off and put back.
        np.testing.assert_allclose(np.angle(np.exp(1j * (found - error))), 0.0, atol=1e-12)
        channels = next(step.before for step in steps if step.key == "after channels")
        assert block.channels[k].tobytes() == channels.tobytes()
    assert len(drawn_iterations) > 1


def test_labels_strengths_and_parameters_agree() -> None:
    job = training()
    block = job.arrays(0)
    assert block["error_deg"].dtype == np.float32
    assert np.array_equal(block["labels"] == 1, block["strength_deg"] > 0.0)
    assert block["labels"].sum(axis=1).max() <= 3
    names = parameter_names(job.recipe)
    column = names.index(("hysteresis", "lag_deg"))
    cause = job.recipe.causes.index("hysteresis")
    assert np.array_equal(block["parameters"][:, column] != 0.0, block["labels"][:, cause] == 1)


@pytest.mark.parametrize(
    "cause", ["hysteresis", "magnet_harmonic", "latency", "output_quantisation", "reference_jitter"]
)
def test_a_strength_is_the_size_of_the_error_it_makes(cause: str) -> None:
    sizes = {"most": 1, "noise_deg": (1e-6, 1.1e-6)}
    strong = training(causes=(cause,), strength_deg=(YARDSTICK_DEG, 1.001 * YARDSTICK_DEG), **sizes).arrays(0)
    absent = training(causes=(cause,), strength_deg=(1e-6, 1.1e-6), **sizes).arrays(0)
    acts = strong["labels"][:, 0] == 1
    assert 0 < acts.sum() < 16
    difference = (strong["error_deg"] - absent["error_deg"])[acts]
    assert 0.05 < np.sqrt(np.mean(difference**2)) < 0.15
    assert np.array_equal(strong["error_deg"][~acts], absent["error_deg"][~acts])


def test_the_store_is_the_same_for_one_and_two_workers_and_a_cluster(tmp_path: Path) -> None:
    for needed in ("xarray", "zarr", "distributed"):
        pytest.importorskip(needed, reason="needs the extra 'sweeps'")
    job = training()
    machines = {
        "one": Machines(workers=1),
        "two": Machines(workers=2),
        "dask": Machines(workers=2, scheduler="local"),
    }
    for name, where in machines.items():
        generate(job, tmp_path / name, where)
    assert content(tmp_path / "one") == content(tmp_path / "two") == content(tmp_path / "dask")
    (tmp_path / "one" / "done" / "000002").unlink()
    generate(job, tmp_path / "one", Machines(workers=1))
    assert content(tmp_path / "one") == content(tmp_path / "two")

    # Marks that are lost are made again; with another seed nobody knows whose the sweeps are.
    shutil.rmtree(tmp_path / "one" / "done")
    before = content(tmp_path / "one")
    with pytest.raises(UserError, match="begun with --seed 0, now 9; give another folder"):
        generate(replace(job, recipe=replace(job.recipe, seed=9)), tmp_path / "one", Machines(workers=1))
    assert content(tmp_path / "one") == before
    generate(job, tmp_path / "one", Machines(workers=1))
    assert content(tmp_path / "one") == content(tmp_path / "two")

    import zarr

    group = zarr.open_group(tmp_path / "one" / "sweeps.zarr", mode="r")
    assert np.array_equal(group["error_deg"][16:32], job.arrays(1)["error_deg"])
    assert group["error_deg"].chunks == (16, len(job.recipe.motion))
    assert group.attrs["causes"] == list(job.recipe.causes)
    assert 'schema = "halltwin.twin/1"' in group.attrs["twin_toml"]


def test_a_cause_the_protocol_cannot_show_is_refused() -> None:
    said = r"'gain_drift' cannot be drawn with this protocol \(it needs temperature_c, two temperatures\)"
    with pytest.raises(UserError, match=said):
        training(causes=("gain_drift",))
