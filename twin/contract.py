"""What every effect promises. The tests check it for the catalogue, the commands for an effect of the user's own."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, get_args

import numpy as np

from twin.angles import TAU, Array, wrap
from twin.catalogue import STAGES, in_order
from twin.chain import Chain
from twin.effect import ActsOn, Effect, Footprint, Param, Role
from twin.motion import Motion

ROUNDING_RAD = 1e-12
"""Rounding that is allowed: a double near 4 pi carries about 1e-15, a few operations and the arctangent add to it."""
NEEDS = frozenset(
    {
        *("time_s", "direction", "speed_rpm", "turn", "temperature_c", "vx"),
        *("both directions", "two speeds", "moving shaft", "one turn", "several turns", "two temperatures"),
        *("two turns", "two air gaps"),
    }
)
"""What :attr:`twin.motion.Motion.provides` may hold, and two air gaps, which no single sweep provides."""
NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
"""Names of effects: lower-case words joined by underscores."""
_PHASE_DEG = 35.0
_ACTING: tuple[Role, ...] = ("strength", "level", "per turn", "random")
_SMOOTH: tuple[Role, ...] = ("strength", "level")


@dataclass(frozen=True, kw_only=True)
class Example:
    """Parameters at which an effect is checked: ``strengths`` make it vanish at their null, ``shapes`` are all others.

    ``memory``: what it does depends on the order of the readings. ``origin``: the values from which strengths are
    scaled, where these are not null. ``power``: the error grows as this power of the strengths.
    """

    strengths: Mapping[str, Any]
    shapes: Mapping[str, float]
    memory: bool = False
    power: float = 1.0
    origin: Mapping[str, float] = field(default_factory=dict)

    @property
    def params(self) -> dict[str, Any]:
        """All parameters of the example."""
        return {**self.strengths, **self.shapes}

    def scaled(self, factor: float, null: Mapping[str, float]) -> dict[str, Any]:
        """The parameters with their strengths' distance from the origin scaled."""
        start = {**null, **self.origin}
        moved = {name: start[name] + factor * (value - start[name]) for name, value in self.strengths.items()}
        return {**moved, **self.shapes}


@dataclass(frozen=True)
class Promise:
    """One promise.

    ``broken`` returns in words what is wrong, or "" where the promise is kept; ``unasked`` returns why the promise does
    not apply to an effect, or "" where it does.
    """

    name: str
    broken: Callable[[Effect, Example, Motion], str]
    unasked: Callable[[Effect, Example], str] = lambda effect, case: ""


@dataclass(frozen=True)
class Result:
    """Whether an effect keeps one promise; ``kept`` is None where the promise does not apply.

    ``said`` is what is wrong, or why the promise does not apply.
    """

    promise: str
    kept: bool | None
    said: str = ""


def full_motion(points: int = 120) -> Motion:
    """Two turns in both directions at two speeds and two temperatures, everything recorded: all effects can be seen."""
    steps = np.arange(2 * points)
    angle = TAU / points * steps
    rows: dict[str, list[Array]] = {}
    clock, leg = 0.0, 0
    for temperature in (20.0, 60.0):
        for rpm in (60.0, 300.0):
            for way in (1.0, -1.0):
                one = {
                    "shaft_rad": angle if way > 0 else angle[::-1],
                    "time_s": clock + 60.0 / rpm / points * steps,
                    "direction": np.full(steps.size, way),
                    "speed_rad_s": np.full(steps.size, way * rpm * TAU / 60.0),
                    "turn": 2 * leg + steps // points,
                    "temperature_c": np.full(steps.size, temperature),
                }
                for name, values in one.items():
                    rows.setdefault(name, []).append(values)
                clock, leg = clock + 60.0 / rpm / points * steps.size + 0.5, leg + 1
    columns: dict[str, Any] = {name: np.concatenate(parts) for name, parts in rows.items()}
    return Motion.from_angle(**columns, has_channels=True)


def permuted(motion: Motion, order: np.ndarray[Any, Any]) -> Motion:
    """The same readings in another order."""
    arrays = [item.name for item in fields(motion) if item.name != "columns"]
    return replace(motion, **{name: getattr(motion, name)[order] for name in arrays})


