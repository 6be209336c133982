"""Synthetic training sweeps with known truth."""
