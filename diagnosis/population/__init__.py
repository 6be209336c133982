"""Many devices of one batch: what they have in common, how they scatter, which stand apart, and since when."""
