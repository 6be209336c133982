"""What :func:`diagnosis.explain` answers: verdict, causes, extended twin; as text, JSON, table, picture or report."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import isnan
from typing import TYPE_CHECKING, Any

from diagnosis.changed_parameter import ChangedParameter, number_or

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from diagnosis.discovery.result import Discovery
    from diagnosis.discovery.whole_record import WholeRecord
    from diagnosis.report.provenance import Provenance
    from twin.chain import Chain
    from twin.sweep import Sweep

_LONGEST = 240
"""Characters that are shown of a cause at a prompt."""


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter with its 95 % interval.

    Attributes
    ----------
    value : float
        The estimate; NaN where there is none.
    low, high : float
        Ends of the 95 % interval; infinite where the sweep sets none.
    unit : str
        Unit of the three, ``"1"`` for a pure number.
    """

    value: float
    low: float
    high: float
    unit: str

    @classmethod
    def of(cls, parameter: Mapping[str, Any]) -> Estimate:
        """The estimate that a parameter of a JSON answer holds."""
        return cls(
            value=number_or(parameter["value"]),
            low=number_or(parameter["low"], float("-inf")),
            high=number_or(parameter["high"], float("inf")),
            unit=parameter["unit"],
        )

    def __str__(self) -> str:
        from diagnosis.report.wording import with_unit

        return with_unit(vars(self))


@dataclass(frozen=True, repr=False)
class Cause:
    """One cause of what the simulation gets wrong. Figures are those of the answer, to seven digits.

    Attributes
    ----------
    name : str
        The cause's name in the catalogue, or ``"unnamed"`` for structure that no cause explains.
    stage : str
        Where in the chain it acts, such as ``"concentrator"``.
    parameters : mapping of str to Estimate
        Its parameters; units are in the names. A second instance of the cause has ``_2`` behind the names.
    false_alarm_probability : float
        Probability that noise alone is given any cause as strong, over everything that was searched.
    heldout_rms_deg_before, heldout_rms_deg_after : float
        RMS error [deg] without and with the cause, on readings that neither fit nor selection has seen.
    indistinguishable_from : tuple of str
        Other causes that explain this sweep as well.
    to_tell_apart : str
        The measurement that would part them; empty where nothing has to be parted.
    rows : tuple of int
        The single readings that it touched (first reading = 1), for causes of single readings.
    """

    name: str
    stage: str
    parameters: Mapping[str, Estimate]
    false_alarm_probability: float
    heldout_rms_deg_before: float
    heldout_rms_deg_after: float
    indistinguishable_from: tuple[str, ...]
    to_tell_apart: str
    rows: tuple[int, ...] = ()

    @classmethod
    def of(cls, entry: Mapping[str, Any]) -> Cause:
        """The cause that an entry of ``causes`` in the JSON answer describes."""
        return cls(
            name=entry["name"],
            stage=entry["stage"],
            parameters={name: Estimate.of(parameter) for name, parameter in entry["parameters"].items()},
            false_alarm_probability=number_or(entry["false_alarm_probability"]),
            heldout_rms_deg_before=number_or(entry["heldout_rms_deg_before"]),
            heldout_rms_deg_after=number_or(entry["heldout_rms_deg_after"]),
            indistinguishable_from=tuple(entry["indistinguishable_from"]),
            to_tell_apart=entry["to_tell_apart"],
            rows=tuple(entry.get("rows", ())),
        )

    def __repr__(self) -> str:
        told = ", ".join(f"{name}={estimate}" for name, estimate in self.parameters.items())
        shown = told if len(told) <= _LONGEST else f"{told[:_LONGEST]}..."
        before, after = self.heldout_rms_deg_before, self.heldout_rms_deg_after
        gain = "not held out" if isnan(before) or isnan(after) else f"held-out RMS {before:.4g} -> {after:.4g} deg"
        return f"Cause({self.name}: {shown}; {gain})"


