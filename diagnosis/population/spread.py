"""What the batch has in common: each factor's mean and spread, and the causes that its devices share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from diagnosis.population.batch import ZERO, Batch
from diagnosis.population.pooled import (
    FALSE_SHARE,
    OWN,
    REFERENCE,
    SENSOR,
    WAYS,
    Figures,
    log_p_of,
)
from diagnosis.population.random_effects import RandomEffects, random_effects
from twin.angles import Array
from twin.baseline import FACTORS, Factor
from twin.confidence import student_95
from twin.effect import BoolArray

_TRUSTED = 30
"""Devices from which on the two halves say how large the errors are: their variance is then known to a quarter."""


@dataclass(frozen=True, kw_only=True)
class FactorOfBatch:
    """One of the paper's factors over the devices; ``inflation``: of the errors' variance, by the halves."""

    factor: Factor
    found: RandomEffects
    inflation: float


@dataclass(frozen=True, kw_only=True)
class CauseOfBatch:
    """A cause that the devices share.

    ``log_p``: that chance alone makes any candidate look as much so. ``phase_from``: from where the phase is counted
    that all share, both places where the zeros are alike; empty where each device has its own or there is none.
    ``mean`` of the coefficients, with their interval; ``amplitude`` that of the mean, or the root mean square over
    devices where each has a phase of its own; ``spread`` between devices. ``on_one``: the size on a usual device in
    standard errors of a single sweep.
    """

    name: str
    shape: Mapping[str, float]
    unit: str
    parameter: str
    log_p: float
    phase_from: tuple[str, ...]
    own_phase: bool
    amplitude: float
    low: float
    high: float
    phase_deg: float | None
    spread: float
    on_one: float
    devices: int
    not_told_from: tuple[str, ...] = ()


def inflation_of(halves: Array, errors: Array) -> float:
    """By how much two halves' figures (2, N) differ beyond their errors (2, N): a ratio of variances, 1 for few."""
    if halves.shape[1] < _TRUSTED:
        return 1.0
    return float(np.mean((halves[0] - halves[1]) ** 2 / np.sum(errors**2, axis=0)))


def factors_of(batch: Batch) -> list[FactorOfBatch]:
    """Mean and spread of each factor but the zero over the devices."""
    found = []
    for place, factor in enumerate(FACTORS):
        if place == ZERO:
            continue
        halves, errors = (batch.arrays[name][:, :, place].T for name in ("fitted_halves", "halves_error"))
        inflation = inflation_of(halves, errors)
        own = np.sqrt(inflation) * batch.arrays["fitted_error"][:, place]
        effects = random_effects(batch.arrays["fitted"][:, place], own)
        found.append(FactorOfBatch(factor=factor, found=effects, inflation=inflation))
    return found


def cause_of(batch: Batch, number: int, others: tuple[str, ...], usual: BoolArray) -> CauseOfBatch:
    """A cause that is fitted along; ``usual`` (N,) devices do not stand apart and tell its size."""
    one, figures = batch.present[number], batch.figures_of_present(number)
    tried = len(batch.question.candidates)
    log_p = log_p_of(figures, one.sign)
    least = float(np.nanmin(log_p)) + np.log(np.count_nonzero(~np.isnan(log_p)) * tried)
    shared = tuple(way for way, p in zip(WAYS, log_p, strict=True) if way != OWN and p < np.log(FALSE_SHARE / tried))
    where = _best(shared, log_p)
    amplitude, ends, phase, spread = _size(figures, usual & figures.seen, where)
    if one.terms == 1 or one.order is None:
        from_where: tuple[str, ...] = ()
    elif where is not None and figures.turned is None:
        from_where = (REFERENCE, SENSOR)
    else:
        from_where = () if where is None else (where,)
    seen = figures.seen & usual
    return CauseOfBatch(
        name=one.effect,
        shape=one.values,
        unit=one.unit,
        parameter=one.strength,
        log_p=float(min(least, 0.0)),
        phase_from=from_where,
        own_phase=where is None and figures.line,
        amplitude=amplitude,
        low=float(ends[0]),
        high=float(ends[1]),
        phase_deg=phase if one.order is not None else None,
        spread=spread,
        on_one=float(abs(amplitude) / np.median(figures.errors[seen])),
        devices=int(np.count_nonzero(seen)),
        not_told_from=others,
    )


def _best(shared: tuple[str, ...], log_p: Array) -> str | None:
    return min(shared, key=lambda way: log_p[WAYS.index(way)]) if shared else None


def _size(
    figures: Figures, chosen: BoolArray, where: str | None
) -> tuple[float, tuple[float, float], float | None, float]:
    """Amplitude with its interval, phase [deg] and spread between devices, from the chosen ones (N,)."""
    errors = figures.errors[chosen]
    if where is None:
        return _own_size(figures.halves[:, chosen])
    values = figures.counted_from(where)[chosen]
    parts = [random_effects(column, errors) for column in values.T]
    spread = float(np.sqrt(np.mean([part.spread**2 for part in parts])))
    if len(parts) == 1:
        return parts[0].mean, (parts[0].low, parts[0].high), None, spread
    mean = np.array([part.mean for part in parts])
    size = float(np.hypot(*mean))
    half = np.array([0.5 * (part.high - part.low) for part in parts])
    # The interval of a length is that of the component along it.
    along = float(np.hypot(*(half * mean / max(size, 1e-300))))
    return size, (max(size - along, 0.0), size + along), float(np.degrees(np.arctan2(mean[1], mean[0]))), spread


def _own_size(halves: Array) -> tuple[float, tuple[float, float], None, float]:
    """Root mean square over devices of a size whose phase is each one's own, from the halves' products."""
    product = np.einsum("nt,nt->n", *halves)
    count = product.size
    half = float(student_95(count - 1) * np.std(product, ddof=1) / np.sqrt(count))
    mean = float(product.mean())
    low, middle, high = (float(np.sqrt(max(value, 0.0))) for value in (mean - half, mean, mean + half))
    return middle, (low, high), None, middle
