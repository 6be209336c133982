"""What :func:`diagnosis.diagnose` answers: the paper's error factors as text, plain values, table, picture or twin."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from diagnosis.explanation import Estimate

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from diagnosis.factors.air_gaps import AirGaps, Law
    from diagnosis.factors.findings import Findings, OneSense
    from diagnosis.report.provenance import Provenance
    from diagnosis.thermal.over_temperature import OverTemperature
    from twin.chain import Chain
    from twin.sweep import Sweep

_COLUMNS = ("sweep", "rows", "rms_deg")


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis:
    """The error factors of one sweep.

    Attributes
    ----------
    findings : diagnosis.factors.findings.Findings
        Everything that was found: the fit with its residuals, identifiability, equivalents, raw channels.
    made : diagnosis.report.provenance.Provenance
        Version, day, seed and command that the answer comes from.
    """

    findings: Findings
    made: Provenance

    def __repr__(self) -> str:
        told = ", ".join(f"{name}={estimate}" for name, estimate in self.factors.items())
        return f"Diagnosis({self.sweep.name!r}, {told}; {self.rms_deg:.4g} deg RMS left)"

    @property
    def sweep(self) -> Sweep:
        """The sweep, as it was fitted."""
        return self.findings.sweep

    @cached_property
    def factors(self) -> dict[str, Estimate]:
        """The six factors by name, with their 95 % intervals.

        ``Vx_over_Ax`` and ``Vy_over_Ay``: offsets in amplitudes of their channel; ``gain_ratio``: Ay/Ax;
        ``beta_deg``: the channels' departure from a right angle; ``quad``: the quadratic term at full field, against
        the linear one; ``zero_deg``: what the sensor reads at the reference's zero.
        """
        from diagnosis.report.diagnose_answer import parameters

        return {name: Estimate.of(parameter) for name, parameter in parameters(self.findings).items()}

    @property
    def rms_deg(self) -> float:
        """RMS error [deg] that the fitted model leaves, over the readings that are no gross errors."""
        from math import degrees

        return degrees(self.findings.fit.rms_rad)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What these readings can tell and what they cannot, in words."""
        return self.findings.sentences

    @property
    def twin(self) -> Chain:
        """The twin with these factors and nothing else, not even noise: to simulate with."""
        return self.findings.fit.chain()

    def summary(self, width: int = 80) -> str:
        """The answer as a person reads it: the text that ``halltwin diagnose`` prints for one sweep.

        Parameters
        ----------
        width : int, optional
            Characters in a line.

        Returns
        -------
        str
            Several lines, without a line break at the end.
        """
        return self._alone.summary(width)

    def to_dict(self) -> dict[str, Any]:
        """The answer as plain values: the content of ``halltwin diagnose --json``, schema ``halltwin.diagnose/1``.

        Returns
        -------
        dict
            Strings, numbers, lists and dicts alone. ``sweeps`` holds the one entry; what is not finite is None.
        """
        return self._alone.to_dict()

    def to_dataframe(self) -> pd.DataFrame:
        """The factors as a table of one row, see :meth:`Diagnoses.to_dataframe`."""
        return self._alone.to_dataframe()

    def plot(self) -> Figure:
        """Draw the measured error over the turn, and the curve of the fitted factors.

        Returns
        -------
        matplotlib.figure.Figure
            A figure of its own: pyplot does not know it, and matplotlib's settings stay as they are.

        Raises
        ------
        twin.errors.UserError
            Where matplotlib is not installed.
        """
        return self._alone.plot()

    @property
    def over_temperature(self) -> OverTemperature | None:
        """The law of each factor, where the sweep holds temperatures more than 5 K apart; else None."""
        return self._alone.over_temperature

    def plot_over_temperature(self) -> Figure:
        """Draw each factor over temperature, see :meth:`Diagnoses.plot_over_temperature`."""
        return self._alone.plot_over_temperature()

    @cached_property
    def _alone(self) -> Diagnoses:
        return Diagnoses((self,), self.made)


