"""Several air gaps: each cause has its law over the magnet's own field, held against magpylib's field."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import Mounting, diagnose, diagnose_many
from diagnosis.error_model.model import QUAD
from diagnosis.factors.air_gaps import AirGaps, quadratic_law
from diagnosis.factors.displacement import MEASURED, upright_product
from diagnosis.factors.gap_model import ROWS, GapSweep, causes_of, expected
from diagnosis.factors.gap_sets import joined
from diagnosis.factors.gap_words import sentences
from diagnosis.report.gap_answer import gap_answer
from tests.diagnosis.factors.gap_study import asked, of_twin
from tests.diagnosis.factors.gap_sweeps import CASES, OPEN, Truth
from twin.angles import wrap_deg
from twin.errors import UserError
from twin.magnet.magnet import Magnet


def joint(
    truth: Truth,
    gaps_mm: tuple[float, ...],
    mounting: Mounting,
    *,
    seed: int = 0,
    noise_deg: float = 0.02,
    channels: bool = True,
) -> AirGaps:
    rng = np.random.default_rng(seed)
    sweeps = [truth.sweep(gap, rng, noise_deg=noise_deg, channels=channels) for gap in gaps_mm]
    found = diagnose_many(sweeps, output_sense=1, mounting=mounting).air_gap_fit
    assert found is not None
    return found


RAD = np.radians(1.0)
EVERYTHING = replace(CASES["sensor, magnet and electronics"][0], tilt=1.5 - 1.0j, magnet_tilt=-1.0 + 2.0j)
ON_AXIS = Truth(tilt=2.0 - 1.0j, magnet=0.2 + 0.1j, magnet_tilt=1.5 + 1.0j)


@pytest.mark.parametrize(
    ("truth", "values"),
    [
        (
            EVERYTHING,
            {
                "voltage": EVERYTHING.voltage,
                "electronics": complex(EVERYTHING.gain - 1.0, EVERYTHING.beta),
                "sensor": EVERYTHING.sensor**2,
                "magnet": EVERYTHING.sensor * EVERYTHING.magnet,
                "tilt": EVERYTHING.sensor * EVERYTHING.tilt * RAD,
                "magnet_tilt": EVERYTHING.sensor * EVERYTHING.magnet_tilt * RAD,
            },
        ),
        (
            ON_AXIS,
            {
                # A tilt t shortens the field by t^2/2 along itself: a share of -t^2/4 that runs against it.
                "electronics": (ON_AXIS.tilt * RAD).conjugate() ** 2 / 2.0,
                "tilt_and_magnet": ON_AXIS.tilt * RAD * ON_AXIS.magnet.real,
                "both_tilts": ON_AXIS.tilt * RAD * ON_AXIS.magnet_tilt.real * RAD,
            },
        ),
    ],
    ids=["off the axis", "on the axis"],
)
def test_expected_factors_are_those_of_magpylibs_field(truth: Truth, values: dict[str, complex]) -> None:
    """Displacements, tilts, electronics and a voltage together, nearly without noise.

    Offsets and shares are of some per cent, and what the fit neglects is of their third order: 2e-5.
    """
    rng = np.random.default_rng(0)
    gaps = np.array([1.0, 2.0, 3.0])
    made = [truth.sweep(gap, rng, noise_deg=1e-6, channels=False) for gap in gaps]
    found = [diagnose(columns, output_sense=1).findings for columns in made]
    sweeps = [GapSweep.of(one.fit, np.radians(one.sweep.reference_deg)) for one in found]
    numbers = np.array([[part for name in values for part in (values[name].real, values[name].imag)]])
    told = expected(sweeps, Magnet(), causes_of(tuple(values), numbers), gaps[None])
    np.testing.assert_allclose(told.factors[0], [sweep.point[list(ROWS)] for sweep in sweeps], atol=2e-5)
    # Truth has no quadratic term: what is fitted as one is the field's own order 3.
    np.testing.assert_allclose(told.quad[0], [sweep.point[QUAD] for sweep in sweeps], atol=2e-5)


@pytest.mark.parametrize("name", CASES)
def test_causes_are_named_and_displacements_come_back(name: str) -> None:
    """Gaps stated to 0.05 mm. Twice 1.96 standard errors: one draw of each case, of which one in twenty is farther."""
    truth, causes = CASES[name]
    found = asked(truth, 3, channels=True)
    assert found is not None
    assert not found.misfit
    left = causes - set(found.named)
    assert set(found.named) <= causes
    assert not left or (len(found.order_2) > 1 and left <= OPEN)
    for name in MEASURED:
        displacement, true = found.displaced(name), getattr(truth, name)
        if displacement is not None:
            half = 0.5 * (displacement.high - displacement.low)
            assert abs(displacement.value - abs(true)) < 2.0 * half
    bounds = [found.magnet_bound(name) for name in ("magnet", "magnet_tilt")]
    wanted = "sensor" in causes and not {"magnet", "magnet_tilt"} & causes
    assert [bound is not None for bound in bounds] == 2 * [wanted]
    if wanted and abs(truth.sensor) > 0.5:
        off_mm, tilted_deg = bounds
        assert off_mm is not None
        assert off_mm < 0.05
        assert tilted_deg is not None
        assert tilted_deg < 1.0
    # None of the cases has a quadratic term; off the axis the field itself has an order 3.
    assert found.quadratic.best == "none"


@pytest.mark.parametrize(
    ("name", "seed", "channels"),
    [
        ("sensor, a little", 7, True),
        ("sensor, magnet and electronics", 5, False),
        ("sensor and eccentric reference", 1, False),
    ],
)
def test_more_causes_never_fit_worse_than_some_of_them(name: str, seed: int, channels: bool) -> None:
    """A fit ends at its optimum, whose chi-squared a part of its causes cannot undercut. Its own tolerance is 1e-6."""
    if name in CASES:
        truth, causes_there = CASES[name]
        found = asked(truth, seed, channels=channels)
    else:
        truth, causes_there = Truth(sensor=0.6 + 0.3j, eccentric_rad=0.004), frozenset({"sensor", "reference"})
        gaps = (1.0, 2.0, 3.0)
        found = joint(truth, gaps, Mounting(air_gap_mm=gaps), seed=seed, channels=channels)
    assert found is not None
    assert not found.misfit
    if "reference" in causes_there:
        assert set(found.named) == causes_there
        # The magnet's displacement beside what is named: by the reference's share it would be 0.033 mm.
        held = found.fits[joined(("reference", "sensor", "magnet"), found.full_2)]
        bound, by_hand = found.magnet_bound("magnet"), MEASURED["magnet"](held)
        assert held.p > 1e-3
        assert by_hand is not None
        assert bound == by_hand.high
    for causes, fit in found.fits.items():
        assert all(fit.chi2 < part.chi2 + 1e-3 for some, part in found.fits.items() if set(some) < set(causes))
    assert {"sensor"} <= set(found.named) <= causes_there


def test_stated_gaps_do_without_channels() -> None:
    truth = Truth(sensor=0.5 - 0.2j)
    found = joint(truth, (1.0, 2.0, 3.0), Mounting(air_gap_mm=(1.0, 2.0, 3.0)), channels=False)
    assert found.named == ("sensor",)
    # Without channels one stated gap says nothing about the others.
    rng = np.random.default_rng(0)
    sweeps = [truth.sweep(gap, rng, channels=False) for gap in (1.0, 2.0)]
    assert diagnose_many(sweeps, output_sense=1, mounting=Mounting(air_gap_mm=(1.0,))).air_gap_fit is None
    with pytest.raises(UserError, match="found 3 air gaps for 2 sweeps"):
        diagnose_many(sweeps, mounting=Mounting(air_gap_mm=(1.0, 2.0, 3.0)))


def test_channels_that_an_automatic_gain_holds_at_one_size_gauge_no_gap() -> None:
    rng, gaps = np.random.default_rng(0), (1.0, 2.0, 3.0)
    sweeps = [Truth(sensor=0.5 - 0.2j).sweep(gap, rng, noise_deg=0.02) for gap in gaps]
    held = []
    for sweep in sweeps:
        size = float(np.mean(np.hypot(sweep["vx"], sweep["vy"])))
        held.append({**sweep, "vx": sweep["vx"] / size, "vy": sweep["vy"] / size})
    told = [
        diagnose_many(given, output_sense=1, mounting=Mounting(air_gap_mm=gaps)).air_gap_fit for given in (sweeps, held)
    ]
    assert [found.amplitudes_held for found in told if found is not None] == [False, True]
    found = told[1]
    assert found is not None
    assert found.named == ("sensor",)
    assert any("automatic gain" in words for words in sentences(found))
    displaced = found.displaced("sensor")
    assert displaced is not None
    assert displaced.low < abs(0.5 - 0.2j) < displaced.high


@pytest.mark.parametrize(
    ("askew", "magnet"),
    [(0.0, Magnet(diameter_mm=10.0, height_mm=3.0)), (0.1 - 0.1j, Magnet())],
    ids=["another magnet", "a stage that runs askew to the shaft"],
)
def test_what_nothing_explains_is_said_to_fit_nothing(askew: complex, magnet: Magnet) -> None:
    """``askew``: by how much further off the axis the sensor is at each millimetre of the gap [mm]."""
    rng, gaps = np.random.default_rng(0), (1.0, 2.0, 3.0, 4.0)
    sweeps = [Truth(sensor=0.6 + 0.3j + askew * gap).sweep(gap, rng) for gap in gaps]
    found = diagnose_many(sweeps, output_sense=1, mounting=Mounting(magnet=magnet, air_gap_mm=gaps[:1])).air_gap_fit
    assert found is not None
    assert found.misfit
    assert found.named == ()
    said = " ".join(sentences(found))
    assert f"chi^2 = {found.fullest.chi2:.0f} at {found.fullest.degrees_of_freedom} degrees of freedom" in said
    assert "no cause is named" in said
    assert "farthest off" in said or "would rather have" in said
    assert "off the shaft's axis" not in said


def test_a_fourth_gap_tells_a_tilt_beside_the_electronics() -> None:
    """Three causes of order 2 have a number for each of three gaps: they fit anything, and nothing is named."""
    truth = Truth(sensor=0.5 + 0.0j, tilt=4.0 + 3.0j, gain=1.01)
    three, four = (
        joint(truth, gaps, Mounting(air_gap_mm=gaps[:1]), noise_deg=0.01)
        for gaps in ((1.0, 2.0, 3.0), (0.7, 1.2, 2.0, 3.5))
    )
    assert three.unchecked
    assert three.named == ()
    assert "one more gap would tell" in " ".join(sentences(three))
    assert four.named == ("electronics", "sensor", "tilt")
    tilt, off = four.displaced("tilt"), four.displaced("sensor")
    assert tilt is not None
    assert off is not None
    assert tilt.value == pytest.approx(5.0, abs=tilt.high - tilt.low)
    assert off.value == pytest.approx(0.5, abs=off.high - off.low)
    assert "the sensor is tilted by" in " ".join(sentences(four))


@pytest.mark.parametrize("channels", [True, False])
def test_tilts_of_a_twin_come_back(channels: bool) -> None:
    """The twin's own field, and in the next test magpylib's: both are asked what the fit says of them."""
    gaps = (1.0, 2.0, 3.0)
    tilted = {"magnet_tilt_x_deg": 1.5, "magnet_tilt_y_deg": 2.0, "sensor_x_mm": 0.5, "sensor_y_mm": -0.4}
    found = of_twin(gaps, channels, **tilted)
    assert found.named == ("sensor", "magnet_tilt")
    lean, off = found.displaced("magnet_tilt"), found.displaced("sensor")
    assert lean is not None
    assert off is not None
    assert lean.value == pytest.approx(2.5, abs=lean.high - lean.low)
    assert off.value == pytest.approx(np.hypot(0.5, 0.4), abs=off.high - off.low)
    # A turn about x leans backwards along y. Sensor and magnet may both be the other way round.
    turned = 0.0 if abs(wrap_deg(off.direction_deg - np.degrees(np.arctan2(-0.4, 0.5)))) < 90.0 else 180.0
    away = wrap_deg(lean.direction_deg + turned - np.degrees(np.arctan2(-1.5, 2.0)))
    assert abs(away) < 2.0 * lean.direction_half_deg
    assert "the magnet is tilted by" in " ".join(sentences(found))


def test_a_tilt_of_the_sensor_alone_is_told_as_what_the_electronics_may_be() -> None:
    found = of_twin((1.0, 2.0, 3.0), True, sensor_tilt_x_deg=-3.0, sensor_tilt_y_deg=2.0)
    assert found.named == ("electronics",)
    tilt = found.tilt_alone
    assert tilt is not None
    assert tilt.value == pytest.approx(np.hypot(3.0, 2.0), abs=tilt.high - tilt.low)
    away = (tilt.direction_deg - np.degrees(np.arctan2(3.0, 2.0)) + 90.0) % 180.0 - 90.0
    assert abs(away) < 2.0 * tilt.direction_half_deg
    said = " ".join(sentences(found))
    assert "the electronics, or a sensor tilted by" in said
    assert "mounting the sensor anew parts the two" in said


@pytest.mark.parametrize("name", ["tilted on the axis, magnet off", "both tilted on the axis"])
def test_a_tilted_sensor_senses_the_upright_field(name: str) -> None:
    """The product of tilt and what is wrong with the magnet along its magnetisation lies within twice its interval."""
    truth = CASES[name][0]
    found = joint(truth, (1.0, 2.0, 3.0), Mounting(air_gap_mm=(1.0, 2.0, 3.0)))
    cause = "tilt_and_magnet" if truth.magnet else "both_tilts"
    product = upright_product(found.best, cause, magnet=Magnet())
    assert product is not None
    true = abs(truth.tilt) * abs((truth.magnet or truth.magnet_tilt).real)
    assert product.value == pytest.approx(true, abs=product.high - product.low)
    assert f"{product.value:.3g} {product.unit}" in " ".join(sentences(found))
    answer = gap_answer(found)
    assert (answer["tilt_times_displacement"] is None) != (answer["tilt_times_tilt"] is None)


def test_offsets_that_the_gaps_cannot_part_are_given_with_the_measurement_that_would() -> None:
    """Half a degree of a magnet's tilt makes an order 1 of 0.06 deg, whose change over these gaps is of their noise."""
    truth = Truth(sensor=0.4 + 0.2j, magnet_tilt=0.5 + 0.0j)
    narrow, wide = (2.4, 3.3), (0.7, 1.5, 2.4, 3.3)
    near = joint(truth, narrow, Mounting(air_gap_mm=narrow), noise_deg=0.1, channels=False)
    assert {("magnet_tilt",), ("magnet",), ("reference",)} <= set(near.order_1)
    assert near.named == ()
    said = " ".join(sentences(near))
    further = near.order_1_parting_mm
    assert "an eccentric reference" in said
    assert "a tilted magnet" in said
    assert "would tell the first two apart" in said
    assert further is None or f"these gaps cannot tell, a sweep at {further:.2g} mm would" in said
    told = joint(truth, wide, Mounting(air_gap_mm=wide), channels=False)
    assert told.named == ("sensor", "magnet_tilt")


