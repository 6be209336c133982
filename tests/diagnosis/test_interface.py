"""``from diagnosis import explain, diagnose``: the same answer as the command line's, in every form that is offered."""

from __future__ import annotations

import dataclasses
import functools
import json
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis import Cause, Diagnoses, Diagnosis, DiscoverySettings, Explanation, diagnose, diagnose_many, explain
from tests.command_line import halltwin
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.errors import UserError
from twin.extensions import EffectError, effects_of
from twin.files import read_twin, to_dict, write_twin
from twin.motion import Motion
from twin.sweep import Sweep

DATA = Path(__file__).parents[2] / "scenarios" / "data"
BENCH, GEAR, GEAR_MESH = DATA / "bench_sweep.csv", DATA / "gear_sweep.csv", DATA / "gear_mesh.py"
THREE_LINES = 300
TURN = np.radians(np.arange(0.0, 360.0, 4.0))


@functools.cache
def bench() -> Explanation:
    return explain(BENCH)


@functools.cache
def clean() -> Explanation:
    """The answer to a sweep of the error model and noise alone."""
    return explain(Chain().with_effect("noise", rms_deg=0.02).simulate(Motion.from_angle(TURN)))


@functools.cache
def turns(*, swarm: bool = False) -> Diagnoses:
    """The factors of two short sweeps of one sensor."""
    sensor = Chain().with_effect("gain_mismatch", ratio=1.01).with_effect("noise", rms_deg=0.02)
    return diagnose_many([sensor.simulate(Motion.from_angle(TURN), seed=seed) for seed in range(2)], swarm=swarm)


# ---- the same as the command line's ------------------------------------------------------------------------------


def test_explain_answers_as_the_command_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    json_path, report, twin = (tmp_path / name for name in ("a.json", "a.html", "a.toml"))
    ended = halltwin("explain", BENCH, "--json", json_path, "--report", report, "--extended", twin)
    found = bench()
    assert ended.out == f"{found.summary()}\nwrote {json_path}, {report}, {twin}\n"
    command = f"halltwin explain {BENCH} --seed 0"
    assert answer_of(json_path) == found.to_dict() | {"command": command}
    assert to_dict(read_twin(twin)) == to_dict(found.extended)
    found.write_report(str(tmp_path / "b.html"))
    called = f". The same again: <code>{command}</code></p>"
    assert report.read_text().startswith((tmp_path / "b.html").read_text().replace(", called from Python.</p>", called))


def answer_of(path: Path) -> Any:
    """The answer in a file, without the mark that a file bears."""
    answer = json.loads(path.read_text())
    del answer["written_by"]
    return answer


def test_diagnose_answers_as_the_command_does(tmp_path: Path) -> None:
    for files, found in (([BENCH], diagnose(BENCH)), ([BENCH, GEAR], diagnose_many([BENCH, GEAR]))):
        json_path = tmp_path / "a.json"
        ended = halltwin("diagnose", *files, "--json", json_path)
        assert ended.out == f"{found.summary()}\nwrote {json_path}\n"
        command = f"halltwin diagnose {' '.join(map(str, files))} --seed 0"
        assert answer_of(json_path) == found.to_dict() | {"command": command, "unusable": []}


# ---- what a result offers ----------------------------------------------------------------------------------------


def test_results_show_themselves_in_three_lines_at_most() -> None:
    words = {
        "Explanation('bench_sweep.csv', explained: hysteresis; held-out RMS 0.134 -> 0.0248 deg": bench(),
        "Explanation('simulated', adequate; held-out RMS": clean(),
        "Cause(hysteresis: lag_deg=0.1194 deg (0.1175 to 0.1205), memory_deg=": bench().causes[0],
        "Diagnosis('simulated', Vx_over_Ax=": turns()[0],
        "Diagnoses(2 sweeps: simulated, simulated)": turns(),
    }
    for start, shown in words.items():
        assert repr(shown).startswith(start)
        assert len(repr(shown)) <= THREE_LINES


