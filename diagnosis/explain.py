"""The public call: a sweep in, what the simulation gets wrong about it out."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from diagnosis.explanation import Explanation
from diagnosis.input_checks import SweepLike, TwinLike, as_sweeps, as_twin, checked_seed
from diagnosis.progress import Listener

if TYPE_CHECKING:
    import numpy as np

    from diagnosis.discovery.result import Discovery
    from diagnosis.discovery.settings import DiscoverySettings
    from diagnosis.discovery.state import State
    from diagnosis.discovery.watch import Watch
    from diagnosis.discovery.whole_record import WholeRecord
    from diagnosis.factors.mounting import Mounting
    from twin.chain import Chain
    from twin.effect import BoolArray, Effect, Parameters
    from twin.spin import Spin
    from twin.sweep import Sweep

OwnEffects: TypeAlias = "str | os.PathLike[str] | Effect | Sequence[str | os.PathLike[str] | Effect]"
"""Causes of one's own: files that declare them, or effects; one or several."""


def explain(
    sweep: SweepLike | Spin | Sequence[SweepLike | Spin],
    *,
    twin: TwinLike | None = None,
    mounting: Mounting | None = None,
    effects: OwnEffects = (),
    settings: DiscoverySettings | None = None,
    pole_pairs: int | None = None,
    columns: str | None = None,
    seed: int = 0,
    progress: Listener | None = None,
    on_interrupt: Literal["raise", "answer"] = "raise",
    budget_s: float = float("inf"),
) -> Explanation:
    """Say what the simulation gets wrong about a measured sweep, by name, with proof; or that nothing is wrong.

    What ``halltwin explain`` does: the paper's error model is fitted, what it leaves is searched for causes, each
    cause is judged on readings that no fit has seen, and the twin is extended by those that stand.

    Parameters
    ----------
    sweep : str, os.PathLike, Sweep, or columns by name
        The measured sweep: a file (CSV, ``.csv.gz``, Parquet), a :class:`twin.Sweep`, a pandas DataFrame, a dict of
        arrays, or an xarray Dataset. Columns bear the names of the file format, with their units:
        ``reference_deg`` and ``measured_deg``, and where recorded ``time_s``, ``direction``, ``speed_rpm``, ``turn``,
        ``temperature_c``, ``vx`` and ``vy``; one value for each reading, in the order in which they were taken.
        Without ``reference_deg`` the shaft's motion is estimated from ``time_s`` and the readings together with their
        errors.
        A list or tuple of several: recordings of one device, explained together. The device's parameters are common to
        them; each has its own zero and its own noise, and a cause is held out by whole recordings.
    twin : str, os.PathLike, or Chain, optional
        Hold the sweep against this twin of the device instead of the paper's error model: a twin file (TOML), the name
        of a preset, or a :class:`twin.Chain` such as the ``extended`` one of another recording. Which of its own
        parameters have moved is asked first, then which causes it lacks.
    mounting : Mounting, optional
        The magnet and its air gap in whose field a misplacement and a stray field are counted. If not given, a cylinder
        of 6 mm x 2.5 mm at 1.5 mm; a twin brings its own. Of several recordings ``air_gap_mm`` may hold one gap for
        each, in place of the column of that name, and ``turned_deg`` say how the sensor was turned about the shaft.
    effects : str, os.PathLike, Effect, or a sequence of these, optional
        Causes of your own, which are searched beside the catalogue and the installed ones: Python files that
        declare them, or :class:`twin.Effect` objects.
    settings : DiscoverySettings, optional
        Every threshold of the search, the probability of a false alarm first of all; the project's own if not given.
    pole_pairs : int, optional
        How often the field at the sensor turns in a turn of the shaft: a ring of so many pole pairs, a resolver of so
        many speeds. ``measured_deg``, the reference or the channels may turn as often, and ``multipole`` is looked for
        with this number alone. If not given, each angle turns once, and numbers from 3 up are searched.
    columns : str, optional
        Of files with names and units of their own: which of their columns are those of a sweep, as ``--columns`` says
        it and ``halltwin import`` prints it, e.g. ``"time_s=t:ms, measured_deg=angle*360/16384"``.
    seed : int, optional
        Seed of everything random, 0 or more: the same sweep and seed give the same answer, bit for bit.
    progress : callable, optional
        Called with a :class:`diagnosis.Progress` whenever a stage begins or the causes held change. Where it raises
        StopIteration, the search ends where it stands and the answer is what it holds, as after an interrupt.
    on_interrupt : {"raise", "answer"}, optional
        What an interrupt (Ctrl-C) does: raise KeyboardInterrupt, or end the search where it stands and answer with
        what it holds, proven on held-out readings like any other; what else each cause may be is not looked for then,
        since whoever interrupts is waiting. A second one raises. Such an answer says so in
        ``to_dict()["cut_short"]``, and its verdict is never ``"adequate"`` or ``"explained"``, but ``"stopped"`` where
        nothing had been found.
    budget_s : float, optional
        Seconds of computing, for each recording, after which the search ends where it stands and the answer is what it
        holds, as after an interrupt: proven on held-out readings, by the F test alone and without rivals, which on a
        long recording took a third to two thirds as long again. Counted is what this thread computes, so waiting for a
        busy machine costs nothing; where the search stands by then depends on how fast the computer is. An answer that
        was not cut is that without a budget, bit for bit.

    Returns
    -------
    Explanation
        Verdict, causes and extended twin, as text, JSON, table, picture or report.

    Raises
    ------
    twin.SweepError
        Where the sweep cannot be used; a ``ValueError`` whose message says which column and row, what was found,
        what was expected and what to do.
    twin.errors.UserError
        The same, where the twin or an effect cannot be used. Also a ``ValueError``.

    Notes
    -----
    Linear algebra runs on one thread meanwhile: the matrices are small, and more threads take more time.

    References
    ----------
    "A Novel Diagnosis Method for a Hall Plates-Based Rotary Encoder with a Magnetic Concentrator", Sensors 2014,
    14(8), 13980-13998, https://doi.org/10.3390/s140813980: the error model that the search sets out from.

    Examples
    --------
    A simulated sensor lags behind the field by hysteresis, which shows when the shaft turns there and back:

    >>> import numpy as np
    >>> from diagnosis import explain
    >>> from twin import Chain, Motion
    >>> there = np.arange(0.0, 720.0, 2.0)
    >>> motion = Motion.from_angle(np.radians(np.concatenate([there, there[::-1]])))
    >>> sensor = Chain().with_effect("hysteresis", lag_deg=0.12, memory_deg=8.0).with_effect("noise", rms_deg=0.02)
    >>> found = explain(sensor.simulate(motion, seed=1))
    >>> found.verdict
    'explained'
    >>> [cause.name for cause in found.causes]
    ['hysteresis']
    """
    from contextlib import nullcontext

    import numpy as np

    from diagnosis.blas_threads import one_blas_thread
    from diagnosis.discovery.pipeline import discover
    from diagnosis.discovery.settings import DiscoverySettings
    from diagnosis.discovery.watch import Watch, ended_by_budget, stopped_by_interrupt
    from diagnosis.report.provenance import Provenance
    from twin.log import LOG

    rng = np.random.default_rng(checked_seed(seed))
    made = Provenance.today(seed=checked_seed(seed))
    _check_settings(settings)
    _check_on_interrupt(on_interrupt)
    each_s = _checked_budget(budget_s)
    searched = _searched(effects, twin)
    sources = _sources(sweep)
    watch = Watch(progress, budget_s=each_s * len(sources))
    listening = stopped_by_interrupt(watch) if on_interrupt == "answer" else nullcontext()
    with one_blas_thread(), listening, ended_by_budget(watch):
        read = as_sweeps(sources, pole_pairs=pole_pairs, columns=columns, begins=lambda stage: watch.told(stage, ()))
        _check_mounting(read, mounting)
        searched, given = _with_periods(read, searched, twin, pole_pairs)
        start = _start(searched, mounting, given)
        used = vars(settings or DiscoverySettings()).items()
        LOG.info("seed %d; settings: %s", seed, ", ".join(f"{name} {value}" for name, value in used))
        state = _begun(read, given=given, start=start, mounting=mounting, settings=settings, rng=rng, watch=watch)
        found = discover(state)
        whole = _whole_record(read, found, state)
    return Explanation(found, made, whole)


