"""Lines of JSON, each with a checksum over itself and the one before: one that was changed, doubled or lost shows.

The checksum guards against damage, not against forgery.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from typing import Any

_SEALED = re.compile(rb'(\{.+), "seal": "([0-9a-f]{16})"\}')


def sealed(content: Mapping[str, Any], before: str) -> tuple[bytes, str]:
    """An object as a line that follows the one with the seal ``before``, and its own seal; the first follows ""."""
    body = json.dumps(content).encode()
    seal = _seal(body, before)
    return body[:-1] + f', "seal": "{seal}"}}\n'.encode(), seal


def unsealed(line: bytes, before: str) -> tuple[dict[str, Any], str]:
    """The object of a line without its end, and its seal. Raises ValueError where it is not as it was written."""
    found = _SEALED.fullmatch(line)
    if found is None:
        raise ValueError("bears no checksum")
    body = found[1] + b"}"
    seal = _seal(body, before)
    if seal.encode() != found[2]:
        raise ValueError("is not as it was written, or not in its place")
    try:
        return dict(json.loads(body)), seal
    except RecursionError:
        raise ValueError("is no JSON") from None


def _seal(body: bytes, before: str) -> str:
    return hashlib.sha256(before.encode() + body).hexdigest()[:16]
