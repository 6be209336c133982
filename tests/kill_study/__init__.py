"""Whether studies and bench lose anything when they are killed, run out of disk, or are started twice.

``python -m tests.kill_study`` tries it with real runs of ``halltwin generate``, ``recover``, ``design``,
``fleet`` and ``bench``.
"""
