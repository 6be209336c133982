"""Several recordings of one device as one sweep, and the chain that the search sets out from.

The device's parameters are common to all. A recording has its own zero, its own noise, and what happens in time within
it; what follows the magnet's field or distance is that of its air gap.
How the sensor stood in each is told in :mod:`diagnosis.mountings`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.initial_fit import senses_of_channels
from diagnosis.error_model.fit import fit_baseline
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.mounting import Mounting, held_at_one_size
from diagnosis.mountings import own_zeros_deg, with_references
from twin.air_gap import at_air_gap
from twin.angles import Array, wrap_deg
from twin.chain import Chain
from twin.each_recording import MARK, over_recordings
from twin.effect import BoolArray, Effect
from twin.errors import SweepError
from twin.estimated_motion import EstimatedMotion
from twin.hall.offset import OFFSET
from twin.magnet.magnet import Magnet
from twin.mechanics.zero import ZERO
from twin.recordings import Recordings, Setup
from twin.sweep import Sweep
from twin.sweep_columns import OF_SETUP

_BEYOND_NOISE = 4.0
"""Standard errors. Two components together are as far from where they should be by chance in exp(-8), one of three
thousand; one component alone in one of sixteen thousand."""
_LARGEST_RATIO = 10.0
"""The field of the assumed magnet at 0.5 mm is ten times that between 5 and 6 mm: hardly a sensor works at both."""


@dataclass(frozen=True, eq=False)
class Joined:
    """The sweep, the chain to set out from, and the rows (n,) that the fits of single recordings left out."""

    sweep: Sweep
    start: Chain
    suspects: BoolArray


def joined(
    sweeps: Sequence[Sweep],
    effects: Sequence[Effect],
    *,
    mounting: Mounting | None,
    given: Chain | None,
    rng: np.random.Generator,
) -> Joined:
    """Join two or more recordings of one device.

    Parameters
    ----------
    sweeps : sequence of Sweep
        The recordings.
    effects : sequence of Effect
        What may act on each of them.
    mounting : Mounting or None
        The magnet, and where stated the air gap and the sensor's turn of each recording; these go before the columns
        ``air_gap_mm`` and ``mounting_deg``.
    given : Chain or None
        The device's twin, where they are held against one.
    rng : numpy.random.Generator
        Draws the swarms of the fits.

    Raises
    ------
    SweepError
        Where they cannot belong together.
    OutOfRangeError
        Where a parameter of the twin is out of range at the first recording's air gap.
    """
    fits = _baselines(sweeps, rng)
    magnet = _magnet(mounting, given)
    stated = mounting.air_gap_mm if mounting is not None and len(mounting.air_gap_mm) == len(sweeps) else None
    gaps = list(stated) if stated is not None else _stated(sweeps, "air_gap_mm")
    turned = list(mounting.turned_deg) if mounting is not None and mounting.turned_deg else []
    stated_deg = turned or _stated(sweeps, "mounting_deg")
    setups = with_references(_at_gaps(sweeps, fits, gaps, magnet), stated_deg, fits, sweeps)
    chain = fits[0].chain() if given is None else _in_first(given, setups[0])
    zeros_deg = _own_zeros(fits, setups)
    own = {f"{ZERO.name}{MARK}{k + 1}": {"zero_deg": float(zeros_deg[k])} for k in range(1, len(sweeps))}
    start = replace(chain.with_values(own), effects=over_recordings(effects, setups, magnet))
    return Joined(_one_sweep(sweeps, setups), start, np.concatenate([fit.outliers for fit in fits]))


def _in_first(given: Chain, first: Setup) -> Chain:
    """The device's twin at the air gap of the first recording, whose percentages the others' are counted from."""
    if given.magnet is None or first.air_gap_mm in (None, float(given.magnet.placement.air_gap_mm)):
        return given
    assert first.air_gap_mm is not None
    return at_air_gap(given, first.air_gap_mm)


def _magnet(mounting: Mounting | None, given: Chain | None) -> Magnet:
    """The magnet in whose field the gaps are counted: that of the device's twin, else that of the mounting."""
    if given is not None and given.magnet is not None:
        return given.magnet.magnet
    return mounting.magnet if mounting is not None else Magnet()


def _baselines(sweeps: Sequence[Sweep], rng: np.random.Generator) -> list[BaselineFit]:
    """The paper's error model of each recording, in the senses that the first one shows."""
    fits: list[BaselineFit] = []
    senses = next((told for told in map(senses_of_channels, sweeps) if told is not None), None)
    for sweep in sweeps:
        angles = np.radians(sweep.reference_deg), np.radians(sweep.measured_deg)
        fits.append(fit_baseline(*angles, rng=rng, senses=senses, robust=True))
        senses = senses or (fits[0].senses.sensor, fits[0].senses.output)
        if sweep is not sweeps[0] and fits[-1].rms_rad > np.radians(45.0):
            raise SweepError(
                f"{sweep.name}: counts the other way round than {sweeps[0].name}; expected recordings of one device on "
                "one bench; give them one by one (--each)"
            )
    return fits


