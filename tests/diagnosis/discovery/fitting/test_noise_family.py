"""The family of noises: the one that made a sequence is recognised, also where rows are masked."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from diagnosis.discovery.fitting.coefficients import to_cosine
from diagnosis.discovery.fitting.noise_family import noise_family
from diagnosis.discovery.settings import DiscoverySettings
from twin.noise.spectrum import to_rows

ROWS = 600
DRAWS = 20


@pytest.mark.parametrize("masked", [0.0, 0.1])
@pytest.mark.parametrize("label", ["white", "AR(1) 0.6", "AR(1) 0.85 + 50% white", "1/f^1 + 60% white"])
def test_the_noise_that_made_a_sequence_is_chosen_whatever_is_masked(label: str, masked: float) -> None:
    """Neighbours of the family share a part of the draws: at least half must go to the true one.

    Over 200 draws it was 0.7 or more of them for each; fewer than 10 of 20 then has a chance of 2 %, seeds fixed.
    """
    family = noise_family((ROWS,), DiscoverySettings().colour_log_odds)
    member = family.labels.index(label)
    rng = np.random.default_rng([member, int(10 * masked)])
    chosen = 0
    for _ in range(DRAWS):
        noise = to_rows(np.sqrt(family.spectra[member]) * rng.standard_normal(ROWS))
        usable = rng.random(ROWS) >= masked
        observations = cast(Any, SimpleNamespace(usable=usable, scale=np.ones(ROWS), lengths=(ROWS,)))
        squares = to_cosine(observations, noise) ** 2 @ family.weights.T
        rows = int(np.count_nonzero(usable))
        chosen += int(np.argmax(-0.5 * (rows * np.log(squares) + family.cost(rows)))) == member
    assert chosen >= DRAWS // 2
