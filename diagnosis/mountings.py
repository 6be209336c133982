"""How the sensor stood in each of several recordings of a device: as stated, or as zeros and errors tell.

The reference may have found its zero anew between two recordings, and the sensor may have been turned about the shaft:
both move the zero between them. What was stated of the sensor's turn is taken for that; the rest is the reference's,
and its angles are counted back, so that one place of the shaft bears one angle in all recordings.

Where nothing was stated, the errors of the readings may tell. Those of a sensor go with the field's angle, those of the
bench with the shaft's: with the reference counted back both are the same function of the angle in either recording,
with a turned sensor the two are turned against each other. A turn is taken for granted where only that lets one device
have made both recordings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.discovery.fitting.projection import projected
from diagnosis.error_model.result import BaselineFit
from twin.angles import Array, wrap, wrap_deg
from twin.mechanics.zero import ZERO
from twin.motion import LEAST_SPAN_K, LEAST_TURN_RAD
from twin.recordings import Setup
from twin.sweep import Sweep

SAME_PLACE_DEG = 15.0
"""The zeros of two recordings that are nearer than this belong to a reference that was not moved."""
_SENSOR_ORDERS, _BENCH_ORDERS = (1, 2, 3, 4), (1, 2)
"""Orders of the errors that go with the field's angle, and with the shaft's (eccentric reference, coupling)."""
_LOG_P = float(np.log(1e-6))
"""Chance of a turn that is none: it is told once for a set of recordings, and much follows from it."""
_CLOSER = 1.2
"""The turn has to leave an RMS smaller by this, so that it is a third of the squares left without it (1 - 1 / 1.44).
In long records a far smaller share is beyond chance, but may be of what neither describes, such as higher orders."""


def with_references(
    setups: Sequence[Setup], stated: Sequence[float | None], fits: Sequence[BaselineFit], sweeps: Sequence[Sweep]
) -> list[Setup]:
    """The setups with the sensor's turn, stated [deg] or told, and how far the reference has counted on."""
    sense, found = fits[0].senses.sensor, [setups[0]]
    zeros_deg = own_zeros_deg(fits)
    for place in range(1, len(setups)):
        setup, zero_deg, value = setups[place], float(zeros_deg[place]), stated[place]
        if value is None or stated[0] is None:
            far = bool(abs(np.radians(zero_deg)) > LEAST_TURN_RAD)
            turned = far and _alike(setups, fits, sweeps, place) and _turned(fits, sweeps, place)
            by = zero_deg if turned else 0.0
            setup = replace(setup, turn_told=turned)
        else:
            # A sensor that is turned with the angles it counts sees the field stand back by as much. Which way a stage
            # counts is often not written down: the zero tells.
            turn_deg = float(value) - float(stated[0])
            by = min((-turn_deg, turn_deg), key=lambda moved: abs(float(wrap_deg(zero_deg - moved))))
            setup = replace(setup, turn_stated_deg=turn_deg)
        moved = float(wrap_deg(zero_deg - by))
        counted_on = -sense * moved if abs(moved) > SAME_PLACE_DEG else 0.0
        found.append(replace(setup, turned_deg=-by, reference_deg=counted_on))
    return found


def own_zeros_deg(fits: Sequence[BaselineFit]) -> Array:
    """The zero of each recording against the first one's [deg]."""
    zeros = np.array([fit.chain().values[ZERO.name]["zero_deg"] for fit in fits], dtype=np.float64)
    return np.asarray(wrap_deg(zeros - zeros[0]))


def _alike(setups: Sequence[Setup], fits: Sequence[BaselineFit], sweeps: Sequence[Sweep], place: int) -> bool:
    """Whether a recording was made in the first one's conditions, as far as these are known: the device read alike.

    In another field its errors are larger or smaller by as large a share; that must not show beside the noise.
    """
    share = abs(setups[place].field / setups[0].field - 1.0)
    error = _away(fits[0], sweeps[0])
    if share * float(np.std(error)) > max(fits[0].rms_rad, fits[place].rms_rad) * np.sqrt(2.0 / error.size):
        return False
    first_c, here_c = _temperature_c(sweeps[0]), _temperature_c(sweeps[place])
    return first_c is None or here_c is None or abs(here_c - first_c) <= LEAST_SPAN_K


def _temperature_c(sweep: Sweep) -> float | None:
    """The temperature of a recording [C], the median of what was recorded of it; None where nothing was."""
    if sweep.temperature_c is None or not np.isfinite(sweep.temperature_c).any():
        return None
    return float(np.nanmedian(sweep.temperature_c))


def _away(fit: BaselineFit, sweep: Sweep) -> Array:
    """Errors [rad] of the readings in use, about their mean."""
    shaft, read = _in_use(fit, sweep)
    away = wrap(read - fit.senses.sensor * shaft)
    return np.asarray(wrap(away - np.angle(np.mean(np.exp(1j * away)))))


def _in_use(fit: BaselineFit, sweep: Sweep) -> tuple[Array, Array]:
    """Angles [rad] of the shaft and of the sensor, as it counts, at the readings in use."""
    kept = ~fit.outliers
    return np.radians(sweep.reference_deg)[kept], np.radians(sweep.measured_deg)[kept] * fit.senses.output


def _turned(fits: Sequence[BaselineFit], sweeps: Sequence[Sweep], place: int) -> bool:
    """Whether the errors of the first recording and of this one are one device's only if the sensor was turned."""
    error, with_field, with_shaft, number = [], [], [], []
    for index, k in enumerate((0, place)):
        shaft, read = _in_use(fits[k], sweeps[k])
        error.append(_away(fits[k], sweeps[k]))
        with_field.append(read)
        with_shaft.append(shaft)
        number.append(np.full(shaft.size, index))
    zeros = (np.concatenate(number) == np.array([[0], [1]])).astype(np.float64)
    one_device = np.concatenate([zeros, _waves(np.concatenate(with_field), _SENSOR_ORDERS)])
    also_bench = np.concatenate([one_device, _waves(np.concatenate(with_shaft), _BENCH_ORDERS)])
    y = np.concatenate(error)
    together, turned = (float(np.sum(projected(y, columns) ** 2)) for columns in (one_device, also_bench))
    dof = y.size - len(also_bench)
    if dof <= 0 or turned <= 0.0 or together < _CLOSER**2 * turned:
        return False
    statistic = np.array(dof * np.log(together / turned))
    return float(log_probability(statistic, len(also_bench) - len(one_device), dof)) < _LOG_P


def _waves(angle: Array, orders: Sequence[int]) -> Array:
    """Cosine and sine of each order over angles (n,) [rad]: (2 orders, n)."""
    return np.stack([turned(order * angle) for order in orders for turned in (np.cos, np.sin)])
