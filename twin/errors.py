"""The one kind of error that is the user's to mend."""

from __future__ import annotations


class UserError(ValueError):
    """One line: which file, row or column, what was found, what was expected, what to do. The program exits with 2."""


class SweepError(UserError):
    """The sweep cannot be used; the message says in one line where, what was found and what was expected."""


class ColumnMissing(SweepError):
    """A file has none of a sweep's names for a column that is needed: it may be a log under names of its own."""
