"""The forward model of a magnetic angle sensor's chain: simulate it, trace it, read and write its sweeps and twins."""

from twin.chain import Chain
from twin.effect import Effect, Param
from twin.motion import Motion
from twin.sweep import Sweep, SweepError

__all__ = ["Chain", "Effect", "Motion", "Param", "Sweep", "SweepError"]
