"""What is said of an option that cannot be: which name was meant, what was given twice; and before any work."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import pytest

from scenarios.commands.intervals import with_units
from tests.command_line import halltwin
from twin.known_names import nearest
from twin.sweep import Sweep

BENCH = Path(__file__).parents[3] / "scenarios" / "data" / "bench_sweep.csv"


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def unread() -> Iterator[mock.Mock]:
    """No sweep can be read; nothing that an option is refused for needs one."""
    with mock.patch.object(Sweep, "read", side_effect=AssertionError("read")) as read:
        yield read


def refused(*arguments: str | Path) -> str:
    """What a command is refused with: one line, exit code 2, and no file."""
    ended = halltwin(*arguments)
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    assert list(Path().iterdir()) == []
    return ended.err


# ---- names ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("saturaton", "saturation"),
        ("SATURATION", "saturation"),
        ("foo", None),
        ("offset", None),
        ("", None),
        ("x" * 10_000, None),
    ],
)
def test_the_nearest_name_is_told_where_there_is_one(name: str, meant: str | None) -> None:
    assert nearest(name, ["offset", "saturation", "hysteresis"]) == (f" (did you mean {meant}?)" if meant else "")


@pytest.mark.parametrize(
    ("arguments", "meant", "among"),
    [
        (("bench", "--hide", "saturaton:k_percent=2"), "saturation", "hysteresis"),
        (("bench", "--hide", "saturation:k_precent=2"), "k_percent", "k_percent"),
        (("bench", "--fault", "losst"), "lost", "silent"),
        (("bench", "--fault", "silent:hal"), "hall", "stepper"),
        (("generate", "--cause", "hysteresi", "-o", "s"), "hysteresis", "saturation"),
        (("recover", "--cause", "clene", "-o", "s"), "clean", "baseline"),
        (("design", "--grade", "N35h", "-o", "s"), "N35H", "SmCo5"),
        (("design", "--shape", "rings", "-o", "s"), "ring", "cylinder"),
        (("design", "--sampling", "grit", "-o", "s"), "grid", "sobol"),
        (("design", "--tolerance", "off_axes=1", "-o", "s"), "off_axis", "tilt"),
        (("simulate", "imc14bit"), "imc-14bit", "paper-encoder"),
        (("explain", BENCH, "--fail-on", "histeresis"), "hysteresis", "unexplained"),
        (("monitor", BENCH, "--fail-on", "zero_degs"), "zero_deg", "drift"),
    ],
    ids=lambda value: " ".join(map(str, value[:3])) if isinstance(value, tuple) else "",
)
def test_an_unknown_name_is_told_with_the_nearest_and_with_all(
    arguments: tuple[str, ...], meant: str, among: str
) -> None:
    said = refused(*arguments)
    assert f" (did you mean {meant}?)" in said
    assert among in said.partition("?)")[2]


def test_a_name_without_parameters_is_told_as_a_name_first() -> None:
    said = refused("bench", "--hide", "foo")
    assert "no effect named 'foo'; known: adc_inl, adc_quantisation," in said
    said = refused("bench", "--hide", "saturation")
    assert said == (
        "halltwin: --hide saturation: expected EFFECT:PARAMETER=VALUE, e.g. saturation:k_percent=2; "
        "saturation has k_percent, exponent\n"
    )


# ---- twice ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "twice"),
    [
        (("bench", "--hide", "saturation:k_percent=1", "--hide", "saturation:k_percent=2"), "saturation:k_percent"),
        (("bench", "--hide", "offset:x_percent=1,x_percent=1"), "offset:x_percent"),
        (("bench", "--fault", "lost=0.1", "--fault", "lost:hall=0.2"), "lost:hall"),
        (("bench", "--bus-option", "a=1", "--bus-option", "a=2"), "a"),
        (("generate", "--cause", "saturation", "--cause", "saturation", "-o", "s"), "saturation"),
        (("recover", "--cause", "clean", "--cause", "clean", "-o", "s"), "clean"),
        (("design", "--grade", "N42", "--grade", "N42", "-o", "s"), "N42"),
        (("design", "--tolerance", "tilt=1,off_axis=1,tilt=2", "-o", "s"), "tilt"),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, tuple) else "",
)
def test_what_is_given_twice_is_not_decided_in_silence(arguments: tuple[str, ...], twice: str) -> None:
    said = refused(*arguments)
    assert f"gives {twice} twice; give it once" in said


def test_several_parameters_of_one_effect_may_be_given_apart() -> None:
    ended = halltwin(
        *("bench", "--hide", "offset:x_percent=1", "--hide", "offset:y_percent=2", "--points", "8", "-o", "b.csv")
    )
    assert ended.code == 0, ended.err
    assert with_units("tolerance", "tilt=1,off_axis=2mm", {"tilt": "deg", "off_axis": "mm"}) == {
        "tilt": 1.0,
        "off_axis": 2.0,
    }


# ---- examples -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("command", "option", "example"),
    [
        ("design", "--window", "30:90"),
        ("design", "--temperature", "-40:125"),
        ("generate", "--strength", "0.02:0.3"),
        ("generate", "--noise", "0.003:0.05"),
    ],
)
def test_an_example_is_one_of_the_option_at_hand(command: str, option: str, example: str) -> None:
    said = refused(command, option, "x", "-o", "s")
    assert said == f"halltwin: {option.removeprefix('--')} is 'x'; expected low:high, e.g. {example}\n"


# ---- before the work ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        *(("compensate", BENCH, "--header", "c.h", "--prefix", prefix) for prefix in ("1x", "a b", "é", "a-b")),
        ("compensate", BENCH, "--points", "3"),
        ("compensate", BENCH, "--tolerance", "99"),
        ("compensate", BENCH, "--temperature", "-500"),
        ("compensate", BENCH, "--effects", "none.py"),
        ("compensate", BENCH, "--fail-on", "foo"),
        ("compensate", BENCH, "--check", "none.csv"),
        ("compensate", BENCH, "--table", "t.txt"),
        ("export", BENCH, "--for", "foo"),
        ("export", BENCH, "--for", "lut", "--least", "most"),
        ("export", BENCH, "--for", "lut", "--temperature", "-500"),
        ("export", BENCH, "--for", "lut", "--fail-on", "foo"),
        ("export", BENCH, "--for", "lut", "--check", "none.csv"),
        ("export", BENCH, "--for", "lut", "-o", "t.txt"),
        ("export", BENCH, "--for", "c", "-o", "c.h", "--name", "1x"),
        ("explain", BENCH, "--twin", "foo"),
        ("explain", BENCH, "--twin", "none.toml"),
        ("explain", BENCH, "--effects", "none.py"),
        ("explain", BENCH, "--fail-on", "foo"),
        ("explain", BENCH, "--json", "a.txt"),
        ("explain", BENCH, "--max-size", "foo"),
        ("diagnose", BENCH, "--fail-on", "foo"),
        ("diagnose", BENCH, "--plot", "a.txt"),
        ("monitor", BENCH, "--run-length", "1"),
        ("monitor", BENCH, "--fail-on", "foo"),
        ("simulate", "foo", "--motion", BENCH),
        ("simulate", "--effects", "none.py", "--motion", BENCH),
        ("simulate", "--reference-lines", "0", "--motion", BENCH),
        ("simulate", "--plot", "a.txt", "--motion", BENCH),
    ],
    ids=lambda value: " ".join(map(str, (value[0], *value[2:]))),
)
def test_an_option_that_cannot_be_is_told_before_a_sweep_is_read(
    arguments: tuple[str | Path, ...], unread: mock.Mock
) -> None:
    refused(*arguments)
    unread.assert_not_called()
