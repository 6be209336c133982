"""Tables for drives: as good as any of their size, read back, and what the drive's own arithmetic makes of them."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from diagnosis.correction.compensation import correction_of
from diagnosis.correction.straight_lines import Nodes, best_values, best_whole_numbers
from diagnosis.correction.targets import autosar, c_table, klipper, lut, magalpha, mechaduino, moteus, simplefoc
from diagnosis.correction.targets.known import TARGETS, target_of
from diagnosis.correction.targets.target import Table, Target
from diagnosis.correction.wanted import Wanted
from tests.diagnosis.correction.best_table import (
    Made,
    smallest_worst,
    smallest_worst_of_free_pieces,
    smallest_worst_of_whole_numbers,
    weights_of,
)
from twin.angles import TAU, Array, wrap
from twin.chain import Chain
from twin.errors import UserError
from twin.motion import Motion

WORDS = TAU * np.arange(65536) / 65536
WORD_DEG = 360.0 / 65536
BEST = 1.1
"""No table is worse than the best of its size by more."""


@cache
def device(number: int) -> Chain:
    """A sensor of errors of its own, counting either way."""
    rng = np.random.default_rng(number)
    chain = Chain(sensor_sense=1 if number % 2 else -1).with_effect("zero", zero_deg=float(rng.uniform(-180, 180)))
    chain = chain.with_effect("offset", x_percent=float(rng.normal(0, 1)), y_percent=float(rng.normal(0, 1)))
    chain = chain.with_effect("gain_mismatch", ratio=1.0 + 0.02 * float(rng.normal()))
    chain = chain.with_effect("phase", beta_deg=float(rng.normal(0, 0.5))).with_effect("saturation", k_percent=1.0)
    return chain.with_effect("magnet_harmonic", order=int(rng.integers(3, 9)), amplitude_deg=0.05)


@cache
def wanted_of(number: int) -> Wanted:
    """The correction of a device, with every order that is not nothing."""
    return Wanted.of(correction_of(device(number), tolerance_deg=1e-5))


def worst_deg(target: Target, table: Table, wanted: Wanted) -> float:
    """By how much the shaft angle that follows from a table is off, at the worst of all words."""
    return float(np.degrees(np.max(np.abs(wrap(target.shaft(table, wanted, WORDS) - wanted.shaft(WORDS))))))


def added(table_of: Callable[[Array], Table], reading: Array) -> Made:
    """What a drive adds to readings, by the entries of its table."""
    return lambda entries: np.degrees(wrap(table_of(entries).corrected(reading) - reading))


@pytest.mark.parametrize("number", range(4))
def test_a_table_gives_the_shaft_angle_of_its_device(number: int) -> None:
    """Axis, sign, zero and sense of each, against the device itself: its readings lead back to its shaft.

    The best table of the size is off by so little; a wrong sign would double the error, of a degree and more.
    """
    shaft = TAU * np.arange(500) / 500
    reading = device(number).readings(Motion.from_angle(shaft))
    for target in TARGETS:
        back = target.shaft(target.stored(wanted_of(number), target.entries, "worst"), wanted_of(number), reading)
        assert np.degrees(np.max(np.abs(wrap(back - shaft)))) < 0.07, target.what


@pytest.mark.parametrize("number", range(2))
@pytest.mark.parametrize("entries", [12, 64])
def test_of_floats_none_is_better(number: int, entries: int) -> None:
    wanted, at = wanted_of(number), WORDS[::64]
    made = added(lambda entry: simplefoc.SimpleFoc(entry.astype(np.float32)), at)
    best, _ = smallest_worst(weights_of(made, entries, 0.01), np.degrees(wanted.added(at)))
    for target in (simplefoc.TARGET, lut.TARGET):
        assert worst_deg(target, target.stored(wanted, entries, "worst"), wanted) < BEST * best
    c = c_table.TARGET
    # A word in and a word out: rounded to half of one.
    assert worst_deg(c, c.stored(wanted, entries, "worst"), wanted) < BEST * (best + 0.5 * WORD_DEG)


@pytest.mark.parametrize("number", range(2))
def test_of_moteus_of_floats_none_is_better(number: int) -> None:
    wanted, at, target = wanted_of(number), WORDS[::64], moteus.OF_FLOATS
    made = added(lambda entry: moteus.MoteusOfFloats(entry.astype(np.float32)), at)
    best, _ = smallest_worst(weights_of(made, 32, 0.01), np.degrees(wanted.added(at)))
    assert worst_deg(target, target.stored(wanted, 32, "worst"), wanted) < BEST * best


@pytest.mark.parametrize("number", range(2))
def test_of_whole_numbers_none_is_better(number: int) -> None:
    """Against the bound of an integer programme."""
    wanted, at = wanted_of(number), WORDS[::128]
    needed = np.degrees(wanted.added(at))
    magalpha_table = magalpha.TARGET.stored(wanted, 32, "worst")
    made = added(lambda entry: magalpha.MagAlpha(entry.astype(np.int64)), at)
    best, _ = smallest_worst_of_whole_numbers(weights_of(made, 32, 1.0), needed, seconds=5.0)
    assert worst_deg(magalpha.TARGET, magalpha_table, wanted) < BEST * best
    moteus_table = moteus.TARGET.stored(wanted, 256, "worst")
    assert isinstance(moteus_table, moteus.Moteus)
    made = added(lambda entry: replace(moteus_table, entry=entry.astype(np.int64)), at)
    best, _ = smallest_worst_of_whole_numbers(weights_of(made, 256, 1.0), needed, seconds=5.0)
    assert worst_deg(moteus.TARGET, moteus_table, wanted) < BEST * best


def test_of_few_whole_numbers_all_are_tried() -> None:
    """Where the unit is coarse, the best floats, rounded, are worse by a ninth."""
    nodes, unit, curve = Nodes.even(8), np.radians(0.36), wanted_of(4).added
    at, interval, share = nodes.samples()
    wanted = curve(at) / unit
    right = nodes.right(interval)

    def worst(entry: Array) -> float:
        return float(np.max(np.abs(entry[interval] * (1.0 - share) + entry[right] * share - wanted)))

    rounded = np.round(best_values(nodes, curve) / unit)
    best = min(worst(rounded + np.array(moved)) for moved in product((-1, 0, 1), repeat=8))
    assert worst(best_whole_numbers(nodes, curve, unit)) == pytest.approx(best)
    assert worst(rounded) > 1.1 * best


@pytest.mark.parametrize("number", range(2))
def test_of_free_points_none_is_better(number: int) -> None:
    """Against lines that need not even meet. Words in and out are rounded, and the quotient is cut."""
    wanted, target = wanted_of(number), autosar.TARGET
    start = WORDS[32768::128]
    curve = np.degrees(wanted.added(np.append(start, WORDS[:32768:128])))
    best, _ = smallest_worst_of_free_pieces(curve, 15)
    even = worst_deg(lut.TARGET, lut.TARGET.stored(wanted, 15, "worst"), wanted)
    found = worst_deg(target, target.stored(wanted, 16, "worst"), wanted)
    assert found < BEST * best + 0.5 * WORD_DEG
    assert found < even


def test_least_squares_are_better_in_the_mean_and_worse_at_the_worst() -> None:
    wanted, target = wanted_of(1), lut.TARGET
    worst, rms = (target.stored(wanted, 16, least) for least in ("worst", "rms"))
    away = [np.std(wrap(target.shaft(one, wanted, WORDS) - wanted.shaft(WORDS))) for one in (worst, rms)]
    # Of a parabola on even nodes: a third more at the worst, and an eighth less in the mean.
    assert worst_deg(target, rms, wanted) > 1.15 * worst_deg(target, worst, wanted)
    assert away[1] < 0.97 * away[0]


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: f"{target.name}:{target.entries}")
def test_a_file_is_read_back_as_what_was_fitted(target: Target) -> None:
    """Also where its comment holds what the table itself is found by."""
    fitted = target.fitted(wanted_of(0), target.entries, "worst")
    about = ("calibrate: 1, 2", "x_entry[3] = {1}", "# first entry: full step 7", "lookup[2] = {0} */ int")
    read = target.read(fitted.text(about, "name"))
    assert len(read) == len(fitted) == target.entries
    # Texts hold eight decimals or nine digits, and single precision of an angle is 5e-7 rad.
    assert np.max(np.abs(wrap(read.corrected(WORDS) - fitted.corrected(WORDS)))) < 6e-7


# ---- the arithmetic of the drives, from what their sources do, not from the models -----------------------------


def test_simplefoc_takes_the_offset_off() -> None:
    table = simplefoc.TARGET.stored(wanted_of(1), 200, "worst")
    assert isinstance(table, simplefoc.SimpleFoc)
    offset = np.append(table.offset_rad, table.offset_rad[0])
    by_hand = WORDS - np.interp(WORDS, TAU * np.arange(201) / 200, offset)
    # Single precision of an angle up to a turn.
    assert np.max(np.abs(wrap(table.corrected(WORDS) - by_hand))) < 2e-6


def test_moteus_adds_a_part_of_the_scale() -> None:
    text = moteus.TARGET.fitted(wanted_of(1), 256, "worst").text((), "name")
    sets = dict(line.split() for line in text.splitlines())
    scale = float(sets.pop("motor_position.sources.0.compensation_scale"))
    entry = np.array([int(sets[f"motor_position.sources.0.compensation_table.{k}"]) for k in range(256)])
    assert len(sets) == 256
    assert np.max(np.abs(entry)) == 127
    turns = np.arange(65536) / 65536
    by_hand = turns + np.interp(turns, np.arange(257) / 256, np.append(entry, entry[0])) * scale / 127
    assert np.max(np.abs(wrap(moteus.TARGET.read(text).corrected(WORDS) - TAU * by_hand))) < 2e-6


def test_moteus_of_floats_stands_on_the_middles_of_its_bins() -> None:
    table = moteus.OF_FLOATS.stored(wanted_of(1), 32, "worst")
    assert isinstance(table, moteus.MoteusOfFloats)
    turns = np.arange(65536) / 65536
    wide = np.concatenate([table.fraction[-1:], table.fraction, table.fraction[:1]])
    by_hand = turns + np.interp(turns, (np.arange(34) - 0.5) / 32, wide)
    assert np.max(np.abs(wrap(table.corrected(WORDS) - TAU * by_hand))) < 1e-6


@pytest.mark.parametrize("number", [0, 1])
def test_klipper_solves_the_table_that_was_meant(number: int) -> None:
    """The host's solution from the list alone: least squares on 64 nodes, cut to whole numbers, then its integers."""
    text = klipper.TARGET.fitted(wanted_of(number), 200, "worst").text(("calibrate: no",), "x")
    listed = [float(word) for word in text.split("\ncalibrate:")[1].replace(",", " ").split()]
    down = listed[-2] > listed[-1]
    # The sensor counts against the steps where the device does.
    assert down == (wanted_of(number).slope < 0)
    ordered = listed[::-1] if down else listed
    low = ordered.index(min(ordered))
    ordered = ordered[low:] + ordered[:low]
    lines, steps = np.zeros((200, 64)), np.zeros(200)
    for step, angle in enumerate(ordered):
        bucket = int(angle + 0.5) % 65536 // 1024
        part = (angle - 1024 * bucket) / 1024
        lines[step, bucket], lines[step, (bucket + 1) % 64] = 1.0 - part, part
        steps[step] = step * 65536 / 200 - (part * 65536 if bucket == 63 else 0.0)
    solved = [int(value + 0.5) for value in np.linalg.lstsq(lines, steps, rcond=None)[0]]
    solved.append(solved[0] + 65536)
    found = []
    for angle in range(65536):
        left, right = solved[angle >> 10], solved[(angle >> 10) + 1]
        found.append(left + (((angle & 1023) * (right - left) + 512) >> 10))
    turned = (-1 if down else 1) * np.array(found) * TAU / 65536
    # Its zero is the step with the smallest angle, which lies within four steps of the first, as phases need it.
    first = int(text.split("first entry: full step ")[1].split()[0])
    lowest = listed.index(min(listed))
    assert first % 4 == 0
    assert (listed.index(max(listed)) if down else lowest) < 4
    shaft = turned + TAU * (first + lowest) / 200
    away = np.degrees(np.abs(wrap(shaft - wanted_of(number).shaft(WORDS))))
    assert np.max(away) < 0.02
    model = klipper.TARGET.read(text).corrected(WORDS)
    assert np.max(np.abs(wrap(model - shaft))) < 1e-9


