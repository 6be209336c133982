"""The settings: what may not be set, the one policy with the rules that follow from it, and where values come from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import FrozenInstanceError, fields
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2, norm, t

from diagnosis.discovery.settings import FOOTPRINTS, DiscoverySettings
from twin.catalogue import CATALOGUE

PLAIN = DiscoverySettings()
WHOLE = [one.name for one in fields(PLAIN) if isinstance(one.default, int)]


NAMES = [one.name for one in fields(PLAIN)]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 10**400, "4", None, True, [4]], ids=repr)
def test_what_is_no_number_is_refused_by_name(name: str, value: Any) -> None:
    with pytest.raises(
        ValueError, match=f"^{name} is .*; expected a (whole )?number from [0-9e.+-]+ to (below )?[0-9e.+-]+$"
    ):
        DiscoverySettings(**{name: value})


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        *(("false_alarm_probability", value, "a number from 1e-300 to below 1$") for value in (0.0, 1.0, -0.1, 2.0)),
        *((name, value, "a whole number from") for name in WHOLE for value in (0, -1, 2.5, 4.0)),
        *((name, -0.1, "a number from") for name in NAMES if name not in WHOLE and not name.endswith("_log_p")),
        *((name, 0.0, "a number from -10000 to -1e-09") for name in NAMES if name.endswith("_log_p")),
        # One fold holds nothing out.
        ("folds", 1, "a whole number from 2 to 100"),
        ("folds", 10**6, "a whole number from 2 to 100"),
        # Of 99 sweeps the smallest p is 0.01, which is not below 0.01: none could be called unlike.
        ("predictive_sweeps", 99, "a whole number from 100 to 10000"),
        # What may grow by chance does not shrink.
        ("heldout_slack", 0.99, "a number from 1 to 1000"),
        # More than all.
        ("set_share", 1.01, "a number from 0 to 1"),
    ],
)
def test_what_cannot_be_is_refused_by_name(name: str, value: Any, expected: str) -> None:
    with pytest.raises(ValueError, match=f"^{name} is {value}; expected {expected}"):
        DiscoverySettings(**{name: value})


@pytest.mark.parametrize("name", NAMES)
def test_the_range_that_a_message_tells_is_the_one_that_is_allowed(name: str) -> None:
    with pytest.raises(ValueError, match=f"^{name} is nan") as refused:
        DiscoverySettings(**{name: np.nan})
    low, high = str(refused.value).rpartition(" from ")[2].split(" to ")
    kind = int if name in WHOLE else float
    least, most = kind(float(low)), kind(float(high.removeprefix("below ")))
    others = {"fewest_simulated": 16, "most_simulated": 10_000}
    assert getattr(DiscoverySettings(**{**others, name: least}), name) == least
    if high.startswith("below "):
        most = np.nextafter(most, -np.inf)
    assert getattr(DiscoverySettings(**{**others, name: most}), name) == most


@pytest.mark.parametrize("policy", [1e-300, np.nextafter(1.0, 0.0)])
def test_the_ends_of_the_policy_have_a_logarithm(policy: float) -> None:
    assert np.isfinite(DiscoverySettings(false_alarm_probability=policy).effect_log_p(1000))


def test_the_fewest_are_at_most_as_many_as_the_most() -> None:
    with pytest.raises(ValueError, match="fewest_simulated is 97 and most_simulated 96"):
        DiscoverySettings(fewest_simulated=97)


@pytest.mark.parametrize("kind", [np.int64, np.int32, int])
def test_whole_numbers_may_be_those_of_numpy(kind: type) -> None:
    assert DiscoverySettings(folds=kind(5)).folds == 5
    assert DiscoverySettings(spike_sigma=kind(8)).spike_sigma == 8


def test_settings_are_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        PLAIN.folds = 5  # type: ignore[misc]


@pytest.mark.parametrize("policy", [0.001, 0.01, 0.2])
def test_every_limit_follows_from_the_policy(policy: float) -> None:
    """Bonferroni: over the four places where a cause can show, and over the effects that are looked for there."""
    settings = DiscoverySettings(false_alarm_probability=policy)
    assert FOOTPRINTS == 4
    assert FOOTPRINTS * np.exp(settings.footprint_log_p) == pytest.approx(policy)
    for effects in (1, 7, 30):
        assert FOOTPRINTS * effects * np.exp(settings.effect_log_p(effects)) == pytest.approx(policy)
    assert settings.effect_log_p(0) == settings.effect_log_p(1)


def test_two_causes_are_the_same_within_the_squares_of_the_sigma() -> None:
    """Twice the log likelihood ratio of two points is the square of their distance in sigma."""
    assert PLAIN.same_fit(coarse=False) == pytest.approx(PLAIN.sigma_apart**2)
    assert PLAIN.same_fit(coarse=True) == pytest.approx((PLAIN.stairs_sigma_factor * PLAIN.sigma_apart) ** 2)
    assert DiscoverySettings(sigma_apart=4.0).same_fit(coarse=False) == pytest.approx(16.0)


def just_found_sigma(settings: DiscoverySettings) -> float:
    """Of a strength that is found among all effects of the catalogue in the mean, with ten shapes of each."""
    effects = sum(effect.footprint == "mean" and not effect.baseline for effect in CATALOGUE)
    return float(norm.isf(0.5 * np.exp(settings.effect_log_p(effects) - np.log(10.0))))


DERIVED: dict[str, tuple[Callable[[DiscoverySettings], float], float, float]] = {
    # Two-sided, in a million rows; and in a thousand rows of Student's t of four degrees, whose robust sigma is larger.
    "spike_sigma": (lambda s: 2e6 * norm.sf(s.spike_sigma), 0.5e-6, 5e-6),
    "spike_sigma in heavy tails": (
        lambda s: 2e3 * t(4).sf(s.spike_sigma * 1.4826 * t(4).ppf(0.75)),
        1.0,
        2.5,
    ),
    # The share of sweeps of thirty degrees of freedom in which chance exceeds it.
    "radius_left": (lambda s: chi2.sf(30 * s.radius_left, 30), 0.03, 0.05),
    # Twice the log likelihood scatters about the square of what is expected, by twice that.
    "sigma_enough": (lambda s: norm.cdf((s.sigma_apart**2 - s.sigma_enough**2) / (2.0 * s.sigma_enough)), 0.05, 0.06),
    "sigma_apart": (lambda s: 2.0 * norm.sf(s.sigma_apart), 0.002, 0.003),
    # What stairs at the limit add to the RMS of the noise.
    "fewest_checked": (lambda s: np.sqrt(2.0 / s.fewest_checked), 0.24, 0.27),
    "stairs_in_noise": (lambda s: np.hypot(1.0, s.stairs_in_noise) - 1.0, 0.004, 0.005),
    # A stretch is loud from an RMS half as large again on.
    # A cause that makes up this share of what is left is so many times the noise.
    "seen_share": (lambda s: np.sqrt(s.seen_share / (1.0 - s.seen_share)), 3.0, 3.0001),
    "burst_ratio": (lambda s: np.sqrt(s.burst_ratio), 1.5, 1.5),
    # The variance of a parameter in a fit of the other folds, against that in the final fit.
    "folds": (lambda s: s.folds / (s.folds - 1.0), 1.33, 1.34),
    # Each turn's zero is fitted from the rest of the turn, and every part of the turn is held out in some turn.
    "blocks_a_turn": (lambda s: np.gcd(s.blocks_a_turn, s.folds) * (s.blocks_a_turn > 1), 1, 1),
    # How far a cause that is only just found stands out of none on the rows that a held-out fit has seen.
    "heldout_seen": (lambda s: np.sqrt(s.heldout_seen) * just_found_sigma(s), 1.96, 2.1),
    "predictive_sweeps": (lambda s: 1.0 / (s.predictive_sweeps + 1), 0.005, 0.005),
    "unnamed_log_odds": (lambda s: np.exp(s.unnamed_log_odds), 390.0, 410.0),
    "colour_log_odds": (lambda s: np.exp(s.colour_log_odds), 19.0, 21.0),
    "noise_reach": (lambda s: np.exp(-s.noise_reach), 0.015, 0.02),
    "beyond_doubt_log_p": (lambda s: norm.isf(0.5 * np.exp(s.beyond_doubt_log_p)), 6.5, 7.5),
    "fallen_out": (lambda s: s.fallen_out, 0.2, 0.2),
    "most_causes": (lambda s: s.most_causes - 7, 1, 1),
}
"""What a value stands for, worked out apart, and between which numbers the words beside it place that."""


@pytest.mark.parametrize("name", DERIVED)
def test_a_value_is_what_the_words_beside_it_say(name: str) -> None:
    worked_out, low, high = DERIVED[name]
    assert low <= worked_out(PLAIN) <= high
