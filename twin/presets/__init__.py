"""Twin files that come with the project, by name; each figure in them names its source or says it is an assumption."""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path

from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.effect import Effect
from twin.files import TwinError, from_dict, read_twin


def preset_names() -> tuple[str, ...]:
    """The presets' names, sorted."""
    return tuple(
        sorted(entry.name[:-5] for entry in resources.files(__name__).iterdir() if entry.name.endswith(".toml"))
    )


def read_preset(name: str, *, effects: tuple[Effect, ...] = CATALOGUE) -> Chain:
    """The preset with this name. Raises TwinError with the known names."""
    if name not in preset_names():
        raise TwinError(f"no preset named '{name}'; known: {', '.join(preset_names())}")
    content = resources.files(__name__).joinpath(f"{name}.toml").read_text(encoding="utf-8")
    return from_dict(tomllib.loads(content), name=f"preset {name}", effects=effects)


def read_twin_or_preset(given: str | Path, *, effects: tuple[Effect, ...] = CATALOGUE) -> Chain:
    """The chain of a preset's name, or of a twin file's path. Raises TwinError."""
    if str(given) in preset_names():
        return read_preset(str(given), effects=effects)
    if not Path(given).suffix:
        raise TwinError(
            f"{given}: is no preset ({', '.join(preset_names())}); give one of them or a path ending in .toml"
        )
    return read_twin(given, effects=effects)
