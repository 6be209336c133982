"""What the words of a link show by themselves: codes in the place of readings, bits, and ranges that are never sent."""

from __future__ import annotations

import numpy as np
import pytest

from tests.hidden.link_faults import Drawn, draw
from twin.catalogue import CATALOGUE
from twin.decoded import Decoded, decoded
from twin.link.scale_error import find as find_scale
from twin.sweep import Sweep
from twin.words import WordFault, Words

DRAWS = 12
STATES = {"low": (0, 0), "high": (1, 0), "up": (0, 1), "up_or": (0, 1), "down": (0, -1), "down_or": (0, -1)}
"""Level, and neighbour that it counts as, by kind of fault."""


def told(drawn: Drawn) -> Decoded:
    return decoded(Sweep(**drawn.columns), CATALOGUE)


def only(drawn: Drawn) -> tuple[Decoded, WordFault]:
    found = told(drawn)
    assert [key for key, _ in found.faults] == [drawn.cause], drawn.truth
    return found, found.faults[0][1]


def error_deg(measured: np.ndarray, drawn: Drawn) -> np.ndarray:
    """Reading minus reference, about its middle."""
    away = np.radians(measured - drawn.truth["sense"] * drawn.columns["reference_deg"])
    return np.degrees(np.angle(np.exp(1j * (away - np.angle(np.mean(np.exp(1j * away)))))))


@pytest.mark.parametrize("seed", range(DRAWS))
def test_a_code_is_told_with_its_rows(seed: int) -> None:
    drawn = draw("error_code", seed=seed)
    found, fault = only(drawn)
    hit = np.zeros(len(found.lost), dtype=bool)
    hit[drawn.truth["hit_rows"] - 1] = True
    # A reading that is expected within the noise of the code may be either.
    assert np.count_nonzero(hit != found.lost) <= 0.03 * hit.sum() + 1
    assert fault.values["reading_deg"] == pytest.approx(drawn.truth["reading_deg"] % 360.0, abs=1e-5)
    low, high = fault.intervals["fraction_percent"]
    assert low <= 100.0 * np.mean(found.lost) <= high


@pytest.mark.parametrize("seed", range(DRAWS))
def test_a_bit_is_told_and_the_readings_told_back(seed: int) -> None:
    drawn = draw("word_bit", seed=seed)
    found, fault = only(drawn)
    state = (fault.values["level"], fault.values["into"])
    assert fault.values["bit"] == drawn.truth["bit"]
    assert fault.values["word_bits"] == drawn.truth["bits"]
    # A bit that counts twice reads like one held at 0, but for its weight in the zero.
    assert state == STATES[drawn.truth["kind"]] or {state, STATES[drawn.truth["kind"]]} == {(0, 0), (0, 1)}
    assert not found.lost.any()
    # All that is left is the sensor's own error: at most 1.7 deg by the draw, and the noise.
    assert np.max(np.abs(error_deg(found.sweep.measured_deg, drawn))) < 2.0 + 5.0 * drawn.truth["noise_deg"]


@pytest.mark.parametrize("seed", range(DRAWS))
def test_a_zone_is_told_by_its_edges(seed: int) -> None:
    drawn = draw("dead_zone", seed=seed)
    _, fault = only(drawn)
    for name in ("start_deg", "width_deg"):
        low, high = fault.intervals[name]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        away = (drawn.truth[name] - middle + 180.0) % 360.0 - 180.0
        assert abs(away) <= half + 8.0 * drawn.truth["noise_deg"] + 360.0 / 2 ** drawn.truth["bits"], name


@pytest.mark.parametrize("kind", ["clean", "index_slip", "table", "typing_error", "scale_error"])
def test_nothing_is_told_where_the_words_are_sound(kind: str) -> None:
    # Of draw 59 the readings stand clear of some words by chance.
    for seed in (*range(2 * DRAWS), 59):
        drawn = draw(kind, seed=seed)
        found = told(drawn)
        assert found.faults == (), (seed, drawn.truth)
        assert np.array_equal(found.sweep.measured_deg, drawn.columns["measured_deg"])


def test_two_codes_are_two_faults() -> None:
    drawn = draw("clean", seed=1)
    measured = drawn.columns["measured_deg"].copy()
    measured[10:60:10], measured[15:65:10] = 0.0, 123.75
    found = decoded(Sweep(drawn.columns["reference_deg"], measured), CATALOGUE)
    assert [key for key, _ in found.faults] == ["error_code", "error_code#2"]
    assert {fault.values["reading_deg"] for _, fault in found.faults} == {0.0, 123.75}


