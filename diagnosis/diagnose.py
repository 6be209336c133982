"""The public call for the paper's error factors: one sweep or many in, factors with their intervals out."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from diagnosis.diagnosed import Diagnoses, Diagnosis
from diagnosis.input_checks import SweepLike, TwinLike, as_sweep, as_twin, checked_seed
from diagnosis.progress import Count, Listener

if TYPE_CHECKING:
    from diagnosis.factors.mirror import KnownSense
    from diagnosis.factors.mounting import Mounting
    from twin.chain import Chain


def diagnose(
    sweep: SweepLike,
    *,
    robust: bool = True,
    seed: int = 0,
    band_deg: float | None = None,
    twin: TwinLike | None = None,
    output_sense: int | None = None,
    mounting: Mounting | None = None,
    columns: str | None = None,
    swarm: bool = False,
) -> Diagnosis:
    """Quantify the paper's error factors of a sweep, and say what each figure is worth.

    What ``halltwin diagnose`` does for one sweep: descents from several starts find the valley, the paper's particle
    swarm where they do not agree or where it is asked for, and least squares its floor; then intervals, what these
    readings cannot tell, and the mechanical cause that would make the same curve. Causes beyond the error model are
    what :func:`diagnosis.explain` looks for.

    Parameters
    ----------
    sweep : str, os.PathLike, Sweep, or columns by name
        The measured sweep, as :func:`diagnosis.explain` takes it.
    robust : bool, optional
        Leave isolated gross errors out of the fit, as the paper's pretreatment does.
    seed : int, optional
        Seed of the swarm, 0 or more: the same sweep and seed give the same answer, bit for bit.
    band_deg : float, optional
        Delta E of the paper's Eq. 7 [deg]: particles whose error leaves this band are discarded (Eq. 11), and the
        answer says how many, and whether the fitted curve keeps the band. Without it none is discarded.
    twin : str, os.PathLike or Chain, optional
        A twin file, a preset's name or a chain: its magnet and air gap, for which millimetres and millitesla are
        counted; and which way its output counts, where the sweep holds no raw channels.
    output_sense : {1, -1}, optional
        Which way the output counts: +1 where it is atan2(y, x) of the channels, -1 where it is minus that. Without
        it, channels and a twin, the quadratic term decides, or both solutions are given.
    mounting : Mounting, optional
        The magnet and its air gap, in place of the twin's.
    columns : str, optional
        Which columns of a file are those of a sweep, as :func:`diagnosis.explain` takes it.
    swarm : bool, optional
        Search by the paper's modified particle swarm even where descents from all starts agree; ``band_deg`` asks for
        it, too.

    Returns
    -------
    Diagnosis
        The factors as text, plain values, table, picture or twin.

    Raises
    ------
    twin.SweepError
        Where the sweep cannot be used; a ``ValueError`` whose message says which column and row, what was found,
        what was expected and what to do.

    See Also
    --------
    diagnose_many : many sweeps at once.
    diagnosis.explain : what this error model gets wrong.

    References
    ----------
    "A Novel Diagnosis Method for a Hall Plates-Based Rotary Encoder with a Magnetic Concentrator", Sensors 2014,
    14(8), 13980-13998, https://doi.org/10.3390/s140813980.

    Examples
    --------
    >>> import numpy as np
    >>> from diagnosis import diagnose
    >>> from twin import Chain, Motion
    >>> motion = Motion.from_angle(np.radians(np.arange(0.0, 360.0, 2.0)))
    >>> sensor = Chain().with_effect("offset", x_percent=0.8, y_percent=-0.5).with_effect("noise", rms_deg=0.01)
    >>> found = diagnose(sensor.simulate(motion, seed=1))
    >>> x = found.factors["Vx_over_Ax"]
    >>> x.low < 0.008 < x.high
    True
    """
    return diagnose_many(
        [sweep if columns is None else as_sweep(sweep, columns=columns)],
        robust=robust,
        seed=seed,
        band_deg=band_deg,
        twin=twin,
        output_sense=output_sense,
        mounting=mounting,
        swarm=swarm,
    )[0]


def diagnose_many(
    sweeps: Iterable[SweepLike],
    *,
    robust: bool = True,
    seed: int = 0,
    band_deg: float | None = None,
    twin: TwinLike | None = None,
    output_sense: int | None = None,
    mounting: Mounting | None = None,
    progress: Listener | None = None,
    swarm: bool = False,
) -> Diagnoses:
    """Quantify the paper's error factors of many sweeps; those of equal length together.

    Parameters
    ----------
    sweeps : iterable of sweeps
        Measured sweeps, each as :func:`diagnosis.explain` takes it.
    robust : bool, optional
        Leave isolated gross errors out of the fits.
    seed : int, optional
        Seed of the swarm, 0 or more.
    band_deg : float, optional
        Delta E [deg] of the discard rule, as in :func:`diagnose`.
    twin : str, os.PathLike or Chain, optional
        As in :func:`diagnose`.
    output_sense : {1, -1}, optional
        As in :func:`diagnose`.
    mounting : Mounting, optional
        As in :func:`diagnose`; one air gap, that of the first sweep, or one for each.
    progress : callable, optional
        Called with a :class:`diagnosis.Progress` as the sweeps are read, fitted and judged.
    swarm : bool, optional
        As in :func:`diagnose`.

    Returns
    -------
    Diagnoses
        A sequence of :class:`Diagnosis`, and what the sweeps say together.

    Raises
    ------
    twin.SweepError
        Where one of the sweeps cannot be used, as in :func:`diagnose`.
    twin.errors.UserError
        Where there is no sweep, or the band is none.

    Examples
    --------
    >>> import numpy as np
    >>> from diagnosis import diagnose_many
    >>> from twin import Chain, Motion
    >>> motion = Motion.from_angle(np.radians(np.arange(0.0, 360.0, 2.0)))
    >>> sensor = Chain().with_effect("gain_mismatch", ratio=1.01).with_effect("noise", rms_deg=0.01)
    >>> found = diagnose_many(sensor.simulate(motion, seed=seed) for seed in range(3))
    >>> [round(one.factors["gain_ratio"].value, 3) for one in found]
    [1.01, 1.01, 1.01]
    """
    from dataclasses import replace

    import numpy as np

    from diagnosis.blas_threads import one_blas_thread
    from diagnosis.error_model.global_search import QUICK
    from diagnosis.factors.findings import placed, quantify_many
    from diagnosis.report.provenance import Provenance
    from twin.catalogue import CATALOGUE
    from twin.decoded import decoded
    from twin.errors import UserError
    from twin.limits import require_within
    from twin.sweep import Sweep

    if band_deg is not None:
        require_within("band", band_deg, 1e-6, 180.0, "deg")
    rng = np.random.default_rng(checked_seed(seed))
    made = Provenance.today(seed=checked_seed(seed))
    if isinstance(sweeps, str | os.PathLike | Sweep) or hasattr(sweeps, "keys"):
        raise UserError("found a single sweep where several are expected; give a list of sweeps, or call diagnose")
    known = as_twin(twin)
    told, place = _told(output_sense, known), mounting or _mounting(known)
    wanted = list(sweeps)
    count = Count(len(wanted), progress)
    each = [count.of("reading", done, decoded(as_sweep(sweep), CATALOGUE)) for done, sweep in enumerate(wanted, 1)]
    read = [one.usable for one in each]
    if not read:
        raise UserError("found no sweep; give at least one")
    with one_blas_thread():
        band_rad = None if band_deg is None else float(np.radians(band_deg))
        place.for_sweeps(len(read))
        search = QUICK if swarm else None
        found = quantify_many(read, rng=rng, robust=robust, band_rad=band_rad, count=count, told=told, swarm=search)
        found = [replace(one, words=told.lines) for one, told in zip(placed(found, place), each, strict=True)]
    return Diagnoses(tuple(Diagnosis(one, made) for one in found), made)


def _told(output_sense: int | None, twin: Chain | None) -> KnownSense | None:
    """Which way the output counts, by the user or a twin. Raises UserError for a sense that is none."""
    from diagnosis.factors.mirror import KnownSense
    from twin.errors import UserError

    if output_sense is not None:
        if output_sense not in (1, -1):
            raise UserError(f"output_sense is {output_sense!r}; expected 1 or -1")
        return KnownSense(int(output_sense), "option")
    return None if twin is None else KnownSense(twin.output_sense, "twin")


def _mounting(twin: Chain | None) -> Mounting:
    """The magnet of a twin at its air gap; without one that is assumed."""
    from diagnosis.factors.mounting import Mounting

    return Mounting.unstated() if twin is None or twin.magnet is None else Mounting.of(twin.magnet)
