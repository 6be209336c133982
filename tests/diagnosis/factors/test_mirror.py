"""The mirror solution: which symmetry it is, who decides, and that no sign is handed out by chance."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import Diagnosis, diagnose, diagnose_many
from diagnosis.error_model.fit import fit_equal
from diagnosis.error_model.model import QUAD, VY, Readings, mirrored
from diagnosis.factors.mirror import judged
from tests.diagnosis.cases import NOISE_RAD, measured, turn
from twin.angles import TAU, Array
from twin.chain import Chain
from twin.errors import UserError
from twin.motion import Motion
from twin.sweep import Sweep

SWEEPS = 60


def point(q: float) -> Array:
    return np.array([0.008, -0.005, 1.01, 0.006, q, 0.7])


def sweeps(q: float, *, output: int = 1, channels: bool = False) -> list[Sweep]:
    """Sweeps of one sensor whose offset y is -0.5 %, of 360 readings with a noise of 0.02 deg."""
    rng = np.random.default_rng(7)
    shaft = turn(360)
    x, y = Readings.of(shaft, shaft, sensor_sense=float(output)).channels(point(q))
    made = []
    for _ in range(SWEEPS):
        read = output * np.arctan2(y, x) + NOISE_RAD * rng.standard_normal(shaft.size)
        columns = {"reference_deg": np.degrees(shaft), "measured_deg": np.degrees(read)}
        noisy = {"vx": x, "vy": y} if channels else {}
        made.append(Sweep.from_columns({**columns, **noisy}))
    return made


def wrong(found: Diagnosis) -> bool:
    """Whether one solution alone is given, and it has the wrong sign of offset y."""
    return found.findings.mirror.decided and found.factors["Vy_over_Ay"].value > 0.0


def test_the_mirrored_point_makes_the_same_curve_but_for_order_3_of_the_quadratic_term() -> None:
    """Exactly the same at q = 0; else the best mirrored fit leaves q / sqrt(8) of order 3, to first order in q.

    With offsets of 1 % and a gain mismatch of 1 % first order is right to a few per cent.
    """
    shaft = turn(720)
    none = measured(point(0.0), shaft)
    np.testing.assert_allclose(measured(mirrored(point(0.0)), shaft, -1, -1), none, atol=1e-12)
    q = 0.002
    fit = fit_equal(shaft[None], measured(point(q), shaft)[None], rng=np.random.default_rng(0), senses=(-1, -1))[0]
    third = 2.0 * abs(np.mean(fit.residual_rad * np.exp(-3j * shaft)))
    assert third == pytest.approx(q / np.sqrt(8.0), rel=0.05)
    assert abs(fit.point[QUAD]) < 0.05 * q
    assert fit.point[VY] == pytest.approx(0.005, abs=q)


@pytest.mark.parametrize("output", [1, -1])
@pytest.mark.parametrize("q", [0.0, 0.0002, 0.0005, 0.002])
def test_the_sign_is_right_or_both_are_given(q: float, output: int) -> None:
    """q has a standard error of 0.00007 here: 0.002 decides every time, none at all never.

    Odds of 1000 to 1 let less than one of these 480 be wrong.
    """
    found = diagnose_many(sweeps(q, output=output))
    assert not any(map(wrong, found))
    decided = [one.findings.mirror.decided for one in found]
    assert all(decided) if q == 0.002 else any(decided) == (q > 0.0)
    for one in found:
        other = one.to_dict()["sweeps"][0]["mirror_solution"]
        assert (other is None) == one.findings.mirror.decided
        if other is not None:
            assert one.factors["Vy_over_Ay"].value * other["parameters"]["Vy_over_Ay"]["value"] < 0.0
            # Which of the two comes first is no matter of chance.
            assert other["output"] == -1


@pytest.mark.parametrize("output", [1, -1])
def test_channels_decide(output: int) -> None:
    found = diagnose_many(sweeps(0.0, output=output, channels=True))
    assert all(one.findings.fit.senses.output == output and one.findings.mirror.by == "channels" for one in found)
    assert not any(map(wrong, found))


@pytest.mark.parametrize("output", [1, -1])
def test_a_twin_and_the_user_decide(output: int) -> None:
    given = sweeps(0.0, output=output)
    for by, known in (("twin", {"twin": Chain(output_sense=output)}), ("option", {"output_sense": output})):
        found = diagnose_many(given, **known)  # type: ignore[arg-type]
        assert all(one.findings.mirror.by == by and one.findings.mirror.other is None for one in found)
        assert not any(map(wrong, found))
    with pytest.raises(UserError, match="output_sense is 2; expected 1 or -1"):
        diagnose(given[0], output_sense=2)


def test_other_structure_of_order_3_does_not_decide() -> None:
    """A twin without a quadratic term, and errors of 0.05 deg in the orders 3 to 6 of something else."""
    rng = np.random.default_rng(1)
    shaft = turn(360)
    made = []
    for _ in range(24):
        other = sum(np.radians(0.05) * np.cos(k * shaft + rng.uniform(0.0, TAU)) for k in (3, 4, 5, 6))
        made.append(measured(point(0.0), shaft, noise=other + NOISE_RAD * rng.standard_normal(shaft.size)))
    fits = fit_equal(np.tile(shaft, (24, 1)), np.array(made), rng=rng)
    # Against the scatter of the readings alone half of them would be decided, and half of those wrong.
    assert sum(fit.senses.sigma > 4.0 for fit in fits) > 6
    assert not any(judged(fit, shaft, counted=fit, covered_deg=360.0).decided for fit in fits)


def test_repeated_readings_count_once() -> None:
    """Sixteen angles, each read a hundred times with an error of its own: how often they were read decides nothing."""
    rng = np.random.default_rng(2)
    shaft = np.repeat(turn(16), 100)
    made = []
    for _ in range(24):
        own = np.repeat(NOISE_RAD * rng.standard_normal(16), 100)
        read = measured(point(0.0), shaft, noise=own + 0.1 * NOISE_RAD * rng.standard_normal(shaft.size))
        made.append(Sweep.from_columns({"reference_deg": np.degrees(shaft), "measured_deg": np.degrees(read)}))
    found = diagnose_many(made)
    assert sum(one.findings.fit.senses.sigma > 4.0 for one in found) > 6
    assert not any(one.findings.mirror.decided for one in found)


def test_both_solutions_are_printed_with_what_each_would_mean() -> None:
    sensor = Chain().with_effect("offset", y_percent=-0.5).with_effect("gain_mismatch", ratio=1.01)
    sensor = sensor.with_effect("phase", beta_deg=0.4).with_effect("noise", rms_deg=0.02)
    found = diagnose(sensor.simulate(Motion.from_angle(TAU * np.arange(360) / 360), seed=1))
    shown = " ".join(found.summary(100).split())
    one, other = found.to_dict()["sweeps"][0], found.to_dict()["sweeps"][0]["mirror_solution"]
    assert "as well, with s = -1, h = -1:" in shown
    assert "s = +1, h = +1 or s = -1, h = -1: these readings do not tell" in shown
    assert shown.count("would look the same") == 2
    assert other["mechanical"]["stray_y_mT"] == pytest.approx(-one["mechanical"]["stray_y_mT"], abs=0.02)
    assert "--output-sense" in shown
    alone = diagnose(found.sweep, output_sense=1)
    assert "as well" not in alone.summary()
    assert alone.to_dict()["sweeps"][0]["mirror_solution"] is None
