"""A torque locked to the angle turns the shaft as the equation of motion says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from twin.mechanics.torque_ripple import response


@pytest.mark.parametrize(("order", "damping"), [(1, 0.0), (4, 0.0), (1, 8.0)])
def test_the_response_is_that_of_the_equation_of_motion(order: int, damping: float) -> None:
    """The next term of the expansion is of the order of (deceleration/(order speed^2))^2, here below 1e-3."""
    size, speed, slows = 0.2 * order, 40.0, -6.0

    def moved(time: float, state: np.ndarray) -> list[float]:
        angle, rate = state
        pull = -damping * (rate - speed - slows * time)
        return [rate, slows + pull + size * np.cos(order * angle)]

    times = np.linspace(0.0, 4.0, 4000)
    found = solve_ivp(moved, (0.0, 4.0), [0.0, speed], t_eval=times, rtol=1e-10, atol=1e-12).y[0]
    even = speed * times + 0.5 * slows * times**2
    told = size * response(
        order,
        shaft_rad=even,
        speed_rad_s=speed + slows * times,
        acceleration_rad_s2=np.full(times.size, slows),
        damping_per_s=damping,
    )
    away = found - even
    # Where the motion begins gives it a start of its own: a straight line, or one that dies away.
    begins = [np.ones_like(times), times] if damping == 0.0 else [np.ones_like(times), np.exp(-damping * times)]
    columns = np.stack([*begins, told[0]])
    part = np.linalg.lstsq(columns.T, away, rcond=None)[0]
    assert part[-1] == pytest.approx(1.0, abs=0.02)
    assert np.std(away - part @ columns) < 0.03 * np.std(told[0])