def _whole_record(read: list[Sweep], found: Discovery, handed_in: State) -> WholeRecord | None:
    """What all readings of a long record show beside what its searched part does; None where there is no more to it.

    The record itself is let go of: the means are all that is searched.
    """
    from diagnosis.discovery.whole_record import averaged, searched

    means = averaged(read[0], found) if len(read) == 1 else None
    read.clear()
    return None if means is None else searched(means, handed_in)


def _sources(sweep: SweepLike | Spin | Sequence[SweepLike | Spin]) -> Sequence[SweepLike | Spin]:
    """What is given, one by one. Raises UserError for a list of none."""
    from typing import cast

    from twin.errors import UserError

    several = isinstance(sweep, list | tuple)
    sources = cast("Sequence[SweepLike | Spin]", sweep) if several else [cast("SweepLike | Spin", sweep)]
    if not sources:
        raise UserError("found a list of no sweep; give one sweep, or several recordings of one device")
    return sources


def _with_periods(
    sweeps: Sequence[Sweep], searched: tuple[Effect, ...], twin: TwinLike | None, pole_pairs: int | None
) -> tuple[tuple[Effect, ...], Chain | None]:
    """The effects, and the twin that is given, with these pole pairs. Raises UserError where it has others."""
    from diagnosis.known_periods import check_periods, check_seen
    from twin.hall.multipole import with_periods

    if pole_pairs is not None and pole_pairs > 1:
        check_seen(sweeps, pole_pairs)
        searched = with_periods(searched, pole_pairs, given=twin is not None)
    given = as_twin(twin, effects=searched)
    if given is not None and pole_pairs is not None:
        check_periods(given, pole_pairs)
    return searched, given


