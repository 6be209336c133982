"""What an answer states, in words: the sentences and lists that terminal, report and notebook have in common.

Each takes the answer (the content of the JSON) and nothing else, so that all three say what it says.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from diagnosis.discovery.proof.misfit import LACK_OF_FIT, LIKENESS
from diagnosis.discovery.result import REPEATED
from diagnosis.discovery.settings import UNLIKE
from diagnosis.report.change_words import other_device_words
from diagnosis.report.factor_names import LABELS, SCALES, UNITS
from diagnosis.report.recordings import contradictions
from diagnosis.report.row_counts import rows_listed
from diagnosis.report.word_fault_words import as_sent_words, instance_line
from diagnosis.report.wording import (
    around,
    figure,
    instances,
    listed,
    plain,
    structure_words,
    with_unit,
)

_LACKS = {
    "a reference": ("no reference", "record a reference encoder beside it"),
    "a reference|two speeds|vx": ("one speed, no reference", "measure at a second speed, or record vx and vy"),
    "a reference|three speeds|vx": ("two speeds, no reference", "let the shaft coast down"),
    "both directions": ("one direction", "turn in both directions"),
    "moving shaft": ("at rest at each reading, or no speed_rpm", "record speed_rpm while the shaft moves, with time_s"),
    "one turn": ("less than a turn", "cover a whole turn"),
    "several turns": ("less than two turns one way", "record several turns one way"),
    "temperature_c": ("no temperature_c", "record temperature_c"),
    "time_s": ("no time_s", "record time_s"),
    "turn": ("no turn column", "number the sweeps in a turn column"),
    "two currents": ("no current_a that changes", "record current_a at several currents"),
    "two currents|a reference": ("no reference and no current_a", "record current_a at several currents"),
    "two currents|moving shaft": ("at rest at each reading and no current_a", "record current_a, or speed_rpm"),
    "two currents|two speeds|both directions": ("one speed one way, no current", "record current_a, or turn both ways"),
    "two air gaps": ("one air gap", "measure at a second air gap"),
    "two speeds": ("one speed", "measure at a second speed"),
    "two speeds|both directions": ("one speed, one direction", "measure at a second speed or in both directions"),
    "two temperatures": ("one temperature", "measure at a second temperature"),
    "two turns": ("one turn in the turn column", "record several turns"),
    "varying speed|two currents": ("no change of speed or current", "record current_a, or speed_rpm as it changes"),
    "vx": ("no vx, vy", "record vx and vy"),
    "whole counts": ("a reference without steps, or uneven readings", "take readings at even steps"),
    "two mountings": ("one mounting", "turn the sensor about the shaft and explain both recordings together"),
    "vx|two air gaps": ("no vx, vy", "record vx and vy, or explain recordings at two air gaps together"),
    "vx|two mountings": (
        "no vx, vy",
        "record vx and vy, or turn the sensor about the shaft and explain both recordings together",
    ),
    "vx|two mountings|two air gaps": (
        "no vx, vy",
        "record vx and vy, or explain recordings of two mountings or air gaps together",
    ),
}
"""What a sweep lacks for a cause to be visible: in words, and what to do about it."""

_ALSO_SAYS = {
    "two temperatures": "temperature_c",
    "two turns": "turn",
    "two speeds|both directions": "moving shaft",
    "a reference|three speeds|vx": "two speeds|both directions",
    "two currents|two speeds|both directions": "two currents|moving shaft",
}
"""A want that goes without saying where the second one is wanted too."""
_UNEXPLAINED = "Structure is there that no cause of the catalogue explains"
UNCHANGED = (
    "Beside zero and noise, which each sweep has of its own, nothing of the given twin has changed beyond chance"
)
NOT_CHANGED = "All else of the given twin has not changed beyond chance"
OTHERS_HELD = f"{NOT_CHANGED}, and stays as it was"
FITTED_ANEW = f"{NOT_CHANGED}; it was fitted anew, as the twin had hardly told some of it from the rest"
_MOST_DIGITS = 7


# ---- the baseline -----------------------------------------------------------------------------------------------


def baseline_words(answer: Mapping[str, Any]) -> str:
    """What the baseline makes of the error, over the readings that it was fitted to."""
    baseline, sweep = answer["baseline"], answer["sweep"]
    model = "The given twin" if sweep.get("held_against") == "given twin" else "The paper's error model"
    before, after = baseline["fitted_error_rms_deg"], baseline["fitted_rms_deg"]
    sent, decoded = as_sent_words(baseline)
    aside = sweep["used"] - sweep["fitted"]
    over = f", over the {sweep['fitted']} readings that were fitted" if aside else ""
    steps = f"{plain(before)} -> {plain(after)} deg RMS{over}"
    share = baseline["explained_percent"]
    if share is None:
        return f"{model} leaves {plain(after)} deg RMS{over}{sent}"
    if share < 0.0:
        return f"{model} makes the error larger: {steps}{sent}"
    return f"{model}: error{decoded} {steps}; {percent_shown(share)} % of its mean square explained{sent}"


def percent_shown(share: float) -> str:
    """A share in whole percent; near the whole, or near nothing, with the digits that tell it from that."""
    for decimals in (0, 1, 2):
        text = f"{share:.{decimals}f}"
        if 0.0 < float(text) < 100.0 or share in (0.0, 100.0):
            return text
    return "> 99.99" if share > 50.0 else "< 0.01"


def floor_words(answer: Mapping[str, Any]) -> str:
    """The noise floor where readings are repeated; else that it is not known, and what is left on held-out readings."""
    floor = answer["noise_floor_deg"]
    if floor is None:
        return "noise floor not known"
    if floor_is_known(answer):
        return f"noise floor {plain(floor)} deg RMS, the scatter of readings repeated at one angle"
    return (
        "noise floor not known, as no angle was read several times in a row; "
        f"{plain(floor)} deg RMS is left on held-out readings"
    )


def floor_is_known(answer: Mapping[str, Any]) -> bool:
    """Whether repeated readings tell the noise floor."""
    return bool(answer["noise_floor_from"] == REPEATED)


class FactorRow(NamedTuple):
    """A factor of the paper's error model as people read it: before the causes, and where there are any, with them.

    ``flag`` says whether it stands at its bound, or elsewhere once the causes are known.
    """

    key: str
    label: str
    before: str
    after: str
    unit: str
    flag: str


def factor_rows(answer: Mapping[str, Any]) -> list[FactorRow]:
    """The paper's factors in order, without a reference but the zero; ``after`` is empty where no cause changes any."""
    before, after = (_values(answer[of]["parameters"]) for of in ("baseline", "extended"))
    # What touches single readings or their scatter alone leaves every factor as it is.
    changed = extends(answer) and before != after
    keys = [key for key in LABELS if key != "zero_deg" or "motion" not in answer]
    return [
        FactorRow(key, LABELS[key], before[key], after[key] if changed else "", UNITS[key], _flag(answer, key))
        for key in keys
    ]


