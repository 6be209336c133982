"""Structure without a name: shapes that the extended twin carries where no cause of the catalogue explains it.

Where nothing says otherwise they act on the computed angle. They are declared like any other effect, so they are
simulated, fitted and searched for by the same code. Their names begin with ``unnamed``.
"""

from twin.empirical.local import UNNAMED_BUMP, UNNAMED_FLANKS, UNNAMED_SEAM
from twin.empirical.orders import (
    UNNAMED_DIRECTION,
    UNNAMED_DIRECTION_ORDER,
    UNNAMED_ORDER,
    UNNAMED_SPEED,
    UNNAMED_SPEED_ZERO,
    UNNAMED_TEMPERATURE,
    UNNAMED_TEMPERATURE_ORDER,
)
from twin.empirical.spread import UNNAMED_BURST
from twin.empirical.time import UNNAMED_CREEP, UNNAMED_DRIFT, UNNAMED_TONE

EFFECTS = (
    UNNAMED_ORDER,
    UNNAMED_DIRECTION,
    UNNAMED_DIRECTION_ORDER,
    UNNAMED_TEMPERATURE,
    UNNAMED_TEMPERATURE_ORDER,
    UNNAMED_SPEED,
    UNNAMED_SPEED_ZERO,
    UNNAMED_TONE,
    UNNAMED_DRIFT,
    UNNAMED_CREEP,
    UNNAMED_BUMP,
    UNNAMED_FLANKS,
    UNNAMED_SEAM,
    UNNAMED_BURST,
)
