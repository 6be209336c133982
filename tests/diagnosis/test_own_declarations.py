"""An effect of one's own works with every task by its declarations alone: no file of the program knows its name."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from diagnosis import explain
from scenarios.bench.hall_node import check_playable
from scenarios.commands.protocol import Protocol
from scenarios.studies.design.field import scaled_values
from scenarios.studies.training.draw import Ranges, draw, drawable, uniforms_needed
from twin.angles import Array, wrap
from twin.catalogue import CATALOGUE, in_order
from twin.chain import Chain
from twin.contract import check
from twin.effect import BoolArray, Effect, Marks, Param, Parameters
from twin.errors import UserError
from twin.hall.offset import add
from twin.magnet.assembly import Assembly
from twin.magnet.placement import Placement
from twin.motion import Motion

AHEAD_RAD = 0.5


def replaced(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    """Words that are ahead by a fixed angle."""
    if rng is None:
        return signal
    hit = rng.random(signal.shape) < 0.01 * np.asarray(values["share_percent"])
    return np.where(hit, signal + AHEAD_RAD, signal)


def find_ahead(measured: Array, residual: Array, noise: float, step: float, motion: Motion) -> tuple[BoolArray, float]:
    """Rows that are ahead by the angle within the noise; each by a chance of one in a thousand."""
    mask = np.abs(wrap(residual - AHEAD_RAD)) < 10.0 * noise
    return mask, float(np.count_nonzero(mask)) * float(np.log(1e-3))


def told(touched: int, readings: int) -> Mapping[str, tuple[float, float]]:
    share = touched / readings
    return {"share_percent": (100.0 * share, 100.0 * float(np.sqrt(share * (1.0 - share) / readings)))}


WORDS_AHEAD = Effect(
    name="words_ahead",
    stage="link",
    acts_on="angle",
    params={"share_percent": Param(unit="%", null=0.0, lower=0.0, upper=99.0, doc="of the words", role="random")},
    forward=replaced,
    footprint="sequence",
    marks=Marks(find=find_ahead, told=told, rows_listed=True),
    source="drawing of the link",
    signature="readings ahead by one angle",
)


def added(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    """A voltage in the channel y that grows over the record."""
    share = (motion.time_s - motion.time_s[0]) / max(float(np.ptp(motion.time_s)), 1e-9)
    return add(signal, 0.0, 0.01 * np.asarray(values["y_percent"]) * share)


CREEP = Effect(
    name="offset_creep",
    stage="hall",
    acts_on="channels",
    params={
        "y_percent": Param(
            unit="%",
            null=0.0,
            lower=-5.0,
            upper=5.0,
            doc="at the end",
            typical=0.3,
            allowed=(0.0, 5.0),
            field_power=-1.0,
            mirror=-1,
        )
    },
    forward=added,
    needs=frozenset({"time_s"}),
    record_wide=True,
    source="drawing of the front-end",
    signature="order 1 times the time",
)
EFFECTS = in_order((*CATALOGUE, CREEP, WORDS_AHEAD))


@pytest.mark.parametrize("effect", [CREEP, WORDS_AHEAD], ids=lambda effect: effect.name)
def test_they_keep_the_contract(effect: Effect) -> None:
    assert [result for result in check(effect) if result.kept is False] == []


def test_single_readings_of_ones_own_cause_are_named_and_counted() -> None:
    motion = Protocol(turns=2, points=360, channels=False).motion()
    chain = Chain(effects=EFFECTS).with_effect("noise", rms_deg=0.02).with_effect("words_ahead", share_percent=2.0)
    sweep = chain.simulate(motion, seed=4)
    ahead = wrap(np.radians(sweep.measured_deg - sweep.reference_deg) - AHEAD_RAD)
    hit = np.flatnonzero(np.abs(ahead) < 0.1)
    (cause,) = explain(sweep, effects=WORDS_AHEAD).to_dict()["causes"]
    assert cause["name"] == "words_ahead"
    assert cause["rows"] == sweep.numbers[hit].tolist()
    share = cause["parameters"]["share_percent"]
    assert share["value"] == pytest.approx(100.0 * hit.size / len(sweep))
    assert share["low"] < 2.0 < share["high"]


def test_the_mirror_the_field_the_bench_and_the_draw_ask_the_effect() -> None:
    chain = Chain(effects=EFFECTS, magnet=Assembly()).with_effect("offset_creep", y_percent=0.4)
    assert chain.mirrored().values["offset_creep"] == {"y_percent": -0.4}
    farther = Assembly(placement=Placement(air_gap_mm=3.0))
    ratio = farther.nominal_mT / Assembly().nominal_mT
    assert scaled_values(chain, farther)["offset_creep"]["y_percent"] == pytest.approx(0.4 / ratio)
    with pytest.raises(UserError, match="offset_creep: is defined over a whole record"):
        check_playable(chain)
    motion = Protocol(turns=1, points=90).motion()
    causes = drawable(motion, EFFECTS)
    assert {"offset_creep", "words_ahead"} <= set(causes)
    uniforms = np.random.default_rng(0).random((64, uniforms_needed(causes)))
    drawn = draw(uniforms, chain, causes, motion, Ranges(most=len(causes)))
    acting = drawn.labels[:, causes.index("offset_creep")]
    # Its typical size makes a tenth of a degree, and physics allows one sign.
    strength = drawn.strength_deg[acting, causes.index("offset_creep")]
    np.testing.assert_allclose(drawn.values["offset_creep"]["y_percent"][acting], strength / 0.1 * 0.3)
