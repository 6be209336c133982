"""The guide's text: Markdown pages and pictures that come with the package, in the order of their index."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from importlib import resources

INDEX = "index"
_ENTRY = re.compile(r"^\| \[([^\]]+)\]\((\w+)\.md\) \|", re.M)


@dataclass(frozen=True)
class Entry:
    """A page as the index lists it: under which heading, by what name."""

    group: str
    name: str
    title: str


@cache
def pages() -> dict[str, str]:
    """Every page's Markdown by its name."""
    folder = resources.files("scenarios").joinpath("guide")
    names = sorted(file.name for file in folder.iterdir() if file.name.endswith(".md"))
    return {name.removesuffix(".md"): folder.joinpath(name).read_text(encoding="utf-8") for name in names}


@cache
def pictures() -> dict[str, bytes]:
    """The pictures that pages show, by file name."""
    folder = resources.files("scenarios").joinpath("data")
    shown = {name for text in pages().values() for name in re.findall(r"\]\(\.\./data/([\w.]+\.png)\)", text)}
    return {name: folder.joinpath(name).read_bytes() for name in sorted(shown)}


def entries() -> list[Entry]:
    """What the index lists, in its order."""
    found = []
    for part in re.split(r"^## ", pages()[INDEX], flags=re.M)[1:]:
        group, _, rest = part.partition("\n")
        found += [Entry(group.strip(), name, title) for title, name in _ENTRY.findall(rest)]
    return found


def title_of(text: str) -> str:
    """A page's first heading."""
    return text.partition("\n")[0].removeprefix("# ").strip()


def anchor(heading: str) -> str:
    """The anchor that a heading gets on the usual hosts of Markdown."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
