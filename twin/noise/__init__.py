"""Noise of a reading: one description, its spectrum, and sequences drawn from it, for simulating as for fitting."""
