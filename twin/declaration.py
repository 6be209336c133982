"""What an effect has to declare, and what is wrong with a declaration, in words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from string import Formatter
from typing import Any, get_args

import numpy as np

from twin.catalogue import STAGES
from twin.effect import ActsOn, Behind, Effect, Footprint, InWords, Line, Marks, Owner, Param, Role
from twin.shown import shown

NEEDS = frozenset(
    {
        *("time_s", "direction", "speed_rpm", "turn", "temperature_c", "vx", "current_a"),
        *("both directions", "two speeds", "moving shaft", "one turn", "several turns", "two temperatures"),
        *("two turns", "two air gaps", "two mountings", "two currents", "varying speed", "a reference"),
        *("whole counts", "three speeds"),
    }
)
"""What :attr:`twin.motion.Motion.provides` may hold, two air gaps and mountings by several recordings only."""
NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
"""Names of effects: lower-case words joined by underscores."""
_ACTING: tuple[Role, ...] = ("strength", "level", "per turn", "random")


def mistyped(effect: Effect) -> str:
    """Which part of a declaration is of another type than all others rely on, in words; "" where none is."""
    for names, fits, expected in _TYPES:
        for name in names:
            value = getattr(effect, name)
            if not fits(value):
                return f"{name} is {shown(value)}; expected {expected}"
    return ""


def _of_words(value: Any) -> bool:
    return all(isinstance(item, str) for item in value)


_TYPES: tuple[tuple[tuple[str, ...], Callable[[Any], bool], str], ...] = (
    (
        ("name", "stage", "acts_on", "source", "signature", "footprint", "kind", "words"),
        lambda value: isinstance(value, str),
        "a text",
    ),
    (
        ("params",),
        lambda value: (
            isinstance(value, Mapping) and _of_words(value) and all(isinstance(p, Param) for p in value.values())
        ),
        "names of parameters, each with a Param",
    ),
    (("needs",), lambda value: isinstance(value, frozenset | set) and _of_words(value), "a frozenset of words"),
    (
        ("zoomed", "fitted_shapes", "channel_shapes"),
        lambda value: isinstance(value, tuple | list) and _of_words(value),
        "a tuple of names of parameters",
    ),
    (("forward", "shapes", "begin", "derived", "angle_only", "figures"), callable, "a function"),
    (
        ("spread", "attainable", "stair", "drawing", "computes", "at_magnet"),
        lambda value: value is None or callable(value),
        "a function, or None",
    ),
    (("behind",), lambda value: value is None or isinstance(value, Behind), "a Behind, or None"),
    (("line",), lambda value: value is None or isinstance(value, Line), "a Line, or None"),
    (("marks",), lambda value: value is None or isinstance(value, Marks), "Marks, or None"),
    (("in_words",), lambda value: value is None or isinstance(value, InWords), "InWords, or None"),
    (
        ("baseline", "output_grid", "repeatable", "record_wide"),
        lambda value: isinstance(value, bool | np.bool_),
        "True or False",
    ),
    (("handicap",), lambda value: isinstance(value, int | float), "a number"),
)
"""Fields of an effect, whether a value fits them, and what is expected in words."""


def undeclared(effect: Effect) -> str:
    """What is missing or wrong in a declaration, in words; "" where nothing is."""
    said = mistyped(effect)
    if not said and not NAME.fullmatch(effect.name):
        said = f"name is {shown(effect.name)}; expected lower-case words joined by underscores"
    if said:
        return said
    for name, value, known in (
        ("stage", effect.stage, STAGES),
        ("acts_on", effect.acts_on, get_args(ActsOn)),
        ("footprint", effect.footprint, get_args(Footprint)),
    ):
        if value not in known:
            return f"{name} is {shown(value)}; expected one of {', '.join(known)}"
    for name, text in (("source", effect.source), ("signature", effect.signature)):
        if len(text.strip()) < (11 if name == "source" else 1):
            return f"{name} is {shown(text)}; expected a few words: where it is defined, what it does to the error"
    for need in effect.needs:
        unknown = [part for part in need.split("|") if part not in NEEDS]
        if unknown:
            return f"needs {shown(unknown[0])}, which no sweep provides; expected among {', '.join(sorted(NEEDS))}"
    if not any(effect.roles(role) for role in _ACTING):
        return "has no strength: no parameter that makes it vanish at its null"
    unclear = next((said for name, param in effect.params.items() for said in _unclear(name, param)), "")
    return unclear or _unsearchable(effect) or _untold(effect)


def _unclear(name: str, param: Param) -> Iterator[str]:
    """What is wrong with a parameter's declaration, in words, one fault after the other."""
    if re.search(r"_\d+$", name) or not name.isidentifier():
        yield f"parameter {shown(name)}: expected a name that ends in its unit and in no number after an underscore"
    if not str(param.unit).strip():
        yield f'{name} has no unit; give one ("1" for a pure number)'
    if not str(param.doc).strip():
        yield f"{name} has no doc; say in a few words what it is"
    if param.role not in get_args(Role):
        yield f"{name}: role is {shown(param.role)}; expected one of {', '.join(get_args(Role))}"
    if not np.isfinite([param.null, param.lower, param.upper]).all() or not param.typical > 0.0:
        yield f"{name}: null, lower, upper and typical must be finite, and typical positive"
    if param.mirror not in (None, -1, 0, 1):
        yield f"{name}: mirror is {shown(param.mirror)}; expected -1, 1, or 0 where no value reads the same"
    if param.owner is not None and param.owner not in get_args(Owner):
        yield f"{name}: owner is {shown(param.owner)}; expected one of {', '.join(get_args(Owner))}"
    low, high = param.allowed or (param.lower, param.upper)
    if not param.lower <= low <= param.null <= high <= param.upper:
        yield f"{name}: allowed is {param.allowed}; expected a range within [lower, upper] that holds the null"
    if not (callable(param.field_power) or np.isfinite(param.field_power)) or not 0.0 <= param.scatter < np.inf:
        yield f"{name}: field_power and scatter must be finite, and scatter not negative"
    yield from _untold_detail(name, param)


