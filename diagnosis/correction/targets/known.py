"""Which tables can be written, by the name that asks for them; and for which drives there is none, and why."""

from __future__ import annotations

from diagnosis.correction.targets import autosar, c_table, klipper, lut, magalpha, mechaduino, moteus, simplefoc
from diagnosis.correction.targets.target import Target
from twin.errors import UserError
from twin.known_names import nearest
from twin.shown import shown

TARGETS: tuple[Target, ...] = (
    simplefoc.TARGET,
    moteus.TARGET,
    moteus.OF_FLOATS,
    klipper.TARGET,
    mechaduino.TARGET,
    magalpha.TARGET,
    c_table.TARGET,
    autosar.TARGET,
    lut.TARGET,
)
"""Of several with one name the first is made where no number of entries is asked for."""
NONE_TAKEN = {
    "odrive": "ODrive takes no table: its public firmware (0.5) corrects an offset alone, and firmware 0.6 measures "
    "orders 1 and 2 itself (harmonic compensation), in coefficients whose sign is not published; put --for c into a "
    "firmware of your own, or between sensor and drive",
    "vesc": "VESC takes no table: its public firmware (6.05) corrects offset, amplitude and phase of a sine-cosine "
    "encoder alone, which halltwin diagnose tells; include --for c in a native library that sets a custom encoder",
}
"""Drives whose firmware has no table of angle corrections: what it has, and what to do."""


def target_of(asked: str) -> tuple[Target, int]:
    """The target of a text such as ``klipper:200``, and the number of entries. Raises UserError."""
    name, colon, count = asked.partition(":")
    if name in NONE_TAKEN:
        raise UserError(f"--for {name}: {NONE_TAKEN[name]}")
    known = [target for target in TARGETS if target.name == name]
    if not known:
        names = list(dict.fromkeys(target.name for target in TARGETS))
        raise UserError(f"--for is {shown(asked)}{nearest(name, names)}; expected among {', '.join(names)}")
    if not colon:
        return known[0], known[0].entries
    number = int(count) if count.isascii() and count.isdigit() and len(count) < 10 else 0
    for target in known:
        if number in target.sizes:
            return target, number
    sizes = " or ".join(_words(target.sizes) for target in known)
    raise UserError(f"--for is {shown(asked)}; expected {name}:N with N {sizes}")


def _words(sizes: range) -> str:
    """Which numbers of entries there are."""
    if len(sizes) == 1:
        return str(sizes[0])
    steps = "" if sizes.step == 1 else f" in steps of {sizes.step}"
    return f"from {sizes[0]} to {sizes[-1]}{steps}"
