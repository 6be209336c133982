"""Small sweeps of the generator in ``tests.hidden``, and the states that the stages are handed with them."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.special import ndtri

from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.answer import answer
from diagnosis.discovery.stages.changes import changes
from diagnosis.discovery.stages.final_fit import final_fit
from diagnosis.discovery.stages.flipped_bits import flipped_bits
from diagnosis.discovery.stages.further_measurements import further_measurements
from diagnosis.discovery.stages.grid_cause import grid_cause
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.stages.initial_fit import initial_fit
from diagnosis.discovery.stages.listed import listed
from diagnosis.discovery.stages.motion_freedom import motion_freedom
from diagnosis.discovery.stages.observe import observe
from diagnosis.discovery.stages.one_source import one_source
from diagnosis.discovery.stages.own_parameters import own_parameters
from diagnosis.discovery.stages.own_shapes import own_shapes
from diagnosis.discovery.stages.predictive_check import predictive_check
from diagnosis.discovery.stages.quantisation import quantisation
from diagnosis.discovery.stages.recording_levels import recording_levels
from diagnosis.discovery.stages.recordings_alone import recordings_alone
from diagnosis.discovery.stages.repeated_frames import repeated_frames
from diagnosis.discovery.stages.ringing import ringing
from diagnosis.discovery.stages.rival_fits import rival_fits
from diagnosis.discovery.stages.row_masks import row_masks
from diagnosis.discovery.stages.sense_check import sense_check
from diagnosis.discovery.stages.spread import spread
from diagnosis.discovery.stages.spread_check import spread_check
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.stages.variance import variance
from diagnosis.discovery.state import Stage, State
from tests.hidden import structures
from tests.hidden.baseline import Baseline, Setting
from tests.hidden.catalogue import CAUSES
from tests.hidden.chain import Bench, sample
from tests.hidden.columns import all_columns
from tests.hidden.motion import Layout, Leg, run
from tests.hidden.noise import Noise
from tests.hidden.streams import stream
from twin.angles import Array
from twin.chain import Chain
from twin.sweep import Sweep

LOOP: tuple[Stage, ...] = (
    *(recording_levels, repeated_frames, variance, stepwise, motion_freedom, ringing, one_source),
    *(sense_check, own_shapes, spread),
)
"""The stages that the pipeline repeats until none of them has anything more to say."""
ONCE: tuple[Stage, ...] = (
    *(observe, initial_fit, row_masks, own_parameters, quantisation),
    *LOOP,
    *(held_out_selection, spread_check, flipped_bits, grid_cause, changes),
    *(final_fit, recordings_alone, answer, listed),
    *(rival_fits, further_measurements, predictive_check),
)
"""Every stage, each once."""


@dataclass(frozen=True, kw_only=True)
class Made:
    """How a sweep is made.

    ``causes`` are names with strengths [deg], settled as the generator's catalogue settles them, ``structure`` likewise
    one of those without a name. ``back``: as many turns on the way back. ``rpm``, ``temperatures_c``: a leg each, there
    (and back). ``left_out``: columns that are not recorded. ``quadratic`` is q of the error model, ``start_sense`` and
    ``start_output`` the senses that the fit sets out from, the true ones if 0.
    """

    causes: tuple[tuple[str, float], ...] = ()
    structure: tuple[str, float] | None = None
    points: int = 180
    turns: int = 1
    back: bool = False
    repeats: int = 1
    rpm: tuple[float, ...] = (0.0,)
    temperatures_c: tuple[float, ...] = (25.0,)
    noise_deg: float = 0.02
    correlation: float = 0.0
    bits: int = 20
    channels: bool = False
    sense: int = 1
    output_sense: int = 1
    quadratic: float = 0.003
    start_sense: int = 0
    start_output: int = 0
    left_out: tuple[str, ...] = ()
    seed: int = 1


@functools.cache
def bench_of(made: Made) -> Bench:
    """All of a sweep but its causes."""
    legs = [
        Leg(made.turns, way, rpm, warm)
        for rpm in made.rpm
        for warm in made.temperatures_c
        for way in ((1, -1) if made.back else (1,))
    ]
    layout = Layout(made.points, 10.0, 0.001, repeats=made.repeats, legs=tuple(legs))
    own = Baseline(30.0, 0.008, -0.005, 1.0, 1.01, 0.3, made.quadratic, made.sense, made.output_sense)
    kind = "ar1" if made.correlation else "white"
    noise = Noise(kind, made.noise_deg, made.correlation, made.repeats)
    motion = run("static", layout, stream(made.seed, "motion"))
    return Bench(motion, own, noise, made.bits, made.channels, 1.0, 2.0**-15)


@functools.cache
def planted_of(made: Made) -> tuple[structures.Injected, ...]:
    """The causes of a sweep with everything about them settled."""
    bench = bench_of(made)
    setting = Setting(bench.motion, bench.baseline, bench.noise, bench.output_bits, weak=False)
    planted = [CAUSES[name].plan(stream(made.seed, name), strength, setting) for name, strength in made.causes]
    if made.structure is not None:
        name, strength = made.structure
        planted.append(structures.plan(name, stream(made.seed, name), strength, setting))
    return tuple(planted)


@functools.cache
def sweep_of(made: Made) -> Sweep:
    """The sweep as a file would hold it."""
    bench = bench_of(made)
    if "output_quantisation" in dict(made.causes):
        bits = {one.name: one for one in planted_of(made)}["output_quantisation"].parameters["bits"]
        bench = replace(bench, output_bits=int(bits))
    columns = all_columns(bench, sample(bench, planted_of(made), stream(made.seed, "noise")))
    kept = {name: np.round(values, 9) for name, values in columns.items() if name not in made.left_out}
    return Sweep.from_columns(kept)


def start_of(made: Made, settings: DiscoverySettings | None = None) -> State:
    """What the first stage is handed: the fit sets out from the true senses and zero, and knows nothing else."""
    sense, output = made.start_sense or made.sense, made.start_output or made.output_sense
    chain = Chain(sensor_sense=sense, output_sense=output).with_effect("zero", zero_deg=30.0)
    return State.of(sweep_of(made), chain, settings=settings, rng=np.random.default_rng(made.seed))


def through(state: State, *stages: Stage) -> State:
    """The state behind these stages."""
    for stage in stages:
        state = stage(state)
    return state


def before(stage: Stage, made: Made, **settings: Any) -> State:
    """The state that a stage is handed in a pipeline that runs each stage once; settings by their names."""
    return _before(stage, made, tuple(sorted(settings.items())))


@functools.cache
def _before(stage: Stage, made: Made, changed: tuple[tuple[str, Any], ...]) -> State:
    place = ONCE.index(stage)
    if place == 0:
        return start_of(made, DiscoverySettings(**dict(changed)))
    earlier = ONCE[place - 1]
    return earlier(_before(earlier, made, changed))


def with_residual(state: State, residual_rad: Array) -> State:
    """The state whose readings lie so far (n,) [rad] from what its fit predicts."""
    fit = state.fit
    measured = fit.linear.angle + residual_rad
    observations = replace(fit.observations, measured=measured)
    sweep = replace(state.sweep, measured_deg=np.degrees(measured) % 360.0)
    return state.with_(evaluate(fit.chain, fit.free, observations, fit.weighting), sweep=sweep)


def with_settings(state: State, **changed: Any) -> State:
    """The state with some thresholds changed, also those that its fit carries."""
    settings = replace(state.settings, **changed)
    if state.fitted is None:
        return state.with_(settings=settings)
    fit = state.fit
    return state.with_(replace(fit, weighting=replace(fit.weighting, settings=settings)), settings=settings)


def noise(n: int, rms_deg: float = 0.02, seed: int = 3) -> Array:
    """White noise (n,) [rad]: each of n quantiles of the normal distribution once, in an order that the seed sets.

    So no moment of it is left to chance.
    """
    quantiles = ndtri((np.arange(n) + 0.5) / n)
    return np.asarray(np.radians(rms_deg) * np.random.default_rng(seed).permutation(quantiles))


def truth_of(made: Made, name: str) -> Mapping[str, float]:
    """The planted parameters of a cause."""
    return {one.name: one for one in planted_of(made)}[name].parameters
