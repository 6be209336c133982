"""Changes: which parameters of a twin have moved, from their differences and what the fit knows of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.proof.changes import Differences, _parallel
from diagnosis.discovery.settings import DiscoverySettings

FREE = (
    *(Free("offset", "x_percent"), Free("offset", "y_percent")),
    *(Free("gain_mismatch", "ratio"), Free("phase", "beta_deg")),
)
SETTINGS = DiscoverySettings()


def differences(away: Sequence[float], correlation: float = 0.0, alike: Sequence[int] = (0, 1)) -> Differences:
    """Differences in units of their own deviation, two of them correlated."""
    information = np.eye(len(FREE))
    first, second = alike
    information[first, second] = information[second, first] = correlation
    threshold = SETTINGS.effect_log_p(len(FREE))
    return Differences(FREE, np.array(away, dtype=float), information, 1000, threshold, SETTINGS.same_fit(coarse=False))


def test_a_parameter_must_gain_what_chance_never_does() -> None:
    """The price is where the log probability by chance is that of one effect among so many."""
    told = differences([0.0] * 4)
    assert told.log_p(told.price) == pytest.approx(told.threshold, abs=1e-3)


def test_nothing_has_moved_by_chance() -> None:
    """Each of four by two and a half deviations, which chance does to one of eighty."""
    assert differences([2.5, -2.5, 2.5, -2.5]).moved() == ()


def test_one_has_moved_and_takes_what_leans_on_it_along() -> None:
    """Two that read nearly alike share in the estimate what one of them did: the other stays."""
    told = differences([9.0, 0.5, 0.3, -0.4], correlation=0.8)
    assert told.moved() == (0,)


def test_two_that_hide_one_another_are_found_together() -> None:
    """Opposite differences of two that read nearly alike: either alone gains hardly anything."""
    told = differences([14.0, -14.0, 0.0, 0.0], correlation=0.9)
    alone = min(told.left((0,)), told.left((1,)))
    assert told.left(()) - alone < told.price
    assert told.moved() == (0, 1)


def test_all_four_have_moved() -> None:
    """More than the sets that are all tried: built up one by one from there."""
    assert sorted(differences([20.0, -15.0, 30.0, 9.0]).moved()) == [0, 1, 2, 3]


@pytest.mark.parametrize(("correlation", "alike"), [(0.999, True), (0.5, False)])
def test_what_would_do_as_well_is_told(correlation: float, alike: bool) -> None:
    """Of two whose columns are parallel but for a share, either explains what the sweep shows within three sigma."""
    told = differences([8.0, 0.0, 0.0, 0.0], correlation=correlation)
    assert told.moved() == (0,)
    instead = told.left((1,)) < told.left((0,)) + told.same
    assert instead == alike


def test_a_direction_that_the_sweep_does_not_tell_is_no_change() -> None:
    """Without information a parameter may stand anywhere."""
    told = differences([0.0, 1e6, 0.0, 0.0])
    information = told.information.copy()
    information[1] = information[:, 1] = 0.0
    free = Differences(FREE, told.difference, information, told.dof, told.threshold, told.same)
    assert free.moved() == ()


def test_a_difference_is_known_as_well_as_both_of_its_sides_allow() -> None:
    """Of two estimates as good as each other half the information is left; of what one does not tell, none."""
    first = np.array([[4.0, 1.0], [1.0, 9.0]])
    assert _parallel(first, first) == pytest.approx(0.5 * first)
    second = np.array([[2.0, -1.0], [-1.0, 8.0]])
    assert np.linalg.inv(_parallel(first, second)) == pytest.approx(np.linalg.inv(first) + np.linalg.inv(second))
    one_way = np.array([[1.0, 1.0], [1.0, 1.0]])
    blind = np.array([1.0, -1.0])
    assert blind @ _parallel(first, one_way) @ blind == pytest.approx(0.0, abs=1e-9)
