"""Effects of one's own: read from files and from installed packages, checked, and put in order with the catalogue's."""

from __future__ import annotations

import runpy
import traceback
from collections.abc import Iterable, Sequence
from importlib import metadata
from os import PathLike
from pathlib import Path
from typing import Any

from twin.catalogue import CATALOGUE, in_order
from twin.contract import check
from twin.declaration import mistyped
from twin.effect import Effect
from twin.example import full_motion
from twin.guarded import EffectError, guarded
from twin.shown import shown, shown_error
from twin.surroundings import StreamTakenError, undisturbed

GROUP = "halltwin.effects"
"""Entry points of this group name an :class:`Effect` or a sequence of them."""
RESERVED = "unnamed"
"""What the names of structure without a name begin with."""


def effects_with(own: Sequence[str | PathLike[str] | Effect] = ()) -> tuple[Effect, ...]:
    """The catalogue, the effects of installed packages and one's own, in chain order.

    ``own`` are files that declare effects, and effects; those that are known already are not taken twice.

    Raises EffectError where one cannot be loaded, has a name that is taken, or breaks a promise of
    :mod:`twin.contract`.
    """
    declared = {effect.name: "the catalogue" for effect in CATALOGUE}
    known: list[Effect] = []
    found: list[Effect] = []
    for where, effects in (*_installed(), *map(_declared, own)):
        for effect in effects:
            if any(effect is one for one in known):
                continue
            refuse_broken(effect, where)
            if effect.name in declared:
                raise EffectError(
                    f"{where}: effect '{effect.name}' is declared by {declared[effect.name]} already; "
                    "give it another name, or leave one of them out"
                )
            declared[effect.name] = where
            known.append(effect)
            found.append(guarded(effect, where))
    return in_order((*CATALOGUE, *found)) if found else CATALOGUE


def _declared(own: str | PathLike[str] | Effect) -> tuple[str, tuple[Effect, ...]]:
    """Where effects of one's own come from, and which these are."""
    if isinstance(own, Effect):
        return "handed in", _effects_in(own)
    if not isinstance(own, str | PathLike):
        raise EffectError(f"effects holds {shown(own)}; expected the path of a Python file, or an Effect")
    path = Path(own)
    return path.name, effects_of(path)


def effects_of(path: Path) -> tuple[Effect, ...]:
    """The effects that a Python file declares, as they are: single ones and sequences, in the file's order.

    The file is run. Raises EffectError where it cannot be read, does not run, or declares none.
    """
    if not path.is_file():
        raise EffectError(f"{path}: no such file; give a Python file that declares an Effect (halltwin new-effect)")
    try:
        with undisturbed():
            names = runpy.run_path(str(path), run_name=path.stem)
    except OSError as error:
        if error.filename != str(path):
            raise EffectError(_does_not_run(path, error)) from None
        raise EffectError(f"{path.name}: cannot be read ({error.strerror}); give another file") from None
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        # A file that ends the program is one that does not run.
        raise EffectError(_does_not_run(path, error)) from None
    # One that is declared by name may stand in a list as well: by identity, because effects hold tables.
    effects = tuple({id(effect): effect for value in names.values() for effect in _effects_in(value)}.values())
    if not effects:
        raise EffectError(f"{path.name}: declares no Effect; see halltwin new-effect for one that does")
    return effects


def refuse_broken(effect: Effect, where: str) -> None:
    """Raise EffectError where the effect may not take part: it breaks a promise, or is of a kind that is not loaded."""
    said = unfit(effect)
    if not said:
        broken = next((r for r in check(effect, motion=full_motion()) if r.kept is False and r.binding), None)
        said = "" if broken is None else f"{broken.said} (promise: {broken.promise})"
    if said:
        raise EffectError(
            f"{where}: effect {shown(effect.name)}: {said}; mend it, halltwin check-effect shows all promises"
        )


def unfit(effect: Effect) -> str:
    """Why an effect of the user's own may not be loaded even if it keeps every promise, in words; "" if it may."""
    said = mistyped(effect)
    if said:
        return said
    if effect.name.startswith(RESERVED):
        return f"names that begin with '{RESERVED}' are for structure without a name"
    if effect.baseline:
        return "baseline is True; only the paper's error model is fitted always"
    return ""


def _installed() -> Iterable[tuple[str, tuple[Effect, ...]]]:
    """For each entry point, sorted by package and name: where it comes from, and its effects."""
    entries = metadata.entry_points(group=GROUP)
    for entry in sorted(entries, key=lambda e: (e.dist.name if e.dist else "", e.name)):
        where = f"package {entry.dist.name if entry.dist else '?'}, entry point '{entry.name}'"
        try:
            with undisturbed():
                effects = _effects_in(entry.load())
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise EffectError(
                f"{where}: cannot be loaded ({shown_error(error)}); mend or uninstall the package"
            ) from None
        if not effects:
            raise EffectError(f"{where}: is no Effect and no sequence of them; mend or uninstall the package")
        yield where, effects


def _effects_in(value: Any) -> tuple[Effect, ...]:
    """The effects that a value is or holds, without those of the catalogue, which the user's file has only imported."""
    items = value if isinstance(value, tuple | list) else (value,)
    own = tuple(item for item in items if isinstance(item, Effect))
    return tuple(effect for effect in own if not any(effect is known for known in CATALOGUE))


def _does_not_run(path: Path, error: BaseException) -> str:
    """The message for a file that does not run: the line at which it failed, and how."""
    rows = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)]
    row = error.lineno if isinstance(error, SyntaxError) and error.filename == str(path) else (rows or [None])[-1]
    at = f"line {row}: " if row is not None else ""
    if isinstance(error, StreamTakenError):
        return f"{path.name}: once it has run, {error}"
    said = f"{type(error).__name__}: {error.msg}" if isinstance(error, SyntaxError) else shown_error(error)
    return f"{path.name}: {at}{said}; mend the file"