def test_a_tilt_is_looked_for_where_narrow_gaps_hardly_tell_electronics_from_a_displacement() -> None:
    truth, gaps = Truth(sensor=0.4 + 0.2j, magnet_tilt=1.0 + 0.5j), (2.0, 2.5, 3.0)
    found = joint(truth, gaps, Mounting(air_gap_mm=gaps), noise_deg=0.05, channels=False)
    assert not found.fits.sees_sensor
    assert found.named == ("sensor", "magnet_tilt")


def test_a_stated_gap_that_the_readings_contradict_is_named() -> None:
    found = joint(Truth(sensor=0.6 + 0.3j), (1.0, 2.0, 3.0), Mounting(air_gap_mm=(1.6,)))
    assert found.misfit
    assert "mm instead of 1.60 mm" in " ".join(sentences(found))


def test_two_causes_that_the_gaps_cannot_part_are_given_together_with_the_gap_that_would() -> None:
    """Off the axis of this magnet the share of order 2 stands nearly still between 2.4 and 3.6 mm."""
    truth = Truth(sensor=0.25 + 0.1j)
    near = joint(truth, (2.4, 3.3), Mounting(air_gap_mm=(2.4,)), noise_deg=0.05)
    assert near.order_2 in ((("sensor",), ("electronics",)), (("electronics",), ("sensor",)))
    assert near.named == ()
    assert near.parting_mm is not None
    assert not 2.4 <= near.parting_mm <= 3.3
    assert f"a sweep at {near.parting_mm:.2g} mm would" in " ".join(sentences(near))
    wider = joint(truth, (2.4, 3.3, near.parting_mm), Mounting(air_gap_mm=(2.4,)), noise_deg=0.05)
    assert wider.named == ("sensor",)


