"""The inverse of the twin: from measured sweeps to error factors, causes and corrections."""

from diagnosis.baseline_fit import BaselineFit
from diagnosis.findings import Findings, diagnose, diagnose_many
from diagnosis.fit import fit_baseline

__all__ = ["BaselineFit", "Findings", "diagnose", "diagnose_many", "fit_baseline"]
