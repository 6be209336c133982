"""A name that nothing bears: which of the known ones was meant, perhaps."""

from __future__ import annotations

from collections.abc import Iterable


def nearest(name: object, known: Iterable[str]) -> str:
    """`` (did you mean NAME?)`` to stand behind an unknown name in a message; empty where it is known, or like none."""
    from difflib import get_close_matches

    by_letters = {one.casefold(): one for one in known}
    if name in by_letters.values():
        return ""
    found = get_close_matches(str(name)[:100].casefold(), by_letters, n=1)
    return f" (did you mean {by_letters[found[0]]}?)" if found else ""
