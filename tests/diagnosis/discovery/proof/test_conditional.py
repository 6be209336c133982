"""Rows held out one by one in coloured noise: what their neighbours foretell is no evidence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.proof import selection
from diagnosis.discovery.proof.conditional import unforeseen
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from tests.diagnosis.discovery.sweeps import Made, before
from twin.angles import Array
from twin.noise import spectrum

COLOURED = 5
"""A member of the family of noises: correlated by 0.92 from row to row."""


def fit_in(member: int) -> Fit:
    fit = before(held_out_selection, Made(causes=(("saturation", 0.08),), points=96)).fit
    assert fit.observations.usable.all()
    return replace(fit, weighting=replace(fit.weighting, member=member))


def drawn(fit: Fit, seed: int) -> Array:
    """Noise (n,) of the fit's member."""
    white = np.random.default_rng(seed).standard_normal(len(fit.observations))
    own = fit.weighting.family.spectra[fit.weighting.member]
    return spectrum.to_rows(np.sqrt(own) * white, fit.observations.lengths) * 1e-3


def test_in_white_noise_neighbours_foretell_nothing() -> None:
    fit = fit_in(0)
    residual = drawn(fit, 1)
    np.testing.assert_allclose(unforeseen(fit, residual), residual, rtol=1e-9)


def test_each_row_is_left_out_of_the_noise_that_foretells_it() -> None:
    """As the inverse of the covariance, written out, says; of 96 rows."""
    fit = fit_in(COLOURED)
    residual, lengths = drawn(fit, 2), fit.observations.lengths
    cosines = spectrum.to_cosine(np.eye(residual.size), lengths)
    inverse = cosines @ np.diag(fit.weighting.family.weights[COLOURED]) @ cosines.T
    np.testing.assert_allclose(unforeseen(fit, residual), inverse @ residual / np.diag(inverse), rtol=1e-8)


@pytest.mark.parametrize(("narrow", "gains"), [(False, True), (True, False)])
def test_what_follows_its_neighbours_gains_nothing(narrow: bool, gains: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cause that is no more than the mean of both neighbours leaves less of slow noise, and foretells nothing new."""
    fit = fit_in(COLOURED)
    noise = drawn(fit, 3)
    follows = 0.5 * (np.roll(noise, 1) + np.roll(noise, -1))
    monkeypatch.setattr(selection, "held_out_residuals", lambda *_, **__: [noise, noise - follows])
    _, (before_deg, after_deg) = selection._held_out(fit, ["any"], np.zeros(96, int), at_once=False, narrow=narrow)
    assert (after_deg < before_deg) == gains


def test_a_step_gains_where_the_noise_is_slow(monkeypatch: pytest.MonkeyPatch) -> None:
    """One of as much as the noise, which no slow noise makes."""
    fit = fit_in(COLOURED)
    noise = drawn(fit, 4)
    step = 3.0 * float(np.std(noise)) * (np.arange(96) >= 40)
    monkeypatch.setattr(selection, "held_out_residuals", lambda *_, **__: [noise + step, noise])
    _, (before_deg, after_deg) = selection._held_out(fit, ["any"], np.zeros(96, int), at_once=False, narrow=True)
    assert after_deg < 0.9 * before_deg
