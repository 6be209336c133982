"""The factors over the air gap: what each sweep gives, and the curve of the causes that are told."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.factors.air_gaps import AirGaps
from diagnosis.factors.gap_fit import GapFit
from diagnosis.factors.gap_model import ROWS, causes_of, expected
from diagnosis.report.plotting import CURVE
from twin.angles import Array
from twin.baseline import FACTORS
from twin.confidence import Z95

_POINTS = 61
_MARGIN = 0.08
"""Of the range of gaps, by which the curves run on."""


def draw_over_gaps(axes: Any, found: AirGaps) -> None:
    """One panel for each of offset x, offset y, gain ratio and phase, on four axes.

    Points with 95 % intervals are the sweeps at their fitted gaps, the curve is that of the fit whose causes are told.
    """
    fit, sweeps = found.told, found.fits.problem.sweeps
    gaps = _grid(fit.gap_mm)
    curves = _curves(found, fit, gaps)
    for k, (axis, row) in enumerate(zip(axes, ROWS, strict=True)):
        factor = FACTORS[row]
        scale = factor.per_coordinate
        value = scale * np.array([sweep.point[row] for sweep in sweeps])
        half = scale * Z95 * np.sqrt([sweep.covariance[k, k] for sweep in sweeps])
        axis.errorbar(fit.gap_mm, value, half, fmt="o", ms=3.5, lw=1.0, color="#4477aa", label="sweeps, 95 %")
        axis.plot(gaps, scale * curves[:, k], lw=1.2, color=CURVE, label=_words(found, fit))
        unit = f" [{factor.shown_unit}]" if factor.shown_unit else " [1]"
        axis.set(xlabel="air gap [mm]", ylabel=f"{factor.label}{unit}")
        axis.ticklabel_format(useOffset=False)
        axis.grid(alpha=0.25)


def _curves(found: AirGaps, fit: GapFit, gaps_mm: Array) -> Array:
    """The factors ROWS (gaps, 4) that the causes of a fit make at these gaps.

    A sweep's fit is linear near its own gap: between two gaps theirs are blended.
    """
    sweeps = found.fits.problem.sweeps
    causes = causes_of(fit.causes, np.tile(fit.numbers, (gaps_mm.size, 1)))
    each = np.repeat(gaps_mm[:, None], len(sweeps), axis=1)
    factors = expected(sweeps, found.mounting.magnet, causes, each).factors
    order = np.argsort(fit.gap_mm)
    share = np.stack([np.interp(gaps_mm, fit.gap_mm[order], one[order]) for one in np.eye(len(sweeps))], axis=1)
    return np.asarray(np.sum(share[..., None] * factors, axis=1))


def _grid(gap_mm: Array) -> Array:
    low, high = float(gap_mm.min()), float(gap_mm.max())
    more = _MARGIN * (high - low)
    return np.linspace(max(low - more, 0.5 * low), high + more, _POINTS)


def _words(found: AirGaps, fit: GapFit) -> str:
    goodness = f"chi-squared {fit.chi2:.0f} at {fit.degrees_of_freedom}"
    if found.misfit:
        return f"no set of causes holds ({goodness})"
    return f"{', '.join(fit.causes).replace('_', ' ') or 'no cause'} ({goodness})"
