"""The joint fit of sweeps at several air gaps: generalised least squares of their factors on causes and gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from diagnosis.error_model.model import QUAD
from diagnosis.factors.gap_model import CAUSES, ROWS, GapSweep, causes_of, expected, imagined
from diagnosis.factors.mounting import Mounting
from twin.angles import Array

_SIZE = {
    "voltage": 0.1,
    "reference": 1e-3,
    "electronics": 1e-3,
    "sensor": 0.1,
    "magnet": 0.1,
    "tilt": 0.01,
    "magnet_tilt": 0.01,
    "tilt_and_magnet": 0.01,
    "both_tilts": 1e-3,
}
"""Steps in which the causes are counted, in their own unit; differences are taken over a hundredth."""
_LENGTHS = {"sensor": 2, "magnet": 2, "tilt": 1, "magnet_tilt": 1, "tilt_and_magnet": 1, "both_tilts": 0}
"""How many lengths stand in a product: none of them is longer than the magnet's reach, no angle larger than 1 rad."""
_STEP = 0.01
LOG_AMPLITUDE_ERROR = 2e-3
"""Of the channels' amplitude beside the fit's own: two kelvin of a magnet of rare earth."""


@dataclass(frozen=True, eq=False)
class GapFit:
    """What some causes make of all gaps together."""

    causes: tuple[str, ...]
    numbers: Array
    """Two for each cause, then the gaps [mm], then the scale of the amplitudes where there are any."""
    covariance: Array
    chi2: float
    degrees_of_freedom: int
    readings: int
    """Degrees of freedom of the sweeps' variances, which chi2 is counted against."""
    gap_mm: Array
    misses: Array
    """Fitted factor minus the expected one (sweeps, 4), in its own standard errors."""
    differences: Array
    """The same in the factor's unit."""

    @cached_property
    def p(self) -> float:
        """Probability of a chi2 as large where the causes are all there is."""
        from scipy.special import fdtrc

        if self.degrees_of_freedom < 1:
            return 1.0
        return float(fdtrc(self.degrees_of_freedom, self.readings, self.chi2 / self.degrees_of_freedom))

    def with_gap(self, gap_mm: float) -> GapFit:
        """The same numbers with a further gap behind the others, to start another fit from."""
        return replace(self, numbers=np.insert(self.numbers, 2 * len(self.causes) + self.gap_mm.size, gap_mm))

    def pair(self, cause: str) -> tuple[complex, float]:
        """A cause's two numbers as a complex one, and its standard error along itself; zeros where it is absent."""
        if cause not in self.causes:
            return 0j, 0.0
        at = 2 * self.causes.index(cause)
        rows = slice(at, at + 2)
        x, y = self.numbers[rows]
        size = float(np.hypot(x, y))
        along = np.array([x, y]) / size if size > 0.0 else np.array([1.0, 0.0])
        # What the gaps do not tell has a variance that is all rounding, of either sign.
        return complex(x, y), float(np.sqrt(max(float(along @ self.covariance[rows, rows] @ along), 0.0)))


