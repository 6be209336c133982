"""Figure 13 and the comparison of the methods of search, as pictures, tables and figures held against the paper's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from diagnosis.error_model.grid_search import full_grid_count
from scenarios.commands.paper.held import Held
from scenarios.commands.paper.search import Median, Method, Paired, Searched, median_of, paired
from twin.angles import Array

PRINTED_ITERATIONS, PRINTED_PARTICLES = 200, 20_000
"""Section 4.2: converged with fewer iterations; particles that these are of 100 each."""
BANDS = (1.0, 2.0, 4.0, 8.0)
"""Bands that the discard rule is tried with, in Delta E."""


def held(found: Mapping[str, Searched], *, settings_particles: int, delta_e_deg: float) -> list[Held]:
    """What the paper says of its search, and what we find."""
    swarm = found["modified"]
    median, rule = median_of(swarm.needed), paired(found["discard"], swarm)
    return [
        Held(
            where="Fig. 13",
            what="iterations until converged, slowest",
            printed=None,
            stated=f"below {PRINTED_ITERATIONS}",
            ours=float(np.max(swarm.needed)),
            unit="1",
            remark=f"{swarm.needed.size} cases, median {_interval(median)}",
        ),
        Held(
            where="Sec. 4.2",
            what="particles evaluated",
            printed=PRINTED_PARTICLES,
            ours=settings_particles * swarm.best_rad.shape[1],
            unit="1",
            remark=f"the start counts too; the ordinary method's grid has {full_grid_count():.1e} points",
        ),
        Held(
            where="Eq. 11",
            what="iterations that the discard rule adds",
            printed=None,
            stated="fewer than without",
            ours=rule.difference.value,
            low=rule.difference.low,
            high=rule.difference.high,
            unit="1",
            remark=f"median {_interval(median_of(found['discard'].needed))} with it, on the same cases; "
            f"{_words(rule)}; Delta E {delta_e_deg:.3f} deg",
        ),
    ]


def _words(found: Paired) -> str:
    return f"slower in {found.slower} cases, faster in {found.faster}, p = {found.p_value:.1g}"


def _interval(median: Median) -> str:
    return f"{median.value:.0f} (95 %: {median.low:.0f} to {median.high:.0f})"


def methods_csv(found: Mapping[str, Searched], chosen: Mapping[str, Method], grid_rad: Array) -> str:
    """The methods side by side: iterations until converged and what they leave, against the paper's own."""
    lines = [
        "method,cases,converged_percent,iterations_median,iterations_low,iterations_high,iterations_largest,"
        "rms_left_deg,more_than_modified_median,more_low,more_high,slower_cases,faster_cases,p_value,discarded_particles"
    ]
    for name, searched in found.items():
        many = median_of(searched.needed)
        cells = [
            f'"{chosen[name].words}"',
            f"{searched.needed.size}",
            f"{100.0 * np.mean(np.isfinite(searched.needed)):.4g}",
            *(_cell(value) for value in (many.value, many.low, many.high, float(np.max(searched.needed)))),
            f"{np.degrees(np.median(searched.best_rad[:, -1])):.5g}",
        ]
        if name == "modified":
            cells += [""] * 6
        elif not np.isfinite(many.value):
            # The difference would be that to the last iteration tried.
            cells += ["never"] * 3 + [""] * 3
        else:
            pair = paired(searched, found["modified"])
            cells += [f"{value:g}" for value in (pair.difference.value, pair.difference.low, pair.difference.high)]
            cells += [f"{pair.slower}", f"{pair.faster}", f"{pair.p_value:.2g}"]
        lines.append(",".join([*cells, f"{np.mean(searched.discarded):.0f}"]))
    coarse = f'"ordinary method on a grid of 5 points a factor",{grid_rad.size},0,,,,,'
    lines.append(f"{coarse}{np.degrees(np.median(grid_rad)):.5g},,,,,,,")
    return "\n".join(lines) + "\n"


def _cell(iterations: float) -> str:
    return f"{iterations:g}" if np.isfinite(iterations) else "never"


