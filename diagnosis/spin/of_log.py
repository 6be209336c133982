"""From logs without a reference to sweeps: the shaft's motion estimated, and how freely it may have moved."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis.spin.clock import even_clock
from diagnosis.spin.columns import HIGHEST_OF_FRICTION, HIGHEST_ORDER
from diagnosis.spin.problem import Own
from diagnosis.spin.scatter import ANY_GROWTH
from diagnosis.spin.smoother import MotionFit, fitted_motion
from diagnosis.spin.stretches import Turning, turning
from twin.angles import TAU, Array, IntArray
from twin.errors import SweepError
from twin.estimated_motion import EstimatedMotion, Torque
from twin.runs import runs
from twin.second_inertia import Tied
from twin.spin import FEWEST_ROWS, Spin
from twin.sweep import Sweep

CHANNELS_TELL = 4
"""Order up to which offset, gain, phase and saturation of the channels show in their radius."""
_SECTORS = 36
"""Of a turn, by which it is counted how much of it a log passes: a reading every ten degrees makes it all."""
_FREE = 3.0
"""Times the usual: where the motion is freer than that, as in a jerk, readings tell of it and not of the sensor."""


@dataclass(frozen=True, eq=False)
class _Log:
    """A spin, the times (n,) [s] of its readings, whether they are those of an even clock, and where it turns."""

    spin: Spin
    time_s: Array
    even: bool
    found: Turning

    @classmethod
    def of(cls, spin: Spin) -> _Log:
        """Raises SweepError where no stretch shows a turning shaft."""
        even = None if spin.time_s is None else even_clock(spin.time_s, spin.row_numbers)
        stamps = spin.row_numbers.astype(np.float64) if spin.time_s is None else spin.time_s
        time = stamps if even is None else even
        found = _checked(turning(np.radians(spin.measured_deg), time), spin)
        return cls(spin, time, even is not None or spin.time_s is None, found)


MOTION = "estimated_motion"
"""The stage of a call in which it is estimated."""


def with_motion(
    recordings: Sequence[Sweep | Spin], *, begins: Callable[[str], object] = lambda stage: None
) -> list[Sweep]:
    """Recordings of one device as sweeps: those without a reference with the motion estimated from all of them.

    ``begins`` hears of it before, where there is one. Raises SweepError where one of the others has no time stamps:
    speeds of all are told together.
    """
    spins = [one for one in recordings if isinstance(one, Spin)]
    untimed = [one.name for one in recordings if isinstance(one, Sweep) and one.time_s is None]
    if spins and untimed:
        raise SweepError(
            f"{untimed[0]}: no time_s beside {spins[0].name}, which has no reference_deg; expected the time of each "
            "reading in all of them: record time_s, or explain it by itself"
        )
    made: Iterator[Sweep] = iter(())
    if spins:
        begins(MOTION)
        made = iter(sweeps_of(spins))
    return [next(made) if isinstance(one, Spin) else one for one in recordings]


def sweeps_of(spins: Sequence[Spin]) -> list[Sweep]:
    """The sweeps whose reference is the motion estimated from the readings themselves.

    Parameters
    ----------
    spins : sequence of Spin
        Logs of one device's readings alone: their speeds together tell torques from errors of the sensor.

    Returns
    -------
    list of Sweep
        Of each the rows in which the shaft turns, ``reference_deg`` being the estimated motion; ``estimated`` says how
        freely the shaft may have moved beside it. The other rows are counted in ``set_aside``.

    Raises
    ------
    SweepError
        Where no stretch of a log shows a turning shaft.
    """
    logs = [_Log.of(spin) for spin in spins]
    fit = _fitted(logs, seek_second=True)
    knees = np.split(fit.knee_rad_s, np.cumsum([log.found.rows.size for log in logs])[:-1])
    parts = [knee > _FREE * float(np.median(knee)) for knee in knees]
    if any(part.any() for part in parts):
        calmer = [replace(log, found=log.found.kept(~out)) for log, out in zip(logs, parts, strict=True)]
        if all(log.found.rows.size >= FEWEST_ROWS for log in calmer):
            logs = calmer
            # From one speed to another a shaft goes by all between: what of a torque grows with the speed shows there,
            # and what swings behind a belt.
            fit = _fitted(logs, most_growing=fit.growing, second=fit.second)
    channels = all("vx" in log.spin.others for log in logs)
    torques = _torques(fit, told_by_channels=CHANNELS_TELL if channels else 0)
    ends = np.cumsum([0, *(log.found.rows.size for log in logs)])
    return [_sweep(log, fit, slice(a, b), torques) for log, a, b in zip(logs, ends[:-1], ends[1:], strict=True)]


def _checked(found: Turning, spin: Spin) -> Turning:
    """What turns of a spin, where it is enough: an error repeats at each pass of an angle, and a motion does not."""
    # So many readings cover as many steps as they are, though one less lies between them.
    stretches = [found.readings_rad[rows] for rows in runs(found.stretch)]
    turns = sum(float(np.ptp(one)) * one.size / max(one.size - 1, 1) for one in stretches) / TAU
    passed = np.unique(np.floor(found.readings_rad / TAU % 1.0 * _SECTORS)).size / _SECTORS
    if found.rows.size < FEWEST_ROWS or turns < max(1.0, 2.0 * passed):
        raise SweepError(
            f"{spin.name}: no reference_deg, and the shaft turns evenly in {found.rows.size} of {len(spin)} rows "
            f"({turns:.2g} turns); without a reference expected a shaft that coasts or turns steadily for some turns, "
            f"at least {FEWEST_ROWS} readings one after another and each angle passed twice; or add reference_deg"
        )
    return found


def _fitted(
    logs: Sequence[_Log],
    *,
    most_growing: Array = ANY_GROWTH,
    second: Tied | None = None,
    seek_second: bool = False,
) -> MotionFit:
    """The motion in all logs, one behind the other: each as free, and its readings as noisy, as it is alone."""
    own = None if len(logs) == 1 else _own([_one_behind_the_other([log], second=second) for log in logs])
    return _one_behind_the_other(logs, own=own, most_growing=most_growing, second=second, seek_second=seek_second)


def _own(alone: Sequence[MotionFit]) -> Own:
    """What each log has of its own, by its fit alone."""
    least = min(float(fit.noise_rad[0]) for fit in alone)
    usual = [float(np.median(np.abs(fit.speed_rad_s))) for fit in alone]
    orders, errors = np.arange(1, HIGHEST_ORDER + 1), slice(2 * HIGHEST_ORDER)
    seen = [np.hypot(*fit.terms.values[errors].reshape(-1, 2).T) for fit in alone]
    return Own(
        precision=np.concatenate([(least / fit.noise_rad) ** 2 for fit in alone]),
        knee_rad_s=np.concatenate([np.full_like(fit.knee_rad_s, np.median(fit.knee_rad_s)) for fit in alone]),
        usual_rad_s=np.concatenate(
            [np.full_like(fit.speed_rad_s, speed) for fit, speed in zip(alone, usual, strict=True)]
        ),
        largest_rad_s2=np.max([one * (orders * speed) ** 2 for one, speed in zip(seen, usual, strict=True)], axis=0),
    )


def _one_behind_the_other(logs: Sequence[_Log], **known: Any) -> MotionFit:
    """The motion in logs, one behind the other; ``known``: what :func:`fitted_motion` takes beside the readings."""
    times, stretches, begins, number = [], [], 0.0, 0
    for log in logs:
        taken = log.time_s[log.found.rows]
        times.append(taken - taken[0] + begins)
        stretches.append(log.found.stretch + number)
        begins, number = float(times[-1][-1]) + 1.0, int(stretches[-1][-1]) + 1
    time, stretch = np.concatenate(times), np.concatenate(stretches)
    readings = np.concatenate([log.found.readings_rad for log in logs])
    return fitted_motion(readings, time, runs(stretch), **known)


def _sweep(log: _Log, fit: MotionFit, own: slice, torques: tuple[Torque, ...]) -> Sweep:
    spin, rows = log.spin, log.found.rows
    told = ("speed_rpm", "direction")
    columns: dict[str, Any] = {name: values[rows] for name, values in spin.others.items() if name not in told}
    time, speed = log.time_s[rows], fit.speed_rad_s[own]
    return Sweep(
        reference_deg=np.degrees(fit.shaft_rad[own]),
        measured_deg=spin.measured_deg[rows],
        time_s=time,
        direction=np.sign(speed),
        speed_rpm=np.degrees(speed) / 6.0,
        rejected=spin.rejected,
        name=spin.name,
        row_numbers=spin.row_numbers[rows],
        read_as=spin.read_as,
        set_aside=len(spin) - rows.size,
        estimated=EstimatedMotion(
            stretch=log.found.stretch,
            knee_rad=fit.knee_rad_s[own] * float(np.median(np.diff(time))),
            noise_rad=float(np.median(fit.noise_rad[own])),
            torques=torques,
            damping_per_s=fit.damping_per_s,
            damping_sd_per_s=fit.damping_sd_per_s,
            second=fit.second,
            rows_aside=len(spin) - rows.size,
            even_clock=log.even,
        ),
        **columns,
    )


def _torques(fit: MotionFit, *, told_by_channels: int) -> tuple[Torque, ...]:
    """What was found of the torques of each order.

    Up to the order ``told_by_channels`` a torque that the speeds do not tell may be any: the channels' radius tells
    what of the error is theirs.
    """
    terms, first, growing = fit.terms, 2 * HIGHEST_ORDER, 4 * HIGHEST_ORDER
    reversing = growing + 2 * HIGHEST_OF_FRICTION
    usual = float(np.median(np.abs(fit.speed_rad_s)))
    error = np.sqrt(np.diag(terms.covariance))
    torques = []
    for place, order in enumerate(range(1, HIGHEST_ORDER + 1)):
        pair: IntArray = first + 2 * place + np.arange(2)
        separable = bool(fit.separable[place])
        if not separable:
            # One radian: further than any torque turns a shaft to and fro that goes round.
            scatter = (order * usual) ** 2 if order <= told_by_channels else 0.0
            torques.append(Torque(order=order, scatter_rad_s2=scatter))
            continue
        torques.append(
            Torque(
                order=order,
                cos_rad_s2=float(terms.values[pair[0]]),
                sin_rad_s2=float(terms.values[pair[1]]),
                sd_rad_s2=float(np.max(error[pair])),
                scatter_rad_s2=float(terms.sd[pair[0]]),
                growing_rad_s=float(terms.sd[growing + 2 * place]) if order <= HIGHEST_OF_FRICTION else 0.0,
                reversing_rad_s2=float(terms.sd[reversing + 2 * place]) if order <= HIGHEST_OF_FRICTION else 0.0,
                separable=True,
            )
        )
    return tuple(torques)
