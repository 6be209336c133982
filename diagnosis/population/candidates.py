"""What is looked for on every device of a batch: causes at common shapes, so that their sizes can be pooled.

A device's own search may zoom in on a memory or an order; estimates of different shapes cannot be averaged. Here each
cause is asked for at each shape of a grid that all devices share: the grid of its declaration, or every whole order
where it is a line over the turn. Causes whose columns cannot be told apart on such a motion are one candidate under
several names.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from diagnosis.discovery.fitting.linearised_chain import Linear
from twin.angles import Array
from twin.baseline import FACTORS
from twin.catalogue import CATALOGUE, find, unnamed
from twin.chain import Chain
from twin.effect import Effect
from twin.motion import Motion

MOST_TERMS = 2
"""Coefficients of a candidate: more are a shape of their own on each device, and no size that can be averaged."""
MOST_SHAPES = 16
"""A cause with a finer grid is a search of its own, which the explanation of a single device does."""
HIGHEST_ORDER = 100
"""Lines above have been met on drives of more than fifty pole pairs alone."""
_SAME = 0.999
"""Cosine between two candidates beyond the factors above which they count as one: to tell a cause of ten standard
errors from it takes a millionth of its sum of squares times ten thousand, a fifth of a standard error."""
_TAKEN = 1e-3
"""Share of a candidate's size beyond the factors below which they do its work, so that it cannot be seen."""


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A cause at one shape.

    ``terms`` coefficients (1, or 2: the strength at the phases 0 and 90 deg, or two strengths). ``order`` over the turn
    of a line. ``sign`` of the one coefficient that physics allows, 0: either. ``same``: other causes whose readings
    cannot be told from it on such a motion.
    """

    effect: str
    shape: tuple[tuple[str, float], ...]
    terms: int
    order: float | None
    sign: int
    unit: str
    same: tuple[str, ...] = ()

    @property
    def values(self) -> Mapping[str, float]:
        """The shape parameters by name."""
        return dict(self.shape)

    @cached_property
    def declared(self) -> Effect:
        """The effect as the catalogue declares it."""
        return find(self.effect)

    @property
    def strength(self) -> str:
        """The first of the parameters that its coefficients stand for."""
        return self.declared.roles("strength")[0]


def candidates_for(motion: Motion, chain: Chain) -> tuple[Candidate, ...]:
    """All candidates that such a motion shows beyond the factors, each once."""
    linear = Linear(chain, motion, blur=0.0, observables=1)
    asked = [one for effect in _asked(motion) for one in _of_effect(effect, motion, linear)]
    basis = _orthonormal(factor_columns(linear).T)
    kept: list[Candidate] = []
    spans: list[Array] = []
    for one, columns in zip(asked, columns_of(linear, asked), strict=True):
        beyond = columns - (columns @ basis) @ basis.T
        if np.linalg.norm(beyond) <= _TAKEN * np.linalg.norm(columns):
            continue
        span = _orthonormal(beyond.T)
        if span.shape[1] < one.terms:
            continue
        same = [place for place, other in enumerate(spans) if _overlap(span, other) > _SAME]
        if same:
            names = dict.fromkeys([*kept[same[0]].same, one.effect])
            names.pop(kept[same[0]].effect, None)
            kept[same[0]] = replace(kept[same[0]], same=tuple(names))
            continue
        kept.append(one)
        spans.append(span)
    return tuple(kept)


def overlaps(motion: Motion, chain: Chain, candidates: Sequence[Candidate], present: Sequence[Candidate]) -> Array:
    """Largest cosine (C, C) between candidates on such a motion, beyond the factors and what is present."""
    linear = Linear(chain, motion, blur=0.0, observables=1)
    beside = [factor_columns(linear), *columns_of(linear, present)]
    basis = _orthonormal(np.concatenate(beside).T)
    spans = [_orthonormal((c - (c @ basis) @ basis.T).T) for c in columns_of(linear, candidates)]
    ends = np.cumsum([0, *(span.shape[1] for span in spans)])
    together = np.abs(np.concatenate(spans, axis=1).T @ np.concatenate(spans, axis=1))
    rows = np.maximum.reduceat(together, ends[:-1], axis=0)
    return np.asarray(np.maximum.reduceat(rows, ends[:-1], axis=1))


def _asked(motion: Motion) -> Iterator[Effect]:
    """Effects with a size in proportion on the mean of the readings that the motion shows; those with a name first."""
    shown = [
        effect
        for effect in CATALOGUE
        if not effect.baseline
        and effect.footprint == "mean"
        and effect.visible_in(motion.provides)
        and effect.roles("strength")
        and not effect.roles("per turn")
    ]
    yield from (effect for effect in shown if not unnamed(effect.name))
    yield from (effect for effect in shown if unnamed(effect.name))


def _of_effect(effect: Effect, motion: Motion, linear: Linear) -> Iterator[Candidate]:
    """The effect at each shape of its grid; none where that is too fine or its order is any number."""
    terms = linear.terms(effect)
    shapes = _shapes(effect, motion)
    if len(terms) > MOST_TERMS or len(shapes) > MOST_SHAPES * (1 if effect.line is None else HIGHEST_ORDER):
        return
    strength = effect.params[terms[0].param]
    sign = int(strength.lower == 0.0) - int(strength.upper == 0.0) if len(terms) == 1 else 0
    for shape in shapes:
        order = float(shape["order"]) if effect.roles("phase") and "order" in shape else None
        yield Candidate(
            effect=effect.name,
            shape=tuple((name, float(value)) for name, value in shape.items()),
            terms=len(terms),
            order=order,
            sign=sign,
            unit=strength.unit,
        )


def _shapes(effect: Effect, motion: Motion) -> Sequence[Mapping[str, float]]:
    if effect.line is None:
        return list(effect.shapes(motion))
    if effect.line.clock != "shaft":
        return []
    low, high = effect.line.limits(motion)
    orders = np.arange(np.ceil(low), min(np.floor(high), HIGHEST_ORDER) + 1)
    return [effect.line.begun(float(order)) for order in orders[effect.line.within(orders)]]


def factor_columns(linear: Linear) -> Array:
    """Derivatives (6, n) [rad] of the readings with respect to the paper's factors, in the twin's units."""
    rows = [linear.derivatives(factor.key, factor.effect, [(factor.param, None)])[0, 0] for factor in FACTORS]
    return np.stack(rows)


def columns_of(linear: Linear, candidates: Sequence[Candidate]) -> list[Array]:
    """Change of the readings (terms, n) [rad] for a coefficient of 1 of each candidate."""
    found: list[Array] = [np.zeros((0, 0))] * len(candidates)
    places: dict[str, list[int]] = {}
    for place, one in enumerate(candidates):
        places.setdefault(one.effect, []).append(place)
    for name, of_effect in places.items():
        effect = find(name)
        shapes = [candidates[place].values for place in of_effect]
        made = _lines(linear, effect, shapes) if effect.line is not None else linear.columns(effect, shapes)[:, :, 0]
        for place, columns in zip(of_effect, made, strict=True):
            found[place] = columns
    return found


def _lines(linear: Linear, effect: Effect, shapes: Sequence[Mapping[str, float]]) -> Array:
    """Columns (G, 2, n) of a line over the turn at many orders, from those at one.

    The line at order k is the real part of A exp(i k angle), with an amplitude A (n,) that does not depend on k.
    """
    assert effect.line is not None
    orders = np.array([shape[effect.line.param] for shape in shapes])
    cosine, quadrature = linear.columns(effect, shapes[:1])[0, :, 0]
    turned = np.empty((orders.size, cosine.size), dtype=complex)
    turned[0] = cosine - 1j * quadrature
    once = np.exp(1j * linear.motion.shaft_rad)
    for place, step in enumerate(np.diff(orders), 1):
        # Orders follow one another: a product takes a tenth of the time of an exponential.
        turned[place] = turned[place - 1] * (once if step == 1.0 else once**step)
    return np.stack([turned.real, -turned.imag], axis=1)


def _orthonormal(columns: Array) -> Array:
    """An orthonormal basis (n, rank) of what the columns (n, k) span."""
    size = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(size > 0.0, size, 1.0)
    left, values, _ = np.linalg.svd(scaled, full_matrices=False)
    return np.asarray(left[:, values > 1e-7])


def _overlap(span: Array, other: Array) -> float:
    """Smallest cosine between two spans of equally many columns; 0 where their numbers differ."""
    if span.shape != other.shape:
        return 0.0
    return float(np.linalg.svd(span.T @ other, compute_uv=False).min())