def _untold_detail(name: str, param: Param) -> Iterator[str]:
    """What is wrong with what a recording must hold to show a detail, in words."""
    told_by = param.told_by if isinstance(param.told_by, frozenset | set) else {shown(param.told_by)}
    if not told_by <= NEEDS or (told_by and not param.detail):
        known = ", ".join(sorted(NEEDS))
        yield f"{name}: told_by is {shown(param.told_by)}; expected, of a detail, a frozenset of these: {known}"


def _unsearchable(effect: Effect) -> str:
    """What keeps an effect from being searched for, in words."""
    named = [*effect.zoomed, *effect.fitted_shapes, *effect.channel_shapes]
    named += [effect.line.param] if effect.line is not None else []
    for name in named:
        if name not in effect.params:
            return f"zoomed, fitted_shapes or line name {shown(name)}, which is no parameter"
    if effect.line is not None and effect.line.clock != "channels" and len(effect.roles("phase")) != 1:
        return "has a line but not one parameter of role 'phase'"
    missing = {
        "mean": not any(effect.roles(role) for role in ("strength", "level", "per turn")) and "a strength or a level",
        "spread": (effect.spread is None or not effect.roles("random")) and "`spread` and a parameter of role 'random'",
        "values": (effect.attainable is None or not effect.roles("level")) and "`attainable` and a level",
        "sequence": effect.marks is None and effect.in_words is None and "`marks`",
    }[effect.footprint]
    # The baseline's noise is not searched for, and a burst by code of its own.
    exempt = effect.baseline or effect.name.startswith("unnamed_")
    return f"footprint {shown(effect.footprint)} needs {missing}" if missing and not exempt else ""


def _untold(effect: Effect) -> str:
    """What keeps an effect from being told to a person, in words."""
    if effect.output_grid and effect.attainable is None:
        return "output_grid needs `attainable`: the angles of the grid"
    if effect.line is not None and any(times < 2 for times in effect.line.multiples):
        return f"line.multiples are {effect.line.multiples}; expected whole numbers from 2"
    told = {} if effect.marks is None else effect.marks.told(1, 100)
    strange = next((name for name in told if name not in effect.params), None)
    if strange is not None:
        return f"marks.told tells of {shown(strange)}, which is no parameter"
    known = {*effect.params, *effect.figures(effect.null()), "largest_deg"}
    strange = next((name for _, name, _, _ in Formatter().parse(effect.words) if name and name not in known), None)
    return f"words name {shown(strange)}, which is neither a parameter nor a figure" if strange is not None else ""
