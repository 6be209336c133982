"""Real sweeps and cases after public reports: what is wrong with their set-up, and nothing that is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from diagnosis.setup.checks import checked
from diagnosis.setup.of_log import read_record
from tests.measured import DATA, REAL

pytestmark = pytest.mark.measured

CASES = {
    "D06b_spin_down_no_reference_column": ["no_reference"],
    "D09a_sixstep_motor0_typo": ["typing_error"],
    "F04_zero_reads_100": ["error_code"],
    "F06b_two_slips_midturn_180": ["turn_not_closed"],
    "F07_factor_0p087_72": ["wrong_counts"],
    "S05b_dead_zone_8deg": ["dead_zone"],
    "S06_bit6_misread": ["word_bit"],
    "S07c_msb_stuck_40_radians_message": ["word_bit"],
    "S16_axial_magnet_180_230": ["axial_magnet"],
}
"""Of all other cases, whose fault is the sensor's, nothing is found."""
FILES = sorted([*REAL.glob("*.csv"), *(DATA / "cases").glob("*.csv")])


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_what_is_wrong_is_found_and_nothing_else(path: Path) -> None:
    read = read_record(path, name=path.name)
    found = checked(read.record, read.findings).findings
    assert [one.kind for one in found] == CASES.get(path.stem, [])


def test_the_mistyped_row_is_named() -> None:
    path = DATA / "cases" / "D09a_sixstep_motor0_typo.csv"
    (found,) = checked(read_record(path, name=path.name).record).findings
    assert found.rows == (17,)
