"""Checks that two set-ups answer alike: both are named, or nothing is said."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.setup.checks import checked
from diagnosis.setup.field import too_strong
from diagnosis.setup.finding import Finding
from diagnosis.setup.link import lost_frames
from diagnosis.setup.ratio_search import closest_ratio
from diagnosis.setup.record import Record
from twin.angles import Array, IntArray

TURN_DEG = np.arange(400) * 1.8
"""Two turns at 200 points each."""
READING_DEG = (
    TURN_DEG + 0.8 * np.sin(np.radians(TURN_DEG)) + 0.03 * np.random.default_rng(3).standard_normal(400)
) % 360.0


def record(**columns: Array) -> Record:
    return Record("record", columns, np.arange(1, next(iter(columns.values())).size + 1))


def found(**columns: Array) -> tuple[Finding, ...]:
    return checked(record(**columns)).findings


COUNTERS = {
    "end-to-end protection": (1, 15, 0),
    "nibble": (1, 16, 0),
    "toggle": (1, 2, 0),
    "from 1": (1, 100, 1),
    "decimal": (1, 100, 0),
    "in tens": (10, 1000, 0),
    "step that does not divide": (3, 256, 0),
    "down": (-1, 256, 0),
    "one wrap": (1, 300, 0),
    "no wrap": (1, 65536, 700),
}


@pytest.mark.parametrize(("step", "modulus", "first"), COUNTERS.values(), ids=COUNTERS)
def test_a_counter_ends_where_its_wraps_say(step: int, modulus: int, first: int) -> None:
    counter = np.mod(step * np.arange(400.0), modulus) + first
    assert lost_frames(record(frame=counter)) is None


@pytest.mark.parametrize(("modulus", "lost"), [(15, [40, 41, 200]), (100, [99, 250]), (256, [57, 255, 256, 257, 310])])
def test_frames_lost_are_counted_by_the_counters_own_end(modulus: int, lost: list[int]) -> None:
    """At the end of it too: of the byte's single wrap the value 2 behind 254 tells, as no counter begins with it."""
    rows: IntArray = np.setdiff1d(np.arange(30 if modulus == 256 else 0, 400), lost)
    finding = lost_frames(record(frame=np.mod(rows, float(modulus))))
    assert finding is not None
    assert f"leaves out {len(lost)} and repeats 0" in finding.evidence


def test_a_time_in_thousands_may_be_in_two_units() -> None:
    """2000 from stop to stop are 2 s in ms, or 2 ms in us: a factor of 1000 must not be guessed."""
    (finding,) = found(reference_deg=TURN_DEG, measured_deg=READING_DEG, time_s=2000.0 * np.arange(400))
    assert (finding.kind, finding.what, finding.columns) == ("time_unit", "the time is in ms or us, not in s", "")
    assert 'time_s=time_s*0.001"' in finding.remedy
    assert 'time_s=time_s*1e-06"' in finding.remedy


def test_a_time_that_one_unit_alone_can_mean_has_its_statement() -> None:
    """3e9 from row to row are 50 min in us, and 3 s in ns."""
    (finding,) = found(reference_deg=TURN_DEG, measured_deg=READING_DEG, time_s=3e9 * np.arange(400))
    assert finding.what == "the time is in ns, not in s"
    assert "time_s=time_s*1e-09" in finding.columns


@pytest.mark.parametrize(("times", "kinds"), [(1.0, []), (5.0, []), (0.15, ["time_unit"])])
def test_a_speed_that_the_shaft_outruns_is_wrong(times: float, kinds: list[str]) -> None:
    """A recorded speed of so many times that by the stamps; a higher one is that between stops."""
    turning = 6.0 * 50.0
    columns = {"reference_deg": TURN_DEG, "measured_deg": READING_DEG, "time_s": TURN_DEG / turning}
    rpm = np.full(TURN_DEG.size, 50.0 * times)
    assert [one.kind for one in found(**columns, speed_rpm=rpm)] == kinds


@pytest.mark.parametrize("pairs", [72, 700])
def test_a_fine_ring_is_no_missing_magnet(pairs: int) -> None:
    """2,000 points a turn show 1,000 pole pairs; the search thins the rows, which must not make others of them."""
    shaft = np.linspace(0.0, 360.0, 2000, endpoint=False)
    noise = 0.5 * np.random.default_rng(5).standard_normal(2000)
    (finding,) = found(reference_deg=shaft, measured_deg=(pairs * shaft + noise) % 360.0)
    assert finding.kind == "pole_pairs"
    assert f"turns {pairs} times" in finding.what


