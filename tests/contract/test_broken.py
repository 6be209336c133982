"""Each promise can be broken: an effect for each that breaks it, and what is then said."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from twin.angles import Array
from twin.contract import check
from twin.effect import Effect, Forward, Line, Marks, Param, Parameters
from twin.example import Example
from twin.motion import Motion

STRENGTH = Param(unit="deg", null=0.0, lower=-9.0, upper=9.0, doc="amplitude")
SHAPE = Param(unit="1/turn", null=5.0, lower=1.0, upper=9.0, doc="order", role="shape")


def sound(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal + np.radians(values["amplitude_deg"]) * np.sin(5.0 * motion.shaft_rad)


SOUND = Effect(
    name="belt_splice",
    stage="mechanics",
    acts_on="shaft",
    params={"amplitude_deg": STRENGTH, "order": SHAPE},
    forward=sound,
    shapes=lambda motion: [{"order": 5.0}],
    needs=frozenset({"one turn"}),
    source="drawing of the belt",
    signature="order 5",
)


def acting(change: Any) -> Forward:
    """A forward function from (signal, motion, amplitude [rad], generator) -> what it returns."""

    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        result: Array = change(signal, motion, np.radians(np.asarray(values["amplitude_deg"])), rng)
        return result

    return forward


def in_place(signal: Array, motion: Motion, size: Array, rng: object) -> Array:
    signal += size
    return signal


DRAWN = np.random.default_rng(0)
BROKEN: Mapping[str, tuple[str, dict[str, Any]]] = {
    "name in capitals": ("lower-case words", {"name": "Belt"}),
    "unknown stage": ("stage is 'belt'; expected one of mechanics", {"stage": "belt"}),
    "unknown signal": ("acts_on is 'belt'", {"acts_on": "belt"}),
    "unknown footprint": ("footprint is 'belt'", {"footprint": "belt"}),
    "no source": ("source is ''", {"source": ""}),
    "no signature": ("signature is ' '", {"signature": " "}),
    "unknown need": ("needs 'a belt', which no sweep provides", {"needs": frozenset({"one turn", "a belt"})}),
    "no strength": ("has no strength", {"params": {"order": SHAPE}}),
    "no unit": ("amplitude_deg has no unit", {"params": {"amplitude_deg": replace(STRENGTH, unit="")}}),
    "no doc": ("amplitude_deg has no doc", {"params": {"amplitude_deg": replace(STRENGTH, doc=" ")}}),
    "unknown role": (
        "order: role is 'x'",
        {"params": {"amplitude_deg": STRENGTH, "order": replace(SHAPE, role="x")}},  # type: ignore[arg-type]
    ),
    "infinite range": ("must be finite", {"params": {"amplitude_deg": replace(STRENGTH, upper=np.inf)}}),
    "numbered parameter": ("'size_2'", {"params": {"amplitude_deg": STRENGTH, "size_2": STRENGTH}}),
    "fits what is not there": ("name 'width_deg', which is no parameter", {"fitted_shapes": ("width_deg",)}),
    "line without a phase": (
        "a line but not one parameter of role 'phase'",
        {"line": Line(param="order", clock="shaft", limits=lambda m: (1, 9), within=lambda o: o > 0)},
    ),
    "spread that says nothing": ("footprint 'spread' needs `spread`", {"footprint": "spread"}),
    "values that say nothing": ("footprint 'values' needs `attainable`", {"footprint": "values"}),
    "shape out of range": ("shapes holds order = 99", {"shapes": lambda motion: [{"order": 99.0}]}),
    "shape that is none": ("shapes holds 'width'", {"shapes": lambda motion: [{"width": 1.0}]}),
    "acts at its null": ("with every strength at its null", {"forward": acting(lambda s, m, a, r: s + 1e-9)}),
    "other shape": ("array of shape (1920,)", {"forward": acting(lambda s, m, a, r: s[0] + a if np.any(a) else s)}),
    "not finite": ("not finite", {"forward": acting(lambda s, m, a, r: s + a / np.where(a == 0.0, 1.0, 0.0))}),
    "noise of its own": (
        "called again with the same seed",
        {"forward": acting(lambda s, m, a, r: s + a * DRAWN.standard_normal(s.shape))},
    ),
    "changes what it is given": ("changes the array it is given", {"forward": acting(in_place)}),
    "does nothing": ("does nothing at its typical size", {"forward": acting(lambda s, m, a, r: s + 0.0)}),
    "hidden randomness": (
        "give the size of what is random the role 'random'",
        {"forward": acting(lambda s, m, a, r: s + a * (1.0 + (0.0 if r is None else r.standard_normal())))},
    ),
    "random without a draw": (
        "sweeps of different seeds are the same",
        {"params": {**SOUND.params, "rms_deg": replace(STRENGTH, role="random")}},
    ),
    "no batch": ("one call each", {"forward": acting(lambda s, m, a, r: s + a if np.ndim(a) == 0 else s)}),
    "bent": ("half the strengths do 0.25 of the error", {"forward": acting(lambda s, m, a, r: s + 50.0 * a * a)}),
    "mirror that is none": ("mirror is 2", {"params": {"amplitude_deg": replace(STRENGTH, mirror=2)}}),  # type: ignore[arg-type]
    "told by nothing known": (
        "told_by is",
        {"params": {"amplitude_deg": STRENGTH, "share": replace(SHAPE, detail=True, told_by=frozenset({"Vx"}))}},
    ),
    "nobody's": ("owner is 'me'", {"params": {"amplitude_deg": replace(STRENGTH, owner="me")}}),  # type: ignore[arg-type]
    "allows what is out of range": (
        "amplitude_deg: allowed is (0.0, 99.0)",
        {"params": {"amplitude_deg": replace(STRENGTH, allowed=(0.0, 99.0))}},
    ),
    "infinite power of the field": (
        "field_power and scatter must be finite",
        {"params": {"amplitude_deg": replace(STRENGTH, field_power=np.inf)}},
    ),
    "multiples that are none": (
        "line.multiples are (1, 2)",
        {
            "line": Line(
                param="order", clock="channels", limits=lambda m: (1, 9), within=lambda o: o > 0, multiples=(1, 2)
            )
        },
    ),
    "grid without angles": ("output_grid needs `attainable`", {"output_grid": True}),
    "words for nothing": ("words name 'width_deg'", {"words": "{amplitude_deg} deg, {width_deg:4} deg wide"}),
    "tells of nothing": (
        "marks.told tells of 'count'",
        {"marks": Marks(find=lambda *_, **__: (np.zeros(1, bool), 0.0), told=lambda touched, n: {"count": (1.0, 0.0)})},
    ),
    "changes sign in the mirror": (
        "reads otherwise by 0.2 deg when both sides count the other way; declare mirror=-1 for amplitude_deg",
        {"acts_on": "angle", "stage": "link", "params": {**SOUND.params, "amplitude_deg": replace(STRENGTH, mirror=1)}},
    ),
    "has no mirror": (
        "or mirror=0 for what no value sets right",
        {"acts_on": "channels", "forward": acting(lambda s, m, a, r: s + a * s**2)},
    ),
    "needs no mirror": (
        "declares mirror=0 although it reads the same",
        {"params": {**SOUND.params, "amplitude_deg": replace(STRENGTH, mirror=0)}},
    ),
    "foresees": (
        "depends on those to come; declare record_wide=True",
        {"forward": acting(lambda s, m, a, r: s + a * m.time_s / m.time_s[-1])},
    ),
    "foresees nothing": ("declares record_wide although", {"record_wide": True}),
    "draws what is not there": ("draws 'width_deg'", {"drawing": lambda s, u, m: {"width_deg": s}}),
    "draws out of range": (
        "draws amplitude_deg outside [-9, 9]",
        {"drawing": lambda s, u, m: {"amplitude_deg": 99 * s}},
    ),
    "draws one for all": ("of shape (); expected (16,)", {"drawing": lambda s, u, m: {"amplitude_deg": np.array(1.0)}}),
    "draws nothing": ("is drawn at its null", {"drawing": lambda s, u, m: {"amplitude_deg": 0.0 * s}}),
    "raises": ("raises ZeroDivisionError", {"forward": acting(lambda s, m, a, r: s + 1 / 0 if np.any(a) else s)}),
}


def test_a_sound_one_keeps_them_all() -> None:
    assert [result.said for result in check(SOUND) if result.kept is False] == []


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_promise_is_said(case: str) -> None:
    said, changes = BROKEN[case]
    broken = [result.said for result in check(replace(SOUND, **changes)) if result.kept is False]
    assert broken
    assert said in broken[0]


def test_a_memory_that_is_denied_is_seen() -> None:
    remembers = replace(SOUND, forward=acting(lambda s, m, a, r: s + a * np.sign(np.gradient(m.shaft_rad))))
    forgets = Example(strengths={"amplitude_deg": 0.1}, shapes={"order": 5.0})
    broken = {result.promise: result.said for result in check(remembers, example=forgets) if result.kept is False}
    assert broken == {
        "does not care for the order of the readings": "acts otherwise when the readings come in another order"
    }
