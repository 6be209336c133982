"""The inverse of the twin: from measured sweeps to error factors, causes and corrections."""

from diagnosis.error_model.fit import fit_baseline
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.findings import Findings, diagnose, diagnose_many

__all__ = ["BaselineFit", "Findings", "diagnose", "diagnose_many", "fit_baseline"]
