"""Hide a cause, ask for it: a small part of the study in ``tests.hidden.study``, with seeds that were not chosen.

One draw for each cause of the generator on the easy bench, a few clean sweeps on both benches, a few structures that no
catalogue holds and a few pairs. Each answer is right only if every cause is matched one to one and nothing is named
besides. The discovery itself allows a false alarm on one sweep in a hundred (its probability bound is 1 % over all that
it searched), so of the clean sweeps here about one in a hundred may fail by chance alone, once for all: the draws are
fixed.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from .catalogue import CAUSES
from .generator import Hidden, draw
from .scoring import verdict
from .study import DEFAULT_ANSWERER, load

FIRST_SEED = 7000
ALONE = {name: FIRST_SEED + place for place, name in enumerate(sorted(CAUSES))}
CLEAN = [(bench, FIRST_SEED + 100 + number) for bench in ("easy", "hard") for number in range(6)]
UNNAMED = [("order_9_to_19", FIRST_SEED + 200), ("local_bump", FIRST_SEED + 201), ("time_frequency", FIRST_SEED + 202)]
PAIRS = [
    (("saturation", "hysteresis"), FIRST_SEED + 300),
    (("magnet_harmonic", "bearing_wobble"), FIRST_SEED + 301),
    (("reference_rezero", "saturation"), FIRST_SEED + 302),
    (("offset_drift", "phase_drift"), FIRST_SEED + 303),
]


def judged(hidden: Hidden, folder: Path) -> str:
    """The verdict on the answer to a draw, with what was answered where it is not right."""
    path = folder / "sweep.csv"
    hidden.write_csv(path)
    answer = load(DEFAULT_ANSWERER)(str(path))
    given = [(cause["name"], cause["indistinguishable_from"]) for cause in answer["causes"]]
    said = verdict(answer, hidden.truth)
    return said if said == "right" else f"{said}: {given} for {hidden.truth['causes']}"


@pytest.mark.parametrize("name", sorted(CAUSES))
def test_one_cause(name: str, tmp_path: Path) -> None:
    assert judged(draw([name], seed=ALONE[name]), tmp_path) == "right"


@pytest.mark.parametrize(("bench", "seed"), CLEAN)
def test_clean_sweep_names_nothing(bench: str, seed: int, tmp_path: Path) -> None:
    assert judged(draw([], seed=seed, bench=bench), tmp_path) == "right"


@pytest.mark.parametrize(("structure", "seed"), UNNAMED)
def test_structure_outside_the_catalogue_is_unnamed(structure: str, seed: int, tmp_path: Path) -> None:
    assert judged(draw([], seed=seed, structure=structure), tmp_path) == "right"


@pytest.mark.parametrize(("causes", "seed"), PAIRS)
def test_two_causes(causes: tuple[str, str], seed: int, tmp_path: Path) -> None:
    assert judged(draw(causes, seed=seed), tmp_path) == "right"