@dataclass(frozen=True, eq=False, repr=False)
class Explanation:
    """The answer to one sweep.

    Attributes
    ----------
    discovery : diagnosis.discovery.pipeline.Discovery
        Everything that the search found, down to residuals and Jacobians; its inner structure may change.
    made : diagnosis.report.provenance.Provenance
        Version, day, seed and command that the answer comes from.
    whole_record : diagnosis.discovery.whole_record.WholeRecord or None
        What all readings of a record that is too long to be searched in full show beside, averaged over its turns;
        None where there is no more to it.
    """

    discovery: Discovery
    made: Provenance
    whole_record: WholeRecord | None = None

    def __repr__(self) -> str:
        from diagnosis.report.wording import plain

        before, extended = self._answer["baseline"]["heldout_rms_deg"], self._answer["extended"]
        names = ", ".join([*(change.parameter for change in self.changed), *(cause.name for cause in self.causes)])
        held = "nothing held out" if before is None else f"held-out RMS {plain(before)} deg"
        if names and extended["gain"] is not None:
            gain = f"{plain(extended['gain'])} times closer"
            held = f"held-out RMS {plain(before)} -> {plain(extended['heldout_rms_deg'])} deg, {gain}"
        names = f": {names}" if names else ""
        return f"Explanation({self.sweep.name!r}, {self.verdict}{names}; {held})"

    def _repr_html_(self) -> str:
        """Verdict and causes as a notebook shows them."""
        from diagnosis.report.notebook import notebook_html

        return notebook_html(self._answer)

    @property
    def sweep(self) -> Sweep:
        """The sweep that was searched: the readings in use of the one handed in."""
        return self.discovery.sweep

    @property
    def verdict(self) -> str:
        """How the matter stands.

        ``"adequate"``: nothing stands out of the noise; ``"explained"``: every cause has a name; ``"unnamed"``:
        structure is there that no cause of the catalogue explains; ``"partly explained"``: both.
        """
        return self.discovery.verdict

    @cached_property
    def causes(self) -> tuple[Cause, ...]:
        """What the simulation gets wrong, strongest first; empty where nothing stands out of the noise."""
        return tuple(Cause.of(entry) for entry in self._answer["causes"])

    @cached_property
    def changed(self) -> tuple[ChangedParameter, ...]:
        """What has changed of the given twin, strongest first; empty without one, and where nothing has."""
        return tuple(ChangedParameter.of(entry) for entry in self._answer["changed"])

    @property
    def other_device(self) -> bool:
        """Whether the given twin is another device's."""
        return self.discovery.other_device

    @property
    def baseline(self) -> Chain:
        """The twin before: the paper's error model as fitted to this sweep, or the one that was given."""
        return self.discovery.baseline.chain

    @property
    def extended(self) -> Chain:
        """The twin after: the causes and the noise included, to simulate with.

        Of several recordings the device's, mounted as in the first of them.
        """
        return self.discovery.device

    @cached_property
    def _answer(self) -> dict[str, Any]:
        from diagnosis.report.answer import to_json
        from diagnosis.report.whole_record import whole_answer

        return to_json(self.discovery, self.made) | whole_answer(self.whole_record)

    def summary(self, width: int = 80) -> str:
        """The answer as a person reads it: the text that ``halltwin explain`` prints, without colours.

        Parameters
        ----------
        width : int, optional
            Characters in a line.

        Returns
        -------
        str
            Several lines, without a line break at the end.
        """
        from diagnosis.report.console import text

        return text(self._answer, width=width)

    def to_dict(self) -> dict[str, Any]:
        """The answer as plain values: the content of ``halltwin explain --json``, schema ``halltwin.explain/1``.

        Returns
        -------
        dict
            Strings, numbers, lists and dicts alone, so that ``json.dumps`` takes it as it is; a copy that may be
            changed. A figure that is not finite is None.
        """
        from copy import deepcopy

        return deepcopy(self._answer)

    def to_dataframe(self) -> pd.DataFrame:
        """The causes as a table: one row each, and a column for every figure; ahead of them what has changed of a twin.

        Returns
        -------
        pandas.DataFrame
            Columns ``sweep``, ``cause``, ``stage``, ``false_alarm_probability``, ``heldout_rms_deg_before``,
            ``heldout_rms_deg_after``, ``indistinguishable_from`` (names, parted by commas), ``to_tell_apart``; then
            each parameter with the ends of its 95 % interval, such as ``lag_deg``, ``lag_deg_low``, ``lag_deg_high``.
            A change has its parameter as the ``cause``, such as ``offset.x_percent``, and its old value as ``was``.
            Tables of several sweeps can be put together by ``pandas.concat``.

        Raises
        ------
        twin.errors.UserError
            Where pandas is not installed.
        """
        from diagnosis.report.frames import data_frame

        changed = [_change_row(self.sweep.name, entry) for entry in self._answer["changed"]]
        return data_frame([*changed, *(_row(self.sweep.name, cause) for cause in self.causes)], columns=_COLUMNS)

    def plot(self) -> Figure:
        """Draw the error over the reference angle: as measured, left by the baseline, left by the extended twin.

        Returns
        -------
        matplotlib.figure.Figure
            A figure of its own: pyplot does not know it, and matplotlib's settings stay as they are.

        Raises
        ------
        twin.errors.UserError
            Where matplotlib is not installed.
        """
        from diagnosis.report.explain_plot import residual_figure

        return residual_figure(self.discovery)

    def write_report(self, path: str | os.PathLike[str]) -> None:
        """Write the answer as one HTML page with pictures, that needs nothing else: ``halltwin explain --report``.

        Parameters
        ----------
        path : str or os.PathLike
            The file, written whole or not at all.

        Raises
        ------
        twin.errors.UserError
            Where it cannot be written.
        """
        from pathlib import Path

        from diagnosis.report.page import write_report

        write_report(Path(path), self.discovery, self._answer)


_COLUMNS = (
    "sweep",
    "cause",
    "stage",
    "false_alarm_probability",
    "heldout_rms_deg_before",
    "heldout_rms_deg_after",
    "indistinguishable_from",
    "to_tell_apart",
)


def _row(sweep: str, cause: Cause) -> dict[str, Any]:
    """One row of the table of causes."""
    row: dict[str, Any] = {"sweep": sweep, "cause": cause.name}
    row |= {name: getattr(cause, name) for name in _COLUMNS[2:]}
    row["indistinguishable_from"] = ", ".join(cause.indistinguishable_from)
    for name, estimate in cause.parameters.items():
        row |= {name: estimate.value, f"{name}_low": estimate.low, f"{name}_high": estimate.high}
    return row


def _change_row(sweep: str, entry: Mapping[str, Any]) -> dict[str, Any]:
    """The row of something that has changed of a given twin."""
    change, name = ChangedParameter.of(entry), entry["parameter"].partition(".")[2]
    row: dict[str, Any] = {"sweep": sweep, "cause": change.parameter, "stage": entry["stage"]}
    row |= {key: getattr(change, key) for key in _COLUMNS[3:6]}
    row |= {"indistinguishable_from": ", ".join(change.indistinguishable_from), "to_tell_apart": ""}
    return row | {"was": change.was, name: change.value, f"{name}_low": change.low, f"{name}_high": change.high}
