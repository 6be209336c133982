"""Answer: one entry a cause, strongest first, with the RMS of single readings before and after it."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.fitting.observations import of_readings
from diagnosis.discovery.proof.cross_validation import rms_deg
from diagnosis.discovery.result import Discovery
from diagnosis.discovery.stages.answer import answer
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before

SATURATION, GRID, STALE, BURST = "saturation", "output_quantisation", "stale_frames", "unnamed_burst"
MADE = Made(causes=((SATURATION, 0.08), (STALE, 0.05)), points=90, turns=2)
ROUNDED = Made(causes=((SATURATION, 0.08), (GRID, 0.08)), points=120, turns=2)
NOISE_DEG = 0.02


def figures(state: State) -> dict[str, tuple[float, float]]:
    """Before and after of each cause of the answer."""
    return {cause.name: (cause.before_deg, cause.after_deg) for cause in answer(state).causes}


def test_a_cause_of_the_mean_has_its_held_out_figures() -> None:
    state = before(answer, MADE)
    (finding,) = [one for one in state.findings if one.keys == (SATURATION,)]
    assert figures(state)[SATURATION] == (finding.before_deg, finding.after_deg)


def test_what_touches_single_readings_changes_nothing_on_the_others() -> None:
    """The figures are of the rows in use: a repeated frame is none of these, however far off."""
    state = before(answer, MADE)
    before_deg, after_deg = figures(state)[STALE]
    assert before_deg == after_deg
    # 174 readings tell their RMS to 1/sqrt(2n): five of these; ten parameters from three quarters of them, 4 %.
    assert min(before_deg, figures(state)[SATURATION][1]) == pytest.approx(NOISE_DEG, rel=5.0 / np.sqrt(348.0) + 0.04)


def test_of_stairs_what_knowing_them_gains() -> None:
    """Rounding by 0.176 deg behind noise of 0.02 deg leaves step/sqrt(12) unless the stairs are known."""
    state = before(answer, ROUNDED)
    before_deg, after_deg = figures(state)[GRID]
    step_deg = np.degrees(state.step)
    # In quadrature with what is not known yet: the saturation below it in the list.
    below = figures(state)[SATURATION]
    unknown_deg = np.sqrt(max(below[0] ** 2 - below[1] ** 2, 0.0)) if below[0] == after_deg else 0.0
    assert np.sqrt(before_deg**2 - unknown_deg**2) == pytest.approx(step_deg / np.sqrt(12.0), rel=0.2)
    assert after_deg < 0.9 * before_deg


def test_what_makes_readings_scatter_gains_nothing_in_their_mean() -> None:
    state = before(answer, MADE)
    state = state.with_(findings=(*state.findings, Finding.among(1, BURST, -20.0, gain=40.0)))
    before_deg, after_deg = figures(state)["unnamed"]
    assert before_deg == after_deg


CHAINS = {
    "single readings": MADE,
    "stairs": ROUNDED,
    "a second line of one effect": Made(causes=(("drive_ripple", 0.2), (SATURATION, 0.2)), points=180, turns=2),
}


@pytest.mark.parametrize("name", CHAINS)
def test_figures_chain_from_the_baseline_to_the_extended_twin(name: str) -> None:
    """Also where a second line of one effect, the weakest of all, is one entry with the first, the strongest."""
    state = before(answer, CHAINS[name])
    if name == "a second line of one effect":
        assert state.keys == ("drive_ripple", SATURATION, "drive_ripple#2")
    done = answer(state)
    assert len(done.causes) == 2
    observations = done.fit.observations
    rms = [of_readings(rms_deg(held, observations.usable), observations) for held in done.held]
    assert [(cause.before_deg, cause.after_deg) for cause in done.causes] == list(itertools.pairwise(rms))
    found = Discovery.of(done)
    assert (found.baseline_held_deg, found.extended_held_deg) == (rms[0], rms[-1])
    # All is known at the end: what is left is what the fit of all rows leaves, its dozen parameters aside.
    left_deg = np.degrees(np.sqrt(np.mean(done.fit.residual[0][observations.usable] ** 2)))
    assert rms[-1] == pytest.approx(left_deg, rel=0.15)


def test_figures_are_those_of_single_readings() -> None:
    """Of rows that average several, what averaging has taken away is put back."""
    state = before(answer, MADE)
    fit, within_deg = state.fit, 0.3
    observations = replace(fit.observations, within=float(np.radians(within_deg)) ** 2)
    averaged = state.with_(evaluate(fit.chain, fit.free, observations, fit.weighting))
    plain = figures(state)
    for name, (before_deg, after_deg) in figures(averaged).items():
        assert before_deg == pytest.approx(np.hypot(plain[name][0], within_deg))
        assert after_deg == pytest.approx(np.hypot(plain[name][1], within_deg))


def test_instances_of_one_effect_are_one_entry_and_so_is_all_without_a_name() -> None:
    """As improbable as the more improbable, as strong as both together; rivals are those of both."""
    state = before(answer, MADE)
    fit = state.fit

    def finding(key: str, gain: float, **more: object) -> Finding:
        return replace(Finding((key,), -0.5 * gain, gain, -gain, before_deg=0.3, after_deg=0.2), **more)

    state = state.with_(
        findings=(
            finding("drive_ripple", 30.0, rivals={"cardan_coupling": fit, "magnet_harmonic": fit}),
            finding("unnamed_order", 50.0),
            finding("drive_ripple#2", 40.0, rivals={"magnet_harmonic": fit}, after_deg=0.1, before_deg=0.2),
            finding("unnamed_bump#2", 5.0),
        )
    )
    ripple, nameless = answer(state).causes
    assert (ripple.keys, nameless.keys) == (("drive_ripple", "drive_ripple#2"), ("unnamed_order", "unnamed_bump#2"))
    assert (ripple.gain, nameless.gain) == (70.0, 55.0)
    assert (ripple.log_p, nameless.log_p) == (-20.0, -25.0)
    assert (ripple.family_log_p, nameless.family_log_p) == (-40.0, -50.0)
    assert set(ripple.rivals) == {"magnet_harmonic"}


def test_instances_with_rivals_of_their_own_are_entries_of_their_own() -> None:
    """What one of them cannot be told from says nothing of the other; with the same rivals they are one."""
    state = before(answer, MADE)
    fit = state.fit

    def finding(key: str, gain: float, *rivals: str) -> Finding:
        return Finding((key,), -0.5 * gain, gain, -gain, dict.fromkeys(rivals, fit), before_deg=0.3, after_deg=0.2)

    state = state.with_(
        findings=(
            finding("magnet_harmonic", 50.0, "saturation"),
            finding("magnet_harmonic#2", 40.0),
            finding("magnet_harmonic#3", 30.0, "saturation"),
        )
    )
    assert [(cause.keys, set(cause.rivals)) for cause in answer(state).causes] == [
        (("magnet_harmonic", "magnet_harmonic#3"), {"saturation"}),
        (("magnet_harmonic#2",), set()),
    ]


def test_without_findings_there_is_no_entry() -> None:
    assert answer(before(answer, Made(points=72))).causes == ()