def test_a_reading_that_scatters_about_a_ratio_is_not_called_noise() -> None:
    """Scatter of 75 deg is too much to follow by, but 2,000 readings of pure noise would not go with one ratio so."""
    shaft = np.linspace(0.0, 360.0, 2000, endpoint=False)
    scatter = np.random.default_rng(6).standard_normal(2000)
    assert found(reference_deg=shaft, measured_deg=(72.0 * shaft + 75.0 * scatter) % 360.0) == ()
    (finding,) = found(reference_deg=shaft, measured_deg=(360.0 * scatter) % 360.0)
    assert finding.kind == "no_magnet"
    assert "no ratio of speeds up to 1000" in finding.evidence


@pytest.mark.parametrize(
    ("times", "said"),
    [(26.37, "26.37 times a turn, 65.9 Hz, as what wires pick up does"), (27.0, "or as a ring of poles")],
)
def test_what_swings_at_no_order_of_the_turn_is_no_magnet_on_the_shaft(times: float, said: str) -> None:
    """A line of the mains goes with some ratio, but in both senses alike; at a whole one it may be a ring's."""
    turn = np.linspace(0.0, 4.0, 800, endpoint=False)
    rng = np.random.default_rng(9)
    swing = 30.0 * np.sin(2.0 * np.pi * times * turn) + 10.0 * rng.standard_normal(turn.size)
    (finding,) = found(reference_deg=360.0 * turn, measured_deg=(90.0 + swing) % 360.0, time_s=0.4 * turn)
    assert finding.kind == "no_magnet"
    assert said in finding.evidence


def test_chance_alone_makes_no_ratio() -> None:
    """Of 200 records of noise at most 2 have p < 0.01 where 2 are expected and the bound is a sum of five times as
    many ratios as there are independent ones; more than 6 have a chance of 1 in 200."""
    rng = np.random.default_rng(7)
    p = [closest_ratio(TURN_DEG, rng.uniform(0.0, 360.0, 400)).chance for _ in range(200)]
    assert sum(one < 0.01 for one in p) <= 6


def test_pole_pairs_that_even_points_show_alike_are_both_named() -> None:
    """Of 72 points a turn 50 pole pairs look like 22 that count the other way."""
    shaft = 5.0 * np.arange(72)
    noise = 0.5 * np.random.default_rng(8).standard_normal(72)
    finding = found(reference_deg=shaft, measured_deg=(50.0 * shaft + noise) % 360.0)[0]
    assert "22 pole pairs" in finding.what
    assert "50 or 94 pole pairs" in finding.what
    assert "196 points a turn" in finding.remedy


def test_a_reference_that_trembles_at_its_stops_makes_no_ring_of_a_motor() -> None:
    """Ten readings at each of 72 stops: 7 pole pairs, not one of the aliases that the trembling leaves nearly alike."""
    for seed in range(10):
        rng = np.random.default_rng([10, seed])
        shaft = np.repeat(5.0 * np.arange(72), 10) + 0.01 * rng.standard_normal(720)
        finding = found(reference_deg=shaft, measured_deg=(7.0 * shaft + 0.3 * rng.standard_normal(720)) % 360.0)[0]
        assert "turns 7 times" in finding.what


def test_uneven_points_tell_pole_pairs_from_their_alias() -> None:
    """0.09 deg off the grid are 6.5 deg between 22 and 50 pole pairs: 72 times as much."""
    rng = np.random.default_rng(9)
    shaft = 5.0 * np.arange(72) + rng.uniform(-0.09, 0.09, 72)
    finding = found(reference_deg=shaft, measured_deg=(22.0 * shaft + 0.5 * rng.standard_normal(72)) % 360.0)[0]
    assert finding.what.endswith("a 22:1 gear before it")


@pytest.mark.parametrize(("status", "levels"), [(None, ["note"]), (32.0, []), (48.0, ["fault"])])
def test_a_gain_of_128_is_an_end_on_one_supply_alone(status: float | None, levels: list[str]) -> None:
    """The status decides: magnet detected (32), too weak (16)."""
    columns = {"reference_deg": TURN_DEG, "measured_deg": READING_DEG, "agc": np.full(400, 128.0)}
    if status is not None:
        columns["status"] = np.full(400, status)
    findings = found(**columns)
    assert [one.kind for one in findings] == ["weak_field"] * len(levels)
    assert [one.level for one in findings] == levels


def test_channels_that_stay_at_their_end_by_rounding_alone_are_not_clipped() -> None:
    """Ten codes of amplitude: a sine is rounded to its largest one for a fifth of the turn; cut off at seven of ten
    thousand it stays there for longer than any sine."""
    at = np.radians(TURN_DEG)
    shape = {"reference_deg": TURN_DEG, "measured_deg": TURN_DEG % 360.0}
    assert too_strong(record(**shape, vx=np.round(10.0 * np.cos(at)), vy=np.round(10.0 * np.sin(at)))) is None
    vx, vy = (np.round(1e4 * np.clip(wave, -0.97, 0.97)) for wave in (np.cos(at), np.sin(at)))
    assert too_strong(record(**shape, vx=vx, vy=vy)) is not None
