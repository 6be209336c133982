"""From two channel codes to an angle."""

from twin.cordic.cordic_truncation import CORDIC_TRUNCATION

EFFECTS = (CORDIC_TRUNCATION,)
