"""An explained sweep as the page shows it: the error in layers that are taken off and put on, its factors moved.

All is the answer's own: the residual is that of its fit, with another chain in the place of the one found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from diagnosis import Explanation
from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.intervals import intervals_95
from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.discovery.marks.row_masks import raw_residual
from diagnosis.report.data import Readings, binned, highest_order, noise_level, readings, spectrum, two_ways
from diagnosis.report.pictures import angle_bins
from diagnosis.report.wording import label
from scenarios.lab.columns import drawn, highest_in_columns
from twin.angles import Array, wrap_deg
from twin.baseline import FACTORS
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import BoolArray
from twin.errors import UserError
from twin.mechanics.zero import ZERO
from twin.motion import RPM
from twin.shown import shown

MODEL = "error model"
"""The layer of the paper's factors, or of a given twin's."""
_WIDEST = 4000
_BEFORE = tuple(dict.fromkeys(factor.key for factor in FACTORS if factor.effect is not ZERO))
_REACH, _PAST_NULL = 10.0, 1.25
"""A slider goes so many half widths of the 95 % interval to either side; or so far past the value of no effect, if that
is more."""


@dataclass(frozen=True, kw_only=True)
class Look:
    """What is to be drawn: layers that are off, values that were moved, over what, in how many pixels' columns."""

    off: frozenset[str]
    values: Mapping[str, float]
    over: str
    width: int
    with_spectrum: bool


def look_of(content: Any) -> Look:
    """The look that the page asks for. Raises UserError."""
    known = {"off", "values", "over", "width", "spectrum"}
    if not isinstance(content, Mapping) or set(content) != known:
        raise UserError(f"a look is {shown(content)}; expected {', '.join(sorted(known))}")
    off, values, width = content["off"], content["values"], content["width"]
    if not isinstance(off, list) or not all(isinstance(one, str) for one in off):
        raise UserError(f"off is {shown(off)}; expected names of layers")
    plain = isinstance(values, Mapping) and all(
        isinstance(value, int | float) and not isinstance(value, bool) for value in values.values()
    )
    if not plain:
        raise UserError(f"values is {shown(values)}; expected numbers by name")
    if isinstance(width, bool) or not isinstance(width, int) or not 10 <= width <= _WIDEST:
        raise UserError(f"width is {shown(width)}; expected a whole number from 10 to {_WIDEST}")
    return Look(
        off=frozenset(off),
        values={name: float(value) for name, value in values.items()},
        over=str(content["over"]),
        width=width,
        with_spectrum=bool(content["spectrum"]),
    )