def test_klipper_refuses_a_turn_that_its_steps_do_not_tell() -> None:
    """An error of 70 deg: from one full step to the next the sensor turns by more than a part of Klipper's."""
    chain = Chain().with_effect("offset", x_percent=60.0, y_percent=-70.0)
    with pytest.raises(UserError, match="too few of 200 full steps fall into some of the 64 parts"):
        klipper.TARGET.stored(Wanted.of(correction_of(chain)), 200, "worst").corrected(WORDS)


def test_mechaduino_looks_the_count_up() -> None:
    table = mechaduino.TARGET.stored(wanted_of(1), 16384, "worst")
    assert isinstance(table, mechaduino.Mechaduino)
    assert np.all((table.angle_deg >= 0.0) & (table.angle_deg < 360.0))
    count = TAU * np.arange(16384) / 16384
    away = wrap(np.radians(table.angle_deg.astype(np.float64)) - wanted_of(1).shaft(count))
    # Four decimals, in single precision of an angle up to 360 deg.
    assert np.degrees(np.max(np.abs(away))) < 1e-4


def test_magalpha_writes_bytes_of_two_complement() -> None:
    text = magalpha.TARGET.fitted(wanted_of(1), 32, "worst").text((), "x")
    byte = np.array([int(word) for word in text.split("{")[1].split("}")[0].replace(",", " ").split()])
    assert np.all((byte >= 0) & (byte < 256))
    signed = np.where(byte < 128, byte, byte - 256) * 360.0 / 4096
    by_hand = np.interp(np.arange(65536) / 65536, np.arange(33) / 32, np.append(signed, signed[0]))
    model = np.degrees(wrap(magalpha.TARGET.read(text).corrected(WORDS) - WORDS))
    np.testing.assert_allclose(model, by_hand, atol=1e-9)


