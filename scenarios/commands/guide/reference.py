"""The reference of what may be imported, as Markdown: signatures and docstrings as they stand in the code."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from functools import cache, cached_property
from importlib import import_module
from itertools import pairwise
from types import ModuleType
from typing import Any

PACKAGES = ("twin", "diagnosis")
_HEAD = """# Python reference

What `twin` and `diagnosis` export, from the docstrings. [From Python](python.md) shows it at work.
"""
_SECTION = re.compile(r"^([A-Z][A-Za-z ]+)\n-{3,}$", re.M)
_ENTRIES = frozenset({"Parameters", "Returns", "Raises", "Attributes", "Yields"})
_ROLE = re.compile(r":\w+:`~?([^`]+)`")
_LONG, _LONG_DEFAULT = 100, 32
"""Letters of a line, and of a default within it."""


def as_markdown() -> str:
    """The whole reference."""
    parts = [_HEAD]
    for name in PACKAGES:
        package = import_module(name)
        parts += [f"## {name}", _described(inspect.getdoc(package) or "")]
        parts += [_exported(package, one) for one in sorted(package.__all__, key=str.lower)]
    return "\n\n".join(part.strip() for part in parts if part.strip()) + "\n"


def _exported(package: ModuleType, name: str) -> str:
    """One name that a package exports."""
    thing, head = getattr(package, name), f"### {package.__name__}.{name}"
    if inspect.isclass(thing):
        return "\n\n".join([head, *_class(name, thing)])
    if inspect.isfunction(thing):
        return "\n\n".join([head, _signature(name, thing), _described(inspect.getdoc(thing) or "")])
    value, said = _assigned(_tree(_home_of(package, name)).body, name)
    return "\n\n".join([head, f"```python\n{name} = {value}\n```", _described(said)])


def _class(name: str, thing: type) -> Iterator[str]:
    """A class: how it is made, what it says of itself, its fields with words of their own, what it can be asked."""
    yield _signature(name, thing)
    yield _described(inspect.getdoc(thing) or "")
    body = next((one.body for one in _classes(thing) if one.name == thing.__name__), [])
    fields = [(one, _assigned(body, one)[1]) for one in vars(thing).get("__annotations__", {})]
    yield "\n".join(f"- `{one}`: {_flowing(said)}" for one, said in fields if said)
    for one, member in vars(thing).items():
        asked = _asked(member)
        if one.startswith("_") or asked is None or asked.__name__ != one:
            continue
        yield f"#### {name}.{one}"
        yield _signature(one, asked) if not _is_property(member) else ""
        yield _described(inspect.getdoc(asked) or "")


def _classes(thing: type) -> list[ast.ClassDef]:
    return [node for node in _tree(import_module(thing.__module__)).body if isinstance(node, ast.ClassDef)]


def _asked(member: Any) -> Any:
    """The function behind a method or a property; None for anything else."""
    if isinstance(member, property):
        return member.fget
    if isinstance(member, cached_property):
        return member.func
    called = member.__func__ if isinstance(member, classmethod | staticmethod) else member
    return called if inspect.isfunction(called) else None


def _is_property(member: Any) -> bool:
    return isinstance(member, property | cached_property)


class _Something:
    """A default that is too long to be read."""

    def __repr__(self) -> str:
        return "..."


def _signature(name: str, thing: Any) -> str:
    """How it is called, as a block of code: in one line, or a parameter a line; "" for what is not made by a call."""
    if inspect.isclass(thing) and ("__init__" not in vars(thing) or getattr(thing, "_is_protocol", False)):
        return ""
    shown = inspect.signature(thing)
    kept = [_short(one) for key, one in shown.parameters.items() if key not in ("self", "cls")]
    told = [str(one) for one in kept]
    for kind, mark in ((inspect.Parameter.KEYWORD_ONLY, "*"), (inspect.Parameter.VAR_POSITIONAL, "")):
        at = next((k for k, one in enumerate(kept) if one.kind is kind), None)
        if at is not None:
            told[at:at] = [mark] if mark else []
            break
    gives = shown.return_annotation
    end = "" if inspect.isclass(thing) or gives is inspect.Signature.empty else f" -> {_bare(gives)}"
    line = f"{name}({', '.join(told)}){end}"
    if len(line) > _LONG:
        line = "\n".join([f"{name}(", *(f"    {one}," for one in told), f"){end}"])
    return f"```python\n{line}\n```"


def _short(one: inspect.Parameter) -> inspect.Parameter:
    """A parameter with its kind as it is written, and a default that is read at a glance."""
    long = one.default is not one.empty and (len(repr(one.default)) > _LONG_DEFAULT or repr(one.default)[0] == "<")
    kind = one.annotation if one.annotation is one.empty else _Written(_bare(one.annotation))
    return one.replace(annotation=kind, default=_Something() if long else one.default)


class _Written:
    """An annotation that is shown as it was written, without quotes."""

    def __init__(self, words: str) -> None:
        self._words = words

    def __repr__(self) -> str:
        return self._words


def _bare(annotation: Any) -> str:
    return annotation.strip("'\"") if isinstance(annotation, str) else inspect.formatannotation(annotation)


def _described(docstring: str) -> str:
    """A docstring after numpydoc as Markdown."""
    first, *rest = _SECTION.split(docstring)
    parts = [_prose(first)]
    for title, body in zip(rest[::2], rest[1::2], strict=True):
        text = _entries(body) if title in _ENTRIES else _prose(body)
        parts.append(f"**{title}**\n\n{text}")
    return "\n\n".join(part for part in parts if part)


def _entries(body: str) -> str:
    """Parameters and the like: a name with its kind, and the words indented below it."""
    found: list[tuple[str, list[str]]] = []
    for line in inspect.cleandoc(body).splitlines():
        if line and not line.startswith(" "):
            found.append((line, []))
        elif found:
            found[-1][1].append(line.strip())
    said = []
    for head, words in found:
        name, colon, kind = head.partition(" : ")
        said.append(f"- `{name}`{f' ({_words(kind)})' if colon else ''}: {_flowing(' '.join(words))}".rstrip(": "))
    return "\n".join(said)


def _prose(text: str) -> str:
    """Paragraphs; what is indented or shown at a Python prompt is code."""
    parts = []
    for paragraph in re.split(r"\n\s*\n", inspect.cleandoc(text)):
        if paragraph.startswith((">>>", "    ")):
            parts.append(f"```pycon\n{inspect.cleandoc(paragraph)}\n```")
        elif paragraph.strip():
            parts.append(_words(paragraph))
    return "\n\n".join(parts)


def _flowing(words: str) -> str:
    return _words(" ".join(words.split()))


def _words(text: str) -> str:
    """Sphinx's marks as Markdown's."""
    return _ROLE.sub(r"`\1`", text).replace("``", "`")


def _home_of(module: ModuleType, name: str) -> ModuleType:
    """The module in which a name is assigned, also where it comes through others."""
    for node in ast.walk(_tree(module)):
        if isinstance(node, ast.ImportFrom) and node.module and any(one.name == name for one in node.names):
            return _home_of(import_module(node.module), name)
    return module


def _assigned(body: list[ast.stmt], name: str) -> tuple[str, str]:
    """What is assigned to a name, as it is written, and the string that stands below; "" for what there is not."""
    for one, other in pairwise([*body, ast.Pass()]):
        target = (
            one.target if isinstance(one, ast.AnnAssign) else one.targets[0] if isinstance(one, ast.Assign) else None
        )
        if isinstance(one, ast.AnnAssign | ast.Assign) and isinstance(target, ast.Name) and target.id == name:
            value = "" if one.value is None else ast.unparse(one.value).strip("'\"")
            said = other.value if isinstance(other, ast.Expr) else None
            told = said.value if isinstance(said, ast.Constant) else ""
            return value, inspect.cleandoc(told) if isinstance(told, str) else ""
    return "", ""


@cache
def _tree(module: ModuleType) -> ast.Module:
    return ast.parse(inspect.getsource(module))