def _check_mounting(sweeps: Sequence[Sweep], mounting: Mounting | None) -> None:
    """Refuse where more or fewer are mounted than there are. Raises UserError."""
    from twin.errors import UserError

    gaps, angles = (1, 0) if mounting is None else (len(mounting.air_gap_mm), len(mounting.turned_deg))
    if gaps not in (1, len(sweeps)):
        expected = "one, that of the sweep" if len(sweeps) == 1 else "one, or one for each sweep in their order"
        raise UserError(f"found {gaps} air gaps; expected {expected}")
    if angles and len(sweeps) == 1:
        raise UserError(
            "the sensor's turn (mounting) says how several recordings differ, and there is one sweep; leave it out, or "
            "give the other recordings too"
        )
    if angles not in (0, len(sweeps)):
        count = f"{angles} angle{'s' if angles > 1 else ''}"
        raise UserError(f"found {count} of the sensor for {len(sweeps)} sweeps; expected one for each")


def _begun(
    sweeps: list[Sweep],
    *,
    mounting: Mounting | None,
    given: Chain | None,
    start: Chain,
    settings: DiscoverySettings | None,
    rng: np.random.Generator,
    watch: Watch,
) -> State:
    """Where the search sets out from: the fitted error model, or a given twin."""
    from dataclasses import replace

    from diagnosis.discovery.fitting.subsample import searched_part
    from diagnosis.discovery.marks.words import read_words
    from diagnosis.discovery.settings import DiscoverySettings
    from diagnosis.discovery.state import State
    from diagnosis.joining import joined

    parts = sweeps if len(sweeps) > 1 else [searched_part(sweeps[0])]
    read = read_words(parts, (given or start).effects, settings or DiscoverySettings())
    read, given = read.beside(given)
    told = {"findings": read.findings, "words": read.words, "told_back": read.told_back}
    in_words: dict[str, Any] = {"touched": read.lost, **told, "watch": watch}
    if len(sweeps) > 1:
        watch.told("error_model", ())
        together = joined(read.sweeps, (given or start).effects, mounting=mounting, given=given, rng=rng)
        chain = together.start if given is not None else _known_alone(replace(together.start, magnet=start.magnet))
        state = State.of(together.sweep, chain, given=None if given is None else chain, settings=settings, rng=rng)
        return state.with_(suspects=together.suspects | read.lost, **in_words)
    sweep = read.sweeps[0]
    if given is not None:
        state = State.of(sweep, given, given=given, settings=settings, rng=rng)
        return state.with_(suspects=read.lost, **in_words)
    watch.told("error_model", ())
    model, suspects, begun = _error_model(sweep, read.lost, start, rng)
    state = State.of(sweep, model, settings=settings, rng=rng)
    return state.with_(suspects=suspects | read.lost, begun=begun, **in_words)


