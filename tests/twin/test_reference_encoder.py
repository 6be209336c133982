"""The reference encoder and the drive's orders."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenarios.commands.protocol import Protocol
from scenarios.commands.simulate import Instead, Outputs, run
from scenarios.commands.trace import trace
from twin.angles import TAU
from twin.chain import Chain
from twin.errors import UserError
from twin.files import from_dict, to_dict
from twin.limits import OutOfRangeError
from twin.reference.encoder import Encoder, bldc_order, stepper_order
from twin.sweep import Sweep

SHAFT = np.linspace(0.3, 9.0, 4001)


def test_counts_within_half_a_count() -> None:
    encoder = Encoder(lines=500, index_deg=10.0)
    reading = encoder.read(SHAFT)
    assert encoder.counts == 2000
    assert np.max(np.abs(reading - SHAFT)) <= 0.5 * TAU / 2000 * (1 + 1e-9)
    counts = (reading - np.radians(10.0)) / TAU * 2000
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)


def test_without_an_index_it_starts_at_zero() -> None:
    reading = Encoder(lines=5000, has_index=False).read(SHAFT)
    assert reading[0] == 0.0
    assert np.max(np.abs(reading - (SHAFT - SHAFT[0]))) <= 0.5 * TAU / 20000 * (1 + 1e-9)


def test_orders_of_drives() -> None:
    assert stepper_order(200) == 50
    assert bldc_order(7) == 42


def test_refuses_by_name_value_and_range() -> None:
    with pytest.raises(OutOfRangeError, match="lines is 0; expected a whole number from 1 to 1e"):
        Encoder(lines=0)


TWIN = {"schema": "halltwin.twin/1", "reference": {"lines": 90, "index_deg": 5.0}}


def test_a_twin_file_gives_the_reference_its_lines() -> None:
    chain = from_dict(TWIN)
    assert to_dict(chain)["reference"] == TWIN["reference"]
    motion = Protocol(points=97).motion()
    recorded = chain.simulate(motion, seed=1).reference_deg
    # 90 lines of 4 counts: a count is a degree, and the index lies on one.
    np.testing.assert_allclose(recorded, np.floor(np.degrees(motion.shaft_rad) + 0.5), atol=1e-9)
    np.testing.assert_array_equal(trace(chain, motion, seed=1).reference_deg, recorded)
    # An expected reading is counted by nothing.
    np.testing.assert_array_equal(chain.reference(motion), Chain().reference(motion))


def test_the_option_replaces_the_lines_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "twin.toml").write_text('schema = "halltwin.twin/1"\n[reference]\nlines = 90\n')
    for lines, count_deg in ((None, 1.0), (45, 2.0)):
        out = tmp_path / f"{lines}.csv"
        run(
            str(tmp_path / "twin.toml"),
            Outputs(sweep=out),
            recorded=None,
            protocol=Protocol(points=97),
            seed=1,
            instead=Instead(reference_lines=lines),
        )
        counts = Sweep.read(out).reference_deg / count_deg
        np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)
        assert np.ptp(np.diff(counts)) > 0.5  # whole counts, not all the same: the points lie between them


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"reference": {"lines": 0}}, "[reference]: lines is 0; expected a whole number from 1 to 1e+06"),
        ({"reference": {"lines": True}}, "[reference]: lines is True; expected a number or a word"),
        ({"reference": {"has_index": "yes"}}, "[reference]: has_index is 'yes'; expected true or false"),
        ({"reference": {"rulings": 3}}, "[reference]: reference has no 'rulings' (did you mean lines?); it has lines"),
        ({"reference": 5000}, "[reference]: reference is 5000; expected a table"),
        ({"hardware": {"disk": {"gain": 0.0}}}, "[hardware]: gain is 0; expected from 0.1 to 100"),
        ({"hardware": {"disk": 6.0}}, "[hardware]: hardware.disk is 6.0; expected a table"),
        ({"hardware": {"plate": {"offset_uV": [1.0, 2.0]}}}, "[hardware]: offset_uV is [1.0, 2.0]; expected a single"),
        ({"hardware": {"field_mT": float("nan")}}, "[hardware]: field_mT is nan mT; expected from 0.001 to 10000 mT"),
    ],
)
def test_tables_of_a_twin_file_refuse_by_name_value_and_range(table: dict[str, object], message: str) -> None:
    with pytest.raises(UserError) as refused:
        from_dict({"schema": "halltwin.twin/1", **table})
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)
