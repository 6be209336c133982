"""Twin files that come with the project, by name; each figure in them names its source or says it is an assumption."""

from __future__ import annotations

import os
import tomllib
from importlib import resources
from pathlib import Path

from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.effect import Effect
from twin.ending import ending_of
from twin.files import TwinError, from_dict, read_twin
from twin.known_names import nearest
from twin.log import LOG


def preset_names() -> tuple[str, ...]:
    """The presets' names, sorted."""
    return tuple(
        sorted(entry.name[:-5] for entry in resources.files(__name__).iterdir() if entry.name.endswith(".toml"))
    )


def read_preset(name: str, *, effects: tuple[Effect, ...] = CATALOGUE) -> Chain:
    """The preset with this name. Raises TwinError with the known names."""
    if name not in preset_names():
        raise TwinError(f"no preset named '{name}'{nearest(name, preset_names())}; known: {', '.join(preset_names())}")
    content = resources.files(__name__).joinpath(f"{name}.toml").read_text(encoding="utf-8")
    return from_dict(tomllib.loads(content), name=f"preset {name}", effects=effects)


def read_twin_or_preset(given: str | Path, *, effects: tuple[Effect, ...] = CATALOGUE) -> Chain:
    """The chain of a preset's name, or of a twin file's path.

    A file of a preset's very name is neither taken for the preset nor the preset for it. Raises TwinError.
    """
    name = str(given)
    LOG.info("twin %s", name)
    if name in preset_names():
        if Path(name).is_file():
            raise TwinError(f"{name}: is a preset and also a file here; give the file as .{os.sep}{name}, or rename it")
        return read_preset(name, effects=effects)
    if not ending_of(name) and not Path(name).exists():
        raise TwinError(
            f"{name}: is no preset{nearest(name, preset_names())}; "
            f"give one of {', '.join(preset_names())}, or a path ending in .toml"
        )
    if name.removesuffix(".toml") in preset_names() and not Path(name).exists():
        raise TwinError(f"{name}: no such file; the preset is named {name.removesuffix('.toml')}")
    return read_twin(given, effects=effects)


def is_twin(given: str | Path) -> bool:
    """Whether a name stands for a twin rather than for a sweep: a preset's, or a path that ends in .toml."""
    return str(given) in preset_names() or ending_of(given) == ".toml"