@dataclass(frozen=True, eq=False, repr=False)
class Diagnoses:
    """The error factors of many sweeps, one :class:`Diagnosis` each: iterate, index, or take them together.

    Attributes
    ----------
    items : tuple of Diagnosis
        In the order of the sweeps.
    made : diagnosis.report.provenance.Provenance
        Version, day, seed and command that the answer comes from.
    """

    items: tuple[Diagnosis, ...]
    made: Provenance

    def __len__(self) -> int:
        return len(self.items)

    def __iter__(self) -> Iterator[Diagnosis]:
        return iter(self.items)

    def __getitem__(self, place: int) -> Diagnosis:
        return self.items[place]

    def __repr__(self) -> str:
        names = ", ".join(item.sweep.name for item in self.items[:3])
        return f"Diagnoses({len(self)} sweeps: {names}{', ...' if len(self) > 3 else ''})"

    @cached_property
    def air_gaps(self) -> tuple[Law, ...]:
        """How the factors go over the air gaps, where these are known to differ; else empty."""
        from diagnosis.factors.air_gaps import laws

        return () if self.air_gap_fit is None else laws(self.air_gap_fit)

    @cached_property
    def air_gap_fit(self) -> AirGaps | None:
        """The joint fit of sweeps at several air gaps, by the magnet's field; None where the gaps are not known."""
        from diagnosis.factors.findings import gap_fit

        return gap_fit(self._findings, self._findings[0].mounting)

    @cached_property
    def over_temperature(self) -> OverTemperature | None:
        """The law of each factor where the sweeps hold temperatures more than 5 K apart; else None.

        All sweeps count as recordings of one sensor; None also where some of them count the other way round.
        """
        import numpy as np

        from diagnosis.blas_threads import one_blas_thread
        from diagnosis.thermal.over_temperature import find_laws
        from diagnosis.thermal.recording import counts_as, joined, over_temperature

        sweeps = [item.sweep for item in self.items]
        if not over_temperature(sweeps) or len({counts_as(sweep) for sweep in sweeps}) > 1:
            return None
        with one_blas_thread():
            return find_laws(joined(sweeps), rng=np.random.default_rng(0), senses=self.one_sense.senses)

    @cached_property
    def one_sense(self) -> OneSense:
        """The senses in which the sweeps count, taken as those of one sensor, and who decides between the two pairs."""
        from diagnosis.factors.findings import one_sense

        return one_sense(self._findings)

    def summary(self, width: int = 80) -> str:
        """The text that ``halltwin diagnose`` prints: all about a single sweep, or one line each.

        Parameters
        ----------
        width : int, optional
            Characters in a line.

        Returns
        -------
        str
            Several lines, without a line break at the end.
        """
        from diagnosis.report.diagnose_text import text

        return text(self.to_dict(), width=width)

    def to_dict(self) -> dict[str, Any]:
        """The answer as plain values: the content of ``halltwin diagnose --json``, schema ``halltwin.diagnose/1``.

        Returns
        -------
        dict
            Strings, numbers, lists and dicts alone; what is not finite is None.
        """
        from diagnosis.report.diagnose_answer import to_json

        return to_json(self._findings, self.air_gap_fit, self.over_temperature, self.made)

    def to_dataframe(self) -> pd.DataFrame:
        """The factors as a table: one row a sweep.

        Returns
        -------
        pandas.DataFrame
            Columns ``sweep``, ``rows``, ``rms_deg``; then each factor with the ends of its 95 % interval, such as
            ``gain_ratio``, ``gain_ratio_low``, ``gain_ratio_high``.

        Raises
        ------
        twin.errors.UserError
            Where pandas is not installed.
        """
        from diagnosis.report.frames import data_frame

        return data_frame([_row(item) for item in self.items], columns=_COLUMNS)

    def plot(self) -> Figure:
        """Draw the measured error over the turn and the fitted curve, one panel a sweep.

        Of sweeps at several air gaps the factors over the gap stand below, with the curve of the causes that are told.

        Returns
        -------
        matplotlib.figure.Figure
            A figure of its own: pyplot does not know it, and matplotlib's settings stay as they are.

        Raises
        ------
        twin.errors.UserError
            Where matplotlib is not installed, or for more sweeps than can be seen in one picture.
        """
        from diagnosis.report.diagnose_plot import fitted_figure

        return fitted_figure(self._findings, self.air_gap_fit)

    def plot_convergence(self) -> Figure:
        """Draw how the swarm converged: RMS error of its best and of the particles' own bests over the iterations.

        Returns
        -------
        matplotlib.figure.Figure
            A figure of its own: pyplot does not know it, and matplotlib's settings stay as they are.

        Raises
        ------
        twin.errors.UserError
            Where matplotlib is not installed.
        """
        from diagnosis.report.diagnose_plot import convergence_figure

        return convergence_figure(self._findings)

    def plot_over_temperature(self) -> Figure:
        """Draw each factor over temperature: its law with the interval, and what each temperature by itself gives.

        Returns
        -------
        matplotlib.figure.Figure
            A figure of its own: pyplot does not know it, and matplotlib's settings stay as they are.

        Raises
        ------
        twin.errors.UserError
            Where matplotlib is not installed, or the sweeps tell nothing of temperature.
        """
        from diagnosis.report.temperature_plot import laws_figure
        from twin.errors import UserError

        if self.over_temperature is None:
            raise UserError(
                "nothing to draw over temperature; expected sweeps of one sensor whose temperature_c differ by more "
                "than 5 K"
            )
        return laws_figure(self.over_temperature)

    @property
    def _findings(self) -> tuple[Findings, ...]:
        return tuple(item.findings for item in self.items)


def _row(item: Diagnosis) -> dict[str, Any]:
    """One row of the table of factors."""
    row: dict[str, Any] = {"sweep": item.sweep.name, "rows": item.sweep.rows, "rms_deg": item.rms_deg}
    for name, estimate in item.factors.items():
        row |= {name: estimate.value, f"{name}_low": estimate.low, f"{name}_high": estimate.high}
    return row
