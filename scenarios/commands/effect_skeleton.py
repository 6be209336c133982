"""Skeletons of effects: one Python file for each kind of structure, commented for who writes the physics into it."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

_WHOLE = 0.02
"""An order this near to a whole number is meant to be one: what repeats each turn."""
_RPM = 1000.0


@dataclass(frozen=True, kw_only=True)
class Parts:
    """What tells one skeleton from another, as Python text; ``body`` is that of ``forward``."""

    constants: str
    params: str
    body: str
    needs: tuple[str, ...]
    signature: str
    functions: str = ""
    declared: str = ""


def skeleton(name: str, *, file: str, structure: Mapping[str, Any] | None, sweep: Mapping[str, Any], found: str) -> str:
    """The text of an effect file called ``file``.

    ``structure`` and ``sweep`` are those of an answer of ``halltwin explain`` (none: a line of order 5), ``found``
    says in words where the skeleton comes from.
    """
    structure = structure or {"kind": "order", "order": 5.0}
    parts = KINDS.get(str(structure.get("kind")), _order)(structure, sweep)
    needs = ", ".join(f'"{need}"' for need in parts.needs)
    head = _HEAD.format(name=name, file=file, found=textwrap.fill(found, 100))
    declared = _EFFECT.format(
        name=name,
        params=textwrap.indent(parts.params.strip("\n"), " " * 8),
        declared=textwrap.indent(parts.declared, " " * 4),
        needs=f"frozenset({{{needs}}})",
        signature=parts.signature,
    )
    # Two empty lines between functions, one behind the imports.
    constants = [f"{head}\n{parts.constants}" if parts.constants else head]
    functions = [_FORWARD + textwrap.indent(parts.body.strip("\n"), " " * 4), parts.functions, declared]
    return "\n\n\n".join(block.strip("\n") for block in (*constants, *functions) if block) + "\n"


_HEAD = '''"""{name}: say in one line what happens, and by what physics.

{found}

Change what stands below to your physics, then:
    halltwin check-effect {file}
    halltwin explain SWEEP --effects {file}