def test_magalpha_refuses_what_no_register_holds() -> None:
    far = Wanted.of(correction_of(Chain().with_effect("offset", x_percent=25.0)))
    with pytest.raises(UserError, match=r"a register of the MA600 holds 11\.2 deg"):
        magalpha.TARGET.fitted(far, 32, "worst")


_PROGRAM = """
#include <stdio.h>
#include "table.h"
int main(void)
{
    for (uint32_t k = 0; k < 65536u; ++k)
        printf("%u\\n", (unsigned)test_shaft((uint16_t)k));
    return 0;
}
"""


@pytest.mark.parametrize("chain", [0, 1, "none", "much"], ids=str)
@pytest.mark.parametrize(("target", "entries"), [(c_table.TARGET, 64), (c_table.TARGET, 7), (autosar.TARGET, 24)])
def test_compiled_c_is_the_python_on_all_words(target: Target, entries: int, chain: int | str, tmp_path: Path) -> None:
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no C compiler here: the table is not compiled")
    much = Chain().with_effect("gain_mismatch", ratio=1.9).with_effect("offset", x_percent=20.0)
    wanted = (
        wanted_of(chain) if isinstance(chain, int) else Wanted.of(correction_of(Chain() if chain == "none" else much))
    )
    table = target.fitted(wanted, entries, "worst")
    (tmp_path / "table.h").write_text(table.text(("a comment */ that ends early",), "test"))
    (tmp_path / "program.c").write_text(_PROGRAM)
    strict = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run([compiler, *strict, "-o", "program", "program.c"], cwd=tmp_path, check=True)
    out = subprocess.run(["./program"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert isinstance(table, c_table.CTable | autosar.Autosar)
    assert np.array_equal(np.array(out.split(), dtype=np.int64), table.of_words(np.arange(65536)))


def test_what_is_no_target_is_refused_with_what_there_is() -> None:
    assert target_of("moteus")[0] is moteus.TARGET
    assert target_of("moteus:32") == (moteus.OF_FLOATS, 32)
    for asked, said in {
        "odrive": "ODrive takes no table",
        "vesc:360": "VESC takes no table",
        "simplefox": "did you mean simplefoc",
        "moteus:64": "N 256 or 32",
        "klipper:202": "in steps of 4",
        "lut:": "lut:N with N from 4 to 4096",
        "lut:3": "lut:N with N from 4",
        "lut:٦٤": "lut:N with N from 4",
    }.items():
        with pytest.raises(UserError, match=said):
            target_of(asked)
