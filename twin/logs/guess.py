"""Which columns of a log are those of a sweep, guessed from names, units and values, as the statement that says so."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from twin.angles import Array
from twin.errors import SweepError
from twin.logs.alone import alone, in_order
from twin.logs.angles import AngleUnit, units_of_pair
from twin.logs.asked_back import raise_open, raise_several
from twin.logs.candidates import Candidate, candidates_of, weight_of
from twin.logs.channels import angle_of, channels
from twin.logs.devices import meanings_of
from twin.logs.errors_listed import statements_of_errors
from twin.logs.lookups import statements_of
from twin.logs.names import Meaning
from twin.logs.odd_factors import odd_factor
from twin.logs.others import others
from twin.logs.ratios import Turned, turned
from twin.logs.row_counters import counts_rows
from twin.logs.statement import Column, text_of
from twin.logs.table import LARGEST, Table
from twin.sweep_columns import is_spin

_SIDES = 2
_ERROR_IS = "an error is the reading less the true angle, a correction the reverse"
_UNIT_OF_ERROR = "one without a unit is in that of the angle beside it"
_WHICH_IS_TRUE = "reference_deg is the angle that is taken as true, and neither names nor values say which is"
_DIRECTIONS = 3
_FEWEST = 4
"""Numbers that a column must hold to be judged."""
_MOST_ANGLES = 12
"""Columns that are compared each with each other; of more a name must say that they are angles."""


@dataclass(frozen=True)
class Guess:
    """A statement for ``--columns``, what was taken for granted in it, and the columns that it leaves out, with why."""

    columns: tuple[Column, ...]
    notes: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """As ``--columns`` takes it."""
        return text_of(self.columns)


def guessed(table: Table) -> Guess:
    """The one statement that fits a table. Raises SweepError where none does, and where two do."""
    if table.entries:
        return _guessed_of_entries(table)
    said = tuple(map(_borne_out, meanings_of(table.described), table.values))
    usable = [k for k, values in enumerate(table.values) if k not in table.faults and not _untold(values)]
    angles = [k for k in usable if said[k].role in ("angle", "")]
    if len(angles) > _MOST_ANGLES:
        angles = [k for k in angles if said[k].role]
    if len(angles) > _MOST_ANGLES:
        raise SweepError(
            f"{table.file}: {len(angles)} columns may be angles (found {table.listed()}); say which are meant: "
            '--columns "reference_deg=NAME, measured_deg=NAME"'
        )
    candidates = candidates_of(table, said, angles)
    pair = _pair(table, said, angles, usable, candidates)
    found = channels(table, said, usable, None if pair is None else pair[1].of(table))
    if pair is None and not found.columns and (listed := statements_of_errors(table, said, usable)):
        return _one_of(listed, (_ERROR_IS, _UNIT_OF_ERROR), table)
    if pair is None:
        pair = _by_channels(table, said, angles, found.columns)
        if pair is None and (single := alone(table, _without_counters(table, said), usable, found)) is not None:
            columns = in_order(single.columns)
            return Guess(columns, single.notes, unused_by(columns, table, single.why))
        if pair is None:
            _raise_doubtful(table, said, usable, candidates)
            _raise_no_angles(table)
        if any(column.per for column in pair):
            # A radius that goes with a period is none of the turn.
            found = replace(found, columns=())
    rest = others(table, said, usable, pair[0].of(table))
    columns = in_order((*pair, *found.columns, *rest.columns))
    unused = unused_by(columns, table, {**found.why, **rest.why})
    several = tuple(
        f"{one.target} turns {one.per:g} times in a turn of the shaft: pole pairs, or a gear" for one in pair if one.per
    )
    return Guess(columns, (*several, *found.notes, *rest.notes), unused)


def _borne_out(said: Meaning, values: Array) -> Meaning:
    """What a name says, where the values (n,) can be that: a direction is one of two, or of three with a stop."""
    if said.role == "direction" and np.unique(values[np.isfinite(values)]).size > _DIRECTIONS:
        return Meaning("")
    return said


def _without_counters(table: Table, said: tuple[Meaning, ...]) -> tuple[Meaning, ...]:
    """What names say, but for those that call a counter of rows an angle."""
    return tuple(
        Meaning("") if one.role == "angle" and counts_rows(values, one) else one
        for values, one in zip(table.values, said, strict=True)
    )


def _guessed_of_entries(table: Table) -> Guess:
    return _one_of(*statements_of(table), table)


def _one_of(fitting: Sequence[tuple[Column, Column]], notes: tuple[str, ...], table: Table) -> Guess:
    """The one statement that fits. Raises OpenGuess where more do."""
    if len(fitting) > 1:
        raise_several(table, fitting, "; ".join(notes))
    return Guess(fitting[0], notes, unused_by(fitting[0], table))


def _untold(values: Array) -> str:
    """Why a column (n,) tells nothing: few numbers, or one that no bench can have meant; empty where it does."""
    known = values[np.isfinite(values)]
    if known.size < _FEWEST:
        return f"holds {known.size or 'no'} number{'' if known.size == 1 else 's'}"
    largest = float(np.max(np.abs(known)))
    return "" if largest <= LARGEST else f"holds numbers up to {largest:.3g}, beyond {LARGEST:g}"


def unused_by(columns: tuple[Column, ...], table: Table, why: Mapping[int, str] | None = None) -> tuple[str, ...]:
    """The columns of a table that a statement leaves out, with why by their places, where that is known."""
    used = {table.place(source) for one in columns for source in one.sources if not table.counts_rows(source)}
    why = why or {}
    return tuple(_left(table, k, why.get(k, "")) for k in range(len(table.names)) if k not in used)


def _left(table: Table, place: int, why: str) -> str:
    fault = table.faults.get(place, "")
    why = why or ("holds words" if " words " in fault else fault and "holds cells that are no numbers")
    why = why or _untold(table.values[place])
    return f"{table.names[place] or f'#{place + 1}'}{f' ({why})' if why else ''}"


def _pair(
    table: Table, said: tuple[Meaning, ...], angles: list[int], usable: list[int], candidates: Sequence[Candidate]
) -> tuple[Column, Column] | None:
    """The reference and the sensor; None where there are not two angles. Raises SweepError, see :func:`guessed`."""
    fitting = [one for one in candidates if not one.doubt]
    if not fitting:
        turning = [k for k in angles if not counts_rows(table.values[k], said[k])]
        several = _turned(table, said, turning)
        if several is not None or candidates:
            return several
        _raise_contradiction(table, said, angles)
        _raise_odd_factor(table, said, angles)
        return _by_name_alone(table, said, angles)
    if len(fitting) > 1:
        swapped = {(one.reference, one.measured) for one in fitting} >= {(fitting[0].measured, fitting[0].reference)}
        whole = [_with_others(table, said, usable, one.columns(table)) for one in fitting]
        raise_several(table, whole, _WHICH_IS_TRUE if swapped else "")
    return fitting[0].columns(table)


def _raise_doubtful(
    table: Table, said: tuple[Meaning, ...], usable: list[int], candidates: Sequence[Candidate]
) -> None:
    """Raise OpenGuess where two angles follow each other and one of them is hardly a reference."""
    if not candidates:
        rows = [k for k in usable if said[k].role == "other" and counts_rows(table.values[k], said[k])]
        angles = [k for k in usable if said[k].role in ("angle", "")]
        candidates = candidates_of(table, said, [*angles, *rows]) if len(angles) == 1 else []
    if not candidates:
        return
    whole = [_with_others(table, said, usable, one.columns(table)) for one in candidates]
    # What has a time, too, may be a log without a reference.
    single = tuple(column for column in whole[0] if column.target != "reference_deg")
    if is_spin([column.target for column in single]):
        whole.append(single)
    raise_open(table, candidates[0].doubt, list(map(text_of, whole)), alone=single)


def _with_others(
    table: Table, said: tuple[Meaning, ...], usable: list[int], pair: tuple[Column, Column]
) -> tuple[Column, ...]:
    """A reference and a sensor, and what else of a sweep the log holds beside them."""
    rest = others(table, said, usable, pair[0].of(table))
    return in_order((*pair, *channels(table, said, usable, pair[1].of(table)).columns, *rest.columns))


def _turned(table: Table, said: tuple[Meaning, ...], angles: list[int]) -> tuple[Column, Column] | None:
    """A reference and a sensor of which one turns a whole number of times faster. Raises OpenGuess where two fit."""
    weighed = [(weight_of(said[a], said[b]), a, b) for a, b in itertools.permutations(angles, 2)]
    for weight in sorted({weight for weight, _, _ in weighed if weight >= 0}, reverse=True):
        found = [
            (a, b, one)
            for own, a, b in weighed
            if own == weight
            for one in turned(table.values[a], table.values[b], said=(said[a], said[b]))
        ]
        fitting = [one.columns((table.sources[a], table.sources[b])) for a, b, one in found]
        if len(found) == 1 and found[0][2].is_one_sensors(table.values[found[0][0]], table.values[found[0][1]]):
            a, b = (table.names[k] for k in found[0][:2])
            raise_open(
                table,
                f"{a} and {b} hold one angle to the last digit, one of them {max(found[0][2].times):g} times a turn, "
                "as those of one sensor do",
                [text_of(fitting[0])],
                alone=fitting[0][1:],
            )
        if len(fitting) > 1:
            raise_several(table, fitting)
        if fitting:
            return fitting[0]
    return None


def _raise_contradiction(table: Table, said: tuple[Meaning, ...], angles: list[int]) -> None:
    """Raise SweepError where two columns follow each other in other units than their names say."""
    free = tuple(Meaning(one.role, one.reference, one.sensor) for one in said)
    fitting = candidates_of(table, free, angles)
    if not fitting:
        return
    named = (fitting[0].reference, fitting[0].measured)
    stated = {k: one.name for k in named if (one := said[k].unit)} | {k: "counts" for k in named if said[k].counts}
    wrong = [
        f"{table.names[k]} is named in {stated[k]}, its values fit {unit}"
        for k, unit in zip(named, fitting[0].units, strict=True)
        if k in stated and stated[k] != (unit.name or "counts")
    ]
    what = "; ".join(wrong) or "no two columns follow each other in the units of their names"
    raise_open(table, what, [text_of(one.columns(table)) for one in fitting])


def _raise_odd_factor(table: Table, said: tuple[Meaning, ...], angles: list[int]) -> None:
    """Raise OpenGuess where two columns follow each other by a factor that no encoder and no whole gear has."""
    pairs = [pair for pair in itertools.permutations(angles, 2) if weight_of(said[pair[0]], said[pair[1]]) >= 0]
    for a, b in sorted(pairs, key=lambda pair: -weight_of(said[pair[0]], said[pair[1]])):
        odd = odd_factor(
            (table.values[a], table.values[b]), said=(said[a], said[b]), sources=(table.sources[a], table.sources[b])
        )
        if odd is not None:
            name = table.names[(a, b)[odd.place]] or table.sources[(a, b)[odd.place]]
            raise_open(table, f"{name}: {odd.said}", [text_of(odd.columns)])


def _by_name_alone(table: Table, said: tuple[Meaning, ...], angles: list[int]) -> tuple[Column, Column] | None:
    """The pair that names alone single out: what is wrong with its values is said where they are a sweep's."""
    weighed = [(weight_of(said[a], said[b]), a, b) for a, b in itertools.permutations(angles, 2)]
    most = max((weight for weight, _, _ in weighed), default=0)
    best = [(a, b) for weight, a, b in weighed if weight == most]
    if most < 1 or len(best) > 1:
        return None
    units = [AngleUnit(one.name) for k in best[0] if (one := said[k].unit)]
    # Units that nothing tells are no guess to go by.
    return Candidate(*best[0], (units[0], units[1]), most).columns(table) if len(units) == _SIDES else None


