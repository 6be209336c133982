"""The inverse of the twin: from measured sweeps to error factors, causes and corrections.

    from diagnosis import diagnose, explain

    found = explain("sweep.csv")    # what the simulation gets wrong: causes, verdict, extended twin
    found = diagnose("sweep.csv")   # the paper's error factors with their intervals

Both take a path, a :class:`twin.Sweep`, a pandas DataFrame, a dict of arrays or an xarray Dataset.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from diagnosis.changed_parameter import ChangedParameter
from diagnosis.diagnose import diagnose, diagnose_many
from diagnosis.diagnosed import Diagnoses, Diagnosis
from diagnosis.explain import OwnEffects, explain
from diagnosis.explanation import Cause, Estimate, Explanation
from diagnosis.input_checks import Columns, SweepLike
from diagnosis.progress import Progress

if TYPE_CHECKING:
    from diagnosis.discovery.settings import DiscoverySettings
    from diagnosis.error_model.fit import fit_baseline
    from diagnosis.error_model.result import BaselineFit
    from diagnosis.factors.findings import Findings
    from diagnosis.factors.mounting import Mounting

_LOADED_WHEN_USED = {
    "BaselineFit": "diagnosis.error_model.result",
    "DiscoverySettings": "diagnosis.discovery.settings",
    "Findings": "diagnosis.factors.findings",
    "Mounting": "diagnosis.factors.mounting",
    "fit_baseline": "diagnosis.error_model.fit",
}
"""Names of the package whose modules load NumPy: importing ``diagnosis`` does not wait for it."""

__all__ = [
    "BaselineFit",
    "Cause",
    "ChangedParameter",
    "Columns",
    "Diagnoses",
    "Diagnosis",
    "DiscoverySettings",
    "Estimate",
    "Explanation",
    "Findings",
    "Mounting",
    "OwnEffects",
    "Progress",
    "SweepLike",
    "diagnose",
    "diagnose_many",
    "explain",
    "fit_baseline",
]


def __getattr__(name: str) -> Any:
    if name in _LOADED_WHEN_USED:
        return getattr(import_module(_LOADED_WHEN_USED[name]), name)
    raise AttributeError(f"module 'diagnosis' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_LOADED_WHEN_USED])
