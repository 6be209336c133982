"""The twin beside what vendors publish, as a table of the guide: ``python -m tests.twin.published_table``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from scipy.optimize import brentq

from tests.twin import published as told
from twin.chain import Chain
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.magnet.ring_sensor import RingSensor, ring_channels_mT
from twin.magnet.side_shaft import SideShaft, radial_over_tangential, side_channels_mT

Row = tuple[str, str, str, str, str]
"""Source, what, published, ours, what the tolerance is made of."""


def rows() -> Iterator[Row]:
    """One row a published figure or curve."""
    yield from _rings()
    yield from _planes()
    yield from _side()
    yield from _chains()


def _rings() -> Iterator[Row]:
    def errors(plates: int) -> list[float]:
        sensor, gap = RingSensor(plates=plates), told.AM4096_GAPS_MM[0]
        placed = [Placement(air_gap_mm=gap, sensor_x_mm=shift) for shift in told.AM4096_ERROR_DEG]
        return [told.ring_error_deg(sensor, told.AM4096_MAGNET, one) for one in placed]

    what = f"ring of plates displaced by {_listed(told.AM4096_ERROR_DEG, 'g')} mm: error, deg"
    ours = f"{_listed(errors(4), '.2f')} (4 plates); {_listed(errors(8), '.2f')} (8)"
    yield told.AM4096, what, _listed(told.AM4096_ERROR_DEG.values(), "g"), ours, "number and radius of plates, gap"
    fields = [
        np.max(ring_channels_mT(RingSensor(), told.AM4096_MAGNET, Placement(air_gap_mm=gap), told.TURN_RAD))
        for gap in told.AM4096_GAPS_MM
    ]
    what = f"field at its radius, {_listed(told.AM4096_GAPS_MM, 'g')} mm from the magnet, mT"
    yield told.AM4096, what, f"{told.AM4096_FIELD_MT:g} typical", _listed(fields, ".1f"), "its text and table disagree"
    placed = Placement(air_gap_mm=2.0, sensor_x_mm=0.5, sensor_y_mm=0.5)
    added = [told.ring_error_deg(RingSensor(radius_mm=1.1, plates=n), told.AS5048_MAGNET, placed) for n in (4, 8)]
    published = f"{told.AS5048_DISPLACED_DEG:g} against {told.AS5048_ALIGNED_DEG:g}"
    what = "ring of plates, 0.5 mm off in x and y: error, deg, against aligned"
    yield told.AS5048, what, published, f"{_listed(added, '.2f')} more (4, 8 plates)", "rounding of both to 0.1"


def _planes() -> Iterator[Row]:
    def errors(diameter: float, gap: float) -> list[float]:
        magnet = Magnet(diameter_mm=diameter, height_mm=4.0)
        return [told.plane_error_deg(magnet, Placement(air_gap_mm=gap, sensor_x_mm=d)) for d in told.A1335_ERROR_DEG]

    what = f"plates in the plane displaced by {_listed(told.A1335_ERROR_DEG, 'g')} mm: error, deg"
    as_stated, fitting = (_listed(errors(*body), ".2f") for body in ((10.0, 2.7), (9.5, 2.31)))
    ours = f"as stated {as_stated}; a magnet of 9.5 mm at 2.31 mm {fitting}"
    published = _listed(told.A1335_ERROR_DEG.values(), "g")
    yield told.A1335, what, published, ours, "the magnet's sizes to a millimetre, the die's depth"
    times, largest = told.MLX90363_RULE
    sizes = ((6.0, 2.5), (8.0, 3.0), (10.0, 4.0), (14.0, 5.0), (20.0, 6.0))
    worst = max(
        told.plane_error_deg(
            Magnet(diameter_mm=across, height_mm=high), Placement(air_gap_mm=gap, sensor_x_mm=across / times)
        )
        for across, high in sizes
        for gap in (0.5, 1.0, 2.0, 3.0, 4.0, 5.0)
    )
    what = "displaced by a tenth of the diameter: error, deg"
    yield told.MLX90363, what, f"below {largest:g}", f"{worst:.2f} at most, of five magnets", "a rule, for any magnet"


def _side() -> Iterator[Row]:
    magnet, found = Magnet(diameter_mm=10.0, height_mm=0.5), []
    for k in told.MA702_SIDE_SHAFT:
        z = brentq(lambda z, k=k: radial_over_tangential(SideShaft(distance_mm=5.3, height_mm=z), magnet) - k, 0.0, 8.0)
        place = SideShaft(distance_mm=5.3, height_mm=float(z))
        found.append(told.error_deg(side_channels_mT(place, magnet, told.TURN_RAD)))
    what = f"beside the magnet, field radial over tangential {_listed(told.MA702_SIDE_SHAFT, 'g')}: error, deg"
    published = _listed((error for error, _ in told.MA702_SIDE_SHAFT.values()), "g")
    yield told.MA702, what, published, _listed(found, ".1f"), "rounding to 0.1"


def _chains() -> Iterator[Row]:
    noise = [
        np.std(told.turning(told.noise_at(field, stated_mT=30.0, stated_deg=0.17), 0.0))
        for field in told.A1335_NOISE_DEG
    ]
    what = f"noise at {_listed(told.A1335_NOISE_DEG, 'g')} mT, deg RMS"
    published = _listed(told.A1335_NOISE_DEG.values(), "g")
    yield told.A1335, what, published, f"{_listed(noise, '.3f')} (stated at 30 mT)", "read by eye to 0.01"
    chain = Chain().with_effect("noise", rms_deg=told.AS5048_NOISE_DEG).with_effect("output_quantisation", bits=14)
    steps = np.std(told.turning(chain, 0.0)) / told.AS5048_LSB_DEG
    what = f"noise of {told.AS5048_NOISE_DEG:g} deg in steps of 14 bits"
    yield told.AS5048, what, f"{told.AS5048_NOISE_LSB:g}", f"{steps:.2f}", "rounding of the 0.06 deg"
    what = f"slow filters that delay by {_listed(told.AS5600_FILTER, 'g')} ms: noise, deg RMS"
    filtered = [told.filtered_deg(delay)[0] for delay in told.AS5600_FILTER]
    published = _listed(told.AS5600_FILTER.values(), "g")
    yield told.AS5600, what, published, f"{_listed(filtered, '.4f')} (stated at the fastest)", "rounding to 0.001"
    for source, what, delay_us, rpm, published in (
        (told.AM4096, "lag of 0.7 + 10 + 20 us at 1000 rpm, deg", sum(told.AM4096_DELAY_US), 1000.0, "30.7 us"),
        (told.TMAG5170, "lag of 6 x 8 x 25 + 25 us at 0.85 Hz, deg", float(told.TMAG5170_US), 51.0, "0.37485"),
    ):
        lag = -np.mean(told.turning(Chain().with_effect("latency", delay_us=delay_us), rpm))
        yield source, what, published, f"{lag:.5g}", "none: a product"
    apart = []
    for stated in told.AM4096_HYSTERESIS_DEG:
        forward, backward = (told.turning(told.hysteresis_of(stated), 0.0, way=way) for way in (1, -1))
        apart.append(np.mean(backward) - np.mean(forward))
    what = "electrical hysteresis through 12 bits, deg"
    yield told.AM4096, what, _listed(told.AM4096_HYSTERESIS_DEG, "g"), _listed(apart, ".3f"), "a hundredth of a step"


def _listed(values: Iterable[float], form: str) -> str:
    return ", ".join(format(float(value), form) for value in values)


def table() -> str:
    """The rows as a table of Markdown."""
    head = ("source", "what", "published", "ours", "what the tolerance allows for")
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, ("---",) * 5, *rows())) + "\n"


if __name__ == "__main__":
    print(table(), end="")
