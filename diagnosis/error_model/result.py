"""The result of a fit of the paper's error model: values, intervals, senses, search range, and what each step gave."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import model
from diagnosis.error_model.model import NAMES
from twin.angles import Array
from twin.chain import Chain


@dataclass(frozen=True)
class Senses:
    """The senses in which sensor and output count: s of a = s theta + zero, h of m = h atan2(y, x).

    The slope of the readings tells their product. Which of the two pairs with that product is the right one shows only
    through the quadratic term: ``other`` holds the parameters (6,) of the swapped pair, ``sigma`` says by how many
    standard errors it fits worse. Where the pair was given, the other one is not tried: None and infinity.
    """

    sensor: int
    output: int
    sigma: float
    other: Array | None


@dataclass(frozen=True)
class SearchRange:
    """The box that the swarm searched, (6,) each, and which of its sides had to be moved outwards from Table 2's."""

    lower: Array
    upper: Array
    widened: tuple[str, ...]
    rounds: int


@dataclass(frozen=True)
class Contributions:
    """What each step of the fit gave: the RMS error [rad] with the zero alone, after the search, after least squares.

    The first two come from the quadratic form, sines of the angle error weighted by r^2: the RMS to a few per cent.
    """

    zero_only_rms_rad: float
    swarm_rms_rad: float | None
    """None where the swarm did not run."""
    descents_rms_rad: float | None
    """Where descents from all starts end in one minimum; None where they do not, or the swarm was asked for."""
    polished_rms_rad: float
    particles_evaluated: int
    particles_discarded: int
    """By Eq. 11, where the band is given."""
    passes: int
    best_history_rad: Array
    """RMS of the swarm's best after each iteration of the last round."""
    own_history_rad: Array
    """RMS of the mean of the particles' own bests after each iteration of the last round."""


@dataclass(frozen=True, eq=False)
class BaselineFit:
    """The paper's error model fitted to one sweep.

    ``point``, ``low``, ``high`` (6,) are in the order and units of :data:`diagnosis.error_model.model.NAMES`; low
    and high bound the 95 % interval under independent readings. ``residual_rad`` (n,) is measured minus predicted
    reading, wrapped, for every row; ``outliers`` (n,) marks rows that the robust option left out.
    """

    point: Array
    covariance: Array
    low: Array
    high: Array
    at_bound: NDArray[np.bool_]
    senses: Senses
    search: SearchRange
    contributions: Contributions
    residual_rad: Array
    outliers: NDArray[np.bool_]
    sigma_rad: float
    """Standard deviation of a reading of weight 1, from the residual and its degrees of freedom."""
    rms_rad: float
    """Over the rows that are no outliers."""
    degrees_of_freedom: int
    """Of sigma_rad: used rows less the six parameters."""
    settled: bool
    """Whether least squares converged."""

    def __repr__(self) -> str:
        point = ", ".join(f"{name}={value:.5g}" for name, value in self.named().items())
        return f"BaselineFit({point}; {np.degrees(self.rms_rad):.4g} deg RMS)"

    @cached_property
    def values(self) -> dict[str, dict[str, float]]:
        """Parameters of the twin's effects, by effect."""
        return model.twin_values(self.point)

    @property
    def standard_errors(self) -> Array:
        """Standard errors (6,) of the point."""
        return np.sqrt(np.diagonal(self.covariance))

    def chain(self) -> Chain:
        """The twin with these parameters and nothing else."""
        return Chain(values=self.values, sensor_sense=self.senses.sensor, output_sense=self.senses.output)

    def named(self) -> dict[str, float]:
        """The point by name."""
        return dict(zip(NAMES, map(float, self.point), strict=True))
