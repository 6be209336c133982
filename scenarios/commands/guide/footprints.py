"""What each cause does to the error over a turn, as a small picture that the twin itself computes."""

from __future__ import annotations

from html import escape

import numpy as np

from twin.angles import Array, wrap
from twin.catalogue import CATALOGUE, in_order
from twin.chain import Chain
from twin.drawing import drawn
from twin.effect import Effect
from twin.example import full_motion
from twin.motion import Motion

WIDTH, HEIGHT = 640, 240
"""Of the picture, in units so small that whole ones draw it."""
_INSIDE = 16
_POINTS = 120
_RPM, _WARM_C, _CURRENT_A = 300.0, 60.0, 1.0
_STRENGTH_DEG = 0.1
_MIDDLE = np.full((1, 4), 0.5)
_SHARE_PERCENT = 97.0
"""Of a curve's readings so many set its scale: what a reversal does to one or two leaves the rest to be seen."""


def motion() -> Motion:
    """Two turns there and two back, warm, with a motor that draws current: what needs one of these shows."""
    return full_motion(_POINTS, temperatures_c=(_WARM_C,), speeds_rpm=(_RPM,), currents_a=(_CURRENT_A,))


def error_deg(effect: Effect, moved: Motion) -> Array:
    """Reading minus reference [deg] (n,) with the effect alone, as strong as about 0.1 deg, and with its scatter."""
    chain = Chain(effects=in_order((effect,)))
    values = drawn(effect, np.array([_STRENGTH_DEG]), _MIDDLE, moved)
    chain = chain.with_effect(effect.name, **{name: value[0] for name, value in values.items()})
    sweep = chain.simulate(moved, seed=1)
    return np.asarray(np.degrees(wrap(np.radians(sweep.measured_deg - sweep.reference_deg))))


def footprint(effect: Effect, moved: Motion) -> str:
    """The picture: error over the shaft's turn, the way back dashed; single readings as dots.

    Its scale is its own.
    """
    error = error_deg(effect, moved)
    curve = effect.footprint == "mean"
    reach = float(np.percentile(np.abs(error), _SHARE_PERCENT if curve else 100.0)) or float(np.max(np.abs(error)))
    x = _INSIDE + (WIDTH - 2 * _INSIDE) * (np.degrees(moved.shaft_rad) % 360.0) / 360.0
    y = HEIGHT / 2 - (HEIGHT / 2 - _INSIDE) * np.clip(error / (reach or 1.0), -1.0, 1.0)
    paths = [f'<path class="zero" d="M0 {HEIGHT // 2}H{WIDTH}"/>']
    for name, way in (("there", moved.direction > 0.0), ("back", moved.direction < 0.0)):
        drawing = _curve(x[way], y[way]) if curve else _dots(x[way], y[way])
        paths.append(f'<path class="{name}{"" if curve else " dots"}" d="{drawing}"/>')
    words = f"Error over a turn with {effect.name} alone, {reach:.2g} deg high"
    return (
        f'<svg class="footprint" role="img" viewBox="0 0 {WIDTH} {HEIGHT}" aria-label="{escape(words)}">'
        f"<title>{escape(words)}</title>{''.join(paths)}</svg>"
    )


def footprints() -> dict[str, str]:
    """Of every cause of the catalogue, by its name."""
    moved = motion()
    return {effect.name: footprint(effect, moved) for effect in CATALOGUE}


def _curve(x: Array, y: Array) -> str:
    """A line through the readings in their order, begun anew where the turn does."""
    begun = np.concatenate([[True], np.abs(np.diff(x)) > WIDTH / 2])
    return "".join(f"{'M' if new else 'L'}{a:.0f} {b:.0f}" for new, a, b in zip(begun, x, y, strict=True))


def _dots(x: Array, y: Array) -> str:
    return "".join(f"M{a:.0f} {b:.0f}h0" for a, b in zip(x, y, strict=True))
