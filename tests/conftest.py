"""For every test: numerical libraries on one thread, as the command line has them."""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