def _values(parameters: Mapping[str, Any]) -> dict[str, str]:
    return {key: with_unit(parameters[key], UNITS[key], SCALES[key]) for key in LABELS}


def _flag(answer: Mapping[str, Any], key: str) -> str:
    """What else is to be said of a factor."""
    last = answer["extended"] if extends(answer) else answer["baseline"]
    if held_fixed(answer) and last["parameters"][key]["low"] == last["parameters"][key]["high"]:
        return "held"
    if last["parameters"][key]["at_bound"]:
        return "at its bound"
    return "moved" if extends(answer) and key in answer["extended"]["moved"] else ""


def extends(answer: Mapping[str, Any]) -> bool:
    """Whether the extended twin is another than the one before: by a cause, or by what has changed of a given one."""
    return bool(answer["causes"] or answer["changed"] or answer["fitted_anew"])


def after_head(answer: Mapping[str, Any]) -> str:
    """What stands above the factors of the extended twin."""
    return "with the causes" if answer["causes"] else "in this sweep"


def moved_words(answer: Mapping[str, Any]) -> str:
    """Which factors stand elsewhere once the causes are known; of a given twin, that the others were held."""
    if held_fixed(answer):
        if answer["fitted_anew"]:
            return FITTED_ANEW
        return OTHERS_HELD if answer["changed"] else UNCHANGED
    if not answer["causes"]:
        return ""
    names = [LABELS[key] for key in answer["extended"]["moved"]]
    if not names and answer["extended"]["parameters"] == answer["baseline"]["parameters"]:
        return ""
    if not names:
        return "With the causes known, every factor stays within its interval"
    return (
        f"With the causes known, {listed(names)} {'lies' if len(names) == 1 else 'lie'} outside of the interval before"
    )


_MIRRORED = ("Vy_over_Ay", "beta_deg", "zero_deg")
"""What has another sign in the mirrored twin of one recording."""


