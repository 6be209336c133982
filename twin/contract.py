"""What every effect promises. The tests check it for the catalogue, the commands for an effect of the user's own."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from twin import drawing
from twin.angles import Array, wrap
from twin.catalogue import in_order
from twin.chain import Chain
from twin.declaration import undeclared
from twin.effect import Effect, Param, Role
from twin.example import Example, example_of, full_motion, permuted, signal_for
from twin.motion import Motion
from twin.shown import shown, shown_error
from twin.surroundings import StreamTakenError, streams_kept

ROUNDING_RAD = 1e-12
"""Rounding that is allowed: a double near 4 pi carries about 1e-15, a few operations and the arctangent add to it."""
_OFF_AXIS_RAD = 0.01234
_TWO = frozenset({"two mountings"})
_SMOOTH: tuple[Role, ...] = ("strength", "level")


@dataclass(frozen=True)
class Promise:
    """One promise.

    ``broken`` returns in words what is wrong, or "" where the promise is kept; ``unasked`` returns why the promise does
    not apply to an effect, or "" where it does. An effect that breaks a promise which is not ``binding`` is loaded all
    the same: it acts as it should, and only what is declared about it is missing or wrong.
    """

    name: str
    broken: Callable[[Effect, Example, Motion], str]
    unasked: Callable[[Effect, Example], str] = lambda effect, case: ""
    binding: bool = True


@dataclass(frozen=True)
class Result:
    """Whether an effect keeps one promise; ``kept`` is None where the promise does not apply.

    ``said`` is what is wrong, or why the promise does not apply.
    """

    promise: str
    kept: bool | None
    said: str = ""
    binding: bool = True


def check(effect: Effect, *, example: Example | None = None, motion: Motion | None = None) -> Iterator[Result]:
    """Check every promise in turn; an exception in the effect's own code breaks the promise that was being checked."""
    motion = motion or full_motion()
    said = _asked(undeclared, effect)
    yield Result("is declared and documented", not said, said)
    if said:
        return
    cases = [] if example is None else [example]

    def by_declaration() -> str:
        cases.append(example_of(effect, motion))
        return ""

    said = "" if cases else _asked(by_declaration)
    if said:
        yield Result("has a grid of shapes", False, said)
        return
    for promise in PROMISES:
        unasked = promise.unasked(effect, cases[0])
        if unasked:
            yield Result(promise.name, None, unasked)
            continue
        said = _asked(promise.broken, effect, cases[0], motion)
        yield Result(promise.name, not said, said, promise.binding)


def _asked(question: Callable[..., str], *given: Any) -> str:
    """The answer to a question, or that the effect's code raised an exception; an exit is one too."""
    try:
        with streams_kept(), np.errstate(all="ignore"):
            return question(*given)
    except KeyboardInterrupt:
        raise
    except StreamTakenError as error:
        return f"behind its code {error}"
    except BaseException as error:
        return f"its code raises {shown_error(error)}"


# ---- what it does -----------------------------------------------------------------------------------------------


def _chain(effect: Effect, **params: Any) -> Chain:
    return Chain(effects=in_order((effect,))).with_effect(effect.name, **params)


def _error(effect: Effect, motion: Motion, **params: Any) -> Array:
    return _chain(effect, **params).error(motion)


def _not_null(effect: Effect, case: Example, motion: Motion) -> str:
    signal = signal_for(effect, motion)
    values = {**effect.null(), **case.shapes}
    for tried, rng in itertools.product((effect.null(), values), (None, np.random.default_rng(1))):
        moved = np.asarray(effect.forward(signal, motion, tried, rng))
        if moved.shape != signal.shape or not np.array_equal(moved, signal):
            return "with every strength at its null it still changes the signal; expected the very same numbers"
    if np.max(np.abs(_error(effect, motion, **values))) > ROUNDING_RAD:
        return "at its null the chain does not return the true angle"
    return ""


def _misshapen(effect: Effect, case: Example, motion: Motion) -> str:
    signal = signal_for(effect, motion)
    kept = signal.copy()
    values = {**effect.null(), **case.params}
    first, second = (np.asarray(effect.forward(signal, motion, values, np.random.default_rng(5))) for _ in range(2))
    if first.shape != signal.shape:
        return f"returns an array of shape {first.shape} for a signal of shape {signal.shape}; expected the same"
    if not np.isfinite(first).all():
        return f"returns {np.count_nonzero(~np.isfinite(first))} values that are not finite"
    if first.tobytes() != second.tobytes():
        return "gives another result when called again with the same seed; draw from `rng` only"
    if not np.array_equal(signal, kept):
        return "changes the array it is given; return a new one"
    return "does nothing at its typical size" if np.array_equal(first, signal) else ""


