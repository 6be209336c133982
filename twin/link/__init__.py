"""The angle word on its way. What makes a reading old, or its instant uncertain, acts on the shaft angle it shows."""

from twin.link.bus_glitch import BUS_GLITCH
from twin.link.dead_zone import DEAD_ZONE
from twin.link.error_code import ERROR_CODE
from twin.link.latency import LATENCY
from twin.link.output_quantisation import OUTPUT_QUANTISATION
from twin.link.scale_error import SCALE_ERROR
from twin.link.stale_frames import STALE_FRAMES
from twin.link.time_jitter import TIME_JITTER
from twin.link.word_bit import WORD_BIT

EFFECTS = (
    LATENCY,
    TIME_JITTER,
    OUTPUT_QUANTISATION,
    STALE_FRAMES,
    BUS_GLITCH,
    DEAD_ZONE,
    WORD_BIT,
    SCALE_ERROR,
    ERROR_CODE,
)
