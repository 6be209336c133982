"""The two channels beside the reading: swapped, turned over, or about a mid-range."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.record import FEWEST, Record
from twin.angles import Array, wrap_deg
from twin.following import spread_deg

_SURELY = 4.0
"""One sense is clearly meant where the other leaves so many times as much."""
_QUARTER_DEG = 1.0
"""Channels that are swapped give 90 deg minus the angle, but for what their offsets move its mean by."""


def _channels(record: Record) -> tuple[Array, Array, Array] | None:
    """The channels and the reading (m,), where both channels hold a signal."""
    vx, vy = record.column("vx"), record.column("vy")
    if vx is None or vy is None or vx.size < FEWEST:
        return None
    known = np.isfinite(vx) & np.isfinite(vy)
    if known.sum() < FEWEST or min(np.ptp(vx[known]), np.ptp(vy[known])) == 0.0:
        return None
    return vx[known], vy[known], record.measured_deg[known]


def swapped_channels(record: Record) -> Finding | None:
    """Channels whose angle counts the other way than the reading that is computed from them."""
    found = _channels(record)
    if found is None or any(column.across is not None for column in record.statement):
        return None
    vx, vy, measured = found
    angle = np.degrees(np.arctan2(_about_middle(vy), _about_middle(vx)))
    along, against = spread_deg(measured - angle), spread_deg(measured + angle)
    if against * _SURELY > along or against > 30.0:
        return None
    zero = float(np.degrees(np.angle(np.mean(np.exp(1j * np.radians(measured + angle))))))
    # Any other sum is that of a sensor whose output counts against its channels, as many do.
    if abs(float(wrap_deg(zero - 90.0))) > _QUARTER_DEG:
        return None
    return Finding(
        kind="swapped_channels",
        what="sine and cosine are swapped",
        evidence=f"the reading and atan2(vy, vx) add up to {zero:.1f} deg, within {against:.2f} deg: the angle is "
        "atan2(vx, vy)",
        consequence="offset, gain and phase are told of the wrong channel",
        remedy="take vx for vy and vy for vx",
        columns=record.exchanged("vx", "vy"),
    )


def mid_range(record: Record) -> Finding | None:
    """Channels about the middle of a converter's range instead of about zero."""
    found = _channels(record)
    if found is None:
        return None
    vx, vy, measured = found
    middles = [_middle(one) for one in (vx, vy)]
    plain = np.degrees(np.arctan2(vy, vx))
    centred = np.degrees(np.arctan2(vy - middles[1], vx - middles[0]))
    own, mended = (min(spread_deg(measured - s * one) for s in (1.0, -1.0)) for one in (plain, centred))
    if own < 30.0 or mended * _SURELY > own:
        return None
    return Finding(
        kind="mid_range",
        what="the channels stand about the middle of the converter's range instead of about zero",
        evidence=f"vx about {middles[0]:.4g} and vy about {middles[1]:.4g}; less these, their angle is the reading's",
        consequence="no radius and no offset can be told of them",
        remedy=f"take the middle off: vx=...-{middles[0]:.0f}, vy=...-{middles[1]:.0f} in the statement",
    )


def _middle(values: Array) -> float:
    return float(np.max(values) + np.min(values)) / 2.0


def _about_middle(values: Array) -> Array:
    """A channel about its middle where all its values have one sign."""
    return values - _middle(values) if values.min() > 0.0 or values.max() < 0.0 else values
