"""Proof: held-out readings, family-wise error by the parametric bootstrap, the predictive check."""
