"""What an option may say once only: of two values for one thing the last would count, and nobody would hear of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from twin.errors import UserError


def check_once(option: str, names: Iterable[str]) -> None:
    """Refuse a name that an option gives more than once. Raises UserError."""
    for name, count in Counter(names).items():
        if count > 1:
            raise UserError(f"{option} gives {name} {'twice' if count == 2 else f'{count} times'}; give it once")
