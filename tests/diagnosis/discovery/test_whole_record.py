"""Long records: what all readings show, averaged over turns, that the part which is searched in full does not."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from diagnosis.discovery import whole_record
from diagnosis.discovery.result import Discovery
from diagnosis.discovery.state import State
from diagnosis.discovery.whole_record import Averaged, averaged, searched, stairs_left
from scenarios.commands.protocol import Protocol
from twin.angles import TAU, Array, wrap
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.sweep import Sweep

NOISE_DEG = 0.02
WEAK = {"order": 6.0, "amplitude_deg": 0.001, "phase_deg": 40.0}
KNOWN = {"zero": {"zero_deg": 20.0}, "hysteresis": {"lag_deg": 0.1, "memory_deg": 8.0}, "noise": {"rms_deg": NOISE_DEG}}
EFFECTS = tuple(e for e in CATALOGUE if e.baseline or e.name in {"magnet_harmonic", "hysteresis", "noise"})
TWIN = Chain(KNOWN, effects=EFFECTS)


def record(*, turns: int = 240, points: int = 400, seed: int = 0, weak: bool = True) -> Sweep:
    """A long record of both directions with a cause a twentieth of the noise."""
    motion = Protocol(turns=turns / 2, points=points, both_directions=True, channels=False).motion()
    return Chain({**KNOWN, "magnet_harmonic": WEAK} if weak else KNOWN).simulate(motion, seed=seed)


def shown(twin: Chain = TWIN, **other: Any) -> Discovery:
    """What a searched part is taken to have shown."""
    figures = {"sweep": SimpleNamespace(set_aside=10**6), "cut_short": None, "words": {}, "bits": None, "device": twin}
    return cast(Discovery, SimpleNamespace(**(figures | other)))


def beside(means: Averaged) -> Array:
    """What the means (n,) [rad] are beside the twin that they were held against."""
    return wrap(np.radians(means.sweep.measured_deg) - means.twin.readings(means.sweep.motion()))


def told(sweep: Sweep, **other: Any) -> Averaged:
    """The means, of which there are some."""
    found = averaged(sweep, shown(**other))
    assert found is not None
    return found


def test_means_are_as_much_less_noisy_as_readings_are_in_them() -> None:
    means = told(record(weak=False))
    assert means.readings == 240 * 400
    left = np.degrees(beside(means))
    assert np.std(left) == pytest.approx(NOISE_DEG / np.sqrt(means.each), rel=0.05)
    assert means.each == pytest.approx(20.0, rel=0.2)
    motion = means.sweep.motion()
    assert {1.0, -1.0} == set(motion.direction)
    assert np.all(np.diff(motion.time_s) > 0.0)
    # One turn after the other, forth and back.
    assert np.degrees(np.abs(np.diff(motion.shaft_rad)).max()) < 3.0


def test_blocks_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    """One begins where the direction has changed, which a hysteresis remembers."""
    monkeypatch.setattr(whole_record, "_BLOCK", 4000)
    twin = TWIN.without("noise")
    sweep = twin.simulate(Protocol(turns=20, points=400, both_directions=True, channels=False).motion())
    blocks = list(whole_record.left_beside(sweep, twin))
    assert [rows[0] for _, rows, _ in blocks] == [0, 4000, 8000, 12_000]
    assert max(np.abs(left).max() for _, _, left in blocks) < 1e-9
    shaft = np.concatenate([motion.shaft_rad for motion, _, _ in blocks])
    np.testing.assert_allclose(shaft, sweep.motion().shaft_rad, atol=1e-9)


def test_wild_readings_are_no_part_of_the_means() -> None:
    sweep = record(weak=False)
    sweep.measured_deg[1000::997] += 20.0
    left = np.degrees(beside(told(sweep)))
    assert np.abs(left).max() < 6.0 * NOISE_DEG / np.sqrt(20.0)


def test_the_means_show_what_the_noise_of_the_searched_part_hides() -> None:
    rng = np.random.default_rng(0)
    found = {}
    for weak in (True, False):
        sweep = record(turns=1200, weak=weak)
        means = told(sweep)
        whole = searched(means, State.of(sweep, TWIN, rng=rng))
        found[weak] = [cause.name for cause in whole.found.causes]
        if weak:
            values = whole.found.fit.chain.values["magnet_harmonic"]
            assert values["order"] == WEAK["order"]
            assert values["amplitude_deg"] == pytest.approx(WEAK["amplitude_deg"], abs=1.5e-4)
    assert found == {True: ["magnet_harmonic"], False: []}


@pytest.mark.parametrize(
    "why",
    [
        {"cut_short": "stepwise"},
        {"words": {"word_bit": {"bit": 3.0}}},
        {"sweep": SimpleNamespace(set_aside=11_000)},
        {"bits": 8.0},
        {"device": Chain({**KNOWN, "reference_rezero": {}})},
    ],
    ids=[
        "ended early",
        "words told back",
        "most of it was searched",
        "stairs that the noise does not blur",
        "turns of their own",
    ],
)
def test_no_means_where_they_would_say_nothing(why: dict[str, Any]) -> None:
    assert averaged(record(turns=60), shown(**why)) is None


def test_too_few_turns_are_not_averaged() -> None:
    assert averaged(record(turns=12, points=360), shown()) is None


@pytest.mark.parametrize("noise_steps", [0.2, 0.3, 0.5])
def test_stairs_that_are_left(noise_steps: float) -> None:
    step = TAU / 2.0**10
    angle = np.linspace(0.0, 3.0 * step, 31)[:-1]
    noise = noise_steps * step * np.random.default_rng(0).standard_normal((200_000, 1))
    rounded = np.mean(step * np.round((angle + noise) / step), axis=0) - angle
    amplitude = 2.0 * np.abs(np.mean(rounded * np.exp(2j * np.pi * angle / step)))
    sigma = step * np.sqrt(noise_steps**2 + 1.0 / 12.0)
    assert stairs_left(10.0, float(sigma)) == pytest.approx(amplitude, rel=0.05, abs=0.003 * step)
