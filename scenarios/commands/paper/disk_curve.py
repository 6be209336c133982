"""The concentrator's output over the field (Fig. 6), from its disk, and the quadratic of Eq. 2 that is fitted to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenarios.commands.paper.held import Held
from scenarios.commands.paper.table_1 import largest_deg
from twin.angles import Array
from twin.chain import Chain
from twin.concentrator.disk import Disk, vertical_mT
from twin.hall.quadratic_nonlinearity import QUADRATIC_NONLINEARITY

LARGEST_MT = 100.0
ASSUMED_MT = 500.0
"""In-plane field at which the disk saturates: a typical assumption; the paper names none."""
PRINTED_NL_MT, PRINTED_UP_TO_MT = 0.5, 80.0
"""Section 2.1: the magnetic non-linearity, and the field that it is stated up to."""
PRINTED_ERROR_DEG = 0.07682
"""Table 1: the error by the non-linearity at 100 mT."""


@dataclass(frozen=True, eq=False)
class DiskCurve:
    """Field in the plane [mT] (n,), from zero up, and what the disk makes of it, by a field of the slope at zero.

    ``quadratic`` holds K3, K2, K1 of Eq. 2 for the field in mT and the output in V, 1 V at 100 mT.
    """

    disk: Disk
    field_mT: Array
    seen_mT: Array
    quadratic: Array

    @property
    def deviation_mT(self) -> Array:
        """How far the output stays behind a straight line."""
        return np.asarray(self.seen_mT - self.field_mT)

    @property
    def voltage_V(self) -> Array:
        """The output at the plates, as a voltage."""
        return np.asarray(self.seen_mT / self.seen_mT[-1])

    @property
    def fitted_V(self) -> Array:
        """The quadratic's."""
        return np.asarray(np.polynomial.polynomial.polyval(self.field_mT, self.quadratic), dtype=np.float64)

    @property
    def fitted_deviation_mT(self) -> Array:
        """The quadratic's deviation from the same straight line."""
        return np.asarray(self.fitted_V * self.seen_mT[-1] - self.field_mT)

    @property
    def q(self) -> float:
        """q = K1 mag / K2 at 100 mT."""
        return float(self.quadratic[2] * LARGEST_MT / self.quadratic[1])


def disk_curve(disk: Disk | None = None) -> DiskCurve:
    """The curve of a disk; without one that of the assumed saturation."""
    disk = disk or Disk(saturation_mT=ASSUMED_MT)
    field: Array = np.linspace(0.0, LARGEST_MT, 201)
    seen = vertical_mT(np.stack([field, np.zeros(field.size)]), disk)[0] / disk.gain
    return DiskCurve(disk, field, seen, np.polynomial.polynomial.polyfit(field, seen / seen[-1], 2))


def held(curve: DiskCurve) -> list[Held]:
    """The paper's non-linearity, and its error at 100 mT, against the disk's."""
    at = float(np.interp(PRINTED_UP_TO_MT, curve.field_mT, -curve.deviation_mT))
    # The cubic term of tanh: the deviation goes inversely with the square of the saturation.
    as_printed = curve.disk.saturation_mT * np.sqrt(at / PRINTED_NL_MT)
    error = largest_deg(Chain().with_effect(QUADRATIC_NONLINEARITY.name, q_percent=100.0 * curve.q))
    return [
        Held(
            where="Fig. 6",
            what="non-linearity up to 80 mT",
            printed=PRINTED_NL_MT,
            ours=at,
            unit="mT",
            remark=f"a disk that saturates at {curve.disk.saturation_mT:g} mT, a typical assumption; "
            f"one of {as_printed:.0f} mT has the printed figure",
        ),
        Held(
            where="Fig. 7",
            what="error by the quadratic fit at 100 mT",
            printed=PRINTED_ERROR_DEG,
            ours=error,
            unit="deg",
            remark=f"K1 mag / K2 is {curve.q:.4f} for the disk's curve, the printed error needs 0.0019; over a whole "
            "turn that curve is odd in the field and makes order 4, not the quadratic's orders 1 and 3",
        ),
    ]