def _unseeded(effect: Effect, case: Example, motion: Motion) -> str:
    chain = _chain(effect, **case.params)
    one, two, other = (chain.simulate(motion, seed=seed) for seed in (3, 3, 4))
    if any(values.tobytes() != two.columns[name].tobytes() for name, values in one.columns.items()):
        return "two sweeps of one seed differ; draw from `rng` only"
    same = all(np.array_equal(values, other.columns[name]) for name, values in one.columns.items())
    # The baseline's rounding is the one "random" role that draws no numbers.
    if same == bool(effect.roles("random")) and not effect.baseline:
        return (
            "has a parameter of role 'random' but sweeps of different seeds are the same"
            if same
            else "draws random numbers; give the size of what is random the role 'random'"
        )
    return ""


def _batch_apart(effect: Effect, case: Example, motion: Motion) -> str:
    smooth = [name for name in case.strengths if effect.params[name].role in _SMOOTH]
    members = [case.scaled(factor, effect.null()) for factor in (1.0, 0.5, 0.25)]
    for name in smooth:
        if effect.params[name].counts:
            members = [{**member, name: round(member[name]) + 1.0} for member in members]
    batch = {name: np.array([member[name] for member in members]) for name in smooth}
    rest = {name: value for name, value in case.params.items() if name not in batch}
    together = _error(effect, motion, **{**rest, **batch})
    alone = np.stack([_error(effect, motion, **{**rest, **{k: member[k] for k in batch}}) for member in members])
    if together.shape != alone.shape or not np.allclose(together, alone, rtol=0.0, atol=ROUNDING_RAD):
        return (
            "parameters of shape (batch, 1, 1) do not give what one call each gives; "
            "use np.asarray, and no `if` on values"
        )
    return ""


def _bent(effect: Effect, case: Example, motion: Motion) -> str:
    sizes = [float(np.sqrt(np.mean(_error(effect, motion, **case.scaled(f, effect.null())) ** 2))) for f in (1.0, 0.5)]
    if sizes[0] <= ROUNDING_RAD:
        return "changes the angle by nothing at its typical size"
    if abs(sizes[0] / max(sizes[1], 1e-300) / 2.0**case.power - 1.0) > 0.15:
        return (
            f"half the strengths do {sizes[1] / sizes[0]:.2f} of the error, not half; "
            "give another parameter, or the role 'level'"
        )
    return ""


def _unordered(effect: Effect, case: Example, motion: Motion) -> str:
    # The first and the last reading keep their places: they set the clock's zero and the record's middle.
    order = np.arange(len(motion))
    order[1:-1] = np.random.default_rng(2).permutation(order[1:-1])
    chain = _chain(effect, **case.params)
    off = wrap(chain.error(permuted(motion, order)) - chain.error(motion)[order])
    return "acts otherwise when the readings come in another order" if np.max(np.abs(off)) > ROUNDING_RAD else ""


def _boundless(effect: Effect, case: Example, motion: Motion) -> str:
    for name, param in effect.params.items():
        for wrong in (param.upper + 1.0 + abs(param.upper), float("nan")):
            try:
                _chain(effect, **{name: wrong})
            except ValueError:
                continue
            return f"{name} = {wrong:g} is accepted"
    return ""


def _lost_shapes(effect: Effect, case: Example, motion: Motion) -> str:
    for shape in effect.shapes(motion):
        for name, value in shape.items():
            param = effect.params.get(name)
            if param is None or param.role not in ("shape", "level"):
                return f"shapes holds {shown(name)}, which is no parameter of role 'shape' or 'level'"
            if not param.lower <= value <= param.upper:
                return f"shapes holds {name} = {value:g}, outside [{param.lower:g}, {param.upper:g}]"
    return ""


def _misread_in_the_mirror(effect: Effect, case: Example, motion: Motion) -> str:
    # Off the axes: on them an angle lies on the edge of quantisers, and falls to either side by rounding.
    motion = replace(motion, shaft_rad=motion.shaft_rad + _OFF_AXIS_RAD)
    worst = max(_mirror_error(effect, case, motion, *senses) for senses in itertools.product((1, -1), (1, -1)))
    if not effect.mirrors:
        return "declares mirror=0 although it reads the same counted the other way" if worst <= ROUNDING_RAD else ""
    if worst <= ROUNDING_RAD:
        return ""
    turned = [name for name, param in effect.params.items() if _turned_fits(effect, case, motion, name, param)]
    cure = f"declare mirror={-effect.mirror(turned[0])} for {turned[0]}" if turned else _NO_MIRROR
    return f"reads otherwise by {np.degrees(worst):.2g} deg when both sides count the other way; {cure}"


