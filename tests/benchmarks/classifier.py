"""A classifier trained on generated sweeps against ``explain``: ``python -m tests.benchmarks.classifier [draws]``.

Both see angles of stop-and-measure sweeps there and back, with one hidden cause or none. The sweeps that they are
compared on come from the independent generator of tests/hidden; the classifier is also shown sweeps like its own.
Needs the extras ``sweeps`` and ``learn``.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis import explain
from diagnosis.error_model.fit import fit_baseline, fit_equal
from scenarios.commands.protocol import Protocol
from scenarios.studies.machines import Machines
from scenarios.studies.training.draw import Ranges
from scenarios.studies.training.job import Training
from scenarios.studies.training.recipe import recipe_of
from scenarios.studies.training.run import generate
from scenarios.studies.training.store import STORE
from tests.benchmarks.classifier_features import Record, features
from tests.hidden.generator import draw
from tests.hidden.scoring import right
from tests.hidden.streams import derived_seed
from twin.angles import Array
from twin.sweep import Sweep

CAUSES = (
    "saturation",
    "clipping",
    "magnet_harmonic",
    "drive_ripple",
    "hysteresis",
    "backlash",
    "zero_drift",
    "index_slip",
    "reference_jitter",
    "adc_stuck_bit",
    "cordic_truncation",
    "output_quantisation",
    "stale_frames",
    "bus_glitch",
)
NOTHING = "nothing"
PROTOCOLS = (
    Protocol(turns=1, points=360, both_directions=True),
    Protocol(turns=2, points=240, both_directions=True),
    Protocol(turns=2, points=512, both_directions=True),
)
TRAINING = 2000
"""Sweeps of each protocol."""
# The bench of the independent generator: noise of 0.005 to 0.02 deg or so, strengths of 0.05 to 0.15 deg.
RANGES = Ranges(strength_deg=(0.04, 0.2), noise_deg=(0.002, 0.05), most=1)


def generated(folder: Path) -> tuple[Array, Array, Array]:
    """Features (sweeps, figures), labels (sweeps,) and splits (sweeps,) of training sweeps, read from Zarr stores."""
    import zarr

    rows, labels, splits = [], [], []
    for number, protocol in enumerate(PROTOCOLS):
        recipe = recipe_of("paper-encoder", protocol=protocol, ranges=RANGES, causes=CAUSES, seed=number)
        job = Training(recipe=recipe, sweeps=TRAINING, chunk=250, channels=False)
        generate(job, folder / str(number), Machines())
        store: Any = zarr.open_group(folder / str(number) / STORE, mode="r")
        shaft = np.radians(store["shaft_deg"][:])
        measured = shaft + np.radians(store["error_deg"][:].astype(float) + store["mean_deg"][:][:, None])
        fits = fit_equal(
            np.broadcast_to(shaft, measured.shape), measured, rng=np.random.default_rng(0), senses=(1, 1), robust=True
        )
        for reading, fit in zip(measured, fits, strict=True):
            rows.append(features(Record(shaft, reading, store["direction"][:], store["time_s"][:]), fit))
        names = np.array([*store.attrs["causes"], NOTHING])
        marks = store["labels"][:]
        labels.append(names[np.where(marks.any(axis=1), marks.argmax(axis=1), len(names) - 1)])
        splits.append(store["split"][:])
    return np.array(rows), np.concatenate(labels), np.concatenate(splits)


def unseen(draws: int, folder: Path) -> Iterator[tuple[str, dict[str, Any], Sweep]]:
    """Cause, truth and sweep from the independent generator."""
    for cause in (*CAUSES, NOTHING):
        for number in range(draws):
            asked = [] if cause == NOTHING else [cause]
            seed = derived_seed(20, "classifier", cause, str(number))
            hidden = draw(asked, seed=seed, protocol="static_both-channels")
            path = folder / f"{cause}{number}.csv"
            hidden.write_csv(path)
            yield cause, hidden.truth, Sweep.read(path)


def figures_of(sweep: Sweep) -> Array:
    """The features of a measured sweep."""
    motion = sweep.motion()
    measured = np.radians(sweep.measured_deg)
    fit = fit_baseline(motion.shaft_rad, measured, rng=np.random.default_rng(0), robust=True)
    return features(Record(motion.shaft_rad, measured, motion.direction, motion.time_s), fit)


def main() -> None:
    """Train, compare, print one line a cause."""
    from sklearn.ensemble import RandomForestClassifier

    draws = int(sys.argv[1]) if len(sys.argv) > 1 else 4
    with tempfile.TemporaryDirectory() as place:
        start = time.perf_counter()
        rows, labels, splits = generated(Path(place))
        forest = RandomForestClassifier(300, min_samples_leaf=2, class_weight="balanced", random_state=0, n_jobs=1)
        forest.fit(rows[splits == 0], labels[splits == 0])
        own = float(np.mean(forest.predict(rows[splits == 2]) == labels[splits == 2]))
        took = time.perf_counter() - start
        print(f"trained on {np.count_nonzero(splits == 0)} sweeps, {rows.shape[1]} figures, {took:.0f} s")
        print(f"on {np.count_nonzero(splits == 2)} unseen sweeps of its own kind: {100 * own:.0f} % right")
        guessed, answered, total = Counter[str](), Counter[str](), Counter[str]()
        spent = {"classifier": 0.0, "explain": 0.0}
        mistakes: dict[str, list[str]] = {}
        for cause, truth, sweep in unseen(draws, Path(place)):
            total[cause] += 1
            start = time.perf_counter()
            guess = str(forest.predict(figures_of(sweep)[None])[0])
            spent["classifier"] += time.perf_counter() - start
            start = time.perf_counter()
            answer = explain(sweep).to_dict()
            spent["explain"] += time.perf_counter() - start
            guessed[cause] += guess == cause or guess in truth.get("tolerated", ())
            answered[cause] += right(answer, truth)
            if guess != cause:
                mistakes.setdefault(cause, []).append(guess)
    print(f"{'cause':22s} classifier  explain   of   classifier's mistakes")
    for cause in total:
        wrong = ", ".join(mistakes.get(cause, []))
        print(f"{cause:22s} {guessed[cause]:10d} {answered[cause]:8d} {total[cause]:4d}   {wrong}")
    count = sum(total.values())
    for name, hits in (("classifier", guessed), ("explain", answered)):
        print(f"{name}: {100 * sum(hits.values()) / count:.0f} % of {count}, {spent[name] / count:.2f} s a sweep")


if __name__ == "__main__":
    main()