def senses_words(answer: Mapping[str, Any]) -> str:
    """Which senses sensor and output count in, where signs hang on it, or that they may as well count the other way."""
    senses = answer.get("senses")
    if senses is None:
        return ""
    if senses["decided"] or not senses["mirrored"]:
        return _signs_words(senses, zero="motion" not in answer) if senses["sensor"] < 0 else ""
    mirrored = senses["mirrored"]
    parameters = (answer["extended"] if answer["causes"] else answer["baseline"])["parameters"]
    there = []
    for key in LABELS:
        if key == "zero_deg" and "motion" in answer:
            continue  # Without a reference there is none.
        # A sensor that was turned between recordings is another one in the mirror, not the same with other signs.
        if key not in _MIRRORED and _within(mirrored[key], parameters[key]):
            continue
        # As many digits as the interval of the one that is shown.
        text, _ = figure({**parameters[key], **around(parameters[key], mirrored[key])}, SCALES[key])
        there.append(f"{LABELS[key]} {text} {UNITS[key]}")
    pair = f"s = {-senses['sensor']:+d}, h = {-senses['output']:+d}"
    return f"The mirrored twin ({pair}) fits as well, with {listed(there)}"


def _within(value: float, parameter: Mapping[str, Any]) -> bool:
    """Whether a value lies in a parameter's interval, which may have no end."""
    low, high = parameter["low"], parameter["high"]
    return (low is None or low <= value) and (high is None or value <= high)


def _signs_words(senses: Mapping[str, Any], *, zero: bool) -> str:
    """Whose signs those of offset y and phase are, and of a zero that is told."""
    pair, other = (f"s = {k * senses['sensor']:+d}, h = {k * senses['output']:+d}" for k in (1, -1))
    which = "Offset y, phase and zero" if zero else "Offset y and phase"
    formula = ", in which the reading is h (s x shaft + zero) and an error" if zero else ""
    return f"{which} are those of {pair}{formula}; the same sensor counted with {other} has them with the opposite sign"


def sentence(words: str) -> str:
    """Words as a sentence that ends in a full stop; nothing where there are none."""
    return f"{words[:1].upper()}{words[1:]}." if words else ""


# ---- the causes -------------------------------------------------------------------------------------------------


def held_words(cause: Mapping[str, Any]) -> str:
    """The held-out RMS before and after a cause."""
    before, after = cause["heldout_rms_deg_before"], cause["heldout_rms_deg_after"]
    if before is None or after is None:
        return "not held out"
    # As many digits as show that there is a gain.
    digits = next((n for n in range(3, _MOST_DIGITS) if plain(before, n) != plain(after, n)), 3)
    return f"{plain(before, digits)} -> {plain(after, digits)}"


def parameter_lines(answer: Mapping[str, Any], cause: Mapping[str, Any]) -> list[str]:
    """A cause's parameters, one line an instance; structure without a name in words."""
    if cause["name"] == "unnamed":
        return structure_lines(answer)
    return [line for one in instances(cause["parameters"]) if (line := instance_line(cause["name"], one))]


def structure_lines(answer: Mapping[str, Any]) -> list[str]:
    """Structure without a name in words, part by part."""
    return [structure_words(structure) for structure in answer["unexplained"]["structure"]]


def held_fixed(answer: Mapping[str, Any]) -> bool:
    """Whether the factors are those of a given twin, which only the zero and what has changed may leave."""
    return bool(answer["sweep"].get("held_against") == "given twin")


def single_rows_words(cause: Mapping[str, Any], most: int = 8) -> str:
    """Which single readings a cause has touched and how far off they are; empty for other causes."""
    size = cause.get("rows_rms_deg")
    rows = cause.get("rows", [])
    off = "" if size is None else f"off by {plain(size)} deg RMS, which no held-out figure counts"
    if not rows:
        return f"the readings that it touched are {off}" if off else ""
    listed = rows_listed(rows, len(rows), most)
    return f"{listed}: {off}" if off else listed


# ---- the verdict ------------------------------------------------------------------------------------------------


def verdict_words(answer: Mapping[str, Any]) -> str:
    """The verdict and what follows from it, in one or two sentences."""
    like = "; ".join(filter(None, (lack_words(answer), likeness_words(answer))))
    names = {cause["name"] for cause in answer["causes"]}
    rest = " Part of that is structure without a name." if len(names) > 1 and "unnamed" in names else ""
    said = f"{_gain_words(answer)}{f'; {like}' if like else ''}.{rest}{_stated_words(answer)}{cut_words(answer)}"
    return f"{other_device_words(answer)}{said}"


def _stated_words(answer: Mapping[str, Any]) -> str:
    """That what was stated of the sensor's turn does not agree with the zeros; empty where it does."""
    names = contradictions(answer)
    return f" The turn stated of {listed(names)} does not agree with the zero found there." if names else ""


def cut_words(answer: Mapping[str, Any]) -> str:
    """That the search was stopped, and what that leaves open; empty where it came to its own end."""
    cut = answer.get("cut_short")
    if not cut:
        return ""
    if cut["by"] == "budget":
        spent = "The search ended as its budget of computing time was spent (--budget, budget_s)"
        return f" {spent}, which leaves open {cut['left_open']}."
    return f" The search was stopped before its end, which leaves open {cut['left_open']}."


