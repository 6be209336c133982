"""The discard rule in a diagnosis: Delta E from a twin or as a number, what it discarded, whether the fit keeps it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis import diagnose, diagnose_many
from diagnosis.error_model.error_band import band_terms_rad, delta_e_rad
from tests.command_line import halltwin
from tests.diagnosis.cases import turn
from tests.diagnosis.error_model.study import device
from twin.errors import UserError
from twin.files import write_twin
from twin.motion import Motion

CHAIN = device("a")
DELTA_E_DEG = float(np.degrees(delta_e_rad(CHAIN)))
MOTION = Motion.from_angle(turn(360))


def test_a_device_keeps_its_own_band_and_particles_are_discarded() -> None:
    """Delta E counts four standard deviations of noise: one sweep in 40 of 360 readings would leave it."""
    found = diagnose(CHAIN.simulate(MOTION, seed=1), band_deg=DELTA_E_DEG).findings.band
    assert found is not None
    assert found.delta_e_deg == pytest.approx(DELTA_E_DEG)
    assert found.readings_outside == 0
    assert 0.5 * DELTA_E_DEG < found.largest_deg < DELTA_E_DEG
    assert found.particles_discarded > 0


def test_what_the_model_lacks_leaves_the_band_and_is_counted() -> None:
    """A third order of twice Delta E is beyond the error model: |sin| is above a half over two thirds of a turn.

    The quadratic term has an order 3 of its own, which takes up a little of it.
    """
    lacking = CHAIN.with_effect("magnet_harmonic", order=5, amplitude_deg=2.0 * DELTA_E_DEG, phase_deg=0.0)
    asked = diagnose(lacking.simulate(MOTION, seed=1), band_deg=DELTA_E_DEG)
    found = asked.findings.band
    assert found is not None
    assert found.readings_outside == pytest.approx(360 * 2 / 3, rel=0.1)
    assert f"all readings but {found.readings_outside} within it" in " ".join(asked.summary().split())
    assert "Eq. 7 rejects these factors" in " ".join(asked.summary().split())


def test_of_many_sweeps_those_that_leave_the_band_are_told() -> None:
    lacking = CHAIN.with_effect("magnet_harmonic", order=5, amplitude_deg=2.0 * DELTA_E_DEG, phase_deg=0.0)
    sweeps = [replace(chain.simulate(MOTION, seed=1), name=name) for name, chain in (("a", CHAIN), ("b", lacking))]
    said = " ".join(diagnose_many(sweeps, band_deg=DELTA_E_DEG).summary().split())
    assert "(Eq. 7): 1 of 2 sweeps stay within it of their fitted curve; not b" in said
    many = diagnose_many([sweeps[1]] * 7, band_deg=DELTA_E_DEG).summary()
    assert "0 of 7 sweeps stay within it of their fitted curve; not b, b, b, b, b and 2 more" in " ".join(many.split())
    assert "Delta E" not in diagnose_many(sweeps).summary()


def test_without_a_band_nothing_is_said_of_one() -> None:
    plain = diagnose(CHAIN.simulate(MOTION, seed=1))
    assert plain.findings.band is None
    assert "band" not in plain.to_dict()["sweeps"][0]
    assert "Delta E" not in plain.summary()


def test_the_band_of_a_twin_is_the_number(tmp_path: Path) -> None:
    CHAIN.simulate(MOTION, seed=1).write(tmp_path / "s.csv")
    write_twin(tmp_path / "device.toml", CHAIN)
    answers = []
    for band in (str(tmp_path / "device.toml"), f"{DELTA_E_DEG!r}deg", repr(DELTA_E_DEG)):
        assert halltwin("diagnose", tmp_path / "s.csv", "--band", band, "--json", tmp_path / "a.json").code == 0
        (one,) = json.loads((tmp_path / "a.json").read_text())["sweeps"]
        answers.append(one)
    assert answers[0] == answers[1] == answers[2]
    assert answers[0]["band"]["delta_e_deg"] == pytest.approx(DELTA_E_DEG)


@pytest.mark.parametrize(
    ("band", "said"),
    [
        ("0", "band is 0 deg; expected from 1e-06 to 180 deg"),
        ("nan", "band is nan deg; expected from 1e-06 to 180 deg"),
        ("soon", "soon: is no preset"),
        ("exact.toml", "whose Delta E is 0"),
    ],
)
def test_mistakes_are_one_line(band: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    CHAIN.simulate(MOTION, seed=1).write(tmp_path / "s.csv")
    write_twin(tmp_path / "exact.toml", CHAIN.without("noise").without("adc_quantisation"))
    ended = halltwin("diagnose", "s.csv", "--band", band)
    assert ended.code == 2
    assert said in ended.err
    assert ended.err.count("\n") == 1


def test_a_band_from_python_is_checked() -> None:
    with pytest.raises(UserError, match="band is -1 deg; expected from 1e-06 to 180 deg"):
        diagnose(CHAIN.simulate(MOTION, seed=1), band_deg=-1.0)


def test_the_terms_of_delta_e_have_names() -> None:
    terms = band_terms_rad(CHAIN.with_effect("cordic_truncation", iterations=8), immeasurable_rad=0.01)
    assert list(terms) == ["quantisation", "reference", "noise", "cordic", "immeasurable"]
    assert terms["cordic"] == pytest.approx(np.arctan(2.0**-7))
    assert terms["reference"] == 0.0
    assert terms["immeasurable"] == 0.01