@dataclass(frozen=True, eq=False)
class Problem:
    """The sweeps with the magnet, and the gaps that are stated or that amplitudes tell."""

    sweeps: tuple[GapSweep, ...]
    mounting: Mounting
    start_mm: Array

    @cached_property
    def has_amplitudes(self) -> bool:
        """Whether every sweep holds raw channels."""
        return all(sweep.log_amplitude is not None for sweep in self.sweeps)

    @cached_property
    def whitening(self) -> Array:
        """The inverse roots of the factors' covariances (sweeps, 4, 4)."""
        return np.array([np.linalg.inv(np.linalg.cholesky(sweep.covariance)) for sweep in self.sweeps])

    def fitted(self, causes: Sequence[str], readings: int, *, start: GapFit | None = None) -> GapFit:
        """The best values of these causes, from those of a simpler fit where one is given."""
        from scipy.optimize import least_squares

        names = tuple(name for name in CAUSES if name in causes)
        size = self._sizes(names)
        begin = self._begin(names, start) / size
        wide = np.full(size.size, np.inf)
        for k, name in enumerate(names):
            if name in _LENGTHS:
                wide[2 * k : 2 * k + 2] = float(self.mounting.magnet.reach_mm) ** _LENGTHS[name] / size[2 * k]
        low, high = -wide, wide.copy()
        gaps = slice(2 * len(names), 2 * len(names) + len(self.sweeps))
        low[gaps] = 0.2 * self.start_mm / size[gaps]
        high[gaps] = 5.0 * self.start_mm / size[gaps]
        found = least_squares(
            lambda x: self._misses(names, (x * size)[None])[0],
            begin,
            jac=lambda x: self._slopes(names, x, size),
            bounds=(low, high),
            xtol=1e-10,
            ftol=1e-10,
            max_nfev=60,
        )
        numbers = found.x * size
        covariance = np.linalg.pinv(found.jac.T @ found.jac) * size[:, None] * size
        rows = found.fun
        gap_mm = numbers[gaps]
        differences = self._differences(names, numbers)
        errors = np.array([np.sqrt(np.diagonal(sweep.covariance)) for sweep in self.sweeps])
        return GapFit(
            causes=names,
            numbers=numbers,
            covariance=covariance,
            chi2=float(rows @ rows),
            degrees_of_freedom=rows.size - numbers.size,
            readings=readings,
            gap_mm=gap_mm,
            misses=differences / errors,
            differences=differences,
        )

    def _sizes(self, names: Sequence[str]) -> Array:
        each = [size for name in names for size in 2 * [_SIZE[name]]]
        return np.array([*each, *len(self.sweeps) * [self.mounting.gap_error_mm], *self.has_amplitudes * [1e-2]])

    def _begin(self, names: Sequence[str], start: GapFit | None) -> Array:
        """The values of a simpler fit, the rest at zero, the gaps as stated or told by the amplitudes."""
        out = np.zeros(2 * len(names) + len(self.sweeps) + self.has_amplitudes)
        out[2 * len(names) :][: len(self.sweeps)] = self.start_mm
        if start is None:
            if self.has_amplitudes:
                none = causes_of((), np.zeros((1, 0)))
                logs = expected(self.sweeps, self.mounting.magnet, none, self.start_mm[None]).log_amplitude
                out[-1] = float(np.mean([s.log_amplitude or 0.0 for s in self.sweeps]) - logs.mean())
            return out
        for k, name in enumerate(names):
            value, _ = start.pair(name)
            out[2 * k : 2 * k + 2] = value.real, value.imag
        out[2 * len(names) :] = start.numbers[2 * len(start.causes) :]
        return out

    def _differences(self, names: Sequence[str], numbers: Array) -> Array:
        """Fitted factors minus expected ones (sweeps, 4)."""
        gaps = numbers[2 * len(names) :][: len(self.sweeps)]
        told = expected(self.sweeps, self.mounting.magnet, causes_of(names, numbers[None]), gaps[None])
        return np.asarray(np.array([sweep.point[list(ROWS)] for sweep in self.sweeps]) - told.factors[0])

    def quadratic(self, fit: GapFit) -> Array:
        """The quadratic terms (sweeps,) without what the field's own order 3 adds to them by this fit."""
        numbers = fit.numbers[None]
        told = expected(self.sweeps, self.mounting.magnet, causes_of(fit.causes, numbers), fit.gap_mm[None])
        return np.asarray(np.array([sweep.point[QUAD] for sweep in self.sweeps]) - told.quad[0])

    def with_sweep(self, gap_mm: float, fit: GapFit) -> Problem:
        """These sweeps and a further one at this air gap, as this fit expects it without noise."""
        nearest = self.sweeps[int(np.argmin(np.abs(np.log(gap_mm / fit.gap_mm))))]
        causes = causes_of(fit.causes, fit.numbers[None])
        told = expected([nearest], self.mounting.magnet, causes, np.array([[gap_mm]]))
        if self.has_amplitudes:
            told = told._replace(log_amplitude=told.log_amplitude + fit.numbers[-1])
        stated = self.mounting.air_gap_mm
        place = (
            replace(self.mounting, air_gap_mm=(*stated, gap_mm)) if len(stated) == len(self.sweeps) else self.mounting
        )
        return Problem((*self.sweeps, imagined(nearest, told)), place, np.append(self.start_mm, gap_mm))

    def _misses(self, names: Sequence[str], numbers: Array) -> Array:
        """The whitened misses (batch, rows) of factors, amplitudes and stated gaps."""
        count = len(self.sweeps)
        gaps = numbers[:, 2 * len(names) :][:, :count]
        factors, logs, _ = expected(self.sweeps, self.mounting.magnet, causes_of(names, numbers), gaps)
        points = np.array([sweep.point[list(ROWS)] for sweep in self.sweeps])
        rows = [np.einsum("kij,bkj->bki", self.whitening, points - factors).reshape(len(numbers), -1)]
        if self.has_amplitudes:
            found = np.array([sweep.log_amplitude for sweep in self.sweeps], dtype=np.float64)
            error = np.hypot([sweep.log_amplitude_error for sweep in self.sweeps], LOG_AMPLITUDE_ERROR)
            rows.append((found - logs - numbers[:, -1:]) / error)
        stated = np.array(self.mounting.air_gap_mm)
        rows.append((stated - gaps[:, : stated.size]) / self.mounting.gap_error_mm)
        return np.concatenate(rows, axis=1)

    def _slopes(self, names: Sequence[str], x: Array, size: Array) -> Array:
        """Derivatives (rows, numbers) of the misses by central differences, all in one batch."""
        steps = _STEP * np.eye(x.size)
        both = np.concatenate([x + steps, x - steps]) * size
        misses = self._misses(names, both)
        return np.asarray((misses[: x.size] - misses[x.size :]).T / (2.0 * _STEP))
