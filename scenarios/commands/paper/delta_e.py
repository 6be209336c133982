"""Delta E (Eq. 7), term by term: of the drawn cases and of each preset."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.error_model.error_band import band_terms_rad
from scenarios.commands.paper.table_2 import NOISE_DEG
from twin.adc.adc_quantisation import ADC_QUANTISATION
from twin.chain import Chain
from twin.hall.noise import NOISE
from twin.presets import preset_names, read_preset

DRAWN = "drawn cases"


def terms_deg(chain: Chain) -> dict[str, float]:
    """The terms [deg] by name."""
    return {name: float(np.degrees(size)) for name, size in band_terms_rad(chain).items()}


def drawn_chain() -> Chain:
    """What a drawn case holds beside its factors: a converter of 14 bits and the noise."""
    return Chain().with_effect(ADC_QUANTISATION.name, bits=14).with_effect(NOISE.name, rms_deg=NOISE_DEG)


def all_terms_deg() -> dict[str, dict[str, float]]:
    """The terms of the drawn cases and of every preset, by name."""
    return {DRAWN: terms_deg(drawn_chain()), **{name: terms_deg(read_preset(name)) for name in preset_names()}}


def line() -> str:
    """Delta E of the drawn cases in words."""
    terms = terms_deg(drawn_chain())
    added = " + ".join(f"{name} {size:.4f}" for name, size in terms.items() if size)
    return f"Eq. 7      Delta E of the drawn cases: {added} = {sum(terms.values()):.4f} deg; the paper prints no figure"


def figure(plt: Any) -> tuple[Any, str]:
    """Delta E as bars of its terms, one a twin, and the same as CSV."""
    found = all_terms_deg()
    names = list(found[DRAWN])
    figure, axis = plt.subplots(figsize=(8.0, 0.6 * len(found) + 1.6), layout="constrained")
    left = np.zeros(len(found))
    for name in names:
        width = np.array([terms[name] for terms in found.values()])
        if width.any():
            axis.barh(list(found), width, left=left, label=name)
        left += width
    for row, total in enumerate(left):
        axis.annotate(f"{total:.3f} deg", (total, row), xytext=(4, 0), textcoords="offset points", va="center", size=8)
    axis.set(xlabel="Delta E [deg]", ylabel="twin [name]", xlim=(0.0, 1.15 * float(left.max())))
    axis.invert_yaxis()
    axis.grid(alpha=0.3, axis="x")
    axis.legend(fontsize=8, title="term of Eq. 7", title_fontsize=8)
    lines = [",".join(["twin", *(f"{name}_deg" for name in names), "delta_e_deg"])]
    lines += [
        ",".join([f'"{twin}"', *(f"{size:.6g}" for size in terms.values()), f"{sum(terms.values()):.6g}"])
        for twin, terms in found.items()
    ]
    return figure, "\n".join(lines) + "\n"