def _stated(sweeps: Sequence[Sweep], column: str) -> list[float | None]:
    """What a column states for each recording. Raises SweepError where only some do."""
    found: list[float | None] = []
    for sweep in sweeps:
        values = getattr(sweep, column)
        found.append(None if values is None else float(values[np.isfinite(values)][0]))
    if None in found and any(value is not None for value in found):
        lacking = sweeps[found.index(None)].name
        raise SweepError(
            f"{lacking}: no number in a column {column}, where another recording has one; state it for all or for none"
        )
    return found


def _at_gaps(
    sweeps: Sequence[Sweep], fits: Sequence[BaselineFit], gaps: Sequence[float | None], magnet: Magnet
) -> list[Setup]:
    """How each recording was set up: its air gap, and the field there as the channels or the magnet tell it."""
    if any(gap is None for gap in gaps):
        ratios = [None, *(_offset_ratio(fits[0], fit) for fit in fits[1:])]
        return [Setup(name=sweep.name, offset_ratio=ratio) for sweep, ratio in zip(sweeps, ratios, strict=True)]
    known = np.array(gaps, dtype=np.float64)
    field = Mounting(magnet=magnet, air_gap_mm=tuple(known)).field_mT(known)
    held = False
    if all(sweep.vx is not None for sweep in sweeps) and np.ptp(known) > 0.0:
        amplitude = np.array([np.median(np.hypot(sweep.vx, sweep.vy)) for sweep in sweeps])  # type: ignore[arg-type]
        held = held_at_one_size(amplitude, field=field)
        # A gap set by hand is off by more than an amplitude that was read.
        field = field if held else amplitude
    distance = known + 0.5 * float(magnet.height_mm)
    return [
        Setup(
            name=sweep.name,
            air_gap_mm=float(gap),
            field=float(strength / field[0]),
            distance=float(far / distance[0]),
            amplitude_held=held,
        )
        for sweep, gap, strength, far in zip(sweeps, known, field, distance, strict=True)
    ]


def _offset_ratio(first: BaselineFit, here: BaselineFit) -> float | None:
    """The offset over the first recording's, where that is what another air gap may make; else None.

    Both are more than noise, point the same way, and differ beyond the noise by a ratio that gaps can make.
    """
    old, new = (_offset(fit) for fit in (first, here))
    # In amplitudes, each known by the noise of the angle over the root of half the readings.
    old_sd, new_sd = (fit.rms_rad * np.sqrt(2.0 / np.count_nonzero(~fit.outliers)) for fit in (first, here))
    if abs(old) <= _BEYOND_NOISE * old_sd or abs(new) <= _BEYOND_NOISE * new_sd:
        return None
    ratio = float((old.conjugate() * new).real / abs(old) ** 2)
    apart, aside = abs(new - old) / np.hypot(old_sd, new_sd), abs(new - ratio * old) / np.hypot(ratio * old_sd, new_sd)
    made = 1.0 / _LARGEST_RATIO < ratio < _LARGEST_RATIO
    return ratio if made and apart > _BEYOND_NOISE > aside else None


def _offset(fit: BaselineFit) -> complex:
    """The offset of the channels as a number of the plane, in amplitudes."""
    values = {**OFFSET.null(), **fit.chain().values.get(OFFSET.name, {})}
    return 0.01 * complex(values["x_percent"], values["y_percent"])


def _own_zeros(fits: Sequence[BaselineFit], setups: Sequence[Setup]) -> Array:
    """The zero [deg] of each recording beside the first one's, once its reference is counted back."""
    counted_back = fits[0].senses.sensor * np.array([setup.reference_deg for setup in setups])
    return wrap_deg(own_zeros_deg(fits) + counted_back)


def _left_out(sweeps: Sequence[Sweep]) -> tuple[str, ...]:
    """Columns that only some of the recordings have."""
    given = dict.fromkeys(name for sweep in sweeps for name in sweep.columns)
    return tuple(name for name in given if not all(name in sweep.columns for sweep in sweeps))


def _one_sweep(sweeps: Sequence[Sweep], setups: Sequence[Setup]) -> Sweep:
    """All rows one behind the other, in the columns that all recordings have, numbered through."""
    names = [name for name in sweeps[0].columns if all(name in sweep.columns for sweep in sweeps)]
    columns: dict[str, Any] = {
        name: np.concatenate([sweep.columns[name] for sweep in sweeps]) for name in names if name not in OF_SETUP
    }
    back = [setup.reference_deg for setup in setups]
    columns["reference_deg"] = np.concatenate([s.reference_deg - b for s, b in zip(sweeps, back, strict=True)])
    before = np.cumsum([0, *(sweep.rows for sweep in sweeps[:-1])])
    placed = list(zip(sweeps, before.tolist(), strict=True))
    rejected = {row + first: why for sweep, first in placed for row, why in sweep.rejected.items()}
    number = np.repeat(np.arange(len(sweeps)), [len(sweep) for sweep in sweeps])
    return Sweep(
        **columns,
        rejected=rejected,
        name=", ".join(sweep.name for sweep in sweeps),
        row_numbers=np.concatenate([s.numbers + first for s, first in placed]),
        set_aside=sum(sweep.set_aside for sweep in sweeps),
        recordings=Recordings(number, tuple(setups), _left_out(sweeps)),
        senses=sweeps[0].senses,
        estimated=EstimatedMotion.joined([sweep.estimated for sweep in sweeps], [len(sweep) for sweep in sweeps]),
    )
