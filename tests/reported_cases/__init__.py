"""Sweeps of the kinds that people post when their encoder is off, made by code that knows nothing of the program."""