def test_sweeps_that_decide_between_the_mirror_solutions_decide_for_the_others() -> None:
    """An output that counts backwards: with a quadratic term at the first gap only the others cannot tell."""
    rng = np.random.default_rng(0)
    made = []
    for gap, quad in ((1.0, 2e-5), (2.0, 0.0), (3.0, 0.0)):
        columns = Truth(sensor=0.6 + 0.3j, quad_per_mT=quad).sweep(gap, rng, channels=False)
        made.append({**columns, "measured_deg": -columns["measured_deg"]})
    found = diagnose_many(made, mounting=Mounting(air_gap_mm=(1.0, 2.0, 3.0)))
    assert [one.findings.mirror.decided for one in found] == [True, False, False]
    joint_fit = found.air_gap_fit
    assert joint_fit is not None
    assert joint_fit.named == ("sensor",)
    off = joint_fit.displaced("sensor")
    assert off is not None
    assert off.direction_deg == pytest.approx(np.degrees(np.angle(0.6 + 0.3j)), abs=3.0 * off.direction_half_deg)


def test_the_field_hardly_differs() -> None:
    rng = np.random.default_rng(0)
    sweeps = [Truth().sweep(gap, rng) for gap in (1.5, 1.55)]
    found = diagnose_many(sweeps, mounting=Mounting())
    assert found.air_gap_fit is None
    assert found.air_gaps == ()


@pytest.mark.parametrize(
    ("values", "best"),
    [
        ((0.0, 0.0, 0.0), "none"),
        ((0.002, 0.002, 0.002), "stays"),
        ((0.002, 0.0016, 0.0012), "grows with the field"),
        ((0.002, -0.002, 0.002), "none fits"),
    ],
)
def test_the_quadratic_term_has_a_law_or_none(values: tuple[float, ...], best: str) -> None:
    """A square term V = a B + b B^2 is a share that goes with the field."""
    field, error = np.array([1.0, 0.8, 0.6]), 1e-5
    law = quadratic_law(values, np.full(3, error), field)
    assert law.best == best
    if best == "grows with the field":
        off = np.array(values) - np.mean(values)
        assert law.change_sigma == pytest.approx(np.sqrt(np.sum(off**2)) / error, rel=1e-6)
        assert law.chi2 == pytest.approx(0.0, abs=1e-6)
