"""The files of the page and of its help: fixed tables, so that no name from outside ever becomes a path."""

from __future__ import annotations

from functools import cache
from importlib import resources

_SCRIPT, _STYLE, _PAGE = "text/javascript; charset=utf-8", "text/css; charset=utf-8", "text/html; charset=utf-8"
ASSETS = {
    "": ("lab.html", _PAGE),
    "lab.css": ("lab.css", _STYLE),
    "lab.js": ("lab.js", _SCRIPT),
    "ask.js": ("ask.js", _SCRIPT),
    "dom.js": ("dom.js", _SCRIPT),
    "plot.js": ("plot.js", _SCRIPT),
    "controls.js": ("controls.js", _SCRIPT),
    "scene.js": ("scene.js", _SCRIPT),
    "design.js": ("design.js", _SCRIPT),
    "map.js": ("map.js", _SCRIPT),
    "bench.js": ("bench.js", _SCRIPT),
    "explain.js": ("explain.js", _SCRIPT),
    "layers.js": ("layers.js", _SCRIPT),
    "save.js": ("save.js", _SCRIPT),
    "icon.svg": ("icon.svg", "image/svg+xml"),
}
"""What is asked for, below the secret: the file in the folder ``page``, and its type."""


@cache
def asset(name: str) -> tuple[bytes, str] | None:
    """Content and type of a file of the page; None where there is none of this name."""
    if name not in ASSETS:
        return None
    file, kind = ASSETS[name]
    return resources.files(__package__).joinpath("page", file).read_bytes(), kind


GUIDE = "guide/"
_KINDS = {"html": _PAGE, "css": _STYLE, "png": "image/png"}


def guide_file(name: str) -> tuple[bytes, str] | None:
    """Content and type of a file of the guide, whose pages are made when the first one is asked for."""
    if not name.startswith(GUIDE):
        return None
    from scenarios.commands.guide.site import site

    file = name.removeprefix(GUIDE)
    content = site().get(file)
    return None if content is None else (content, _KINDS[file.rpartition(".")[2]])
