"""The integrated magnetic concentrator: a soft magnetic disk that turns the in-plane field into the Hall plates."""

from twin.concentrator.hysteresis import HYSTERESIS
from twin.concentrator.saturation import SATURATION

EFFECTS = (HYSTERESIS, SATURATION)
