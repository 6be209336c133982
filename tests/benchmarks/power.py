"""The smallest amplitude of a cause that is found half the time, against the limit of a matched test.

    python -m tests.benchmarks.power -o power.json --plot power.svg

Every draw has a bench of its own (baseline, noise, points), so the ladder of amplitudes is laid in units of that
draw's own limit. The limit is that of a test which knows the cause's shape and the noise: the cause's signature with
the paper's error model projected out has a length of `clearance` noise deviations, a chi-square test of the cause's
degrees of freedom is passed half the time at a certain length, and the threshold is the one that the search uses for
one effect among all that it looks at.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from tests.hidden.generator import draw
from tests.hidden.motion import Array
from tests.hidden.scoring import named
from tests.hidden.streams import derived_seed
from tests.hidden.study import DEFAULT_ANSWERER, ONE_THREAD, load

FIRST_DEG = 0.05
"""Strength at which a draw's clearance is taken: signatures are proportional to it."""
EFFECTS = 30
"""Effects looked at, until an answer says how many it was."""


@dataclass(frozen=True)
class Subject:
    """A cause, where it is looked for, and the degrees of freedom of a test for it."""

    cause: str
    protocol: str
    dof: int


SUBJECTS = (
    Subject("saturation", "static-channels", 1),
    Subject("hysteresis", "static_both-channels", 1),
    Subject("cardan_coupling", "static+channels", 2),
    Subject("drive_ripple", "static-channels", 2),
    Subject("magnet_harmonic", "static-channels", 2),
    Subject("latency", "speeds-channels", 1),
    Subject("mains_pickup", "spin_both-channels", 3),
    Subject("offset_drift", "oven-channels", 2),
)


@dataclass(frozen=True)
class Shot:
    """One draw at one rung of the ladder."""

    cause: str
    seed: int
    rung: float
    """Amplitude over the draw's own limit."""
    strength_deg: float
    limit_deg: float
    found: bool
    names: tuple[str, ...]


@dataclass(frozen=True)
class Power:
    """What a ladder says: amplitude over limit at which half are found, with its 95 % interval."""

    cause: str
    limit_deg: float
    """Median over the draws."""
    ratio: float
    low: float
    high: float
    slope: float
    """Width of the logistic in the logarithm of the amplitude."""

    @property
    def found_deg(self) -> float:
        """Amplitude found half the time, degrees."""
        return self.ratio * self.limit_deg


def matched_sigma(dof: int, *, alpha: float) -> float:
    """Length of a signature, in noise deviations, at which a chi-square test of this size is passed half the time."""
    from scipy.optimize import brentq
    from scipy.stats import chi2, ncx2

    threshold = float(chi2.isf(alpha, dof))
    return float(brentq(lambda length: ncx2.sf(threshold, dof, length**2) - 0.5, 1e-3, 50.0))


def shoot(subject: Subject, *, rung: float, seed: int, answerer: str, alpha: float, effects: int) -> tuple[Shot, int]:
    """Draw at a multiple of the draw's own limit and ask; with it, how many effects the answer looked at."""
    explain = load(answerer)
    first = draw([subject.cause], seed=seed, protocol=subject.protocol, strength_deg=FIRST_DEG)
    cleared = first.truth["clearance_sigma"]
    assert isinstance(cleared, dict)
    needed = matched_sigma(subject.dof, alpha=alpha / effects)
    limit_deg = FIRST_DEG * needed / float(cleared[subject.cause])
    strength = rung * limit_deg
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sweep.csv"
        draw([subject.cause], seed=seed, protocol=subject.protocol, strength_deg=strength).write_csv(path)
        answer = explain(str(path))
    given = named(answer)
    shot = Shot(
        cause=subject.cause,
        seed=seed,
        rung=rung,
        strength_deg=strength,
        limit_deg=limit_deg,
        found=any(subject.cause in names for names in given),
        names=tuple(entry["name"] for entry in answer["causes"]),
    )
    return shot, int(answer.get("searched", effects))


