"""The noise of a fit: the spectra it may have, its colour, its distribution and scale, its share ahead of rounding."""
