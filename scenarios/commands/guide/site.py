"""The guide as files of a site: pages that link to each other, one style sheet, pictures; nothing from elsewhere."""

from __future__ import annotations

import re
from functools import cache
from html import escape
from importlib import resources

from scenarios.commands.guide.footprints import footprints
from scenarios.commands.guide.markdown import as_html
from scenarios.commands.guide.reference import as_markdown
from scenarios.commands.guide.text import Entry, entries, pages, pictures, title_of

REFERENCE = Entry("Reference", "reference", "Python reference")
_STYLE = "guide.css"
_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} · halltwin guide</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="{style}">
</head>
<body>
<a class="skip" href="#text">Skip to the text</a>
<header><a class="home" href="index.html">halltwin <span>guide</span></a>
<a class="to-pages" href="#pages">All pages</a></header>
<main id="text">
{body}</main>
<nav id="pages" aria-label="Pages of the guide">{menu}</nav>
</body>
</html>
"""


@cache
def site() -> dict[str, bytes]:
    """Every file by its name, all in one folder."""
    texts = {**pages(), REFERENCE.name: as_markdown()}
    style = resources.files(__package__).joinpath(_STYLE).read_bytes()
    return {
        _STYLE: style,
        **{f"{name}.html": _page(name, text, frozenset(texts)).encode() for name, text in texts.items()},
        **pictures(),
    }


def _page(name: str, text: str, names: frozenset[str]) -> str:
    beside = footprints() if name == "catalogue" else None
    return _PAGE.format(
        title=escape(title_of(text)),
        style=_STYLE,
        menu=_menu(name),
        body=as_html(text, lambda target: _linked(target, names), beside=beside),
    )


def _menu(here: str) -> str:
    """Every page under the heading that the index lists it under."""
    listed = [*entries(), REFERENCE]
    groups = dict.fromkeys(entry.group for entry in listed)
    return "".join(
        f"<p>{escape(group)}</p><ul>{''.join(_item(one, here) for one in listed if one.group == group)}</ul>"
        for group in groups
    )


def _item(entry: Entry, here: str) -> str:
    current = ' aria-current="page"' if entry.name == here else ""
    return f'<li><a href="{entry.name}.html"{current}>{escape(entry.title)}</a></li>'


def _linked(target: str, names: frozenset[str]) -> str | None:
    """Where a link of a page leads: to another page, to the web, or nowhere."""
    if target.startswith(("https://", "#")):
        return target
    page = re.fullmatch(r"(\w+)\.md(#.*)?", target)
    return f"{page[1]}.html{page[2] or ''}" if page and page[1] in names else None
