"""The magnet: its field at the sensor and the orders its magnetisation adds."""

from twin.magnet.magnet_harmonic import MAGNET_HARMONIC
from twin.magnet.magnet_misalignment import MAGNET_MISALIGNMENT
from twin.magnet.motor_field import MOTOR_FIELD
from twin.magnet.motor_poles import MOTOR_POLES
from twin.magnet.stray_field import STRAY_FIELD

EFFECTS = (MAGNET_HARMONIC, MAGNET_MISALIGNMENT, MOTOR_POLES, MOTOR_FIELD, STRAY_FIELD)