def test_a_frame_that_is_sent_again_is_no_code() -> None:
    drawn = draw("clean", seed=1)
    measured = drawn.columns["measured_deg"].copy()
    measured[20:40] = measured[19]
    assert decoded(Sweep(drawn.columns["reference_deg"], measured), CATALOGUE).faults == ()
    # A word that was not there before is one.
    measured[20:40] = 5.625
    (key, _), *_ = decoded(Sweep(drawn.columns["reference_deg"], measured), CATALOGUE).faults
    assert key == "error_code"


def sound(points: int = 800, bits: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """Angles and words of a sensor without fault."""
    angle = np.arange(points) * (360.0 / points)
    return angle, np.round((angle + 0.8 * np.sin(np.radians(angle))) / 360.0 * 2**bits).astype(np.int64) % 2**bits


def test_wrong_words_that_agree_by_chance_are_no_code() -> None:
    """Of sixty random words of 12 bit two are alike in a third of all cases."""
    angle, words = sound()
    wrong = np.random.default_rng(5).integers(0, 2**12, 60)
    wrong[31] = wrong[7]
    words[5:785:13] = wrong
    assert decoded(Sweep(angle, words * (360.0 / 2**12)), CATALOGUE).faults == ()


def test_a_stretch_of_wrong_words_is_no_dead_zone() -> None:
    """Over ten degrees the word before is sent again, and then others that stand anywhere else."""
    angle, words = sound()
    words[100:114] = words[99]
    words[114:122] = 1500 + 97 * np.arange(8)
    keys = [key for key, _ in decoded(Sweep(angle, words * (360.0 / 2**12)), CATALOGUE).faults]
    assert "dead_zone" not in keys


@pytest.mark.parametrize(("others", "zone"), [((), True), ((1,) * 8, True), ((3, 4, 2, 4), False)])
def test_the_longest_of_many_runs_of_repeated_frames_is_no_dead_zone(others: tuple[int, ...], zone: bool) -> None:
    """Over ten degrees the word before is sent again; elsewhere others are, so many times each."""
    angle, words = sound()
    words[100:110] = words[99]
    for start, times in zip(range(120, 360, 25), others, strict=False):
        words[start : start + times] = words[start - 1]
    faults = decoded(Sweep(angle, words * (360.0 / 2**12)), CATALOGUE).faults
    assert ([key for key, _ in faults] == ["dead_zone"]) == zone


@pytest.mark.parametrize("edge", ["low", "high"])
def test_two_readings_within_a_zone_are_no_code(edge: str) -> None:
    """Of a turn of 180 readings two fall into the zone: what they read stands at its edge, and nowhere by itself."""
    angle, words = sound(points=180)
    start, end = int(words[20]) + 10, int(words[23]) - 10
    words[21:23] = start if edge == "low" else end
    (key, fault), *rest = decoded(Sweep(angle, words * (360.0 / 2**12)), CATALOGUE).faults
    assert (key, rest) == ("dead_zone", [])
    low, high = fault.intervals["width_deg"]
    assert low < (end - start) * (360.0 / 2**12) < high


@pytest.mark.parametrize("place", [0, 3, -3])
def test_a_ramp_that_begins_anew_elsewhere_is_no_scale(place: int) -> None:
    """A wrong scale begins anew at the word 0; a turn that drifted does where it began, here three readings away.

    The 0.3 deg there are thirty times the noise: three readings leave no doubt.
    """
    angle = np.arange(200) * 1.8
    error = 0.8 * np.sin(np.radians(angle)) + 0.01 * np.random.default_rng(3).standard_normal(200)
    true = np.mod(angle + 0.9 + error, 360.0)
    ramp = -0.3 / 360.0 * np.mod(true - 1.8 * place, 360.0)
    measured = np.radians(np.mod(true + ramp, 360.0))
    found = find_scale(Words(np.radians(angle), measured, np.ones(200, dtype=bool)))
    assert (found is not None) == (place == 0)


def test_a_sweep_that_only_follows_once_decoded_is_read() -> None:
    """The top bit always reads 1: half of the readings are half a turn off, so that they follow nothing."""
    angle = np.arange(0.0, 360.0, 9.0)
    words = np.round((angle + 0.8 * np.sin(np.radians(angle))) / 360.0 * 2**14).astype(np.int64) % 2**14
    measured = (words | 2**13) * (360.0 / 2**14)
    sweep = Sweep.from_columns({"reference_deg": angle, "measured_deg": measured})
    (key, fault), *rest = decoded(sweep, CATALOGUE).faults
    assert (key, rest) == ("word_bit", [])
    assert (fault.values["bit"], fault.values["level"]) == (13.0, 1.0)


def turned(zero_deg: float = 41.0, points: int = 360) -> tuple[np.ndarray, np.ndarray]:
    """Angles of two turns and 12-bit words of a sensor with a zero of its own and noise of 0.03 deg."""
    angle = np.arange(points) * (720.0 / points)
    noise = 0.01 * np.random.default_rng(3).standard_normal(points)
    read = angle + zero_deg + 1.2 * np.sin(np.radians(angle + 30.0)) + noise
    return angle, np.round(read / 360.0 * 4096).astype(np.int64) % 4096


def read_back(angle: np.ndarray, words: np.ndarray) -> tuple[WordFault, float]:
    """The fault told, and what the reference's zero reads once it is taken off [deg]."""
    found = decoded(Sweep(angle, words * (360.0 / 4096)), CATALOGUE)
    ((key, fault),) = found.faults
    assert key == "word_bit"
    away = np.radians(found.sweep.measured_deg - angle)
    return fault, float(np.degrees(np.angle(np.mean(np.exp(1j * away)))))


@pytest.mark.parametrize("bit", [4, 5, 6, 8])
def test_a_bit_held_at_0_is_told_as_such_beside_what_sends_the_same_words(bit: int) -> None:
    """Added to the next bit it would send the very same words of a sensor whose zero is the bit's weight less."""
    weight = 1 << bit
    angle, words = turned()
    sent = words & ~weight
    other = words - weight
    assert np.array_equal((other + (other & weight)) % 4096, sent)
    fault, zero_deg = read_back(angle, sent)
    assert (fault.values["bit"], fault.values["level"], fault.values["into"]) == (bit, 0.0, 0.0)
    # The mean of 360 readings: their own error is none but for the noise and the step of the words.
    assert zero_deg == pytest.approx(41.0, abs=0.02)
    (alike,) = fault.alike
    assert f"read into bit {bit + 1} (added to it)" in alike.said
    assert np.degrees(alike.zero_rad) == pytest.approx(-weight * 360.0 / 4096)


def test_a_bit_joined_to_the_next_sends_words_of_its_own() -> None:
    angle, words = turned()
    fault, zero_deg = read_back(angle, (words & ~32) | ((words & 32) << 1))
    assert (fault.values["bit"], fault.values["into"], fault.values["joined"]) == (5.0, 1.0, 1.0)
    assert zero_deg == pytest.approx(41.0, abs=0.02)
    assert fault.alike == ()


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("zero_deg", [41.0, -41.0])
def test_a_highest_bit_that_is_held_leaves_half_a_turn_open(level: int, zero_deg: float) -> None:
    """Of the two zeros the smaller is told, and that the other does as well."""
    angle, words = turned(zero_deg)
    fault, told_deg = read_back(angle, (words & ~2048) | 2048 * level)
    assert (fault.values["bit"], fault.values["level"], fault.values["into"]) == (11.0, float(level), 0.0)
    assert told_deg == pytest.approx(zero_deg, abs=0.02)
    assert [np.degrees(one.zero_rad) for one in fault.alike] == [pytest.approx(180.0)]


@pytest.mark.parametrize(("zero_deg", "is_code"), [(40.45, True), (40.2, False)])
def test_a_code_near_its_own_angle_is_the_code_where_the_noise_leaves_no_doubt(zero_deg: float, is_code: bool) -> None:
    """Noise and step leave 0.04 deg: a reading of 0 where 0.24 deg is expected is six of that off, at 0.01 deg none."""
    angle, words = turned(zero_deg)
    expected_deg = (angle + zero_deg + 1.2 * np.sin(np.radians(angle + 30.0)) + 180.0) % 360.0 - 180.0
    near = int(np.argmin(np.abs(expected_deg)))
    assert abs(expected_deg[near]) == pytest.approx(0.242 if is_code else 0.008, abs=0.001)
    hit = {*range(10, 360, 31)}
    words[[*hit, near]] = 0
    found = decoded(Sweep(angle, words * (360.0 / 4096)), CATALOGUE)
    assert [key for key, _ in found.faults] == ["error_code"]
    assert set(np.flatnonzero(found.lost).tolist()) == (hit | {near} if is_code else hit)
