"""Between the shaft and the magnet: coupling, bearing, mount."""

from twin.mechanics.backlash import BACKLASH
from twin.mechanics.bearing_wobble import BEARING_WOBBLE
from twin.mechanics.cardan_coupling import CARDAN_COUPLING
from twin.mechanics.load_torsion import LOAD_TORSION
from twin.mechanics.thermal_zero_shift import THERMAL_ZERO_SHIFT
from twin.mechanics.zero import ZERO
from twin.mechanics.zero_drift import ZERO_DRIFT

EFFECTS = (LOAD_TORSION, BACKLASH, CARDAN_COUPLING, BEARING_WOBBLE, ZERO_DRIFT, THERMAL_ZERO_SHIFT, ZERO)
