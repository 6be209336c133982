"""A torque locked to the angle turns the shaft as the equation of motion says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from twin.mechanics.torque_ripple import response, second_order


@pytest.mark.parametrize(
    ("order", "damping", "slows", "off"),
    [(1, 0.0, -6.0, 0.003), (4, 0.0, -6.0, 0.003), (1, 0.0, -8.0, 0.004), (1, 8.0, -6.0, 0.02)],
)
def test_the_response_is_that_of_the_equation_of_motion(order: int, damping: float, slows: float, off: float) -> None:
    """The third slows by an eighth of its speed in a radian at the end, where the approximant is off by 0.005.

    Of the last, what the damping does while the speed changes is left out: twice 6/16^2 of 8/16 at the end.
    """
    size, speed = 0.02 * order, 40.0
    times = np.linspace(0.0, 4.0, 4000)
    even = speed * times + 0.5 * slows * times**2

    def moved(time: float, state: np.ndarray) -> list[float]:
        away, rate = state
        return [rate, size * np.cos(order * (speed * time + 0.5 * slows * time**2 + away)) - damping * rate]

    away = solve_ivp(moved, (0.0, 4.0), [0.0, 0.0], t_eval=times, rtol=1e-10, atol=1e-14).y[0]
    told = size * response(
        order,
        shaft_rad=even,
        speed_rad_s=speed + slows * times,
        acceleration_rad_s2=np.full(times.size, slows),
        damping_per_s=damping,
    )
    # Where the motion begins gives it a start of its own: a straight line, or one that dies away.
    begins = [np.ones_like(times), times] if damping == 0.0 else [np.ones_like(times), np.exp(-damping * times)]
    columns = np.stack([*begins, told[0]])
    part = np.linalg.lstsq(columns.T, away, rcond=None)[0]
    assert part[-1] == pytest.approx(1.0, abs=off)
    assert np.std(away - part @ columns) < off * np.std(told[0])


def test_a_strong_torque_turns_the_shaft_at_twice_its_order_too() -> None:
    """Against the exact integral over the angle: order 8 by 0.32 deg makes 0.005 deg of the order 16."""
    torques = np.zeros((8, 2))
    torques[7], torques[0] = (0.0, 206.0), (0.2, -0.1)
    speed, shaft = 24.0, np.linspace(0.0, 8.0 * np.pi, 400_001)
    order = np.arange(1, 9)[:, None]
    pull = torques[:, 0] @ np.cos(order * shaft) + torques[:, 1] @ np.sin(order * shaft)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (pull[1:] + pull[:-1]) * np.diff(shaft))])
    slowness = 1.0 / np.sqrt(speed**2 + 2.0 * (work - work.mean()))
    time = np.concatenate([[0.0], np.cumsum(0.5 * (slowness[1:] + slowness[:-1]) * np.diff(shaft))])
    usual = np.full(shaft.size, shaft[-1] / time[-1])
    still = np.zeros(shaft.size)
    turned = shaft - usual * time
    for k, pair in enumerate(torques, start=1):
        turned = turned - pair @ response(k, shaft_rad=shaft, speed_rad_s=usual, acceleration_rad_s2=still)
    beyond = np.std(turned)
    assert beyond == pytest.approx(np.radians(0.0053) / np.sqrt(2.0), rel=0.1)
    assert np.std(turned - second_order(torques, shaft_rad=shaft, speed_rad_s=usual)) < 0.1 * beyond
