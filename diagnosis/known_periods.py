"""Whether a recording and a twin can be those of a sensor whose number of periods a turn is known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from twin.angles import Array
from twin.chain import Chain
from twin.errors import SweepError, UserError
from twin.hall.multipole import MULTIPOLE
from twin.periods import OPTION
from twin.sweep import Sweep

_LEAST_SHOWN = 0.1


def check_seen(sweeps: Sequence[Sweep], pole_pairs: int) -> None:
    """Refuse recordings at whose angles nothing is told of so many periods. Raises SweepError.

    Offset, gain and phase within a period make lines of the orders P and 2P. What of these the angles do not show like
    a constant and orders 1 and 2 must leave each of their combinations a tenth: below, it is known ten times worse than
    readings all over the turn would tell it.
    """
    angle = np.radians(np.concatenate([sweep.reference_deg for sweep in sweeps]))

    def lines(*orders: int) -> list[Array]:
        return [wave(order * angle) for order in orders for wave in (np.cos, np.sin)]

    known = np.stack([np.ones_like(angle), *lines(*(1,) if pole_pairs == 2 else (1, 2))], axis=1)
    sought = np.stack(lines(pole_pairs, 2 * pole_pairs), axis=1)
    left = sought - known @ np.linalg.lstsq(known, sought, rcond=None)[0]
    if np.linalg.svd(left / np.sqrt(0.5 * angle.size), compute_uv=False)[-1] < _LEAST_SHOWN:
        even = np.unique(np.round(np.mod(np.degrees(angle), 360.0), 1) % 360.0).size
        raise SweepError(
            f"{sweeps[0].name}: its {even} different angles do not show the lines of orders {pole_pairs} and "
            f"{2 * pole_pairs} of {pole_pairs} periods a turn ({OPTION}); expected more than {4 * pole_pairs} points a "
            "turn: take more, or check the number"
        )


def check_periods(chain: Chain, periods: int) -> None:
    """Refuse a twin whose sensor has another number of periods. Raises UserError."""
    own = chain.values.get(MULTIPOLE.name, {}).get("periods", periods)
    if own != periods:
        raise UserError(
            f"the twin's sensor has {own:g} periods a turn, and {OPTION} is {periods}; expected the same: leave the "
            "option out, or give the twin of this device"
        )
