"""The encoder on the virtual bench: a twin, and the effects that ``--hide`` hides in it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from scenarios.commands.once import check_once
from twin.catalogue import find
from twin.chain import Chain
from twin.errors import UserError
from twin.known_names import nearest

DEFAULT_TWIN = "paper-encoder"
HIDDEN = "saturation:k_percent=2"
"""What the encoder of the closed loop hides unless told otherwise: a disk near saturation, which the preset lacks."""
_FORM = f"expected EFFECT:PARAMETER=VALUE, e.g. {HIDDEN}"


class Hiding(NamedTuple):
    """One parameter of one effect, as ``--hide`` gives it."""

    key: str
    param: str
    value: float


def hidden_encoder(twin: str | None, hide: Sequence[str], effect_files: Sequence[Path] = ()) -> Chain:
    """A twin or preset with effects EFFECT:PARAMETER=VALUE[,...]. Raises UserError."""
    from twin.extensions import effects_with
    from twin.presets import read_twin_or_preset

    chain = read_twin_or_preset(twin or DEFAULT_TWIN, effects=effects_with(effect_files))
    hidings = [hiding for text in hide for hiding in _parsed(text, chain)]
    check_once("--hide", (f"{hiding.key}:{hiding.param}" for hiding in hidings))
    for key, param, value in hidings:
        try:
            chain = chain.with_effect(key, **{param: value})
        except ValueError as error:
            raise UserError(f"--hide {key}:{param}: {error}") from None
    return chain


def _parsed(text: str, chain: Chain) -> Iterator[Hiding]:
    """The parameters that one option gives; what is wrong is told from left to right. Raises UserError."""
    key, _, given = text.partition(":")
    try:
        effect = find(key, chain.effects)
    except KeyError as error:
        raise UserError(f"--hide {text}: {error.args[0]}") from None
    for part in given.split(","):
        param, sign, value = (piece.strip() for piece in part.partition("="))
        if not sign or not param:
            raise UserError(f"--hide {text}: {_FORM}; {key} has {', '.join(effect.params)}")
        if param not in effect.params:
            meant = nearest(param, effect.params)
            raise UserError(
                f"--hide {text}: {key} has no parameter {param!r}{meant}; it has {', '.join(effect.params)}"
            )
        try:
            yield Hiding(key, param, float(value))
        except ValueError:
            raise UserError(f"--hide {text}: {param} is {value!r}; expected a number") from None
