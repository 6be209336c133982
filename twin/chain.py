"""The chain: effects in physical order, from the shaft to the angle word and to the reference's reading."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from twin.angles import Array, channels_of, wrap
from twin.catalogue import ACTS_ON, CATALOGUE, STAGES, at_magnet, find
from twin.effect import ActsOn, Effect, Parameters
from twin.known_names import nearest
from twin.limits import OutOfRangeError
from twin.magnet.assembly import Assembly
from twin.motion import Motion
from twin.operations import Acting, acting, operations_of
from twin.parameter_values import numbers
from twin.parts import Parts
from twin.reference.encoder import Encoder
from twin.shown import shown
from twin.sweep import Sweep

Values = Mapping[str, Parameters]
SIGNALS: tuple[ActsOn, ...] = ("shaft", "field", "channels", "angle", "word")
"""The signals on the sensor's side, in order; behind its effects each but the last is converted to the next."""


@dataclass(frozen=True)
class Step:
    """One operation of a run: an effect or a conversion (effect None), its parameters, the signal before and after."""

    key: str
    effect: Effect | None
    values: Parameters
    before: Array
    after: Array


@dataclass(frozen=True, eq=False)
class Chain:
    """A twin: effects with their parameters, and the senses in which sensor and output count.

    Immutable: the ``with_`` methods return another chain.

    Attributes
    ----------
    values : mapping of str to parameters
        Parameters of the effects that are present, by instance key; every other effect is at null and does nothing.
    sensor_sense, output_sense : int
        +1 or -1: s of a = s theta + zero, and h of m = h atan2(y, x).
    effects : tuple of Effect
        Those that can be present, in the order in which they act.
    magnet : Assembly or None
        Drives the channels by its computed field; None: they are the field's ideal cosine and sine.
    encoder : Encoder or None
        Rounds the reference of a simulated record to whole counts; None: the reference reads exactly.
    parts : Parts
        The described hardware, in its own units: the field's scale, the concentrator's disk and the Hall plates. A part
        that is not described is ideal.

    Examples
    --------
    >>> import numpy as np
    >>> from twin import Chain, Motion
    >>> sensor = Chain().with_effect("offset", x_percent=1.0)
    >>> motion = Motion.from_angle(np.radians(np.arange(0.0, 360.0, 2.0)))
    >>> print(f"{np.degrees(np.max(np.abs(sensor.error(motion)))):.3f} deg")
    0.573 deg
    >>> sensor.with_effect("noise", rms_deg=0.02).simulate(motion, seed=1)
    Sweep('simulated', 180 readings, columns reference_deg, measured_deg)
    """

    values: Values = field(default_factory=dict)
    sensor_sense: int = 1
    output_sense: int = 1
    effects: tuple[Effect, ...] = CATALOGUE
    magnet: Assembly | None = None
    encoder: Encoder | None = None
    parts: Parts = field(default_factory=Parts)

    def __repr__(self) -> str:
        senses = f"sensor_sense={self.sensor_sense:+d}, output_sense={self.output_sense:+d}"
        return f"Chain({', '.join(self.values) or 'no effect'}; {senses})"

    # ---- changing -------------------------------------------------------------------------------------------------

    def with_effect(self, key: str, **params: Any) -> Chain:
        """The chain with an effect's parameters set; those not given keep their value, or null.

        Parameters
        ----------
        key : str
            Name of the effect; ``NAME#2`` is a second instance of it.
        **params
            Its parameters, in the units of their names.

        Returns
        -------
        Chain
            Another chain.

        Raises
        ------
        KeyError
            For an unknown effect or parameter.
        OutOfRangeError
            For a value out of range; a ``ValueError``.
        """
        effect = find(key, self.effects)
        for name, value in params.items():
            if name not in effect.params:
                meant = nearest(name, effect.params)
                raise KeyError(f"{key} has no parameter '{name}'{meant}; it has {', '.join(effect.params)}")
            param = effect.params[name]
            array = numbers(value)
            if not np.all((array >= param.lower) & (array <= param.upper)):
                raise OutOfRangeError(
                    f"{key}.{name} must lie between {param.lower:g} and {param.upper:g} {param.unit}; "
                    f"found {value if np.ndim(value) else shown(value)}"
                )
        # A field that is not given, of an effect that counts in the magnet's, is that magnet's: also of one to come.
        own = () if effect.at_magnet is None else effect.follow_field
        rest = {name: value for name, value in effect.null().items() if name not in own}
        merged = {**rest, **self.values.get(key, {}), **params}
        return replace(self, values={**self.values, key: merged})

    def with_magnet(self, magnet: Assembly) -> Chain:
        """The chain driven by a magnet's computed field, in which its effects then act.

        Parameters
        ----------
        magnet : Assembly
            One magnet in one place.

        Returns
        -------
        Chain
            Another chain.
        """
        return replace(self, magnet=magnet, effects=at_magnet(self.effects, magnet))

    def with_values(self, values: Values) -> Chain:
        """The chain with several effects' parameters set, unchecked (a fit's inner loop)."""
        return replace(self, values={**self.values, **values})

    def within_limits(self) -> Chain:
        """The chain with every parameter that lies beyond its limits at the nearest one, so that a twin file holds it.

        Returns
        -------
        Chain
            This very chain where none does.
        """
        limited: dict[str, Parameters] = {}
        for key, params in self.values.items():
            known = find(key, self.effects).params
            inside = {name: np.clip(value, known[name].lower, known[name].upper) for name, value in params.items()}
            if any(np.any(inside[name] != value) for name, value in params.items()):
                limited[key] = inside
        return self.with_values(limited) if limited else self

    def without(self, *keys: str) -> Chain:
        """The chain with some effects back at null.

        Parameters
        ----------
        *keys : str
            Instance keys; those that are not present are passed over.

        Returns
        -------
        Chain
            Another chain.
        """
        return replace(self, values={key: params for key, params in self.values.items() if key not in keys})

    def mirrored(self) -> Chain:
        """The chain that counts the other way on both sides and reads the same.

        A parameter that has no such value (:meth:`twin.effect.Effect.mirrors`) is kept: its effect then reads
        otherwise, and that is all by which an angle tells the two chains apart.
        """
        values = {key: find(key, self.effects).mirrored(params) for key, params in self.values.items()}
        turned = replace(
            self,
            values=values,
            parts=self.parts.in_mirror(),
            sensor_sense=-self.sensor_sense,
            output_sense=-self.output_sense,
        )
        if self.magnet is None:
            return turned
        return turned.with_magnet(replace(self.magnet, placement=self.magnet.placement.mirrored()))

    # ---- running --------------------------------------------------------------------------------------------------

    def active(self, acts_on: ActsOn) -> Iterator[tuple[str, Effect, Parameters]]:
        """What acts on this signal, in order: key, effect, complete parameters.

        These are the described parts, each ahead of the effects of its stage, and the effects that are not at null.
        """
        yield from self._acting.get(acts_on, ())

    @cached_property
    def _acting(self) -> Mapping[str, Sequence[Acting]]:
        """The same by signal: a fit asks each chain for it several times."""
        return acting(self.operations, self.described, self.values)

    @property
    def described(self) -> tuple[Effect, ...]:
        """The described parts as operations on the chain's signals, in order."""
        return self.parts.acting(self.nominal_mT)

    @cached_property
    def operations(self) -> tuple[Effect, ...]:
        """All that the effects do, one signal each, in order."""
        return operations_of(self.effects)

    def places(self) -> dict[tuple[str, str], float]:
        """Where everything acts, by name and signal: by its number, a part half a number ahead of its stage's."""
        found = {(effect.name, str(effect.acts_on)): float(place) for place, effect in enumerate(self.operations)}
        for part in self.described:
            behind = (
                place
                for place, one in enumerate(self.operations)
                if (ACTS_ON.index(one.acts_on), STAGES.index(one.stage))
                >= (ACTS_ON.index(part.acts_on), STAGES.index(part.stage))
            )
            found[part.name, part.acts_on] = next(behind, len(self.operations)) - 0.5
        return found

    def steps(self, motion: Motion, rng: np.random.Generator | None = None) -> Iterator[Step]:
        """Run the sensor's side of the chain and yield every operation with the signals around it.

        The signals have the shapes of :data:`twin.effect.ActsOn`; the last one is the measured angle ``(..., 1, n)``.
        """
        signal: Array = np.broadcast_to(motion.shaft_rad, (2, len(motion)))
        sense: Parameters = {"sensor_sense": self.sensor_sense, "output_sense": self.output_sense}
        for acts_on in SIGNALS:
            for key, effect, values in self.active(acts_on):
                after = effect.forward(signal, motion, values, rng)
                yield Step(f"{key} in {acts_on}" if effect.acting else key, effect, values, signal, after)
                signal = after
            if acts_on == "shaft":
                after = self.sensor_sense * signal
            elif acts_on == "field":
                after = self.driven(signal, motion)
            elif acts_on == "channels":
                after = self.computed(signal, as_built=rng is not None)
            elif acts_on == "angle":
                after = self.output_sense * signal
            else:
                return
            yield Step(f"after {acts_on}", None, sense, signal, after)
            signal = after

    def driven(self, angle: Array, motion: Motion) -> Array:
        """The channels in a field at these angles [rad] (..., 2, n): the magnet's field, or cosine and sine."""
        if self.magnet is None:
            return channels_of(np.cos(angle[..., :1, :]), np.sin(angle[..., 1:, :]))
        return self.magnet.channels(angle, motion)

    def computed(self, channels: Array, *, as_built: bool = False) -> Array:
        """The angle [rad] (..., 1, n) of the channels: the arctangent, or as built what a stage computes."""
        for _, effect, values in self.active("angle") if as_built else ():
            if effect.computes is not None and (angle := effect.computes(channels, values)) is not None:
                return angle
        return np.asarray(np.arctan2(channels[..., 1:, :], channels[..., :1, :]))

    def readings(self, motion: Motion, values: Values | None = None) -> Array:
        """The reading that is expected: without noise and rare events.

        Parameters
        ----------
        motion : Motion
            Conditions of n readings.
        values : mapping of str to parameters, optional
            Parameters to set beforehand, unchecked.

        Returns
        -------
        ndarray
            [rad], ``(n,)``, or ``(batch, n)`` where parameters are arrays of shape ``(batch,)``.
        """
        chain = self if values is None else self.with_values(values)
        *_, last = chain.steps(motion)
        return last.after[..., 0, :]

    def channels(self, motion: Motion, rng: np.random.Generator | None = None) -> Array:
        """The two channels (..., 2, n) as the converter hands them on, nominal amplitude 1."""
        return next(step.before for step in self.steps(motion, rng) if step.key == "after channels")

    def reference(self, motion: Motion, rng: np.random.Generator | None = None) -> Array:
        """The reference's reading [rad] (..., n) of the shaft angle."""
        signal: Array = motion.shaft_rad[None, :]
        for _, effect, values in self.active("reference"):
            signal = effect.forward(signal, motion, values, rng)
        return signal[..., 0, :]

    def recorded_reference(self, motion: Motion, rng: np.random.Generator | None = None) -> Array:
        """The reference as a record holds it [rad] (n,): in whole counts of the encoder."""
        reading = self.reference(motion, rng)
        return reading if self.encoder is None else self.encoder.read(reading)

    @property
    def nominal_mT(self) -> Any:
        """The field [mT] in the plane at the nominal amplitude 1; of many designs (designs,)."""
        return self.parts.field_mT if self.magnet is None else self.magnet.nominal_mT

    def shaft(self, recorded: Motion) -> Motion:
        """The true motion of a recorded one: the shaft angles at which the reference reads what was recorded.

        Found by fixed-point iteration, which converges because the reference's error changes far more slowly over a
        turn than the angle does.
        """
        if not any(True for _ in self.active("reference")):
            return recorded
        guess = recorded
        for _ in range(4):
            error = self.reference(guess) - guess.shaft_rad
            guess = recorded.at(recorded.shaft_rad - error)
        return guess

    def trace(self, motion: Motion, *, seed: int | None = None) -> dict[str, Array]:
        """Every intermediate signal of one run, from the shaft to the reading.

        Parameters
        ----------
        motion : Motion
            Conditions of n readings.
        seed : int, optional
            Of noise and rare events; without one there are none.

        Returns
        -------
        dict of str to ndarray
            By the operation's name, shaped as in :data:`twin.effect.ActsOn`, in rad; ``reference`` is what that reads.
        """
        rng = None if seed is None else np.random.default_rng(seed)
        signals = {"shaft": motion.shaft_rad}
        signals.update({step.key: step.after for step in self.steps(motion, rng)})
        signals["reference"] = self.recorded_reference(motion, rng)
        return signals

    def simulate(self, motion: Motion, *, seed: int = 0) -> Sweep:
        """One sweep as a bench records it: noise, rare events and quantisation included.

        Parameters
        ----------
        motion : Motion
            Conditions of n readings, and which columns the bench records.
        seed : int, optional
            Of everything random, 0 or more.

        Returns
        -------
        Sweep
            Measured angles in [0, 360) deg.
        """
        rng = np.random.default_rng(seed)
        channels = measured = None
        for step in self.steps(motion, rng):
            if step.key == "after channels":
                channels = step.before
            measured = step.after
        assert channels is not None
        assert measured is not None
        reference = self.recorded_reference(motion, rng)
        return Sweep.from_motion(
            motion,
            reference_deg=np.degrees(reference),
            measured_deg=np.degrees(measured[0]) % 360.0,
            channels=channels if "vx" in motion.columns else None,
        )

    def error(self, motion: Motion, readings: Array | None = None) -> Array:
        """The angle error that is expected: reading minus reference, in the sense that the two count together.

        Parameters
        ----------
        motion : Motion
            Conditions of n readings.
        readings : ndarray, optional
            :meth:`readings` of this motion, where they are known.

        Returns
        -------
        ndarray
            [rad], (n,), or ``(batch, n)`` as :meth:`readings`.
        """
        slope = self.sensor_sense * self.output_sense
        return wrap((self.readings(motion) if readings is None else readings) - slope * self.reference(motion))
