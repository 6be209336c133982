"""What several air gaps tell, in words: causes by name, classes that are not told apart, or a misfit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.factors.air_gaps import AirGaps
from diagnosis.factors.displacement import Displacement, sensor_displacement, sensor_tilt, upright_product
from diagnosis.factors.gap_fit import GapFit
from diagnosis.factors.gap_model import ROWS
from diagnosis.factors.gap_sets import ON_AXIS
from diagnosis.factors.mounting import HELD_WORDS, Mounting
from twin.baseline import FACTORS
from twin.confidence import Z95

_MOST_PLACES = 3
_CLEAR_SIGMA = 3.0
_ALTERNATIVES = {
    "voltage": "a constant voltage or stray field",
    "reference": "an eccentric reference",
    "magnet": "a magnet off the shaft",
    "magnet_tilt": "a tilted magnet",
    "tilt_and_magnet": "a sensor tilted on the axis, before a magnet off the shaft",
    "both_tilts": "a sensor tilted on the axis, before a tilted magnet",
}


def magnet_words(mounting: Mounting) -> str:
    """The magnet, and whether somebody has named it."""
    return f"{mounting.body}{' (assumed: name yours by --twin or --magnet)' if mounting.assumed else ''}"


def sentences(found: AirGaps) -> tuple[str, ...]:
    """The answer of several air gaps."""
    gaps = ", ".join(f"{gap:.2f}" for gap in found.told.gap_mm)
    stated = ", ".join(f"{gap:.2f}" for gap in found.mounting.air_gap_mm)
    given = f" (stated {stated} mm)" if len(found.mounting.air_gap_mm) == len(found.names) else ""
    said = [f"air gaps: fitted {gaps} mm{given} before {magnet_words(found.mounting)}"]
    if found.amplitudes_held:
        said.append(f"air gaps: {HELD_WORDS}: they gauge no gap, and the stated ones are taken")
    if found.misfit:
        return (*said, *_misfit(found))
    return (*said, *_order_2(found), *_order_1(found), *_magnet(found), _quadratic(found))


def _misfit(found: AirGaps) -> Iterator[str]:
    """By how much nothing fits, and where; or that what fits has a number for each reading and would fit anything."""
    if not found.holds:
        fit = found.fullest
        yield (
            "air gaps: neither the electronics nor displacements and tilts of sensor and magnet explain how offset, "
            f"gain ratio and phase go over the gaps: {_goodness(fit)}; no cause is named"
        )
    else:
        fit = found.simpler
        yield (
            "air gaps: simpler causes do not explain how offset, gain ratio and phase go over "
            f"{len(found.names)} gaps ({_goodness(fit)}), and for more causes no gap is left to check them by; no "
            "cause is named: one more gap would tell"
        )
    yield _where(fit, found.names, found.mounting)


def _goodness(fit: GapFit) -> str:
    return f"chi^2 = {fit.chi2:.0f} at {fit.degrees_of_freedom} degrees of freedom (p = {fit.p:.1g})"


def _where(fit: GapFit, names: tuple[str, ...], mounting: Mounting) -> str:
    """Which factors lie farthest off, and which gaps had to give way."""
    places = [_place(fit, names, *place) for place in farthest(fit)]
    moved = [
        f"{name}, at {gap:.2f} mm instead of {stated:.2f} mm"
        for name, gap, stated in zip(names, fit.gap_mm, mounting.air_gap_mm, strict=False)
        if abs(gap - stated) > _CLEAR_SIGMA * mounting.gap_error_mm
    ]
    said = [f"farthest off are {'; '.join(places)}"] if places else []
    said += [f"the causes would rather have {'; '.join(moved)}"] if moved else []
    return f"air gaps: {'; '.join(said) or 'what does not fit are amplitudes and gaps'}"


def farthest(fit: GapFit) -> list[tuple[int, int]]:
    """Sweep and factor (place in ROWS) of what lies farthest from what is expected, the farthest first."""
    order = np.argsort(-np.abs(fit.misses), axis=None)[:_MOST_PLACES]
    places = zip(*np.unravel_index(order, fit.misses.shape), strict=True)
    return [(int(sweep), int(row)) for sweep, row in places if abs(fit.misses[sweep, row]) > _CLEAR_SIGMA]


def _place(fit: GapFit, names: tuple[str, ...], sweep: int, row: int) -> str:
    factor = FACTORS[ROWS[row]]
    size = f"{fit.differences[sweep, row] * factor.per_coordinate:+.2g} {factor.shown_unit}".rstrip()
    sigma = abs(fit.misses[sweep, row])
    return f"the {factor.label} of {names[sweep]} at {fit.gap_mm[sweep]:.2f} mm by {size} ({sigma:.0f} standard errors)"


def _order_2(found: AirGaps) -> Iterator[str]:
    """Gain ratio and phase."""
    if len(found.order_2) > 1:
        yield _tilted_or_not(found) if "sensor" in found.named else _either(found)
        return
    (causes,) = found.order_2
    if not causes:
        yield "air gaps: gain ratio and phase are compatible with none at every gap"
    if "electronics" in causes:
        yield _electronics(found)
    off = found.displaced("sensor")
    if off is not None:
        yield (
            "air gaps: gain ratio and phase follow this magnet's field off its axis: the sensor is "
            f"{_length(off)} off the shaft's axis, towards {_direction(off)} or opposite"
        )
    tilt = found.displaced("tilt")
    if tilt is not None:
        yield (
            f"air gaps: the sensor is tilted by {_angle(tilt)} too, its normal leaning towards {_direction(tilt)}, or "
            "opposite where the sensor is"
        )


def _electronics(found: AirGaps) -> str:
    """What keeps its share at every gap: the electronics, or a tilt of the sensor by so much."""
    part = "part of gain ratio and phase" if "sensor" in found.named else "gain ratio and phase"
    value, error = found.best.pair("electronics")
    tilt = found.tilt_alone
    other = (
        ""
        if tilt is None
        else f", or a sensor tilted by {_angle(tilt)} towards {_direction(tilt)} or opposite; mounting the sensor anew "
        "parts the two"
    )
    return (
        f"air gaps: {part} (gain ratio {1.0 + value.real:.5f}, phase {np.degrees(value.imag):+.3f} deg, "
        f"±{Z95 * error:.2g} and ±{np.degrees(Z95 * error):.2g} deg) keep their share: the electronics{other}"
    )


def _tilted_or_not(found: AirGaps) -> str:
    """A sensor off the axis, and beside it the electronics or a tilt."""
    ways = []
    for two in found.order_2:
        fit = found.best_with(two)
        off, tilt = sensor_displacement(fit), sensor_tilt(fit)
        assert off is not None
        ways.append(f"{_length(off)} with {'the electronics' if tilt is None else f'a tilt of {_angle(tilt)}'}")
    return (
        "air gaps: the sensor is off the shaft's axis, and not that alone: "
        f"{', or '.join(ways)}; these gaps cannot tell, {_further(found.parting_mm)} would"
    )


def _either(found: AirGaps) -> str:
    """Electronics or displacement, and what would part them."""
    off = sensor_displacement(found.best_with(("sensor",)))
    assert off is not None
    return (
        f"air gaps: gain ratio and phase are the electronics', or those of a sensor {_length(off)} off the axis: these "
        f"gaps cannot tell, {_further(found.parting_mm)} would"
    )


def _further(gap_mm: float | None) -> str:
    return "a wider range of gaps" if gap_mm is None else f"a sweep at {gap_mm:.2g} mm"


def _order_1(found: AirGaps) -> Iterator[str]:
    """The offsets."""
    if len(found.order_1) > 1:
        ways = "; or of ".join(_beside([_ALTERNATIVES[name] for name in one]) or "none" for one in found.order_1)
        which = "" if len(found.order_1) == 2 else " tell the first two apart"
        yield f"air gaps: the offsets are those of {ways}: these gaps cannot tell, {_parts_offsets(found)} would{which}"
        return
    (causes,) = found.order_1
    if not causes:
        yield "air gaps: the offsets are compatible with none at every gap"
    if "voltage" in causes:
        value, error = found.best.pair("voltage")
        yield (
            "air gaps: the offset falls with the field, as a constant voltage and a stray field of "
            f"{value.real:.3g}, {value.imag:.3g} mT (±{Z95 * error:.2g}) do: turning the housing in the stray field "
            "parts the two"
        )
    if "reference" in causes:
        size = float(np.degrees(abs(found.best.pair("reference")[0])))
        yield f"air gaps: {size:.3g} deg of order 1 keep their size at every gap: an eccentric reference"
    for cause in causes:
        if cause in ON_AXIS:
            yield _upright(found, cause)


def _beside(parts: Sequence[str]) -> str:
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else "".join(parts)


def _parts_offsets(found: AirGaps) -> str:
    """The measurement that parts the sets of causes of the offsets."""
    if found.order_1_parting_mm is None and any("reference" in one for one in found.order_1[:2]):
        return "setting the reference anew, turned on the shaft,"
    return _further(found.order_1_parting_mm)


def _upright(found: AirGaps, cause: str) -> str:
    """A sensor tilted on the axis, which senses the upright field of a magnet off the shaft or tilted."""
    product = upright_product(found.best, cause, magnet=found.mounting.magnet)
    assert product is not None
    displaced = product.unit == "mm deg"
    of_magnet, way = ("off the shaft", "displacement") if displaced else ("tilted", "tilt")
    return (
        f"air gaps: the offset follows the upright field of a magnet that is {of_magnet} along its magnetisation, "
        f"before a sensor tilted on the axis: the sensor's tilt times the magnet's {way} is {product.value:.3g} "
        f"{product.unit} ({product.low:.3g} .. {product.high:.3g}); sweeps with the sensor shifted on purpose tell "
        "each by itself"
    )


def _magnet(found: AirGaps) -> Iterator[str]:
    """The magnet, which shows in the offsets beside the sensor's displacement or tilt alone."""
    centre, lean = found.displaced("magnet"), found.displaced("magnet_tilt")
    if centre is not None:
        yield (
            f"air gaps: the magnet is {_length(centre)} off the shaft too, towards {_direction(centre)} where the "
            "field points along the sensor's x axis, or opposite where the sensor is"
        )
    if lean is not None:
        yield (
            f"air gaps: the magnet is tilted by {_angle(lean)}, its axis leaning towards {_direction(lean)} where the "
            "field points along the sensor's x axis, or opposite where the sensor is"
        )
    if centre is not None or lean is not None or len(found.order_1) > 1:
        return
    off_mm, tilted_deg = found.magnet_bound("magnet"), found.magnet_bound("magnet_tilt")
    if off_mm is not None and tilted_deg is not None:
        yield (
            f"air gaps: the magnet, were it upright, is off the shaft by less than {off_mm:.2g} mm, and were it "
            f"centred, tilted by less than {tilted_deg:.2g} deg (97.5 % each); beside each other the two may be larger"
        )
    elif "sensor" not in found.named and not set(ON_AXIS) & set(found.named):
        yield (
            "air gaps: a magnet off the shaft or tilted makes no error while the sensor is upright on the axis: sweeps "
            "with the sensor shifted on purpose, by half a millimetre, would show it"
        )


def _quadratic(found: AirGaps) -> str:
    law = found.quadratic
    if law.best == "none":
        return "air gaps: the quadratic term is compatible with none at every gap"
    if law.best == "none fits":
        return (
            f"air gaps: the quadratic term neither stays nor grows with the field: chi^2 = {law.chi2:.0f} at "
            f"{law.degrees_of_freedom} degrees of freedom (p = {law.p:.1g})"
        )
    return f"air gaps: the quadratic term {law.best}"


def _length(found: Displacement) -> str:
    return f"{found.value:.3f} mm ({found.low:.3f} .. {found.high:.3f})"


def _angle(found: Displacement) -> str:
    return f"{found.value:.2f} deg ({found.low:.2f} .. {found.high:.2f})"


def _direction(found: Displacement) -> str:
    return f"{found.direction_deg:.1f} ±{found.direction_half_deg:.1f} deg"
