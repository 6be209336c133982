"""The angle word on its way. ``latency`` makes a reading old, so it acts on the shaft angle it shows."""

from twin.link.bus_glitch import BUS_GLITCH
from twin.link.latency import LATENCY
from twin.link.output_quantisation import OUTPUT_QUANTISATION
from twin.link.stale_frames import STALE_FRAMES

EFFECTS = (LATENCY, OUTPUT_QUANTISATION, STALE_FRAMES, BUS_GLITCH)
