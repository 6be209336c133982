"""The one name that people read for each factor of the paper's error model, and the unit it is shown in."""

from __future__ import annotations

from twin.baseline import FACTORS

LABELS = {factor.name: factor.label for factor in FACTORS}
"""Key of the JSON -> what people read."""
UNITS = {factor.name: factor.shown_unit for factor in FACTORS}
"""Key of the JSON -> the unit shown: offsets and quadratic term in percent of the amplitude."""
SCALES = {factor.name: 1.0 / factor.scale for factor in FACTORS}
"""Key of the JSON -> what the JSON's figure is multiplied by for that unit."""
