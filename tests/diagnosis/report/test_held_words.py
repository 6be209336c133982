"""How the gain of a cause on held-out readings is told."""

from __future__ import annotations

from diagnosis.report.statements import held_words


def test_a_small_gain_is_shown_with_the_digits_that_tell_it() -> None:
    figures = {"heldout_rms_deg_before": 0.25521, "heldout_rms_deg_after": 0.25489}
    assert held_words(figures) == "0.2552 -> 0.2549"
    assert held_words({**figures, "heldout_rms_deg_after": 0.121}) == "0.255 -> 0.121"
    # What touches single readings alone gains nothing here.
    assert held_words({**figures, "heldout_rms_deg_after": 0.25521}) == "0.255 -> 0.255"
