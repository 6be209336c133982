"""The forward model of a magnetic angle sensor's chain: simulate it, trace it, read and write its sweeps and twins."""

from twin.angles import Array
from twin.chain import Chain
from twin.effect import Effect, Param, Parameters
from twin.errors import SweepError
from twin.motion import Motion
from twin.sweep import Sweep

__all__ = ["Array", "Chain", "Effect", "Motion", "Param", "Parameters", "Sweep", "SweepError"]