def example_of(effect: Effect, motion: Motion) -> Example:
    """An example from the declaration alone: each strength at its typical size, shapes from the middle of their grid.

    A level is taken where its grid is farthest from null: nearer it may do nothing yet.

    Whether the effect has a memory is not declared, so that it is taken to have one.
    """
    grid = list(effect.shapes(motion))
    middle = dict(grid[len(grid) // 2]) if grid else {}
    for level in effect.roles("level"):
        null = effect.params[level].null
        away = [abs(shape.get(level, null) - null) for shape in grid]
        middle = dict(grid[int(np.argmax(away))]) if grid else {}
    if effect.line is not None and effect.line.clock != "channels":
        inside = effect.line.some(motion)
        middle[effect.line.param] = float(inside[inside.size // 3]) if inside.size else effect.null()[effect.line.param]
    strengths: dict[str, Any] = {}
    shapes: dict[str, float] = {}
    for name, param in effect.params.items():
        if param.role == "phase":
            shapes[name] = min(max(_PHASE_DEG, param.lower), param.upper)
        elif param.role == "shape":
            shapes[name] = middle.get(name, param.null)
        elif param.role == "per turn":
            if not effect.roles("random"):
                turns = int(motion.turn.max(initial=0)) + 1
                strengths[name] = param.null + param.typical * np.where(np.arange(turns) % 3, 1.0, -0.5)
        else:
            strengths[name] = middle.get(name, _typical(param))
    return Example(strengths=strengths, shapes=shapes, memory=True)


def _typical(param: Param) -> float:
    value = param.null + param.typical if param.null + param.typical <= param.upper else param.null - param.typical
    value = value if not param.counts else max(round(value), round(param.null) + 1)
    return float(max(value, param.lower))


def check(effect: Effect, *, example: Example | None = None, motion: Motion | None = None) -> Iterator[Result]:
    """Check every promise in turn; an exception in the effect's own code breaks the promise that was being checked."""
    motion = motion or full_motion()
    with np.errstate(all="ignore"):
        said = _undeclared(effect)
        yield Result("is declared and documented", not said, said)
        if said:
            return
        try:
            case = example or example_of(effect, motion)
        except Exception as error:
            yield Result("has a grid of shapes", False, _raised(error))
            return
        for promise in PROMISES:
            unasked = promise.unasked(effect, case)
            if unasked:
                yield Result(promise.name, None, unasked)
                continue
            try:
                said = promise.broken(effect, case, motion)
            except Exception as error:
                said = _raised(error)
            yield Result(promise.name, not said, said)


def _raised(error: Exception) -> str:
    return f"its code raises {type(error).__name__}: {error}"


# ---- the declaration --------------------------------------------------------------------------------------------


def _undeclared(effect: Effect) -> str:
    """What is missing or wrong in a declaration, in words."""
    if not NAME.fullmatch(effect.name):
        return f"name is {effect.name!r}; expected lower-case words joined by underscores"
    for name, value, known in (
        ("stage", effect.stage, STAGES),
        ("acts_on", effect.acts_on, get_args(ActsOn)),
        ("footprint", effect.footprint, get_args(Footprint)),
    ):
        if value not in known:
            return f"{name} is {value!r}; expected one of {', '.join(known)}"
    for name, text in (("source", effect.source), ("signature", effect.signature)):
        if not isinstance(text, str) or len(text.strip()) < (11 if name == "source" else 1):
            return f"{name} is {text!r}; expected a few words: where it is defined, what it does to the error"
    for need in effect.needs:
        unknown = [part for part in need.split("|") if part not in NEEDS]
        if unknown:
            return f"needs {unknown[0]!r}, which no sweep provides; expected among {', '.join(sorted(NEEDS))}"
    if not any(effect.roles(role) for role in _ACTING):
        return "has no strength: no parameter that makes it vanish at its null"
    return next(filter(None, (_unclear(name, param) for name, param in effect.params.items())), "") or _unsearchable(
        effect
    )


def _unclear(name: str, param: Param) -> str:
    """What is wrong with a parameter's declaration, in words."""
    if re.search(r"_\d+$", name) or not name.isidentifier():
        return f"parameter {name!r}: expected a name that ends in its unit and in no number after an underscore"
    if not str(param.unit).strip():
        return f'{name} has no unit; give one ("1" for a pure number)'
    if not str(param.doc).strip():
        return f"{name} has no doc; say in a few words what it is"
    if param.role not in get_args(Role):
        return f"{name}: role is {param.role!r}; expected one of {', '.join(get_args(Role))}"
    if not np.isfinite([param.null, param.lower, param.upper]).all() or not param.typical > 0.0:
        return f"{name}: null, lower, upper and typical must be finite, and typical positive"
    return ""


def _unsearchable(effect: Effect) -> str:
    """What keeps an effect from being searched for, in words."""
    named = [*effect.zoomed, *effect.fitted_shapes, *effect.channel_shapes]
    named += [effect.line.param] if effect.line is not None else []
    for name in named:
        if name not in effect.params:
            return f"zoomed, fitted_shapes or line name {name!r}, which is no parameter"
    if effect.line is not None and effect.line.clock != "channels" and len(effect.roles("phase")) != 1:
        return "has a line but not one parameter of role 'phase'"
    missing = {
        "mean": not any(effect.roles(role) for role in ("strength", "level", "per turn")) and "a strength or a level",
        "spread": (effect.spread is None or not effect.roles("random")) and "`spread` and a parameter of role 'random'",
        "values": (effect.attainable is None or not effect.roles("level")) and "`attainable` and a level",
        "sequence": effect.marks is None and "`marks`",
    }[effect.footprint]
    # The baseline's noise is not searched for, and a burst by code of its own.
    exempt = effect.baseline or effect.name.startswith("unnamed_")
    return f"footprint {effect.footprint!r} needs {missing}" if missing and not exempt else ""


# ---- what it does -----------------------------------------------------------------------------------------------


def signal_for(effect: Effect, motion: Motion) -> Array:
    """A signal of the kind that the effect acts on, with the parts that differ from channel to channel."""
    angle = np.stack([motion.shaft_rad, motion.shaft_rad + 0.01])
    if effect.acts_on in ("shaft", "field"):
        return angle
    if effect.acts_on == "channels":
        return np.stack([np.cos(angle[0]), np.sin(angle[1])])
    return motion.shaft_rad[None]


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
    # The converter's rounding is the one "random" role that draws no numbers.
    if same == bool(effect.roles("random")) and effect.name != "adc_quantisation":
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
                return f"shapes holds {name!r}, which is no parameter of role 'shape' or 'level'"
            if not param.lower <= value <= param.upper:
                return f"shapes holds {name} = {value:g}, outside [{param.lower:g}, {param.upper:g}]"
    return ""


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
)
