"""Statements of which none is taken, as nothing in a log speaks for one of them: what is asked back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from twin.errors import SweepError
from twin.logs.statement import Column, text_of
from twin.logs.table import Table

_SHOWN = 2


class OpenGuess(SweepError):
    """No single guess is right as it stands; ``options`` are the statements of which one may be meant.

    ``fit``: each of several fits names and values as well as the others; else they go against what a name says.
    ``example``: the option is no statement as yet, since nothing in the log tells a number of it. ``what``: what is odd
    about the log, alone. ``alone``: of two columns that are hardly a reference and a sensor, the sensor and what stands
    beside it.
    """

    def __init__(
        self,
        said: str,
        options: tuple[str, ...],
        *,
        what: str,
        fit: bool = False,
        example: bool = False,
        alone: tuple[Column, ...] = (),
    ) -> None:
        super().__init__(said)
        self.options = options
        self.what = what
        self.alone = alone
        self.fit = fit
        self.example = example


def raise_several(table: Table, fitting: Sequence[tuple[Column, ...]], meaning: str = "") -> NoReturn:
    """Raise OpenGuess: nothing speaks for one of the statements that fit. ``meaning`` says in what they differ."""
    count = "two" if len(fitting) == 2 else "several"
    what = f"{count} guesses fit" + (f": {meaning}" if meaning else "")
    raise_open(table, what, [text_of(one) for one in fitting], fit=True)


def raise_open(
    table: Table, what: str, options: Sequence[str], *, fit: bool = False, alone: tuple[Column, ...] = ()
) -> NoReturn:
    """Raise OpenGuess: what is odd about a log, and the statements of which one may be meant."""
    which = "say which it is" if len(options) > 1 else "if so, say it"
    raise OpenGuess(
        f"{table.file}: {what} (found {table.listed()}); {which}: {in_words(options)}",
        tuple(options),
        what=what,
        fit=fit,
        alone=alone,
    )


def raise_untold(table: Table, what: str, example: str) -> NoReturn:
    """Raise OpenGuess: a number that nothing in a log tells, and the statement that it belongs in."""
    said = f"{table.file}: {what} (found {table.listed()}); say it: {in_words([example])}"
    raise OpenGuess(said, (example,), what=what, example=True)


def in_words(options: Sequence[str]) -> str:
    """The first two of some statements as options of a command, and how many more there are."""
    more = f", and {len(options) - _SHOWN} more" if len(options) > _SHOWN else ""
    return " or ".join(f'--columns "{option}"' for option in options[:_SHOWN]) + more