def half_way(shots: Sequence[Shot]) -> Power:
    """Maximum likelihood of a logistic curve in the logarithm of the amplitude, the interval by profile likelihood.

    ValueError where the ladder holds no draw.
    """
    if not shots:
        raise ValueError("a ladder needs at least one draw")
    rungs, place = np.unique(np.log([shot.rung for shot in shots]), return_inverse=True)
    total = np.bincount(place)
    hits = np.bincount(place, [shot.found for shot in shots])
    centres = np.linspace(np.log(0.3), np.log(6.0), 600)
    slopes = np.geomspace(0.02, 0.5, 40)
    steps = (rungs - centres[:, None, None]) / slopes[None, :, None]
    likelihood = -(np.logaddexp(0.0, -steps) @ hits + np.logaddexp(0.0, steps) @ (total - hits))
    profile = likelihood.max(axis=1)
    best = int(np.argmax(profile))
    inside = np.flatnonzero(profile > profile[best] - 1.92)
    return Power(
        cause=shots[0].cause,
        limit_deg=float(np.median([shot.limit_deg for shot in shots])),
        ratio=float(np.exp(centres[best])),
        low=float(np.exp(centres[inside[0]])),
        high=float(np.exp(centres[inside[-1]])),
        slope=float(slopes[int(np.argmax(likelihood[best]))]),
    )


def ladder(rungs: int, *, lowest: float, highest: float) -> Array:
    """Amplitudes over the limit, evenly spaced in the logarithm."""
    return np.geomspace(lowest, highest, rungs)


def climb(
    subject: Subject, *, rungs: Array, draws: int, seed: int, answerer: str, alpha: float, console: Console
) -> list[Shot]:
    """Every rung so many times, each draw with a bench of its own."""
    shots: list[Shot] = []
    effects = EFFECTS
    for number in range(draws):
        for rung in rungs:
            one = derived_seed(seed, "power", subject.cause, f"{rung:.4f}", str(number))
            shot, effects = shoot(subject, rung=float(rung), seed=one, answerer=answerer, alpha=alpha, effects=effects)
            shots.append(shot)
    hits = [sum(s.found for s in shots if s.rung == float(rung)) for rung in rungs]
    console.print(f"{subject.cause}: found {' '.join(str(h) for h in hits)} of {draws} a rung", highlight=False)
    return shots


def power_table(powers: Sequence[Power]) -> Table:
    """The table of the command."""
    made = Table(title="Amplitude found half the time", title_justify="left")
    made.add_column("cause", no_wrap=True)
    for heading in ("found half the time, deg", "matched limit, deg", "ratio", "95 % interval"):
        made.add_column(heading, justify="right")
    for one in powers:
        made.add_row(
            one.cause,
            f"{one.found_deg:.4f}",
            f"{one.limit_deg:.4f}",
            f"{one.ratio:.2f}",
            f"{one.low:.2f} to {one.high:.2f}",
        )
    return made


