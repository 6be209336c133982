"""A small part of the study of physics, with seeds that were not chosen: one draw of each of the quickest kinds.

Of a study's draws 93 in 100 are to be right, and 3 in 100 at most to get a wrong or a further name. At these shares the
least number right and the most wrong here would be missed by chance once in a thousand; the draws are fixed.
"""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

from ..scoring import verdict
from ..study import DEFAULT_PREDICTOR, Asked
from .sets import PhysicsJob

QUICK = ("tanh", "cordic", "play_friction", "ball_bearing", "low_pass", "top_bits", "expanding_frame", "creeping_frame")
CLEAN = ("disc", "vector_saturation_raw", "white_raw", "opposite_heads")
OUTSIDE = ("torsion_swing", "torsion_run_up")
SEED = 9000


def _tail(total: int, share: float, least: int) -> float:
    """Chance of `least` or more where each comes with this probability."""
    return sum(math.comb(total, k) * share**k * (1 - share) ** (total - k) for k in range(least, total + 1))


def test_quick_kinds_are_answered_as_a_study_asks(tmp_path: Path) -> None:
    groups = (("physics", QUICK), ("physics_clean", CLEAN), ("physics_outside", OUTSIDE))
    said: Counter[str] = Counter()
    transfers = []
    for group, labels in groups:
        for label in labels:
            job = PhysicsJob(group, label, SEED)
            hidden = job.draw()
            path = tmp_path / f"{label}.csv"
            hidden.write_csv(path)
            answer, transfer = Asked(predictor=DEFAULT_PREDICTOR).answer(job, path)
            said[verdict(answer, hidden.truth)] += 1
            transfers += [] if transfer is None else [transfer]
    total = sum(said.values())
    assert _tail(total, 0.07, total - said["right"]) > 1e-3, said
    assert _tail(total, 0.03, said["extra"] + said["wrong name"]) > 1e-3, said
    # of the twins, half are to predict another recording within 5 % of the noise
    assert _tail(len(transfers), 0.5, sum(one > 1.05 for one in transfers)) > 1e-3, transfers
