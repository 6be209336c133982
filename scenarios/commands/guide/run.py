"""``halltwin guide``: the guide in the terminal, or all of it as pages of HTML."""

from __future__ import annotations

import sys
from pathlib import Path

from scenarios.commands.guide.text import INDEX, pages
from scenarios.commands.outputs import PAGES, OutputFiles
from twin.errors import UserError
from twin.known_names import nearest
from twin.shown import shown


def run(page: str | None, *, folder: Path | None, force: bool) -> None:
    """Print a page, or write them all into a folder. Raises UserError."""
    if folder is not None:
        if page is not None:
            raise UserError(f"--output writes every page; found {shown(page)} beside it: give one of them")
        _write(folder, force=force)
        return
    text = _page(page or INDEX)
    if not sys.stdout.isatty():
        print(text, end="")
        return
    from rich.console import Console
    from rich.markdown import Markdown

    Console().print(Markdown(text))


def _page(name: str) -> str:
    """A page's Markdown. Raises UserError."""
    known = pages()
    if name not in known:
        raise UserError(
            f"the guide has no page named {shown(name)}{nearest(name, known)}; expected one of {', '.join(known)}"
        )
    return known[name]


def _write(folder: Path, *, force: bool) -> None:
    """Every page, the style sheet and the pictures. Raises UserError."""
    from scenarios.commands.guide.site import site

    files = site()
    outputs = OutputFiles.checked([(folder / name, PAGES) for name in files], force=force, folders=True)
    outputs.write({folder / name: content for name, content in files.items()})
    print(f"wrote {len(files)} files to {folder}; begin with {folder / f'{INDEX}.html'}")
