"""saturation: the concentrator's flux falls behind the field as the field grows."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion

CUBIC = 2.0
"""Exponent of the loss in a curve that is smooth through zero: c - k c^3."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    k = 0.01 * np.asarray(values["k_percent"])
    exponent = exponent_of(values)
    if np.all(exponent == CUBIC):
        return signal - k * (signal * signal * signal)
    return np.asarray(signal - k * of_order_4(exponent) * signal * np.abs(signal) ** exponent)


def exponent_of(values: Parameters) -> Array:
    """The loss's exponent: the power of the field with which its share grows."""
    return np.asarray(values.get("exponent", CUBIC), dtype=np.float64)[()]


def of_order_4(exponent: Array) -> Array:
    """What k is multiplied by so that a loss of this exponent turns the angle in order 4 as the cubic's does.

    The loss k c |c|^p turns the angle by k sin a cos a (|cos a|^p - |sin a|^p), whose component in sin 4a is
    k (4 / sqrt(pi)) p Gamma((p + 3) / 2) / Gamma(p / 2 + 4): a quarter of k for p = 2.
    """
    from scipy.special import gammaln

    share = 4.0 / np.sqrt(np.pi) * exponent * np.exp(gammaln(0.5 * (exponent + 3.0)) - gammaln(0.5 * exponent + 4.0))
    return np.asarray(0.25 / share)


SATURATION = Effect(
    name="saturation",
    stage="concentrator",
    acts_on="channels",
    params={
        # Of a cubic, the next odd term of a magnetisation curve that bends down, it grows with the square of the field.
        "k_percent": Param(
            unit="%",
            null=0.0,
            lower=0.0,
            upper=30.0,
            doc="loss at full amplitude, c - k c^3, or that of the cubic with the same order 4",
            typical=0.5,
            field_power=exponent_of,
        ),
        "exponent": Param(
            unit="1",
            null=CUBIC,
            lower=0.5,
            upper=6.0,
            doc="of the loss; 2: cubic, tanh, 1: Froehlich's curve c / (1 + k |c|)",
            role="shape",
            typical=0.5,
            # Froehlich's curve is as far from it as two standard deviations.
            prior_mean=CUBIC,
            prior_sd=0.5,
            aside=True,
        ),
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    fitted_shapes=("exponent",),
    source="leading term of the magnetisation curve of a soft magnetic disk; paper, section 2.2.4; exponent 1: "
    "Froehlich, Elektrotechnische Zeitschrift 2 (1881) 134",
    signature="order 4, phase locked to the sensor axes (sin 4a); order 4 in the radius",
)