def _turned_pair(found: Turned, source: str, measured: Column) -> tuple[Column, Column]:
    """A reference of this source and a sensor's angle, of which one turns several times in a turn of the other."""
    per = [None if times == 1.0 else times for times in found.times]
    return replace(found.units[0].column("reference_deg", source), per=per[0]), replace(measured, per=per[1])


def _by_channels(
    table: Table, said: tuple[Meaning, ...], angles: list[int], found: tuple[Column, ...]
) -> tuple[Column, Column] | None:
    """A reference, and the angle of the two channels as the sensor's; None where there is none. Raises OpenGuess."""
    if len(found) == 2:
        measured = angle_of(found)
        values = measured.of(table)
        own = Meaning("angle", unit=None, sensor=2)
        fitting = [
            (units[0].column("reference_deg", table.sources[k]), measured)
            for k in angles
            for units in units_of_pair(table.values[k], values, said=(said[k], own))
            if units[1].name == "deg"
        ]
        # Of a ring of magnets, or a resolver of several speeds, the channels turn several times in a turn.
        fitting = fitting or [
            _turned_pair(units, table.sources[k], measured)
            for k in angles
            for units in turned(table.values[k], values, said=(said[k], own))
            if units.units[1].name == "deg"
        ]
        if len(fitting) == 1:
            return fitting[0]
        if fitting:
            raise_several(table, fitting)
    return None


def _raise_no_angles(table: Table) -> NoReturn:
    """Raise SweepError for a log that holds neither a reference and a sensor, nor a sensor alone over time."""
    mistyped = [fault for fault in table.faults.values() if " words " not in fault]
    if mistyped:
        raise SweepError(f"{table.file}: {mistyped[0]}")
    raise SweepError(
        f"{table.file}: no two columns are angles that follow each other (found {table.listed()}); expected a "
        'reference and a sensor: say which, e.g. --columns "reference_deg=NAME*360/4096, measured_deg=NAME:rad"; or, '
        "of a shaft that turns by itself, a time and a sensor"
    )
