"""What the program does, step by step, for whoever wants to know: the logger ``halltwin``, silent unless it is asked.

``halltwin COMMAND --verbose`` shows it; from Python, ``logging.basicConfig(level="INFO")`` does.
"""

from __future__ import annotations

import logging

LOG = logging.getLogger("halltwin")
"""Told at INFO: what was read, with which settings and seed, each stage with its time."""
LOG.addHandler(logging.NullHandler())
