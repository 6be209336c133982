"""The Hall plates and their front-end: from the vertical field to two voltages."""

from twin.hall.gain_drift import GAIN_DRIFT
from twin.hall.gain_mismatch import GAIN_MISMATCH
from twin.hall.mains_pickup import MAINS_PICKUP
from twin.hall.multipole import MULTIPOLE
from twin.hall.noise import NOISE
from twin.hall.offset import OFFSET
from twin.hall.offset_drift import OFFSET_DRIFT
from twin.hall.phase import PHASE
from twin.hall.phase_drift import PHASE_DRIFT
from twin.hall.quadratic_nonlinearity import QUADRATIC_NONLINEARITY

EFFECTS = (
    MULTIPOLE,
    PHASE,
    PHASE_DRIFT,
    QUADRATIC_NONLINEARITY,
    OFFSET,
    OFFSET_DRIFT,
    GAIN_MISMATCH,
    GAIN_DRIFT,
    MAINS_PICKUP,
    NOISE,
)
