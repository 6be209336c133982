"""The pages that people read, the README and the guide, and the marked parts of them."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
GUIDE = ROOT / "scenarios" / "guide"
PAGES = (ROOT / "README.md", *sorted(GUIDE.glob("*.md")), *sorted((ROOT / ".github").glob("*.md")))


def part(page: Path, name: str) -> str:
    """What stands between ``<!-- name -->`` and ``<!-- /name -->`` on a page."""
    found = re.search(f"<!-- {name} -->\n(.*?)\n<!-- /{name} -->", page.read_text(encoding="utf-8"), re.S)
    assert found, f"{page.name} has no part named {name}"
    return found.group(1)


def block(page: Path, name: str, kind: str = "text") -> str:
    """The code block that a part of a page consists of."""
    return part(page, name).removeprefix(f"```{kind}\n").removesuffix("\n```")


def lines(text: str) -> list[str]:
    """Lines without trailing blanks."""
    return [line.rstrip() for line in text.strip().splitlines()]


def words(text: str) -> list[str]:
    """Lines with their figures left out: the last digits may differ between builds of the numerical libraries."""
    return lines(re.sub(r"\d+(\.\d+)?", "#", text))


def figures(text: str) -> list[float]:
    """The numbers in a text that have decimals, without half widths."""
    return [float(number) for number in re.findall(r"(?<!±)\b\d+\.\d+", text)]
