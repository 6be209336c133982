"""For every test: numerical libraries on one thread, as the command line has them."""

from __future__ import annotations

import os
import sys
import warnings

if "numpy" in sys.modules and "OPENBLAS_NUM_THREADS" not in os.environ:
    warnings.warn(
        "a plugin of pytest imported numpy before its threads were limited, so the tests take several times the CPU: "
        "run with OPENBLAS_NUM_THREADS=1, or without the plugin (-p no:NAME)",
        stacklevel=1,
    )
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