"""

from __future__ import annotations

import numpy as np
from twin import Array, Effect, Motion, Param, Parameters
'''

_FORWARD = '''def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    """The signal [rad] with the effect in it; at null the very same numbers.

    The last axis counts the readings in the order in which they were taken. So do the arrays of `motion`: shaft_rad,
    time_s, direction (+1 or -1), speed_rad_s, turn, temperature_c.
    """
'''

_EFFECT = """EFFECT = Effect(
    name="{name}",
    # Where it happens: mechanics, magnet, concentrator, hall, adc, cordic, link or reference.
    stage="mechanics",
    # What it changes: the angle of the "shaft" or of the "field" [rad], the two "channels" (amplitude 1), the computed
    # "angle" [rad], or what the "reference" reads [rad].
    acts_on="shaft",
    # Units stand at the end of names. At its null a strength does nothing; lower and upper bound it; typical is the
    # size that makes about 0.1 deg. Roles: "strength" where none is given, "phase" in deg, "shape" for what is tried on
    # the grid `shapes` (orders, widths), "level" for a strength that is tried there, "random" for the size of noise.
    # Where they apply: allowed=(low, high) for what physics allows, field_power=-1.0 for what falls with the magnet's
    # field, mirror=-1 for what changes sign when sensor and output count the other way, owner="device", "mounting",
    # "bench" or "recording" for whose it is where it is not its stage's (mechanics and reference: the bench's, magnet:
    # the mounting's, others: the device's).
    params={{
{params}
    }},
    forward=forward,
{declared}    # What a sweep must hold to show it; the column `needs` of `halltwin causes` has the words.
    needs={needs},
    source="which book, paper, drawing or data sheet defines this",
    signature="{signature}",
)
"""


# ---- pieces -----------------------------------------------------------------------------------------------------


def _number(value: float) -> str:
    """A float literal of six digits."""
    text = f"{value:.6g}"
    return text if any(c in text for c in ".en") else f"{text}.0"


def _near(value: float) -> float:
    """A bound, to four digits."""
    return float(f"{value:.4g}")


def _param(
    name: str, doc: str, *, unit: str = "deg", null: float = 0.0, low: float, high: float, more: str = ""
) -> str:
    ends = f"null={_number(null)}, lower={_number(low)}, upper={_number(high)}"
    return f'"{name}": Param(unit="{unit}", {ends}, doc="{doc}"{more}),\n'


_PHASE = _param("phase_deg", "its phase", low=-360.0, high=360.0, more=', role="phase"')


def _amplitude(signed: bool) -> str:
    """An amplitude; without a phase to turn it, it has a sign of its own."""
    return _param("amplitude_deg", "amplitude", low=-20.0 if signed else 0.0, high=20.0)


def _amplitude_per_kelvin(signed: bool) -> str:
    low, more = -1.0 if signed else 0.0, ", typical=0.0025"
    return _param("deg_per_K", "amplitude a kelvin", unit="deg/K", low=low, high=1.0, more=more)


_AMPLITUDE_RAD = 'amplitude_rad: Array = np.radians(values["amplitude_deg"])\n'


def _shapes(*pairs: tuple[str, str]) -> str:
    """The grid of a single point: the shape that was found, from which a fit goes on."""
    grid = ", ".join(f'"{name}": {value}' for name, value in pairs)
    return (
        "\ndef shapes(motion: Motion) -> list[dict[str, float]]:\n"
        '    """The shapes that are tried on a motion; a fit goes on from the best of them."""\n'
        f"    return [{{{grid}}}]\n\n"
    )


def _fitted(*names: str) -> str:
    listed = ", ".join(f'"{name}"' for name in names) + ("," if len(names) == 1 else "")
    return f"shapes=shapes,\n# Moved by the fit, not only tried.\nfitted_shapes=({listed}),\n"


def _meant(order: float) -> float:
    """The whole number that an order is close to, or the order."""
    return float(round(order)) if abs(order - round(order)) < _WHOLE else order


def _wave(order: float) -> tuple[str, str, str, str, str]:
    """Constant, parameters, first lines, factor and declarations of a wave over the turn; order 0 is none."""
    order = _meant(order)
    if order == 0.0:
        return "", "", "", "", ""
    first = 'phase_rad: Array = np.radians(values["phase_deg"])\n'
    if order.is_integer():
        constant = f'ORDER = {_number(order)}\n"""Periods in a turn of the shaft: teeth, poles, balls, steps."""\n'
        return constant, _PHASE, first, " * np.sin(ORDER * motion.shaft_rad + phase_rad)", ""
    constant = (
        f'ORDER = {_number(order)}\n"""Periods in a turn of the shaft, as found; the fit sets out from here."""\n'
    )
    reach = 0.1 * abs(order)
    param = _param(
        "order",
        "periods in a turn",
        unit="1/turn",
        null=order,
        low=_near(order - reach),
        high=_near(order + reach),
        more=', role="shape"',
    )
    first += 'order: Array = np.asarray(values["order"])\n'
    return constant, _PHASE + param, first, " * np.sin(order * motion.shaft_rad + phase_rad)", _fitted("order")


def _waves(
    structure: Mapping[str, Any],
    *,
    factor: str,
    words: str,
    needs: tuple[str, ...],
    constants: str = "",
    amplitude: Callable[[bool], str] = _amplitude,
    first: str = _AMPLITUDE_RAD,
) -> Parts:
    """A wave of the structure's order times a factor of the conditions; ``first`` begins the body."""
    order = float(structure.get("order", 0.0))
    constant, params, lines, wave, declared = _wave(order)
    needs = (*needs, "one turn") if wave else needs
    return Parts(
        constants="\n".join(part for part in (constants, constant) if part),
        params=amplitude(not wave) + params,
        body=first + lines + f"return signal + amplitude_rad{factor}{wave}",
        needs=needs,
        signature=f"order {_number(_meant(order)).removesuffix('.0')}{words}",
        functions=_shapes(("order", "ORDER")) if declared else "",
        declared=declared,
    )


# ---- kinds ------------------------------------------------------------------------------------------------------


