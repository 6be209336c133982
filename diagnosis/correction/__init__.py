"""Corrections made from a fit, and what they are worth on readings that no fit has seen."""
