"""Batches of devices with known truth: what they share, which are odd, since when. Independent of the twin."""