def lack_words(answer: Mapping[str, Any]) -> str:
    """How what the fit leaves compares with the scatter of repeated readings; empty where none were repeated."""
    lack = answer.get("lack_of_fit")
    if lack is None:
        return ""
    p = answer["lack_of_fit_p"]
    figures = f"F = {plain(lack['f_ratio'], 2)}, {'p < 1e-6' if p < 1e-6 else f'p = {plain(p, 2)}'}"
    if p >= UNLIKE:
        return f"repeated readings leave no lack of fit ({figures})"
    return (
        f"it lies off the means of repeated readings by {plain(lack['left_deg'])} deg RMS, where their scatter makes "
        f"{plain(lack['by_scatter_deg'])} ({figures}{_where(answer, LACK_OF_FIT)})"
    )


def _where(answer: Mapping[str, Any], against: str) -> str:
    """Where a check's misfit lies and how large it is there; empty where it found none."""
    for one in answer.get("misfits", ()):
        if one["against"] == against:
            return "".join(f"; {said}" for said in (one["where"],) if said) + f", {plain(one['size_deg'])} deg"
    return ""


def likeness_words(answer: Mapping[str, Any]) -> str:
    """Whether sweeps simulated from the extended twin match the measured one, or why that was not checked."""
    extended = answer["extended"]
    p = extended.get("likeness_p")
    if p is None:
        why = extended["likeness_not_checked"]
        if why is None:
            return ""
        few = "" if why["needed"] is None else f": {why['readings']} independent readings, {why['needed']} are needed"
        return f"whether simulated sweeps match was not checked ({why['why']}{few})"
    if p < UNLIKE:
        return f"simulated sweeps do not match (p < {UNLIKE:g}: {extended['likeness_worst']}{_where(answer, LIKENESS)})"
    return f"simulated sweeps match (p = {plain(p, 2)})"


def _gain_words(answer: Mapping[str, Any]) -> str:
    if answer["verdict"] == "adequate":
        return "The baseline is adequate: nothing else stands out of the noise"
    if not extends(answer):
        return "No cause was found" if answer["verdict"] == "stopped" else _UNEXPLAINED
    closer = closer_words(answer)
    if answer["verdict"] == "unnamed":
        return f"{_UNEXPLAINED}. {closer}"
    return closer


def closer_words(answer: Mapping[str, Any]) -> str:
    """How much closer the extended twin is, or why that is no figure."""
    steps = (*answer["changed"], *answer["causes"])
    if steps and all(step["heldout_rms_deg_before"] == step["heldout_rms_deg_after"] for step in steps):
        # Single readings and scatter are no part of what a twin predicts for the mean.
        return "It lies in single readings or in their scatter, so that their mean is predicted no better"
    gain = answer["extended"]["gain"]
    if gain is None:
        return "Too few readings to hold any out: how much closer the extended twin is cannot be told"
    if gain < 1.0:
        return "The extended twin is no closer on readings it never saw"
    return f"The extended twin is {plain(gain, 2 if gain >= 1.1 else 3)} times closer on readings it never saw"


# ---- what the sweep cannot show ---------------------------------------------------------------------------------


def invisible_words(answer: Mapping[str, Any]) -> str:
    """Causes that were not searched for, and what the sweep lacks for each; empty where there are none."""
    return "; ".join(f"{', '.join(names)} ({lacks})" for names, lacks, _ in not_visible(answer["not_visible"]))


def recordings_shown(answer: Mapping[str, Any]) -> str:
    """What was measured, as causes are not visible in it."""
    return "these recordings" if answer.get("recordings") else "this sweep"


def not_visible(missing: Mapping[str, Iterable[str]]) -> list[tuple[list[str], str, str]]:
    """Causes that a sweep cannot show, grouped: (names, what is missing, what to do); the largest group first."""
    groups: dict[str, tuple[list[str], str]] = {}
    for name, needs in missing.items():
        wanted = set(needs)
        told = sorted(need for need in wanted if _ALSO_SAYS.get(need) not in wanted)
        lacks = "; ".join(_LACKS.get(need, (f"no {need}", ""))[0] for need in told)
        todo = "; ".join(_LACKS.get(need, ("", f"provide {need}"))[1] for need in told)
        groups.setdefault(lacks, ([], todo))[0].append(name)
    ranked = sorted(groups.items(), key=lambda item: (-len(item[1][0]), item[1][0]))
    return [(names, lacks, todo) for lacks, (names, todo) in ranked]