_NO_MIRROR = "declare mirror=-1 for what then changes sign, or mirror=0 for what no value sets right"


def _turned_fits(effect: Effect, case: Example, motion: Motion, name: str, param: Param) -> bool:
    other: Any = -effect.mirror(name)
    params = {**effect.params, name: replace(param, mirror=other)}
    return _mirror_error(replace(effect, params=params), case, motion, 1, 1) <= ROUNDING_RAD


def _mirror_error(effect: Effect, case: Example, motion: Motion, sensor: int, output: int) -> float:
    """Largest difference [rad] between the readings of a chain and of the one that counts the other way."""
    chain = replace(_chain(effect, **case.params), sensor_sense=sensor, output_sense=output)
    return float(np.max(np.abs(wrap(chain.readings(motion) - chain.mirrored().readings(motion)))))


def _foresees(effect: Effect, case: Example, motion: Motion) -> str:
    values = {**effect.null(), **case.params}
    # So early that neither the fastest nor the warmest reading has come.
    first = np.arange(len(motion) // 4)
    whole = effect.forward(signal_for(effect, motion), motion, values, None)[..., first]
    begun = motion.part(first)
    same = np.max(np.abs(effect.forward(signal_for(effect, begun), begun, values, None) - whole)) <= ROUNDING_RAD
    if same == effect.record_wide:
        return (
            "declares record_wide although no reading depends on those to come"
            if same
            else "what it does to a reading depends on those to come; declare record_wide=True"
        )
    return ""


def _drawn_astray(effect: Effect, case: Example, motion: Motion) -> str:
    strength = np.geomspace(0.02, 0.3, 16)
    drawn = drawing.drawn(effect, strength, np.random.default_rng(4).random((strength.size, 4)), motion)
    for name, values in drawn.items():
        param = effect.params.get(name)
        if param is None:
            return f"draws {shown(name)}, which is no parameter"
        array = np.asarray(values)
        if array.shape != strength.shape:
            return f"draws {name} of shape {array.shape}; expected {strength.shape}, one value a sweep"
        lowest, highest = param.allowed or (param.lower, param.upper)
        if not np.all((array >= lowest) & (array <= highest)):
            return f"draws {name} outside [{lowest:g}, {highest:g}]"
    if all(np.any(effect.params[name].null == values) for name, values in drawn.items() if _acts(effect, name)):
        return "is drawn at its null; give a `drawing`"
    return ""


def _acts(effect: Effect, name: str) -> bool:
    return effect.params[name].role in (*_SMOOTH, "random")


def _not_drawn(effect: Effect, case: Example) -> str:
    # What only two recordings show is no label of one sweep.
    return "is no cause of a training sweep" if effect.baseline or effect.kind or _TWO & effect.needs else ""


def _only_random(effect: Effect, case: Example) -> str:
    smooth = any(effect.params[name].role in _SMOOTH for name in case.strengths)
    return "" if smooth else "acts at random, or in each turn on its own"


def _no_strength(effect: Effect, case: Example) -> str:
    plain = any(effect.params[name].role == "strength" for name in case.strengths)
    return "" if plain else "has no parameter of role 'strength'"


def _memory(effect: Effect, case: Example) -> str:
    return "may have a memory" if case.memory else _only_random(effect, case)


PROMISES = (
    Promise("has a grid of shapes within range", _lost_shapes),
    Promise("vanishes exactly at its null", _not_null),
    Promise("keeps the shape, stays finite, repeats", _misshapen),
    Promise("same seed, same sweep", _unseeded),
    Promise("a batch gives what a loop gives", _batch_apart, _only_random),
    Promise("half the strength, half the error", _bent, _no_strength),
    Promise("does not care for the order of the readings", _unordered, _memory),
    Promise("refuses what is out of range", _boundless),
    Promise("reads the same counted the other way", _misread_in_the_mirror, _only_random, binding=False),
    Promise("says whether it needs the whole record", _foresees, _only_random, binding=False),
    Promise("is drawn within its range", _drawn_astray, _not_drawn, binding=False),
)