@dataclass(frozen=True, eq=False)
class Layers:
    """The layers of one answer."""

    explained: Explanation

    @cached_property
    def read(self) -> Readings:
        """Its readings."""
        return readings(self.explained.discovery)

    @cached_property
    def across(self) -> dict[str, tuple[Array, str]]:
        """What a residual can be drawn over: the values (n,) and their name with the unit."""
        motion, (clock, clock_name) = self.read.motion, self.read.clock
        found = {"angle": (self.read.angle_deg, "shaft angle / deg"), "clock": (clock, clock_name)}
        if "temperature_c" in motion.columns and np.ptp(motion.temperature_c) > 0.0:
            found["temperature"] = (motion.temperature_c, "temperature / °C")
        speed = np.abs(motion.speed_rad_s) / RPM
        if np.ptp(speed) > 1e-6 * np.max(speed, initial=0.0):
            found["speed"] = (speed, "speed / rpm")
        return found

    @cached_property
    def causes(self) -> dict[str, Finding]:
        """The causes found, by a name of their own: of two with one name the second bears a number."""
        found: dict[str, Finding] = {}
        for cause in self.explained.discovery.causes:
            name, count = cause.name, 2
            while name in found:
                name, count = f"{cause.name} {count}", count + 1
            found[name] = cause
        return found

    def told(self) -> dict[str, Any]:
        """What the page begins with: layers with what each leaves, factors with their intervals, axes."""
        fixed: dict[str, str | None] = {
            MODEL: None,
            **{name: self._fixed(cause) for name, cause in self.causes.items()},
        }
        layers = [
            {
                "name": name,
                "title": self._title(name),
                "without_deg": None if why else self._rms(*self._left(frozenset([name]))),
                "fixed": why,
            }
            for name, why in fixed.items()
        ]
        return {
            "layers": layers,
            "all_deg": self._rms(*self._left(frozenset())),
            "measured_deg": self._rms(self.read.error_deg, self.read.plain),
            "sliders": self._sliders(),
            "across": {key: name for key, (_, name) in self.across.items()},
            "readings": len(self.read.error_deg),
            "two_ways": two_ways(self.read.motion),
        }

    def _title(self, layer: str) -> str:
        """A layer's name in words; of a cause of several lines with the place of each."""
        cause = self.causes.get(layer)
        told = [] if cause is None or len(cause.keys) < 2 else [self._place(key) for key in cause.keys]
        places = dict.fromkeys(name for name, _ in told if name)
        said = [f"{label(name)} {', '.join(value for of, value in told if of == name)}" for name in places]
        return f"{layer.replace('_', ' ')} ({'; '.join(said)})" if said else layer.replace("_", " ")

    def _place(self, key: str) -> tuple[str, str]:
        """What says where a line of a cause lies, such as its order, and the value; empty for what is no line."""
        chain = self.explained.discovery.fit.chain
        line = find(key, chain.effects).line
        value = chain.values.get(key, {}).get(line.param) if line is not None else None
        return ("", "") if line is None or value is None else (line.param, f"{value:.4g}")

    def _fixed(self, cause: Finding) -> str | None:
        """Why a cause cannot be taken off the mean of the readings; None where it can."""
        effect = find(cause.keys[0], self.explained.discovery.fit.chain.effects)
        if set(cause.keys) <= set(self.explained.discovery.words):
            return "it acts on the words as sent; the readings shown are decoded"
        if effect.footprint == "spread" and not cause.rows:
            return "it makes the readings scatter and leaves their mean"
        return None

    def _sliders(self) -> list[dict[str, Any]]:
        """Every fitted number of factors and causes, with the span that its slider goes over."""
        fit = self.explained.discovery.fit
        labels = {(factor.key, factor.param): factor.label for factor in FACTORS}
        owners = {key: name for name, cause in self.causes.items() for key in cause.keys}
        sliders = []
        for (key, name), (low, high) in intervals_95(fit).items():
            effect = find(key, fit.chain.effects)
            param = effect.params[name]
            value = fit.chain.values.get(key, {}).get(name, param.null)
            if np.ndim(value) or param.role in ("per turn", "random"):
                continue
            half = 0.5 * (high - low) if np.isfinite(high - low) else 0.0
            # A zero has no value of no effect: it goes as far as the error does.
            away = (
                self._rms(self.read.error_deg, self.read.plain)
                if effect is ZERO
                else _PAST_NULL * abs(float(value) - param.null)
            )
            reach = max(_REACH * half, away, 1e-6)
            sliders.append(
                {
                    "name": f"{key}.{name}",
                    "label": labels.get((key, name)) or self._labelled(owners.get(key), key, name),
                    "of": owners.get(key, MODEL),
                    "unit": "" if param.unit == "1" else param.unit,
                    "value": float(value),
                    "low": float(max(value - reach, param.lower)),
                    "high": float(min(value + reach, param.upper)),
                    "half_width": float(half),
                }
            )
        return sliders

    def _labelled(self, owner: str | None, key: str, name: str) -> str:
        """A parameter in words, with the place of its line where its cause has several."""
        place, value = self._place(key) if owner is not None and len(self.causes[owner].keys) > 1 else ("", "")
        return f"{label(name)}, {label(place)} {value}" if place not in ("", name) else label(name)

    def look(self, look: Look) -> dict[str, Any]:
        """The residual with some layers off and some values moved, for a picture of so many columns. Raises UserError.

        With all layers off it is the error as measured, less its mean.
        """
        if look.over not in self.across:
            raise UserError(f"over is {shown(look.over)}; expected one of {', '.join(self.across)}")
        left, among = self._left(look.off, look.values)
        x, name = self.across[look.over]
        span = (0.0, 360.0) if look.over == "angle" else (float(x.min()), float(x.max()))
        told: dict[str, Any] = {"x": name, "span": span, "rms_deg": self._rms(left, among), "ways": {}}
        for way, mask in self._ways(among):
            told["ways"][way] = drawn(x[mask], left[mask], span, look.width)
            if look.over == "angle":
                at, mean = binned(x[mask], left[mask], angle_bins(int(np.count_nonzero(mask)), each=5))
                kept = np.isfinite(mean)
                told["ways"][way]["mean"] = {"x": at[kept].round(3).tolist(), "y": mean[kept].round(6).tolist()}
        touched = among & ~self.read.plain
        if touched.any():
            told["touched"] = drawn(x[touched], left[touched], span, look.width)
        if look.with_spectrum:
            told["spectrum"] = self._spectrum(left, among, look.width)
        return told

    def residual_deg(self, chain: Chain) -> Array:
        """What another chain in the place of the fitted one leaves of each reading [deg] (n,)."""
        found = self.explained.discovery
        fit = found.fit
        if chain is fit.chain or chain.values == fit.chain.values:
            return self.read.after_deg
        linear = Linear(chain, fit.observations.motion, blur=fit.weighting.blur, observables=1)
        return np.asarray(np.degrees(raw_residual(replace(fit, chain=chain, linear=linear), found.sweep)))

    def _left(self, off: frozenset[str], values: Mapping[str, float] | None = None) -> tuple[Array, BoolArray]:
        """What is left [deg] (n,) with these layers off and these values moved, and which readings (n,) count.

        Single readings that a cause has touched count where that is off. Without its factors a twin has no zero either:
        the mean is taken off then, as it is of the error as measured. Raises UserError.
        """
        unknown = off - {MODEL, *self.causes}
        if unknown:
            raise UserError(f"off has {shown(min(unknown))}; expected some of {', '.join((MODEL, *self.causes))}")
        causes = [cause for name, cause in self.causes.items() if name in off and not self._fixed(cause)]
        chain = self._moved(values or {}).without(*(key for cause in causes for key in cause.keys))
        left, among = self.residual_deg(chain.without(*_BEFORE) if MODEL in off else chain), self.read.plain.copy()
        for cause in causes:
            among[list(cause.rows)] = True
        if MODEL in off:
            left = wrap_deg(left - np.degrees(np.angle(np.mean(np.exp(1j * np.radians(left[among]))))))
        return left, among

    def _moved(self, values: Mapping[str, float]) -> Chain:
        """The extended twin with some values moved. Raises UserError."""
        chain = self.explained.discovery.fit.chain
        known = {one["name"] for one in self._sliders()} if values else set()
        for name, value in values.items():
            if name not in known:
                raise UserError(f"values has {shown(name)}; expected some of {', '.join(sorted(known))}")
            key, _, param = name.rpartition(".")
            chain = chain.with_effect(key, **{param: value})
        return chain

    def _ways(self, among: BoolArray) -> list[tuple[str, BoolArray]]:
        direction = self.read.motion.direction
        found = [("forward", among & (direction >= 0.0)), ("backward", among & (direction < 0.0))]
        return [(name, mask) for name, mask in found if mask.any()]

    def _spectrum(self, left: Array, among: BoolArray, width: int) -> dict[str, Any]:
        motion = self.read.motion
        order, amplitude = spectrum(motion, left, among, highest_order(motion, ()))
        level = noise_level(order, amplitude, both=two_ways(motion))
        at, high, noise = highest_in_columns(order, amplitude, level, max(width // 2, 10))
        return {
            "order": at.round(4).tolist(),
            "amplitude_deg": high.round(7).tolist(),
            "noise_deg": noise.round(7).tolist(),
        }

    def _rms(self, values: Array, among: BoolArray) -> float:
        return float(np.sqrt(np.mean(values[among] ** 2)))
