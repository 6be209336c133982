"""Twin files: a chain with its parameters as TOML, written whole and read back with every figure checked.

``[effects.NAME]`` holds an effect's parameters. Where they are given, ``[magnet]`` and ``[magnet.placement]`` drive the
channels by a computed field, ``[reference]`` (lines, interpolation, index_deg, has_index) makes the reference an
incremental encoder; ``[hardware]`` (field_mT), ``[hardware.disk]``, ``[hardware.plate]``, ``[hardware.plate_y]`` and
``[hardware.converter]`` describe the concentrator, the Hall plates and the converter. What is not described is ideal.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from twin.bounded_input import whole
from twin.catalogue import CATALOGUE, base_name, find
from twin.chain import Chain
from twin.effect import Effect
from twin.errors import UserError
from twin.known_names import nearest
from twin.magnet.assembly import assembly_from, assembly_table
from twin.parts import Parts, parts_from, parts_table
from twin.reference.encoder import Encoder
from twin.shown import shown
from twin.tables import from_table, to_table
from twin.whole_file import write_beside

SCHEMA = "halltwin.twin/1"
_KEYS = ("schema", "sensor_sense", "output_sense", "magnet", "hardware", "reference", "effects")


_TABLES: dict[str, Callable[[Any], Any]] = {
    "magnet": assembly_from,
    "hardware": parts_from,
    "reference": lambda content: from_table(Encoder, content, "reference"),
}


class TwinError(UserError):
    """The twin file cannot be used; the message says in one line where, what was found and what was expected."""


def to_dict(chain: Chain) -> dict[str, Any]:
    """The chain as plain values: the content of a twin file."""
    effects: dict[str, Any] = {}
    for key, params in chain.values.items():
        effect = find(key, chain.effects)
        if not effect.is_null(params):
            effects[key] = {name: _plain(value) for name, value in params.items()}
    return {
        "schema": SCHEMA,
        "sensor_sense": chain.sensor_sense,
        "output_sense": chain.output_sense,
        **({} if chain.magnet is None else {"magnet": assembly_table(chain.magnet)}),
        **({"hardware": hardware} if (hardware := parts_table(chain.parts)) else {}),
        **({} if chain.encoder is None else {"reference": to_table(chain.encoder)}),
        "effects": effects,
    }


def from_dict(content: Mapping[str, Any], *, name: str = "twin", effects: tuple[Effect, ...] = CATALOGUE) -> Chain:
    """The chain of a twin file's content. Raises TwinError."""
    _check_keys(content, name=name)
    chain = Chain(
        sensor_sense=_sense(content, "sensor_sense", name=name),
        output_sense=_sense(content, "output_sense", name=name),
        effects=effects,
        parts=_table(content, "hardware", name=name) or Parts(),
        encoder=_table(content, "reference", name=name),
    )
    magnet = _table(content, "magnet", name=name)
    if magnet is not None:
        chain = chain.with_magnet(magnet)
    declared = content.get("effects", {})
    if not isinstance(declared, Mapping):
        raise TwinError(f"{name}: effects is {shown(declared)}; expected tables such as [effects.offset]")
    for key, params in declared.items():
        chain = _with_declared(chain, key, params, name=name)
    return chain


def _check_keys(content: Mapping[str, Any], *, name: str) -> None:
    """Refuse another schema and keys that a twin file does not have. Raises TwinError."""
    if content.get("schema") != SCHEMA:
        raise TwinError(
            f"{name}: schema is {shown(content.get('schema'))}; expected {SCHEMA!r}: give a twin file, "
            "such as --extended writes"
        )
    for key in content:
        if key not in _KEYS:
            raise TwinError(f"{name}: unknown key {shown(key)}; expected only {', '.join(_KEYS)}")


def _sense(content: Mapping[str, Any], key: str, *, name: str) -> int:
    """Who counts which way: 1 where nothing is said. Raises TwinError."""
    sense = content.get(key, 1)
    if sense not in (1, -1):
        raise TwinError(f"{name}: {key} is {shown(sense)}; expected 1 or -1")
    return int(sense)


def _table(content: Mapping[str, Any], key: str, *, name: str) -> Any:
    """What a table of the file stands for; None without it. Raises TwinError."""
    if key not in content:
        return None
    try:
        return _TABLES[key](content[key])
    except UserError as error:
        raise TwinError(f"{name}: [{key}]: {error}") from None


def _with_declared(chain: Chain, key: str, params: Any, *, name: str) -> Chain:
    """The chain with the effect of ``[effects.key]``. Raises TwinError."""
    if base_name(key) not in {effect.name for effect in chain.effects}:
        raise TwinError(
            f"{name}: [effects.{key}]: no effect named '{base_name(key)}'; halltwin causes lists them, "
            "and your own come with --effects FILE.py or, for studies, from an installed package"
        )
    try:
        _check_params(find(key, chain.effects), params)
        return chain.with_effect(key, **params)
    except (KeyError, ValueError) as error:
        raise TwinError(f"{name}: [effects.{key}]: {error.args[0] if error.args else error}") from None


def _check_params(effect: Effect, params: Any) -> None:
    """Refuse parameters that are unknown or no numbers. Raises ValueError."""
    if not isinstance(params, Mapping):
        raise ValueError(f"found {shown(params)}; expected a table of parameters: {', '.join(effect.params)}")
    for name, value in params.items():
        if name not in effect.params:
            meant = nearest(name, effect.params)
            raise ValueError(f"has no parameter '{name}'{meant}; it has {', '.join(effect.params)}")
        several = effect.params[name].role == "per turn"
        for item in value if several and isinstance(value, list) and value else [value]:
            if isinstance(item, bool) or not isinstance(item, int | float):
                raise ValueError(
                    f"{name} is {shown(value)}; expected {'numbers, one a turn' if several else 'a number'}"
                )
            if effect.params[name].counts and isinstance(item, float) and not item.is_integer():
                raise ValueError(f"{name} is {shown(value)}; expected a whole number")


def read_twin(path: str | Path, *, effects: tuple[Effect, ...] = CATALOGUE) -> Chain:
    """Read a twin file. Raises TwinError."""
    name = Path(path).name
    try:
        content = tomllib.loads(whole(Path(path), expected="a twin TOML").decode())
    except UserError as error:
        raise TwinError(str(error)) from None
    except RecursionError:
        raise TwinError(
            f"{name}: holds tables or lists too deep in one another; give the path of a twin TOML"
        ) from None
    except ValueError as error:
        # No TOML, no UTF-8, or a number of more digits than Python reads.
        raise TwinError(f"{name}: is no TOML ({error}); give the path of a twin TOML") from None
    return from_dict(content, name=name, effects=effects)


def write_twin(path: str | Path, chain: Chain) -> None:
    """Write a twin file, whole or not at all."""
    write_beside(Path(path), twin_text(chain).encode())


def twin_text(chain: Chain) -> str:
    """The text of a twin file."""
    import tomli_w

    return tomli_w.dumps(to_dict(chain))


def _plain(value: Any) -> Any:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim:
        return [_plain(item) for item in array]
    number = float(array)
    return int(number) if number.is_integer() and abs(number) < 1e15 else number
