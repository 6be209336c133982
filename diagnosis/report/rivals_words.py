"""What a cause cannot be told from, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnosis.report.word_fault_words import same_words


def rivals_words(cause: Mapping[str, Any]) -> str:
    """What a cause cannot be told from, and what would part them; of structure without a name only what it may be."""
    rivals, same = cause["indistinguishable_from"], same_words(cause)
    if cause["name"] == "unnamed" and not rivals:
        return ""
    part = f". To tell them apart: {cause['to_tell_apart']}" if cause["to_tell_apart"] else ""
    told = f"cannot be told from: {'; '.join([*([', '.join(rivals)] if rivals else []), *same])}{part}"
    if not cause.get("rivals_sought", True):
        unsought = "what else it may be was not looked for, as the search was stopped"
        return f"{told}; {unsought}" if rivals else unsought
    return told if rivals or same else "cannot be told from: nothing else that was searched"
