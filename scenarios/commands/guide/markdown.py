"""Markdown as HTML that a strict page may show: no markup from the text, no styles in elements, tables that scroll."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from markdown_it import MarkdownIt
from markdown_it.token import Token

from scenarios.commands.guide.text import anchor

_PART = re.compile(r"^<!-- /?[\w ]+ -->\n", re.M)
"""What marks a part of a page for the tests."""
Linked = Callable[[str], str | None]
"""From a link's target to where it leads on the pages; None where nothing there answers to it."""
_MANY = 3
"""Columns from which on a table's rows stand as blocks on a narrow screen."""


def as_html(text: str, linked: Linked, *, beside: Mapping[str, str] | None = None) -> str:
    """The page's text as HTML. ``beside``: by the name that a table's row begins with, what stands below that name."""
    reader = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = reader.parse(_PART.sub("", text))
    for k, token in enumerate(tokens):
        if token.type == "heading_open":
            token.attrSet("id", anchor(_plain(tokens[k + 1])))
        if token.type == "inline":
            _lead(token, linked)
        if token.type in ("th_open", "td_open") and "style" in token.attrs:
            token.attrs = {"class": "number"}
        if token.type == "tr_open" and beside:
            _set_beside(token, tokens[k + 2], beside)
    _head_cells(tokens)
    return _scrolling(str(reader.renderer.render(tokens, reader.options, {})))


def _plain(inline: Token) -> str:
    """The words of an inline token."""
    return "".join(child.content for child in inline.children or [])


def _lead(inline: Token, linked: Linked) -> None:
    """Send links and pictures where they lead on the pages; what leads nowhere there is words that say where it is."""
    for child in inline.children or []:
        if child.type == "image":
            child.attrSet("src", str(child.attrGet("src")).rpartition("/")[2])
        if child.type != "link_open":
            continue
        target = linked(str(child.attrGet("href")))
        if target is None:
            child.attrs = {"class": "elsewhere", "title": f"in the checkout: {child.attrGet('href')}"}
        else:
            child.attrSet("href", target)


def _head_cells(tokens: list[Token]) -> None:
    """Have each cell of a table of many columns bear its column's head, for where the rows stand as blocks."""
    table, heads, column = None, list[str](), 0
    for k, token in enumerate(tokens):
        if token.type == "table_open":
            table, heads = token, []
        elif token.type == "th_open":
            heads.append(_plain(tokens[k + 1]))
        elif token.type == "tr_open":
            column = 0
        elif token.type == "td_open" and table is not None and len(heads) >= _MANY:
            table.attrSet("class", "many")
            token.attrSet("data-head", heads[column])
            column += 1


def _set_beside(row: Token, cell: Token, beside: Mapping[str, str]) -> None:
    """Give a row that begins with a known name an anchor of that name, and its cell what stands below it."""
    children = cell.children or []
    if children and children[0].type == "code_inline" and children[0].content in beside:
        name = children[0].content
        row.attrSet("id", name)
        cell.children = [*children, Token("html_inline", "", 0, content=beside[name])]


def _scrolling(html: str) -> str:
    """Each table in a frame of its own that scrolls sideways, by keys too."""
    frame = '<div class="scroll" tabindex="0" role="region" aria-label="{}">{}'
    heading = "table"
    parts = re.split(r"(<h\d[^>]*>.*?</h\d>|<table[^>]*>)", html, flags=re.S)
    for k, part in enumerate(parts):
        if part.startswith("<h"):
            heading = re.sub(r"<[^>]+>", "", part)
        elif part.startswith("<table"):
            parts[k] = frame.format(heading.replace('"', "&quot;"), part)
    return "".join(parts).replace("</table>", "</table></div>")