def test_a_cause_holds_the_figures_of_the_json() -> None:
    (cause,), (entry,) = bench().causes, bench().to_dict()["causes"]
    assert bench().verdict == bench().to_dict()["verdict"] == "explained"
    for name in ("name", "stage", "false_alarm_probability", "heldout_rms_deg_before", "heldout_rms_deg_after"):
        assert getattr(cause, name) == entry[name]
    assert cause.parameters.keys() == entry["parameters"].keys()
    for name, estimate in cause.parameters.items():
        assert vars(estimate).items() <= entry["parameters"][name].items()
    assert str(cause.parameters["lag_deg"]) == "0.1194 deg (0.1175 to 0.1205)"


def test_an_end_that_the_sweep_does_not_set_is_infinite() -> None:
    entry = bench().to_dict()["causes"][0]
    entry["parameters"]["lag_deg"] |= {"low": None, "high": None}
    entry["parameters"]["memory_deg"] |= {"value": None}
    found = Cause.of(entry).parameters
    assert (found["lag_deg"].low, found["lag_deg"].high) == (-np.inf, np.inf)
    assert str(found["lag_deg"]).endswith("±∞ deg")
    assert str(found["memory_deg"]) == "not determined"
    assert repr(Cause.of({**entry, "heldout_rms_deg_after": None})).endswith("; not held out)")


def test_a_dict_that_is_changed_changes_no_answer() -> None:
    found = bench().to_dict()
    found["causes"].clear()
    assert bench().to_dict()["causes"]
    factors = turns()[0].to_dict()
    factors["sweeps"][0]["mechanical"].clear()
    assert turns()[0].to_dict()["sweeps"][0]["mechanical"]


