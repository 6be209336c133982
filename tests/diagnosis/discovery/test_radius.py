"""What vx and vy say: a reference or a coupling is named alone only where no misplaced magnet does the same."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from diagnosis import Mounting, explain
from twin.chain import Chain
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import Motion

TURNS = Motion.from_angle(np.radians(np.arange(0.0, 720.0, 2.0)), has_channels=True)
MISPLACED, JOINT, REFERENCE = "magnet_misalignment", "cardan_coupling", "reference_eccentricity"
TURNED = {"amplitude_deg": 0.25, "phase_deg": 30.0}
"""As much as a square block of 6 mm does before a sensor that is 0.3 mm off the axis."""
OFF = Placement(sensor_x_mm=0.25, sensor_y_mm=-0.15, magnet_x_mm=0.1)
ROUND = Mounting(magnet=Magnet())


@dataclass(frozen=True, kw_only=True)
class Case:
    """A device, what is known of its magnet, and the class of each cause that is named, the name first."""

    chain: Chain
    mounting: Mounting | None = None
    classes: list[tuple[str, ...]] = field(default_factory=list)


CASES = {
    "a joint, nothing known of the magnet": Case(
        chain=Chain().with_effect(JOINT, **TURNED), classes=[(MISPLACED, JOINT)]
    ),
    "a joint before a round magnet": Case(
        chain=Chain().with_effect(JOINT, **TURNED), mounting=ROUND, classes=[(JOINT,)]
    ),
    "a joint that bends more than any sensor is off": Case(
        chain=Chain().with_effect(JOINT, amplitude_deg=4.0), classes=[(JOINT,)]
    ),
    "a reference": Case(chain=Chain().with_effect(REFERENCE, **TURNED), classes=[(MISPLACED, REFERENCE)]),
    "both": Case(
        chain=Chain().with_effect(JOINT, **TURNED).with_effect(REFERENCE, **TURNED),
        classes=[(MISPLACED, JOINT), (MISPLACED, REFERENCE)],
    ),
    "a block magnet": Case(
        chain=Chain(magnet=Assembly(Magnet(shape="block"), OFF)),
        classes=[(MISPLACED, JOINT), (MISPLACED, REFERENCE)],
    ),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_class_where_a_misplaced_magnet_does_the_same(case: Case) -> None:
    sweep = case.chain.with_effect("noise", rms_deg=0.02).simulate(TURNS, seed=3)
    found = explain(sweep, mounting=case.mounting).causes
    assert sorted((cause.name, *cause.indistinguishable_from) for cause in found) == sorted(case.classes)
