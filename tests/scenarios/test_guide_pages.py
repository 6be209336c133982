"""The guide as HTML: every link leads somewhere, every cause has its picture, every exported name its place."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import diagnosis
import twin
from scenarios.commands.guide.footprints import error_deg, footprint, motion
from scenarios.commands.guide.markdown import as_html
from scenarios.commands.guide.site import site
from tests.command_line import halltwin
from tests.pages import GUIDE
from twin.catalogue import CATALOGUE, find

PAGES = sorted(name for name in site() if name.endswith(".html"))


class Read(HTMLParser):
    """What a page holds: its tags with their attributes, and which are open at the end."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in ("meta", "link"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def of(self, attribute: str) -> list[str]:
        """All values of an attribute."""
        return [str(attrs[attribute]) for _, attrs in self.tags if attribute in attrs]


@pytest.fixture(scope="module")
def read() -> dict[str, Read]:
    return {name: Read(site()[name].decode()) for name in PAGES}


def test_every_page_of_the_text_is_one_and_the_reference_too() -> None:
    assert {Path(name).stem for name in PAGES} == {page.stem for page in GUIDE.glob("*.md")} | {"reference"}


@pytest.mark.parametrize("name", PAGES)
def test_links_and_pictures_are_there(name: str, read: dict[str, Read]) -> None:
    """Beside pages of the web, which are links alone: nothing is loaded from there."""
    for target in read[name].of("href"):
        if target.startswith("https://") or target == "data:,":
            continue
        file, _, part = target.partition("#")
        assert (file or name) in site(), target
        assert not part or part in read[file or name].of("id"), target
    assert all(source in site() for source in read[name].of("src"))


@pytest.mark.parametrize("name", PAGES)
def test_pages_are_whole_and_keep_the_strict_policy(name: str, read: dict[str, Read]) -> None:
    """Nothing that the policy of the page's server would refuse: no script, no style in an element, no event."""
    page = read[name]
    assert page.open == []
    assert {tag for tag, _ in page.tags} & {"script", "style", "iframe", "form", "object"} == set()
    assert page.of("style") == []
    assert [key for _, attrs in page.tags for key in attrs if key.startswith("on")] == []
    assert [len(page.of("id")), 1] == [len(set(page.of("id"))), sum(tag == "h1" for tag, _ in page.tags)]


def test_every_page_leads_to_every_other(read: dict[str, Read]) -> None:
    for page in read.values():
        assert set(PAGES) - {"index.html"} <= {target.partition("#")[0] for target in page.of("href")} | {""}
        assert page.of("aria-current") in (["page"], [])


def test_markup_in_the_text_is_shown_as_text() -> None:
    made = as_html(
        "<img src=x onerror=alert(1)>\n\n[a](javascript:alert(1)) [b](../../etc/passwd)\n", lambda target: None
    )
    assert "<img" not in made
    assert "&lt;img" in made
    assert "href" not in made


# ---- footprints -------------------------------------------------------------------------------------------------


def test_every_cause_has_its_picture_in_its_row(read: dict[str, Read]) -> None:
    text = site()["catalogue.html"].decode()
    for effect in CATALOGUE:
        row = re.search(f'<tr id="{effect.name}">.*?</tr>', text, re.S)
        assert row, effect.name
        assert f"with {effect.name} alone" in row[0]
    assert text.count('class="footprint"') == len(CATALOGUE)


def test_every_cause_does_something_in_its_footprint() -> None:
    moved = motion()
    for effect in CATALOGUE:
        assert np.max(np.abs(error_deg(effect, moved))) > 1e-3, effect.name


@pytest.mark.parametrize(("name", "order"), [("offset", 1), ("gain_mismatch", 2), ("saturation", 4)])
def test_a_footprint_is_what_the_catalogue_says(name: str, order: int) -> None:
    """The order that the signature names has all of the error, as the curve in the picture has."""
    moved = motion()
    effect = find(name, CATALOGUE)
    turn = error_deg(effect, moved)[:120]
    share = np.abs(np.fft.rfft(turn)) ** 2
    assert np.argmax(share) == order
    assert share[order] > 0.95 * np.sum(share)
    drawn = re.search(r'class="there" d="([^"]+)"', footprint(effect, moved))
    assert drawn
    heights = np.array([float(y) for y in re.findall(r"[ML]\d+ (-?\d+)", drawn[1])])[:120]
    assert np.corrcoef(heights, turn)[0, 1] < -0.999


def test_a_lag_shows_the_two_directions_apart() -> None:
    picture = footprint(find("hysteresis", CATALOGUE), motion())
    there, back = (re.search(f'class="{way}" d="([^"]+)"', picture) for way in ("there", "back"))
    assert there
    assert back
    assert there[1] != back[1]


# ---- the reference ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("package", [twin, diagnosis], ids=lambda package: package.__name__)
def test_every_exported_name_is_in_the_reference_with_words(package: object) -> None:
    from scenarios.commands.guide.reference import as_markdown

    text = as_markdown()
    for name in package.__all__:  # type: ignore[attr-defined]
        section = re.search(rf"^### {package.__name__}\.{name}\n(.*?)(?=^### |\Z)", text, re.S | re.M)  # type: ignore[attr-defined]
        assert section, name
        said = re.sub(r"```.*?```|^#.*$", "", section[1], flags=re.S | re.M).strip()
        assert len(said) > 20, name
    assert not re.search(r"0x[0-9a-f]{6}|:\w+:`|(?<!`)``(?!`)", text)


def test_signatures_are_those_of_the_code() -> None:
    text = site()["reference.html"].decode()
    assert "twin: TwinLike | None = None," in text
    assert "Param(" in text
    assert "false_alarm_probability: float = 0.01," in text
    assert "what the public answer promises" in text


# ---- the command ------------------------------------------------------------------------------------------------


def test_a_page_is_printed() -> None:
    ended = halltwin("guide", "choose_magnet")
    assert (ended.code, ended.out) == (0, (GUIDE / "choose_magnet.md").read_text(encoding="utf-8"))
    assert halltwin("guide").out == (GUIDE / "index.md").read_text(encoding="utf-8")


def test_an_unknown_page_is_one_line() -> None:
    ended = halltwin("guide", "chose_magnet")
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    assert "did you mean choose_magnet?" in ended.err
    both = halltwin("guide", "lab", "-o", "x")
    assert both.code == 2
    assert "give one of them" in both.err


def test_all_pages_are_written(tmp_path: Path) -> None:
    ended = halltwin("guide", "-o", tmp_path / "out")
    assert ended.code == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == set(site())
    (tmp_path / "out" / "index.html").write_text("mine")
    refused = halltwin("guide", "-o", tmp_path / "out")
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert (tmp_path / "out" / "index.html").read_text() == "mine"