def _error_model(
    sweep: Sweep, lost: BoolArray, start: Chain, rng: np.random.Generator
) -> tuple[Chain, BoolArray, dict[str, Parameters]]:
    """The fitted error model, the rows (n,) that its robust fit left out, and the effects that the words tell beside.

    ``lost`` (n,) masks readings that say nothing of the angle.
    """
    from dataclasses import replace

    import numpy as np

    from diagnosis.discovery.fitting.initial_fit import senses_of_channels
    from diagnosis.error_model.fit import fit_baseline
    from twin.decoded import begun_by_words

    told = begun_by_words(sweep, lost, start.effects)
    plain = [np.radians(sweep.measured_deg), *(fault.decoded for _, fault in told)][-1]
    fit = fit_baseline(
        np.radians(sweep.reference_deg),
        plain,
        rng=rng,
        weights=(~lost).astype(np.float64) if lost.any() else None,
        senses=senses_of_channels(sweep),
        robust=True,
    )
    begun = {
        name if not number else f"{name}#{number + 1}": values
        for name, fault in told
        for number, values in enumerate((fault.values, *fault.also))
    }
    return _known_alone(replace(fit.chain(), effects=start.effects, magnet=start.magnet)), fit.outliers, begun


def _known_alone(chain: Chain) -> Chain:
    """The chain without parameters of effects that it cannot have."""
    from twin.catalogue import base_name

    known = {effect.name for effect in chain.effects}
    return chain.without(*(key for key in chain.values if base_name(key) not in known))


def _start(effects: tuple[Effect, ...], mounting: Mounting | None, given: Chain | None) -> Chain:
    """The chain without any effect, in the field of the magnet and at the air gap that are named. Raises UserError."""
    from dataclasses import replace

    from twin.chain import Chain
    from twin.errors import UserError
    from twin.magnet.assembly import Assembly
    from twin.magnet.placement import Placement

    start = Chain(effects=effects)
    usual = Placement()
    if mounting is None or (mounting.assumed and mounting.air_gap_mm[0] == usual.air_gap_mm):
        return start
    if given is not None:
        if mounting.assumed and len(mounting.air_gap_mm) > 1:
            return start
        raise UserError("found a twin and a mounting; give one of them: a twin brings its own magnet and air gap")
    chain = start.with_magnet(Assembly(mounting.magnet, replace(usual, air_gap_mm=mounting.air_gap_mm[0])))
    words = f"{mounting.body} at an air gap of {mounting.air_gap_mm[0]:g} mm" if mounting.assumed else ""
    return replace(chain, effects=tuple(replace(e, assumes=words) if e.at_magnet else e for e in chain.effects))


def _check_settings(settings: DiscoverySettings | None) -> None:
    """Raise UserError for settings that are none."""
    from diagnosis.discovery.settings import DiscoverySettings
    from twin.errors import UserError

    if not (settings is None or isinstance(settings, DiscoverySettings)):
        raise UserError(f"settings is of the type {type(settings).__name__}; expected DiscoverySettings, or None")


def _check_on_interrupt(on_interrupt: str) -> None:
    """Raise UserError for a word that is none of the two."""
    from twin.errors import UserError
    from twin.shown import shown

    if on_interrupt not in ("raise", "answer"):
        raise UserError(f"on_interrupt is {shown(on_interrupt)}; expected 'raise' or 'answer'")


def _checked_budget(budget_s: float) -> float:
    """The budget [s]. Raises UserError for what is no time."""
    from numbers import Real

    from twin.errors import UserError
    from twin.shown import shown

    if isinstance(budget_s, bool) or not isinstance(budget_s, Real) or not budget_s > 0.0:
        found = f"{type(budget_s).__name__} {shown(budget_s)}"
        raise UserError(
            f"budget_s is the {found}; expected a number of seconds of computing, above 0, or inf for no end"
        )
    try:
        return float(budget_s)
    except OverflowError:
        return float("inf")


def _searched(own: OwnEffects, twin: TwinLike | None) -> tuple[Effect, ...]:
    """The catalogue with the installed effects, one's own, and those that a given chain brings along."""
    from twin.catalogue import in_order
    from twin.chain import Chain
    from twin.effect import Effect
    from twin.errors import UserError
    from twin.extensions import effects_with

    if not isinstance(own, str | os.PathLike | Effect | Iterable):
        raise UserError(f"effects is of the type {type(own).__name__}; expected files or effects, one or several")
    effects = effects_with((own,) if isinstance(own, str | os.PathLike | Effect) else tuple(own))
    known = {effect.name for effect in effects}
    brought = [effect for effect in twin.effects if effect.name not in known] if isinstance(twin, Chain) else []
    return in_order((*effects, *brought)) if brought else effects