def plot(powers: Sequence[Power], shots: Sequence[Shot], path: Path) -> None:
    """Share found over the amplitude, one panel a cause. UserError where the picture cannot be drawn."""
    from diagnosis.report.plotting import save, style

    plt = style(path)
    columns = min(4, len(powers))
    rows = math.ceil(len(powers) / columns)
    figure, panels = plt.subplots(
        rows, columns, figsize=(1.9 * columns + 0.4, 1.75 * rows + 0.7), sharex=True, sharey=True, squeeze=False
    )
    for panel, power in zip(panels.flat, powers, strict=False):
        own = [shot for shot in shots if shot.cause == power.cause]
        at = sorted({shot.rung for shot in own})
        total = np.array([sum(shot.rung == rung for shot in own) for rung in at])
        hits = np.array([sum(shot.rung == rung and shot.found for shot in own) for rung in at])
        share = (hits + 0.5) / (total + 1.0)
        panel.axvline(1.0, color="0.55", lw=1.0, ls="--", label="limit of a matched test")
        panel.axvspan(power.low, power.high, color="tab:blue", alpha=0.15, lw=0, label="half found, 95 % interval")
        grid = np.geomspace(at[0] / 1.1, at[-1] * 1.1, 200)
        curve = 1.0 / (1.0 + np.exp(-(np.log(grid) - np.log(power.ratio)) / power.slope))
        panel.plot(grid, 100.0 * curve, color="tab:blue", lw=1.4, label="logistic fit")
        bars = 100.0 * np.sqrt(share * (1.0 - share) / total)
        panel.errorbar(
            at, 100.0 * hits / total, bars, fmt="o", ms=3.5, color="black", lw=0.8, label="draws, ± one binomial sd"
        )
        panel.set_title(f"{power.cause}\nlimit {power.limit_deg:.4f} deg, ratio {power.ratio:.2f}", fontsize=8)
        panel.set_xscale("log")
        ticks = [tick for tick in (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0) if grid[0] <= tick <= grid[-1]]
        panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        panel.minorticks_off()
        panel.set_ylim(-5, 108)
    for panel in panels.flat[len(powers) :]:
        panel.axis("off")
    figure.supxlabel("amplitude / limit of a matched test", fontsize=9)
    figure.supylabel("found, % of draws", fontsize=9)
    handles, labels = panels.flat[0].get_legend_handles_labels()
    figure.tight_layout(rect=(0, 0, 1, 1.0 - 0.32 / figure.get_figheight()))
    figure.legend(handles, labels, loc="upper center", ncol=4, fontsize=7.5, frameon=False)
    save(figure, path)


def parser() -> argparse.ArgumentParser:
    """Options of the command."""
    made = argparse.ArgumentParser(prog="python -m tests.benchmarks.power", description=__doc__.splitlines()[0])
    made.add_argument("--only", default="", help="comma-separated causes to keep")
    made.add_argument("--draws", type=int, default=12, help="draws of each rung")
    made.add_argument("--rungs", type=int, default=6)
    made.add_argument("--lowest", type=float, default=0.7, help="lowest rung, over the matched limit")
    made.add_argument("--highest", type=float, default=2.0, help="highest rung, over the matched limit")
    made.add_argument("--seed", type=int, default=1)
    made.add_argument("--answerer", default=DEFAULT_ANSWERER, help="module:function, path -> dict")
    made.add_argument("--plot", type=Path, help="picture of the shares found: .svg, .png or .pdf")
    made.add_argument("-o", "--output", type=Path, help="JSON of the draws and the powers")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    options = parser().parse_args(arguments)
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    # the rate that the search allows itself is the one the matched test gets
    from diagnosis.discovery.search.stepwise import ALPHA

    console = Console() if Console().is_terminal else Console(width=100)
    only = {one.strip() for one in options.only.split(",") if one.strip()}
    subjects = [subject for subject in SUBJECTS if not only or subject.cause in only]
    rungs = ladder(options.rungs, lowest=options.lowest, highest=options.highest)
    shots = {
        subject.cause: climb(
            subject,
            rungs=rungs,
            draws=options.draws,
            seed=options.seed,
            answerer=options.answerer,
            alpha=ALPHA,
            console=console,
        )
        for subject in subjects
    }
    powers = [half_way(own) for own in shots.values()]
    console.print(power_table(powers))
    everything = [shot for own in shots.values() for shot in own]
    if options.output is not None:
        record = {
            "alpha": ALPHA,
            "seed": options.seed,
            "draws": options.draws,
            "powers": [{**vars(one), "found_deg": one.found_deg} for one in powers],
            "shots": [{**vars(shot), "names": list(shot.names)} for shot in everything],
        }
        options.output.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    if options.plot is not None:
        plot(powers, everything, options.plot)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
