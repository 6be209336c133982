"""A described magnet whose placement has moved: what this changes in the channels that its field drives.

Placement numbers are those of a twin, in no catalogue: the effect exists for one magnet, and vanishes where all its
numbers are that magnet's own. A chain with it is the same as one whose magnet is described elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from twin.air_gap import at_air_gap
from twin.angles import Array, wrap
from twin.catalogue import in_order
from twin.chain import Chain
from twin.effect import Effect, Param, Parameters
from twin.magnet.assembly import Assembly
from twin.magnet.placement import LARGEST_SHIFT_MM, LARGEST_STRAY_MT, LARGEST_TILT_DEG, SMALLEST_GAP_MM
from twin.motion import Motion

PLACEMENT = "magnet.placement"
"""The effect's name: the table of a twin file that holds its numbers."""
_NEWTON = 6
"""Steps in which the field's angle is found: its direction leaves it by some hundredths of a radian."""


@dataclass(frozen=True, eq=False)
class Moved:
    """The channels of a magnet in another placement, from its channels in the one in which it is described.

    They are counted in the amplitude of the described one, as all that the chain does to them is: in a weaker field an
    offset in volts is then a larger share by itself. ``apart_rad`` is by how much the field's angle at y is ahead of
    that at x.
    """

    assembly: Assembly
    apart_rad: float

    def __call__(self, signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        angle = self._angle(signal, motion)
        before = self.assembly.channels(angle, motion)
        sizes = [np.size(value) for value in values.values()]
        moved = [self._channels(values, place, angle, motion) - before for place in range(max(sizes, default=1))]
        return np.asarray(signal + (moved[0] if len(moved) == 1 else np.stack(moved)))

    def _channels(self, values: Parameters, place: int, angle: Array, motion: Motion) -> Array:
        """The channels (2, n) elsewhere, in the amplitude of the described placement."""
        elsewhere = placed(self.assembly, values, place)
        return elsewhere.channels(angle, motion) * (elsewhere.nominal_mT / self.assembly.nominal_mT)

    def _angle(self, signal: Array, motion: Motion) -> Array:
        """The field angles [rad] (2, n) at which the described placement makes these channels (2, n)."""
        direction = np.arctan2(signal[1], signal[0])
        angle = np.stack([direction, direction + self.apart_rad])
        for _ in range(_NEWTON):
            x, y = self.assembly.channels(angle, motion)
            angle = angle + wrap(direction - np.arctan2(y, x))
        return angle


def placed(assembly: Assembly, values: Parameters, place: int = 0) -> Assembly:
    """The magnet with these numbers of its placement; ``place`` picks one of several values of a number."""
    numbers = {name: float(np.ravel(value)[place if np.size(value) > 1 else 0]) for name, value in values.items()}
    return replace(assembly, placement=replace(assembly.placement, **numbers))


def moved_placement(assembly: Assembly, *, apart_rad: float) -> Effect:
    """The effect of a magnet whose placement is another than the described one.

    ``apart_rad`` is by how much the field's angle at y is ahead of that at x.
    """

    def number(unit: str, limit: float, typical: float) -> Callable[[str, str], tuple[str, Param]]:
        def declared(name: str, doc: str) -> tuple[str, Param]:
            own = float(getattr(assembly.placement, name))
            low = SMALLEST_GAP_MM if name == "air_gap_mm" else -limit
            about: dict[str, Any] = {"role": "level", "typical": typical, "owner": "mounting"}
            return name, Param(unit=unit, null=own, lower=low, upper=limit, doc=doc, **about)

        return declared

    length = number("mm", LARGEST_SHIFT_MM, 0.1)
    tilt = number("deg", LARGEST_TILT_DEG, 2.0)
    field = number("mT", LARGEST_STRAY_MT, 0.1)
    return Effect(
        name=PLACEMENT,
        stage="magnet",
        acts_on="channels",
        params=dict(
            [
                *(length(f"{one}_{axis}_mm", f"{one} off the shaft's axis") for one in _BODIES for axis in "xy"),
                *(tilt(f"{one}_tilt_{axis}_deg", f"{one}'s tilt about {axis}") for one in _BODIES for axis in "xy"),
                *(field(f"stray_{axis}_mT", f"stray field along {axis}") for axis in "xy"),
                length("air_gap_mm", "from the magnet's face to the sensing plane"),
            ]
        ),
        forward=Moved(assembly, apart_rad),
        source="the field of the described magnet",
        signature="that of the described magnet elsewhere, less that of the described placement",
    )


_BODIES = ("sensor", "magnet")


def movable(chain: Chain) -> Chain:
    """The chain whose magnet's placement may be moved; without a magnet, or where it may be already, the chain."""
    if chain.magnet is None or any(effect.name == PLACEMENT for effect in chain.effects):
        return chain
    field = np.zeros((2, 1))
    for _, effect, values in chain.active("field"):
        field = effect.forward(field, Motion.from_angle(np.zeros(1)), values, None)
    moved = moved_placement(chain.magnet, apart_rad=float(field[1, 0] - field[0, 0]))
    return replace(chain, effects=in_order((moved, *chain.effects)))


def settled(chain: Chain) -> Chain:
    """The same chain with its magnet described where it has been moved to."""
    if not any(effect.name == PLACEMENT for effect in chain.effects):
        return chain
    values = chain.values.get(PLACEMENT, {})
    effects = tuple(effect for effect in chain.effects if effect.name != PLACEMENT)
    kept = replace(chain.without(PLACEMENT), effects=effects)
    if not values or chain.magnet is None:
        return kept
    there = placed(chain.magnet, values)
    gap = float(there.placement.air_gap_mm)
    return (kept if gap == chain.magnet.placement.air_gap_mm else at_air_gap(kept, gap)).with_magnet(there)
