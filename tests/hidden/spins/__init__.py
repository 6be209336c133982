"""Spins without a reference: rotors with dynamics of their own, sensors on them, and what judges a correction.

Nothing in here uses the simulator or the diagnoser of the project: the tool that is judged is named to the study.
"""
