"""The reference encoder and the drive that turns the shaft: what the sensor is held against."""

from twin.reference.drive_ripple import DRIVE_RIPPLE
from twin.reference.index_slip import INDEX_SLIP
from twin.reference.reference_eccentricity import REFERENCE_ECCENTRICITY
from twin.reference.reference_quantisation import REFERENCE_QUANTISATION
from twin.reference.reference_rezero import REFERENCE_REZERO

EFFECTS = (DRIVE_RIPPLE, REFERENCE_ECCENTRICITY, REFERENCE_REZERO, INDEX_SLIP, REFERENCE_QUANTISATION)
