"""Effects of one's own, so called that a fault in their code ends in one line that says where it is."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Line, Marks, Parameters
from twin.errors import UserError
from twin.motion import Motion
from twin.shown import shown_error
from twin.surroundings import StreamTakenError, streams_kept


class EffectError(UserError):
    """An effect cannot be used; the message says in one line where it is declared, what is wrong and what to do."""


def guarded(effect: Effect, where: str) -> Effect:
    """The effect with every function of its declaration guarded; ``where`` is the file or package that declares it.

    What they raise, an exit included, becomes an :class:`EffectError`; so does a signal of another shape or with values
    that are not finite. What they are handed cannot be written to.
    """
    found: Effect = _with_guards(effect, f"{where}: effect '{effect.name}'", where)
    return found


def sealed(value: Any) -> Any:
    """An array as a view that cannot be written to; anything else as it is."""
    if not isinstance(value, np.ndarray):
        return value
    view = value.view()
    view.flags.writeable = False
    return view


def _with_guards(part: Any, said: str, where: str) -> Any:
    """A declaration, or a part of one, with its own functions guarded; defaults are the project's."""
    guards: dict[str, Any] = {}
    for item in fields(part):
        value = getattr(part, item.name)
        if isinstance(value, Line | Marks):
            guards[item.name] = _with_guards(value, said, where)
        elif callable(value) and value is not item.default and not isinstance(value, Guard):
            kind = _Forward if item.name == "forward" else Guard
            guards[item.name] = kind(call=value, said=f"{said}: {item.name}", where=where)
    return replace(part, **guards)


@dataclass(frozen=True, kw_only=True)
class Guard:
    """A function of the user's own; ``said`` begins the message, ``where`` is the file whose line is named."""

    call: Callable[..., Any]
    said: str
    where: str

    def __call__(self, *given: Any, **named: Any) -> Any:
        """What the function returns. Raises EffectError."""
        try:
            with streams_kept():
                return self.call(*map(sealed, given), **named)
        except (KeyboardInterrupt, EffectError):
            raise
        except StreamTakenError as error:
            raise EffectError(f"{self.said}: {error}") from None
        except BaseException as error:
            # sys.exit() in an effect would end the program without a word.
            rows = [
                one.lineno for one in traceback.extract_tb(error.__traceback__) if Path(one.filename).name == self.where
            ]
            at = f" in line {rows[-1]}" if rows else ""
            raise EffectError(f"{self.said} raises {shown_error(error, at)}{_advice(error)}") from None


class _Forward(Guard):
    """The forward function: its signal keeps its shape and stays finite."""

    def __call__(self, signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        """The signal behind the effect. Raises EffectError."""
        found = super().__call__(signal, motion, {name: sealed(value) for name, value in values.items()}, rng)
        try:
            after = np.asarray(found, dtype=np.float64)
        except (TypeError, ValueError):
            raise EffectError(f"{self.said} returns {type(found).__name__}; expected an array of numbers") from None
        if after.shape[-2:] != np.shape(signal)[-2:]:
            raise EffectError(
                f"{self.said} returns an array of shape {after.shape} for a signal of shape {np.shape(signal)}; "
                "expected the same, or a batch of it"
            )
        if not np.isfinite(after).all():
            told = ", ".join(
                f"{name} = {float(np.ravel(value)[0]):g}" for name, value in values.items() if np.size(value)
            )
            raise EffectError(f"{self.said} returns values that are not finite at {told}; expected finite ones")
        return after


def _advice(error: BaseException) -> str:
    read_only = isinstance(error, ValueError) and "read-only" in shown_error(error)
    return "; an effect may not write to what it is given: return a new array" if read_only else "; mend it"
