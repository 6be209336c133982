"""The paper's error model in the twin's parameters: the six that an angle shows, always fitted, never a discovery."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees

from twin.effect import Effect
from twin.hall.gain_mismatch import GAIN_MISMATCH
from twin.hall.offset import OFFSET
from twin.hall.phase import PHASE
from twin.hall.quadratic_nonlinearity import QUADRATIC_NONLINEARITY
from twin.mechanics.zero import ZERO


@dataclass(frozen=True, kw_only=True)
class Factor:
    """One of the six: its name and unit in answers, the effect and parameter that carry it in a chain.

    The answer's figure is ``scale`` times the parameter; ``label`` is what people read, whatever the key.
    """

    name: str
    label: str
    effect: Effect
    param: str
    scale: float = 1.0
    unit: str = "1"

    @property
    def key(self) -> str:
        """The effect's key in a chain's values."""
        return self.effect.name

    @property
    def per_coordinate(self) -> float:
        """The parameter for a coordinate of 1 of the error model's point: 100 % of a fraction, 57.3 deg of a radian."""
        return degrees(1.0) if self.unit == "deg" else 1.0 / self.scale

    @property
    def shown_unit(self) -> str:
        """The unit in which people read it, which is that of the parameter; nothing for a plain ratio."""
        unit = self.effect.params[self.param].unit
        return "" if unit == "1" else unit

    @property
    def null(self) -> float:
        """The parameter of an ideal sensor."""
        return self.effect.params[self.param].null


FACTORS = (
    Factor(name="Vx_over_Ax", label="offset x", effect=OFFSET, param="x_percent", scale=0.01),
    Factor(name="Vy_over_Ay", label="offset y", effect=OFFSET, param="y_percent", scale=0.01),
    Factor(name="gain_ratio", label="gain ratio", effect=GAIN_MISMATCH, param="ratio"),
    Factor(name="beta_deg", label="phase", effect=PHASE, param="beta_deg", unit="deg"),
    Factor(name="quad", label="quadratic term", effect=QUADRATIC_NONLINEARITY, param="q_percent", scale=0.01),
    Factor(name="zero_deg", label="zero", effect=ZERO, param="zero_deg", unit="deg"),
)
"""In the order of the model's points."""
