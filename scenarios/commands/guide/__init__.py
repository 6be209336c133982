"""The guide as pages of HTML: its text, the reference from the docstrings, and each cause's footprint by the twin."""
