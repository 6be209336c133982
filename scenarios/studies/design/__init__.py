"""Design space: magnets, distances and tolerances through field and error."""
