"""Every threshold of the discovery, in one frozen object: what it decides, and where its value comes from.

One number is the policy: :attr:`DiscoverySettings.false_alarm_probability`, the probability that a sweep without any
cause is given one. What is compared with it follows by the rules below (the properties). The other fields are odds
between descriptions that fit about as well, limits that physics or sampling sets, and budgets of computation. A field
says which of these it is: *derived* (the derivation stands beside it), *odds* (a prior judgement, as log odds in nats),
*limit* (the smallest or largest thing that counts, with its reason) or *budget* (more costs time and changes no answer
that is not at the edge).
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from numbers import Integral, Real
from typing import Any

import numpy as np

from twin.shown import shown

FOOTPRINTS = 4
"""Places where a cause can show: the mean, the spread, the values, and the sequence of the readings."""

CAUSE_PARAMETERS = 2
"""Of a plain cause: the cosine and the sine of a line."""

UNLIKE = 0.01
"""Probability below which the measured sweep is said not to match those simulated from the extended twin."""


def over_footprints(family_log_p: float) -> float:
    """Probability that chance makes as much in any of the footprints, of its log probability in one (Bonferroni)."""
    return float(np.exp(max(min(family_log_p + np.log(FOOTPRINTS), 0.0), -300.0)))


@dataclass(frozen=True)
class Range:
    """The numbers from ``low`` to ``high`` with which the discovery still means something; ``open``: without the last.

    Its text is how a message tells it.
    """

    low: float
    high: float
    open: bool = False

    def __contains__(self, value: float) -> bool:
        return self.low <= value < self.high if self.open else self.low <= value <= self.high

    def __str__(self) -> str:
        return f"from {self.low:g} to {'below ' if self.open else ''}{self.high:g}"


def _within(default: float, low: float, high: float, *, open_end: bool = False) -> Any:
    """A setting with its default and its range."""
    return field(default=default, metadata={"range": Range(low, high, open_end)})


def _log_p(default: float) -> Any:
    return _within(default, -1e4, -1e-9)


def _nats(default: float) -> Any:
    return _within(default, 0.0, 1e4)


def _sigma(default: float) -> Any:
    return _within(default, 0.1, 1e3)


def _share(default: float) -> Any:
    return _within(default, 0.0, 1.0)


def _ratio(default: float) -> Any:
    return _within(default, 1.0, 1e3)


def _count(default: int, fewest: int = 1) -> Any:
    return _within(default, fewest, 10_000)


@dataclass(frozen=True, kw_only=True)
class DiscoverySettings:
    """The settings of one discovery; the defaults are the project's own.

    Probabilities are family-wise: over all effects, shapes and places that a stage looks at.
    """

    # ---- significance -----------------------------------------------------------------------------------------------

    false_alarm_probability: float = _within(0.01, 1e-300, 1.0, open_end=True)
    """Policy. Probability that a sweep without a cause is given one: what the public answer promises."""
    beyond_doubt_log_p: float = _log_p(-25.0)
    """Limit. Log probability below which a finding needs no second opinion: structure that is not known yet can make
    plain noise seem uneven at e^-10, but a finding at e^-25 (seven sigma) survives any structure found later."""
    no_simulation_log_p: float = _log_p(-40.0)
    """Budget. Below this log probability an F test is not calibrated by simulation: the tail of 96 simulated scores
    cannot be extrapolated to where it would matter."""

    # ---- odds between descriptions ----------------------------------------------------------------------------------

    unnamed_log_odds: float = _nats(6.0)
    """Odds. A shape without a name must gain so many nats more than a cause with one (400 to 1): the eleven empirical
    shapes with their orders, places and frequencies together describe anything nearly."""
    swap_log_odds: float = _nats(2.0)
    """Odds. What one cause in another's place must gain: two descriptions that are equally good differ by a nat or so
    by chance (each of a few free shapes adds half a nat of scatter), and a swap for nothing may go round."""
    colour_log_odds: float = _nats(3.0)
    """Odds. White noise against each coloured one before a reading is seen (20 to 1)."""
    stairs_log_odds: float = _nats(20.0)
    """Odds. Beside coarse stairs, whose own pattern aliases to lines at any order: what an effect that could be such a
    line must gain more, and how improbable by chance any cause must be there."""
    aliased_shapes: int = _count(20)
    """Limit. An effect that is tried in more shapes than this has places enough that stairs' own pattern meets one."""
    sigma_apart: float = _sigma(3.0)
    """Derived. Two causes are told apart by three sigma: by twice the log likelihood of 9 in the sweep itself, and by
    the same separation expected of a further measurement."""
    sigma_enough: float = _sigma(5.0)
    """Derived. A further measurement is advised without reserve at five sigma: twice the log likelihood then
    scatters about 25 by 10, and falls below the 9 of three sigma in 5.5 % of the cases."""
    stairs_sigma_factor: float = _ratio(2.0)
    """Limit. Beside coarse stairs so many times more sigma: what the fit leaves of the stairs themselves favours now
    one smooth shape, now another."""

    # ---- what the search tries --------------------------------------------------------------------------------------

    most_causes: int = _count(8)
    """Budget. More causes than the search may add: public sweeps hold up to seven."""
    most_together: int = _count(3)
    """Budget. So many causes at once are looked for where none stands out of coloured noise alone."""
    most_in_place: int = _count(2)
    """Budget. So many named causes are tried in the place of one shape without a name."""
    most_rounds: int = _count(3)
    """Budget. Rounds of a loop that ends earlier where nothing changes any more."""
    most_contenders: int = _count(5)
    """Budget. Candidates that are fitted exactly before one is added."""
    most_rivals: int = _count(3)
    """Budget. Candidates that are fitted exactly in the place of a cause."""
    contender_nats: float = _nats(8.0)
    """Limit. By how much a first-order score may undervalue a candidate: those within it of the best are fitted."""
    contender_share: float = _share(0.15)
    """Limit. The same for strong causes, as a share of the best score: first order errs in proportion to the gain."""
    fair_share: float = _share(0.15)
    """Limit. Share of a cause's gain that another must reach by itself to be tried in its place, or to be one of
    several that take the place of a shape: any shape can be had from a near one and another's small help."""
    rival_share: float = _share(0.3)
    """Limit. Share of a cause's gain to first order below which an effect is not fitted as its rival: an exact fit
    gains up to three times what first order says."""
    seen_share: float = _within(0.9, 0.01, 0.999)
    """Limit. Share of what the error model leaves that a cause makes up if it is three times the noise: so few readings
    that not even such a one would be seen are not searched. None and all of what is left have no F test."""
    whole_order_turns: float = _within(1.8, 0.0, 1e3)
    """Derived. Below two turns an order is not told from the next half one (Rayleigh), so whole orders alone are tried;
    a record of two turns that ends before the last angle counts as two."""
    radius_left: float = _ratio(1.5)
    """Limit. Variance of the radius against that of its noise above which something in it is unexplained: with
    thirty degrees of freedom a ratio of 1.5 is exceeded by chance in 4 % (chi-square), with ten in 13 %."""
    smallest_rms_deg: float = _within(6e-5, 0.0, 180.0)
    """Limit. Residual RMS below which nothing is searched for: less than a step of a 22-bit word (8.6e-5 deg)."""

    # ---- single rows ------------------------------------------------------------------------------------------------

    spike_sigma: float = _sigma(7.0)
    """Limit. A row stands alone beyond so many robust sigma of its neighbours: never by Gaussian noise in a million
    rows (3e-6), and by one or two in a thousand of noise with four degrees of freedom."""
    spike_sigma_few: float = _sigma(14.0)
    """Limit. The same of fewer rows than ``spike_few``: of a dozen the robust sigma is known to a third only."""
    spike_few: int = _count(60)
    """Limit. So few rows do not tell their robust sigma well enough."""
    longest_spike: int = _count(4)
    """Limit. Neighbours off together that still are single readings: five or more are structure."""
    fallen_out: float = _within(0.2, 1e-6, 10.0)
    """Limit. Change of the log of the channels' amplitude that no cause of the catalogue makes: 20 %."""

    # ---- stairs and the spread --------------------------------------------------------------------------------------

    fewest_words: int = _count(40)
    """Limit. A sweep with fewer different words says nothing of its grid: few angles lie on one by choice."""
    stairs_in_noise: float = _share(0.1)
    """Derived. Stairs are modelled where step/sqrt(12) exceeds this share of the noise: below, they add less than half
    a percent to its RMS."""
    stairs_cause_share: float = _share(0.5)
    """Public rule of the catalogue: the output's grid is a cause where step/sqrt(12) exceeds half of what is left."""
    set_share: float = _share(0.9)
    """Limit. A finite set of angles that leaves out less than a tenth of the words cannot be told from all of them."""
    set_missed: float = _within(0.04, 1e-6, 1.0)
    """Limit. Share of the readings that may lie outside a finite set: other links' errors, of a few percent at most.
    Each that does speaks against the set by as much."""
    burst_ratio: float = _ratio(2.25)
    """Limit. A stretch is louder where its noise is at least half as large again (1.5 squared)."""

    # ---- noise ------------------------------------------------------------------------------------------------------

    noise_reach: float = _nats(4.0)
    """Limit. Members of the noise family within so many nats of the best are plausible (e^-4: 2 %)."""
    noise_turns: float = _within(3.5, 0.0, 1e3)
    """Limit. Turns below which what repeats with the angle cannot be told from noise."""

    # ---- proof ------------------------------------------------------------------------------------------------------

    folds: int = _within(4, 2, 100)
    """Derived. Parts of the held-out proof: each fit sees three quarters of the readings, so its parameters' variance
    is a third larger than the final fit's. One part holds nothing out."""
    blocks_a_turn: int = _count(3)
    """Limit. Held-out blocks a turn: shorter than a turn, so that each turn's own zero can be fitted from the rest."""
    heldout_slack: float = _ratio(1.004)
    """Limit. Growth of the held-out RMS that is forgiven a cause that stands beyond doubt: the RMS counts correlated
    noise in full, which such a cause leaves as it is."""
    shared_ratio: float = _ratio(1.1)
    """Limit. RMS of a recording with the parameters common to all, against that with its own, above which it does not
    share them."""
    heldout_seen: float = _within(0.2, 0.0, 0.5)
    """Derived. Share of what a cause does that the rows of each held-out fit must hold, as squares; by design it is
    three quarters. One that is only just found, among all effects and ten shapes of each, stands 4.5 sigma out of the
    noise: a fifth of its squares leaves it 2, so that each fit still tells it from none at 95 %, and predicts."""
    predictive_sweeps: int = _count(199, fewest=round(1.0 / UNLIKE))
    """Derived. Sweeps simulated for the predictive check: of N the smallest p is 1/(N + 1), here 1/200. With fewer than
    a hundred it never falls below ``UNLIKE``, and no sweep could be called unlike."""
    fewest_checked: int = _count(30)
    """Limit. Readings beyond the fitted parameters below which simulated sweeps are not held against the measured one:
    thirty tell a variance to a quarter (the root of 2/30), and fewer hardly anything."""
    fewest_simulated: int = _count(32, fewest=16)
    """Budget. Fewest sweeps that the family-wise probability is calibrated on; the tail is fitted to half of them."""
    most_simulated: int = _count(96, fewest=16)
    """Budget. Most of them."""

    def __post_init__(self) -> None:
        for one in fields(self):
            _require(one.name, getattr(self, one.name), one.metadata["range"], whole=one.type == "int")
        if self.fewest_simulated > self.most_simulated:
            raise ValueError(
                f"fewest_simulated is {self.fewest_simulated} and most_simulated {self.most_simulated}; "
                "expected at most as many"
            )

    def __repr__(self) -> str:
        """Show what differs from the defaults."""
        values = {one.name: getattr(self, one.name) for one in fields(self) if getattr(self, one.name) != one.default}
        return f"DiscoverySettings({', '.join(f'{name}={value!r}' for name, value in values.items())})"

    # ---- rules ------------------------------------------------------------------------------------------------------

    @property
    def footprint_log_p(self) -> float:
        """Log probability by chance below which a footprint counts: the policy's, shared by the four (Bonferroni)."""
        return float(np.log(self.false_alarm_probability / FOOTPRINTS))

    def effect_log_p(self, effects: int) -> float:
        """Log probability of one effect, below which it counts among so many (Bonferroni within the footprint)."""
        return self.footprint_log_p - float(np.log(max(effects, 1)))

    def fewest_rows(self, fitted: int, effects: int) -> int:
        """Fewest independent rows that can carry a verdict, beside so many fitted parameters.

        A cause of two parameters that makes up the share s of what is left has by chance, over f degrees of freedom,
        the probability (1 - s)^(f/2) (F test): f is such that a cause three times the noise is seen.
        """
        freedom = 2.0 * self.effect_log_p(effects) / np.log(1.0 - self.seen_share)
        return fitted + CAUSE_PARAMETERS + int(np.ceil(freedom))

    def same_fit(self, *, coarse: bool) -> float:
        """Difference of twice the log likelihood below which two causes cannot be told apart; ``coarse``: stairs."""
        return (self.sigma_apart * (self.stairs_sigma_factor if coarse else 1.0)) ** 2


def _require(name: str, value: Any, within: Range, *, whole: bool) -> None:
    """Refuse what is no number of the kind, or lies outside the range. Raises ValueError."""
    number = isinstance(value, Integral if whole else Real) and not isinstance(value, bool)
    if not number or value not in within:
        raise ValueError(f"{name} is {shown(value)}; expected {'a whole number' if whole else 'a number'} {within}")
