"""Examples that effects are checked on: a motion that shows all of them, and parameters from a declaration alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from twin.angles import TAU, Array
from twin.effect import Effect, Param
from twin.motion import Motion

_PHASE_DEG = 35.0


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


def full_motion(
    points: int = 120,
    *,
    temperatures_c: Sequence[float] = (20.0, 60.0),
    speeds_rpm: Sequence[float] = (60.0, 300.0),
    currents_a: Sequence[float] = (1.0, 2.0, 3.0),
) -> Motion:
    """Two turns in both directions at each speed and temperature, everything recorded: all effects can be seen.

    The drive pulls unevenly: within each turn the speed is up to a fifth higher and lower. The currents take turns.
    """
    steps = np.arange(2 * points)
    angle = TAU / points * steps
    rows: dict[str, list[Array]] = {}
    clock, leg = 0.0, 0
    for temperature in temperatures_c:
        for rpm in speeds_rpm:
            for way in (1.0, -1.0):
                path = angle if way > 0 else angle[::-1]
                pace = rpm * TAU / 60.0 * (1.0 + 0.2 * np.cos(path))
                step_s = TAU / points / np.sqrt(pace[1:] * pace[:-1])
                one = {
                    "shaft_rad": path,
                    "time_s": clock + np.concatenate([[0.0], np.cumsum(step_s)]),
                    "direction": np.full(steps.size, way),
                    "speed_rad_s": way * pace,
                    "turn": 2 * leg + steps // points,
                    "temperature_c": np.full(steps.size, temperature),
                    "current_a": np.full(steps.size, currents_a[leg % len(currents_a)]),
                }
                for name, values in one.items():
                    rows.setdefault(name, []).append(values)
                clock, leg = float(one["time_s"][-1]) + 0.5, leg + 1
    columns: dict[str, Any] = {name: np.concatenate(parts) for name, parts in rows.items()}
    return Motion.from_angle(**columns, has_channels=True)


def permuted(motion: Motion, order: np.ndarray[Any, Any]) -> Motion:
    """The same readings in another order."""
    arrays = [item.name for item in fields(motion) if item.name not in ("columns", "recordings", "estimated")]
    return replace(motion, **{name: getattr(motion, name)[order] for name in arrays})


def example_of(effect: Effect, motion: Motion) -> Example:
    """An example from the declaration alone: each strength at its typical size, shapes from the middle of their grid.

    A level is taken where its grid is farthest from null, as nearer it may do nothing; beside a strength it is null.

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
        elif param.role != "level" or effect.whole:
            strengths[name] = middle.get(name, _typical(param))
    return Example(strengths=strengths, shapes=shapes, memory=True)


def _typical(param: Param) -> float:
    value = param.null + param.typical if param.null + param.typical <= param.upper else param.null - param.typical
    value = value if not param.counts else max(round(value), round(param.null) + 1)
    return float(max(value, param.lower))


def signal_for(effect: Effect, motion: Motion) -> Array:
    """A signal of the kind that the effect acts on, with the parts that differ from channel to channel."""
    angle = np.stack([motion.shaft_rad, motion.shaft_rad + 0.01])
    if effect.acts_on in ("shaft", "field"):
        return angle
    if effect.acts_on == "channels":
        return np.stack([np.cos(angle[0]), np.sin(angle[1])])
    return motion.shaft_rad[None]
