"""Where the measured and the challenge sweeps lie: beside the checkout, not in the repository.

Tests that read them bear the marker ``measured``; see tests/conftest.py for what becomes of it where they are absent.
"""

from __future__ import annotations

from pathlib import Path

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
REAL = DATA / "real"
"""Sweeps of real sensors; what is known of them stands in their README."""
CHALLENGE = DATA / "challenge"
"""Sweeps made by a program that shares no code with this project, and what is hidden in them (truth.json)."""
