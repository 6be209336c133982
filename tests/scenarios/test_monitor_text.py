"""What ``halltwin monitor`` prints: factors by the names of all commands, digits by their scatter, whither they go."""

from __future__ import annotations

import functools
import io
import json
import re
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from diagnosis.factors.series import LABELS, LAG, RESIDUAL, UNITS, MonitoredSeries, monitor
from diagnosis.report.factor_names import LABELS as FACTORS
from scenarios.commands.monitor_text import show
from tests.command_line import halltwin
from twin.chain import Chain
from twin.motion import Motion
from twin.sweep import Sweep

OLD_NAMES = re.compile(r"V[xy]|\bbeta|\bquad\b|_percent|_deg|log_")
DRIFT = 0.03
"""Change of offset x in percent a sweep, over a scatter of some 0.002, from the seventh sweep on."""


@functools.cache
def series(way: int, louder: float = 1.0) -> tuple[Sweep, ...]:
    """Ten sweeps there and back; offset x moves up or down in the last, or the noise grows so many times."""
    angle = np.radians(np.arange(0.0, 360.0, 6.0))
    motion = Motion.from_angle(np.concatenate([angle, angle[::-1]]))
    sweeps = []
    for number in range(10):
        late = max(number - 5, 0)
        sensor = (
            Chain()
            .with_effect("offset", x_percent=0.8 + way * DRIFT * late, y_percent=-0.5)
            .with_effect("quadratic_nonlinearity", q_percent=1.0)
            .with_effect("noise", rms_deg=0.02 * (louder if late else 1.0))
        )
        made = sensor.simulate(motion, seed=number)
        sweeps.append(
            Sweep.from_columns(
                {"reference_deg": made.reference_deg, "measured_deg": made.measured_deg}, name=f"s{number}"
            )
        )
    return tuple(sweeps)


@functools.cache
def monitored(way: int, louder: float = 1.0) -> MonitoredSeries:
    return monitor(series(way, louder), rng=np.random.default_rng(0))


def shown(found: MonitoredSeries, width: int) -> str:
    out = io.StringIO()
    show(found, Console(file=out, width=width, highlight=False))
    return out.getvalue()


def test_factors_bear_the_names_of_all_commands() -> None:
    assert set(LABELS) == set(UNITS)
    assert [label for name, label in LABELS.items() if name not in (RESIDUAL, LAG)] == list(FACTORS.values())


@pytest.mark.parametrize("width", [40, 80, 160])
@pytest.mark.parametrize("way", [1, -1])
def test_names_digits_and_the_way_it_drifts(way: int, width: int) -> None:
    found = monitored(way)
    text = shown(found, width)
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    assert not OLD_NAMES.search(text)
    words = " ".join(text.split())
    up_or_down = "up" if way > 0 else "down"
    told = re.search(
        rf"offset x drifts {up_or_down}[^:]*: first signalled at sweep \d+ of 10; a ramp of (\S+) %", words
    )
    assert told
    # Four steps of the drift, to a few of its scatter.
    assert float(told[1]) == pytest.approx(4 * way * DRIFT, abs=0.02)
    assert len(told[1].partition(".")[2]) in (3, 4)
    for label in LABELS.values():
        assert label in words
    # Of 120 readings of 0.02 deg a factor is known to some 0.02 sqrt(2/120), 0.003 deg or 0.005 %: four decimals.
    assert re.search(r"phase.{0,12}both[^-\d]*-?0\.\d{4} ", words)


def test_the_rms_of_the_residual_is_told_in_deg_and_by_how_many_times_it_grew() -> None:
    words = " ".join(shown(monitored(0, louder=4.0), 100).split())
    first, last = re.findall(r"residual RMS both deg (0\.\d+) (0\.\d+) ", words)[0]
    # A standard deviation of 114 degrees of freedom is known to 7 %.
    assert float(first) == pytest.approx(0.02, rel=0.25)
    assert float(last) == pytest.approx(0.08, rel=0.25)
    ratio = re.search(r"residual RMS drifts up[^:]*: .* to (\d\.\d+) times", words)
    assert ratio
    assert float(ratio[1]) == pytest.approx(4.0, rel=0.2)


def test_the_factor_may_be_asked_for_by_either_name_and_what_was_not_fitted_is_told(tmp_path: Path) -> None:
    for number, sweep in enumerate(series(-1)):
        measured = sweep.measured_deg.copy()
        if number == 3:
            measured[20] += 90.0
        Sweep.from_columns({"reference_deg": sweep.reference_deg, "measured_deg": measured}).write(
            tmp_path / f"s{number}.csv"
        )
    answer = tmp_path / "answer.json"
    for name in ("offset x", "Vx_over_Ax_percent"):
        ended = halltwin("monitor", tmp_path / "s*.csv", "--fail-on", name, "--json", answer, "--force")
        assert ended.code == 1
        assert re.search(rf"found {name} \(down, signalled at sweep \d+\)", ended.err)
    assert "readings that were not fitted: 1 gross error in s3.csv" in " ".join(ended.out.split())
    told = json.loads(answer.read_text(encoding="utf-8"))["readings"]
    assert [one["fitted"] for one in told] == [120, 120, 120, 119, *[120] * 6]
    assert told[3]["glitch_rows"] == [21]
