"""Two recordings of one device between which one thing has changed, or nothing, or the device itself.

The sensor is taken off and put back in between: its zero is another one in any case. Independent of the simulator under
test, as all of the generator is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from . import baseline as baselines
from . import noise as noises
from . import protocols
from .baseline import Baseline, Injected, Setting
from .catalogue import CAUSES
from .chain import Bench, sample
from .columns import all_columns
from .generator import Hidden, demanded, suitable_protocols
from .motion import Array
from .streams import stream

FACTORS = {
    "offset_x": "offset.x_percent",
    "offset_y": "offset.y_percent",
    "gain_ratio": "gain_mismatch.ratio",
    "phase": "phase.beta_deg",
    "quadratic": "quadratic_nonlinearity.q_percent",
}
"""Factors that may change, with the parameter of the twin that says so."""
CHANGING = (
    *("saturation", "magnet_harmonic", "drive_ripple", "bearing_wobble", "hysteresis", "backlash", "latency"),
    *("xy_skew", "cardan_coupling"),
)
"""Causes that may appear, go or change their size."""
KINDS = (*FACTORS, *CHANGING)
NOTHING, ANOTHER = "nothing", "another device"
WAYS = ("appears", "grows", "goes")
_SMALL, _LARGE = 0.05, 0.15
"""Sizes of a cause, and of a change [deg]: those of the generator's causes."""


@dataclass(frozen=True)
class Pair:
    """Both recordings; what changed: a kind of :data:`KINDS`, and of a cause in which way."""

    before: Hidden
    after: Hidden
    kind: str
    way: str


def pair(kind: str, *, seed: int, number: int = 0) -> Pair:
    """Two recordings of a device on an easy bench; ``number`` takes the ways of a cause in turn.

    The same motion is driven twice. Beside what changes the device has one cause that stays.
    """
    rng = stream(seed, kind, "pair")
    way = WAYS[number % len(WAYS)] if kind in CHANGING else ""
    staying = str(rng.choice([name for name in ("saturation", "magnet_harmonic", "hysteresis") if name != kind]))
    staying = staying if _shown((staying, kind)) else "saturation" if kind != "saturation" else "magnet_harmonic"
    names = tuple(name for name in (staying, kind) if name in CAUSES)
    demands = demanded(names, None, "easy")
    motion = protocols.drive(
        protocols.choose(stream(seed, kind, "protocol"), suitable_protocols(names)),
        stream(seed, kind, "motion"),
        bench="easy",
        demands=demands,
    )
    own = baselines.choose(stream(seed, kind, "baseline"), bench="easy")
    noise = noises.choose(rng, bench="easy", repeats=motion.repeats)
    channels = bool(demands.channels or rng.random() < 0.25)
    setting = Setting(motion, own, noise, 16, False)

    def injected(name: str, size_deg: float) -> Injected:
        """The cause at this size; all that is drawn about it is the same at any."""
        return CAUSES[name].plan(stream(seed, kind, "cause", name), size_deg, setting)

    remounted = replace(own, zero_deg=float(rng.uniform(0.0, 360.0)))
    if kind == ANOTHER:
        remounted = baselines.choose(stream(seed, kind, "other baseline"), bench="easy")
    elif kind in FACTORS:
        remounted = _changed(remounted, kind, float(rng.uniform(_SMALL, _LARGE)) * float(rng.choice((-1.0, 1.0))))
    stays = injected(staying, float(rng.uniform(_SMALL, _LARGE)))
    small, large = float(rng.uniform(_SMALL, 0.08)), float(rng.uniform(0.13, _LARGE))
    sizes = {"appears": (0.0, large), "goes": (large, 0.0), "grows": (small, large)}.get(way, (0.0, 0.0))

    def recorded(baseline: Baseline, size_deg: float, when: str) -> Hidden:
        causes = [stays, *([injected(kind, size_deg)] if size_deg else [])]
        bench = Bench(motion, baseline, noise, 16, channels, 1.0, 2.0**-15)
        columns: dict[str, Array] = all_columns(bench, sample(bench, causes, stream(seed, kind, "noise", when)))
        return Hidden(columns, {"causes": [one.name for one in causes], "baseline": baseline.parameters()})

    return Pair(recorded(own, sizes[0], "before"), recorded(remounted, sizes[1], "after"), kind, way)


def _shown(names: tuple[str, ...]) -> bool:
    return bool(suitable_protocols(tuple(name for name in names if name in CAUSES)))


def _changed(own: Baseline, factor: str, size_deg: float) -> Baseline:
    """The baseline with one factor changed so that the error changes by about so much, in amplitude."""
    size = float(np.radians(size_deg))
    if factor == "offset_x":
        return replace(own, offset_x=own.offset_x + size * own.amplitude_x)
    if factor == "offset_y":
        return replace(own, offset_y=own.offset_y + size * own.amplitude_y)
    if factor == "gain_ratio":
        return replace(
            own, amplitude_y=own.amplitude_y * (1.0 + 2.0 * size), offset_y=own.offset_y * (1.0 + 2.0 * size)
        )
    if factor == "phase":
        return replace(own, phase_deg=own.phase_deg + 2.0 * size_deg)
    return replace(own, quadratic=own.quadratic + 2.0 * size)
