"""The stepwise search over causes: screening by first order, exact fits, removal and replacement."""
