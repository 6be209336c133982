"""Sweeps made from physics: field sums, magnetisation curves, plays, integer converters, rotors, lags.

Nothing here is a formula of the catalogue. Each kind says which answers are right for it.
"""