def test_a_result_cannot_be_changed() -> None:
    for result, name in ((bench(), "discovery"), (bench().causes[0], "name"), (turns()[0], "findings")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(result, name, None)


def test_a_result_can_be_handed_to_another_process() -> None:
    for result in (bench(), turns()):
        assert pickle.loads(pickle.dumps(result)).to_dict() == result.to_dict()
    assert pickle.loads(pickle.dumps(Chain())).effects == CATALOGUE


def test_the_width_of_a_summary_is_kept() -> None:
    for width in (60, 120):
        assert max(map(len, bench().summary(width).splitlines())) <= width


def test_a_notebook_is_shown_verdict_and_causes() -> None:
    html = bench()._repr_html_()
    assert "bench_sweep.csv: explained" in html
    assert "lag 0.1194 deg (0.1175 to 0.1205)" in html
    assert "<table" not in clean()._repr_html_()


def test_tables_hold_a_row_for_each_cause_and_each_sweep() -> None:
    pd = pytest.importorskip("pandas")
    table = bench().to_dataframe()
    assert list(table["cause"]) == ["hysteresis"]
    lag = bench().causes[0].parameters["lag_deg"]
    assert tuple(table.loc[0, ["lag_deg", "lag_deg_low", "lag_deg_high"]]) == (lag.value, lag.low, lag.high)
    nothing = clean().to_dataframe()
    assert nothing.empty
    assert list(table)[: len(list(nothing))] == list(nothing)
    assert len(pd.concat([table, nothing])) == 1
    factors = turns().to_dataframe()
    assert list(factors["gain_ratio"]) == [one.factors["gain_ratio"].value for one in turns()]
    assert len(turns()[1].to_dataframe()) == 1


PICTURES: dict[str, tuple[Callable[[], Any], int]] = {
    "explained": (lambda: bench().plot(), 3),
    "factors": (lambda: turns()[0].plot(), 1),
    "factors of two": (lambda: turns().plot(), 2),
    "convergence": (lambda: turns(swarm=True).plot_convergence(), 1),
}


@pytest.mark.parametrize(("draw", "panels"), PICTURES.values(), ids=PICTURES)
def test_a_picture_leaves_matplotlib_as_it_was(draw: Callable[[], Any], panels: int) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    import matplotlib.pyplot as plt

    before, backend, open_figures = dict(matplotlib.rcParams), matplotlib.get_backend(), plt.get_fignums()
    figure = draw()
    assert len([axis for axis in figure.axes if axis.has_data()]) == panels
    assert dict(matplotlib.rcParams) == before
    assert matplotlib.get_backend() == backend
    assert plt.get_fignums() == open_figures


def test_what_no_swarm_has_searched_has_no_convergence_to_draw() -> None:
    with pytest.raises(UserError, match="swarm=True"):
        turns().plot_convergence()


@pytest.mark.parametrize(
    ("package", "use"),
    [("pandas", Explanation.to_dataframe), ("matplotlib", Explanation.plot)],
    ids=["pandas", "matplotlib"],
)
def test_a_package_that_is_absent_is_asked_for(
    package: str, use: Callable[[Explanation], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(UserError, match=f"needs {package}; pip install"):
        use(bench())


def test_the_extended_twin_simulates_what_it_explains(tmp_path: Path) -> None:
    extended = bench().extended
    again = explain(extended.simulate(bench().sweep.motion(), seed=5))
    assert [cause.name for cause in again.causes] == ["hysteresis"]
    held_against = explain(extended.simulate(bench().sweep.motion(), seed=6), twin=extended)
    assert held_against.verdict == "adequate"
    assert held_against.baseline.values["hysteresis"] == extended.values["hysteresis"]


def test_the_twin_of_the_factors_has_them() -> None:
    one = turns()[0]
    assert isinstance(one, Diagnosis)
    ratio = one.factors["gain_ratio"]
    assert one.twin.values["gain_mismatch"]["ratio"] == ratio.value
    assert ratio.low < 1.01 < ratio.high
    # What is left is the noise: its RMS is known to 1/sqrt(2 n) of itself, and five of those are enough.
    assert one.rms_deg == pytest.approx(0.02, rel=5.0 / np.sqrt(2.0 * TURN.size))


# ---- arguments ---------------------------------------------------------------------------------------------------


def test_a_twin_is_a_file_or_a_chain(tmp_path: Path) -> None:
    given = bench().extended
    write_twin(tmp_path / "twin.toml", given)
    sweep = bench().sweep
    answers = [explain(sweep, twin=twin).to_dict() for twin in (tmp_path / "twin.toml", str(tmp_path / "twin.toml"))]
    assert answers[0] == answers[1] == explain(sweep, twin=read_twin(tmp_path / "twin.toml")).to_dict()
    assert answers[0]["sweep"]["held_against"] == "given twin"
    with pytest.raises(UserError, match="twin is of the type int"):
        explain(sweep, twin=3)  # type: ignore[arg-type]


def test_own_effects_are_files_or_effects_one_or_several() -> None:
    (effect,) = effects_of(GEAR_MESH)
    answers = [explain(GEAR, effects=own) for own in (GEAR_MESH, [str(GEAR_MESH)], effect, [effect, effect])]
    assert [[cause.name for cause in found.causes] for found in answers] == [["gear_mesh"]] * 4
    # A twin brings its own effects along, whether they are given again or not.
    extended = answers[0].extended
    for own in ((), GEAR_MESH):
        assert explain(GEAR, twin=extended, effects=own).verdict == "adequate"
    with pytest.raises(EffectError, match=r"nowhere\.py: no such file"):
        explain(GEAR, effects="nowhere.py")
    for none in (5, None):
        with pytest.raises(UserError, match=r"effects is of the type (int|NoneType); expected files or effects"):
            explain(GEAR, effects=none)  # type: ignore[arg-type]
    with pytest.raises(EffectError, match="effects holds None; expected the path of a Python file, or an Effect"):
        explain(GEAR, effects=[None])  # type: ignore[list-item]


def test_the_seed_alone_decides_what_is_random() -> None:
    coloured = Chain().with_effect("noise", rms_deg=0.02, correlation=0.6, correlated_share=0.8)
    sweep = coloured.simulate(Motion.from_angle(TURN), seed=2)
    assert explain(sweep, seed=1).to_dict() == explain(sweep, seed=np.int64(1)).to_dict()
    assert explain(sweep, seed=1).to_dict() != explain(sweep, seed=2).to_dict()
    assert diagnose(sweep, seed=1).to_dict() == diagnose(sweep, seed=1).to_dict()


def test_settings_decide_how_improbable_a_cause_must_be() -> None:
    there = np.arange(0.0, 720.0, 2.0)
    motion = Motion.from_angle(np.radians(np.concatenate([there, there[::-1]])))
    # A play of 0.004 deg either way in 720 readings with 0.02 deg of noise stands out by 0.004 sqrt(720)/0.02 = 5
    # sigma: improbable by chance, but not as improbable as one in 10^12 over all that is searched.
    weak = (
        Chain()
        .with_effect("backlash", half_width_deg=0.004)
        .with_effect("noise", rms_deg=0.02)
        .simulate(motion, seed=1)
    )
    verdicts = [explain(weak, settings=settings).verdict for settings in (None, DiscoverySettings())]
    assert verdicts == ["explained", "explained"]
    assert explain(weak, settings=DiscoverySettings(false_alarm_probability=1e-12)).causes == ()
    with pytest.raises(UserError, match="settings is of the type float; expected DiscoverySettings"):
        explain(weak, settings=0.01)  # type: ignore[arg-type]


def test_settings_show_what_differs_from_the_defaults() -> None:
    assert repr(DiscoverySettings()) == "DiscoverySettings()"
    assert repr(DiscoverySettings(most_causes=3)) == "DiscoverySettings(most_causes=3)"


@pytest.mark.parametrize("seed", [-1, 0.5, "1", None, True])
def test_a_seed_is_a_whole_number(seed: Any) -> None:
    for call in (explain, diagnose):
        with pytest.raises(UserError, match=r"seed is .*; expected a whole number, 0 or more"):
            call(BENCH, seed=seed)


def test_gross_errors_are_fitted_only_where_that_is_asked_for() -> None:
    sweep = Chain().with_effect("noise", rms_deg=0.02).simulate(Motion.from_angle(TURN), seed=1)
    wild = sweep.measured_deg.copy()
    wild[10] += 90.0
    glitched = dataclasses.replace(sweep, measured_deg=wild)
    assert diagnose(glitched).findings.glitch_rows == (11,)
    assert diagnose(glitched, robust=False).findings.glitch_rows == ()
    # One reading in 90 that is off by 90 deg makes 9.5 deg RMS.
    assert diagnose(glitched, robust=False).rms_deg > 5.0 > diagnose(glitched).rms_deg


@pytest.mark.parametrize("one", [BENCH, str(BENCH), Sweep.read(BENCH), Sweep.read(BENCH).columns], ids=type)
def test_many_sweeps_are_not_one(one: Any) -> None:
    with pytest.raises(UserError, match="a single sweep where several are expected"):
        diagnose_many(one)
    with pytest.raises(UserError, match="found no sweep"):
        diagnose_many([])


# ---- the package -------------------------------------------------------------------------------------------------


def test_importing_it_loads_no_numerical_library() -> None:
    code = "import diagnosis, sys; print(sorted({'numpy', 'scipy', 'rich', 'twin'} & set(sys.modules)))"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "[]"


def test_every_public_name_is_there_and_documented() -> None:
    import diagnosis
    import diagnosis.diagnose
    import diagnosis.explain

    for name in diagnosis.__all__:
        assert getattr(diagnosis, name) is not None
        assert name in dir(diagnosis)
    # The modules of these names do not take the place of the functions.
    assert callable(diagnosis.explain)
    assert callable(diagnosis.diagnose)
    with pytest.raises(AttributeError, match="no attribute 'explainer'"):
        _ = diagnosis.explainer