def _order(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    return _waves(structure, factor="", words="", needs=())


def _direction(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    return _waves(structure, factor=" * motion.direction", words=" times the direction", needs=("both directions",))


def _temperature(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    return _waves(
        structure,
        factor=" * (motion.temperature_c - NEUTRAL_C)",
        words=" times the temperature",
        needs=("temperature_c", "two temperatures"),
        constants='NEUTRAL_C = 25.0\n"""Temperature at which there is none of it."""\n',
        amplitude=_amplitude_per_kelvin,
        first='amplitude_rad: Array = np.radians(values["deg_per_K"])\n',
    )


def _speed(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    fastest = max([abs(float(rpm)) for rpm in sweep.get("speed_rpm", [])], default=0.0) or _RPM
    power = {-1.0: " * np.abs(pace)", 2.0: " * pace * np.abs(pace)", -2.0: " * pace**2"}
    chosen = power.get(float(structure.get("power", 1.0)), " * pace")
    return _waves(
        structure,
        factor=chosen,
        words=" times the speed" if chosen == " * pace" else f",{chosen.removeprefix(' *')} of the speed",
        needs=("moving shaft", "two speeds"),
        constants=f'FAST_RPM = {_number(fastest)}\n"""Speed at which the amplitude is given."""\n',
        first=f"{_AMPLITUDE_RAD}pace = motion.speed_rad_s * 60.0 / (2.0 * np.pi * FAST_RPM)\n",
    )


def _creep(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    constant, at = (
        float(structure.get(name, default)) for name, default in (("time_constant_s", 10.0), ("at_s", 100.0))
    )
    return _waves(
        {**structure, "order": 1.0},
        factor=" * grown",
        words=" that creeps in time",
        needs=("time_s",),
        constants=f'TIME_CONSTANT_S = {_number(constant)}\n"""In which it settles, as found."""\n'
        f'AT_S = {_number(at)}\n"""Time from the first reading at which the amplitude is given."""\n',
        first=f"{_AMPLITUDE_RAD}elapsed_s = motion.time_s - motion.time_s[:1]\n"
        "grown: Array = np.expm1(-elapsed_s / TIME_CONSTANT_S) / np.expm1(-AT_S / TIME_CONSTANT_S)\n",
    )


def _tone(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    hertz = float(structure.get("frequency_Hz", 50.0))
    return Parts(
        constants=f'FREQUENCY_HZ = {_number(hertz)}\n"""As found; the search tries 2 % to either side."""\n\n',
        params=_amplitude(False)
        + _PHASE
        + _param(
            "frequency_Hz",
            "frequency",
            unit="Hz",
            null=hertz,
            low=_near(0.9 * hertz),
            high=_near(1.1 * hertz),
            more=', role="shape"',
        ),
        body=_AMPLITUDE_RAD
        + 'phase_rad: Array = np.radians(values["phase_deg"])\n'
        + 'frequency_hz: Array = np.asarray(values["frequency_Hz"])\n'
        + "# Counted from the middle of the record, where a fit knows the phase best.\n"
        + "elapsed_s = motion.time_s - 0.5 * (motion.time_s[0] + motion.time_s[-1])\n"
        + "wave: Array = np.cos(2.0 * np.pi * frequency_hz * elapsed_s + phase_rad)\n"
        + "return signal + amplitude_rad * wave",
        needs=("time_s", "moving shaft"),
        signature=f"{_number(hertz)} Hz in time",
        functions=(
            "\ndef shapes(motion: Motion) -> list[dict[str, float]]:\n"
            '    """Frequencies 2 % to either side, a quarter of the record\'s resolution apart."""\n'
            "    step_hz = 0.25 / max(float(np.ptp(motion.time_s)), 1e-6)\n"
            "    count = min(int(0.02 * FREQUENCY_HZ / step_hz) + 1, 500)\n"
            "    shares = np.linspace(-0.02, 0.02, 2 * count + 1)\n"
            '    return [{"frequency_Hz": FREQUENCY_HZ * (1.0 + float(share))} for share in shares]\n\n'
        ),
        declared=_fitted("frequency_Hz") + _RECORD_WIDE,
    )


def _drift(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    modes = {int(n[4:-4]): abs(float(v)) for n, v in structure.items() if n.startswith("mode") and n[4:-4].isdigit()}
    strongest = max(modes, key=lambda k: modes[k], default=1)
    return Parts(
        constants=f'HALF_WAVES = {_number(strongest)}\n"""Half waves in the time of the record, as found."""\n\n',
        params=_param("amplitude_deg", "amplitude", low=-20.0, high=20.0),
        body=_AMPLITUDE_RAD
        + "elapsed_s = motion.time_s - motion.time_s[0]\n"
        + "share = elapsed_s / max(float(np.ptp(motion.time_s)), 1e-9)\n"
        + "wave: Array = np.cos(np.pi * HALF_WAVES * share)\n"
        + "return signal + amplitude_rad * wave",
        needs=("time_s",),
        signature="a slow movement of the zero",
        declared=_RECORD_WIDE,
    )


def _local(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    centre, width = float(structure.get("centre_deg", 90.0)), float(structure.get("width_deg", 10.0))
    return Parts(
        constants=f"CENTRE_DEG = {_number(centre)}\nWIDTH_DEG = {_number(width)}\n"
        '"""Place on the shaft and width (sigma), as found; the fit sets out from here."""\n\n',
        params=_param("height_deg", "height", low=-20.0, high=20.0)
        + _param(
            "centre_deg",
            "place on the shaft",
            null=centre,
            low=_near(centre - 30.0),
            high=_near(centre + 30.0),
            more=_SHAPE,
        )
        + _param("width_deg", "its sigma", null=width, low=_near(0.2 * width), high=_near(3.0 * width), more=_SHAPE),
        body='height_rad: Array = np.radians(values["height_deg"])\n'
        'centre_rad: Array = np.radians(values["centre_deg"])\n'
        'width_rad: Array = np.radians(values["width_deg"])\n'
        "away_rad = (motion.shaft_rad - centre_rad + np.pi) % (2.0 * np.pi) - np.pi\n"
        "return signal + height_rad * np.exp(-0.5 * (away_rad / width_rad) ** 2)",
        needs=("one turn",),
        signature=f"a bump at {_number(centre)} deg of the shaft",
        functions=_shapes(("centre_deg", "CENTRE_DEG"), ("width_deg", "WIDTH_DEG")),
        declared=_fitted("centre_deg", "width_deg"),
    )


_SHAPE = ', role="shape"'
_RECORD_WIDE = "# A reading depends on the length of the record: no node on a bus can play it.\nrecord_wide=True,\n"


def _noise(structure: Mapping[str, Any], sweep: Mapping[str, Any]) -> Parts:
    return Parts(
        constants="",
        params=_param("rms_deg", "RMS where it is largest", low=0.0, high=20.0, more=', role="random"'),
        body="if rng is None:\n"
        "    # Without a generator the expected signal is asked for: noise leaves it as it is.\n"
        "    return signal\n"
        "sigma_rad = np.sqrt(spread(motion.shaft_rad, values))\n"
        "return signal + sigma_rad * rng.standard_normal(signal.shape)",
        needs=("one turn",),
        signature="noise that is larger at some angles",
        functions=(
            "\ndef spread(angle_rad: Array, values: Parameters) -> Array:\n"
            '    """Variance [rad^2] of the readings at these angles (n,) of the field in the sensor\'s axes.\n\n'
            "    The search finds a spread by its pattern over the angle; here it is largest along x.\n"
            '    """\n'
            '    rms_rad: Array = np.radians(values["rms_deg"])\n'
            "    return np.asarray((rms_rad * np.cos(angle_rad)) ** 2)\n\n"
        ),
        declared='footprint="spread",\nspread=spread,\n',
    )


KINDS: Mapping[str, Callable[[Mapping[str, Any], Mapping[str, Any]], Parts]] = {
    "order": _order,
    "direction": _direction,
    "temperature": _temperature,
    "speed": _speed,
    "time_frequency": _tone,
    "drift": _drift,
    "creep": _creep,
    "local": _local,
    "noise": _noise,
}
"""Kind of structure in the answer -> what its skeleton holds; any other kind begins as a line over the angle."""
