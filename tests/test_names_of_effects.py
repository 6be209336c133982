"""No file but its own names an effect: what others need to know of one, the effect declares.

Looked for are the strings of the program, docstrings aside. Half of the names are plain words as well (offset, phase,
noise): those count where they stand for a key, which is as a subscript, as the first argument of a look-up, as the key
of a table of tables, or beside the name of one of the effect's parameters.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from twin.catalogue import CATALOGUE, find

ROOT = Path(__file__).parents[1]
NAMES = "|".join(effect.name for effect in CATALOGUE)
KEY = re.compile(rf"(?P<name>{NAMES})(#\w*|[.:](?P<param>\w+)(=.*)?)?")
LOOK_UPS = {"get", "pop", "setdefault", "with_effect", "without", "find", "of", "Free"}
ALLOWED: dict[str, str] = {
    "diagnosis/setup": "a finding of the set-up bears the name of the cause that it is",
    "scenarios/bench/hidden.py": "what the closed loop hides unless told otherwise, as one would write it",
}
"""File or folder -> why it may name effects."""


def uses(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and text of every string that names an effect."""
    parents = {child: parent for parent in ast.walk(tree) for child in ast.iter_child_nodes(parent)}
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Constant) and isinstance(node.value, str)):
            continue
        match = KEY.fullmatch(node.value)
        if match is None or isinstance(parents[node], ast.Expr):
            continue
        known = match["param"] is None or match["param"] in find(match["name"]).params
        plain = "_" not in node.value and "#" not in node.value
        if known and not (plain and not is_key(node, parents)):
            yield node.lineno, node.value


def is_key(node: ast.Constant, parents: Mapping[ast.AST, ast.AST]) -> bool:
    """Whether a plain word stands for an effect."""
    parent = parents[node]
    if isinstance(parent, ast.Subscript):
        return word(parent.value) == "values" or isinstance(parents[parent], ast.Subscript)
    if isinstance(parent, ast.Call):
        return node in parent.args[:1] and word(parent.func) in LOOK_UPS
    if isinstance(parent, ast.Dict) and node in parent.keys:
        return isinstance(parent.values[parent.keys.index(node)], ast.Dict) or holds_values(parents[parent])
    if isinstance(parent, ast.Tuple | ast.List):
        beside = [item.value for item in parent.elts if isinstance(item, ast.Constant)]
        return any(item in find(str(node.value)).params for item in beside)
    return False


def holds_values(node: ast.AST) -> bool:
    """Whether what a table is given to are a chain's values."""
    if isinstance(node, ast.Call):
        return word(node.func) == "with_values"
    targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", node)]
    return any(word(target) == "values" for target in targets)


def word(node: ast.AST) -> str:
    """The last word of a name or of an attribute."""
    return node.attr if isinstance(node, ast.Attribute) else str(getattr(node, "id", ""))


def own_file(name: str) -> Path:
    """The file that declares an effect."""
    declared = re.compile(rf'name="{name}"')
    (found,) = (path for path in (ROOT / "twin").rglob("*.py") if declared.search(path.read_text(encoding="utf-8")))
    return found


OWN = {effect.name: own_file(effect.name) for effect in CATALOGUE}


def named_elsewhere(path: Path) -> list[str]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    found = ((line, text, KEY.fullmatch(text)) for line, text in uses(tree))
    return [f"{path.name}:{line}: {text!r}" for line, text, match in found if match and OWN[match["name"]] != path]


PROGRAM = sorted(path for folder in ("twin", "diagnosis", "scenarios") for path in (ROOT / folder).rglob("*.py"))


@pytest.mark.parametrize("path", PROGRAM, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_file_names_an_effect_of_another(path: Path) -> None:
    allowed = [entry for entry in ALLOWED if str(path.relative_to(ROOT)).startswith(entry)]
    found = named_elsewhere(path)
    assert not found or allowed


@pytest.mark.parametrize("entry", ALLOWED)
def test_what_is_allowed_is_needed(entry: str) -> None:
    files = [path for path in PROGRAM if str(path.relative_to(ROOT)).startswith(entry)]
    assert any(named_elsewhere(path) for path in files)


@pytest.mark.parametrize(
    "text",
    [
        'power = {("saturation", "k_percent"): 2.0}',
        'if key == "drive_ripple": pass',
        'chain.values["offset"]',
        'chain.values.get("noise", {})',
        'chain.with_effect("zero", zero_deg=1.0)',
        'values = {"phase": {"beta_deg": 1.0}}',
        'spread = {"offset.x_percent": 1.0}',
        'values = {"noise": left(fit)}',
        'chain.with_values({"noise": left(fit)})',
        'key = f"unnamed_order#{order}"',
        'beta_deg = other["phase"]["beta_deg"]',
    ],
)
def test_a_name_is_seen(text: str) -> None:
    assert list(uses(ast.parse(text)))


@pytest.mark.parametrize(
    "text",
    [
        '"""drive_ripple is one."""',
        'effect.roles("phase")',
        'Param(role="phase")',
        'labels = ("offset", "zero")',
        'values("noise", noise)',
        'offset.get("signal.attribute")',
        'unit = {"zero": "deg"}',
        'answer["noise"]',
    ],
)
def test_a_plain_word_is_none(text: str) -> None:
    assert not list(uses(ast.parse(text)))
