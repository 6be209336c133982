"""The analogue-to-digital converter. ``xy_skew`` shifts its sampling instants, so it acts on the shaft angle."""

from twin.adc.adc_inl import ADC_INL
from twin.adc.adc_quantisation import ADC_QUANTISATION
from twin.adc.adc_stuck_bit import ADC_STUCK_BIT
from twin.adc.clipping import CLIPPING
from twin.adc.reference_jitter import REFERENCE_JITTER
from twin.adc.reference_ripple import REFERENCE_RIPPLE
from twin.adc.xy_skew import XY_SKEW

EFFECTS = (XY_SKEW, CLIPPING, ADC_INL, REFERENCE_RIPPLE, REFERENCE_JITTER, ADC_STUCK_BIT, ADC_QUANTISATION)
