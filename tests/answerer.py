"""The answer that a study asks for unless it is told of another program."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from diagnosis import explain
from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.fitting.observations import collect
from diagnosis.input_checks import as_sweep


def explain_file(path: str) -> Mapping[str, Any]:
    """The JSON answer of ``halltwin explain`` to a sweep file."""
    return explain(path).to_dict()


def explain_and_predict(path: str, further: str) -> tuple[Mapping[str, Any], float]:
    """The same, and what the extended twin is off in another recording of the device, RMS in degrees.

    Nothing of the twin is fitted to that recording, not even its zero.
    """
    found = explain(path)
    fit = found.discovery.fit
    predicted = evaluate(fit.chain, (), collect(as_sweep(further)), fit.weighting)
    return found.to_dict(), float(np.degrees(np.sqrt(np.mean(predicted.residual[0] ** 2))))