def figure_13(plt: Any, swarm: Searched) -> tuple[Any, dict[str, Array]]:
    """Fig. 13: the swarm's best and the particles' own bests over the iterations, and how many cases have converged."""
    figure, axes = plt.subplots(1, 2, figsize=(10.0, 4.2), layout="constrained")
    iteration: Array = np.arange(swarm.best_rad.shape[1], dtype=np.float64)
    columns = {"iteration": iteration}
    for name, curves, label, colour in (
        ("own", swarm.own_rad, "own bests, mean (BestFiterror)", "#D55E00"),
        ("best", swarm.best_rad, "best of all (Meanfiterror)", "#0072B2"),
    ):
        low, middle, high = np.degrees(np.quantile(curves, [0.05, 0.5, 0.95], axis=0))
        axes[0].fill_between(iteration, low, high, color=colour, alpha=0.2, linewidth=0)
        axes[0].semilogy(iteration, middle, color=colour, label=label)
        columns |= {f"{name}_median_deg": middle, f"{name}_5_percent_deg": low, f"{name}_95_percent_deg": high}
    axes[0].axhline(
        np.degrees(np.median(swarm.least_rad)), color="0.3", linestyle="--", linewidth=0.9, label="least squares"
    )
    axes[0].set(
        title=f"{swarm.needed.size} cases: median, 5 to 95 % shaded", xlabel="iteration [1]", ylabel="RMS error [deg]"
    )
    share = np.mean(swarm.needed[:, None] <= iteration, axis=0)
    columns["converged_percent"] = np.asarray(100.0 * share)
    axes[1].step(iteration, 100.0 * share, where="post", label="within 1 % of the least RMS")
    axes[1].axvline(PRINTED_ITERATIONS, color="0.3", linestyle="--", linewidth=0.9, label="below 200, as printed")
    axes[1].set(
        title=f"slowest case: {_cell(float(np.max(swarm.needed)))} iterations",
        xlabel="iteration [1]",
        ylabel="cases converged [%]",
    )
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8)
    return figure, columns


@dataclass(frozen=True, eq=False)
class Compared:
    """Methods searched on the same cases, with the words for each; the discard rule by its band in Delta E."""

    searched: Mapping[str, Searched]
    words: Mapping[str, str]
    banded: Mapping[float, Searched]
    delta_e_deg: float


def figure_of_methods(plt: Any, compared: Compared) -> tuple[Any, dict[str, Array]]:
    """How many cases each method has brought to convergence, and what the discard rule costs over its band."""
    found, banded = compared.searched, compared.banded
    figure, axes = plt.subplots(1, 2, figsize=(11.0, 5.0), layout="constrained")
    iteration: Array = np.arange(found["modified"].best_rad.shape[1], dtype=np.float64)
    columns = {"iteration": iteration}
    for name, searched in found.items():
        share = 100.0 * np.mean(searched.needed[:, None] <= iteration, axis=0)
        axes[0].step(iteration, share, where="post", label=compared.words[name])
        columns[f"{name}_converged_percent"] = np.asarray(share)
    axes[0].set(title="methods, the same cases", xlabel="iteration [1]", ylabel="cases converged [%]")
    size = compared.delta_e_deg * np.array(list(banded))
    medians = [median_of(searched.needed) for searched in banded.values()]
    middle, low, high = (np.array([getattr(one, name) for one in medians]) for name in ("value", "low", "high"))
    axes[1].errorbar(
        size, middle, yerr=[middle - low, high - middle], fmt="o", capsize=3, label="with the discard rule"
    )
    without = median_of(found["modified"].needed)
    axes[1].axhspan(without.low, without.high, color="0.7", alpha=0.5, linewidth=0)
    axes[1].axhline(without.value, color="0.3", label="without it")
    axes[1].set(
        xscale="log",
        xticks=size,
        xticklabels=[f"{value:.3g}" for value in size],
        title="discard rule: median and its 95 % interval",
        xlabel="band Delta E [deg]",
        ylabel="iterations until converged [1]",
    )
    axes[1].minorticks_off()
    for axis in axes:
        axis.grid(alpha=0.3)
    axes[1].legend(fontsize=8)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower left", ncols=2, fontsize=8)
    return figure, columns
