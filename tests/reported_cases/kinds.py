"""Each kind of report: how a sweep of it is drawn, and whether an answer to it is right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.hidden.period_causes import MOTORS
from tests.reported_cases.bench import Array, Case, Sensor, a_turn, case, some_sensor, words
from tests.reported_cases.counted import coarse_reference, hand_turned, printed
from tests.reported_cases.driven import field_of_drag

Answer = Mapping[str, Any]
WORD = "output_quantisation"
"""Of a short word the rounding is there beside what happens to the word."""


@dataclass(frozen=True)
class Kind:
    """A kind of report: its draw, and the judgement of an answer (None: the sweep was refused) or a refusal."""

    draw: Callable[[np.random.Generator], Case]
    right: Callable[[Case, Answer], bool]
    refused: Callable[[str], bool] = lambda message: False


def _names(answer: Answer) -> list[set[str]]:
    return [{one["name"], *one["indistinguishable_from"]} for one in answer["causes"]]


def _values(answer: Answer, name: str, parameter: str) -> list[float]:
    """Values of a parameter of a cause, `parameter`, `parameter_2` and so on."""
    (cause,) = [one for one in answer["causes"] if one["name"] == name]
    told = cause["parameters"]
    keys = [parameter, *(f"{parameter}_{number}" for number in range(2, 99))]
    return [told[key]["value"] for key in keys if key in told]


def _alone(answer: Answer, name: str, *, beside: str = "") -> bool:
    """Whether it is the one cause named, but for one that is there as well."""
    return [one["name"] for one in answer["causes"] if one["name"] != beside] == [name]


def _nothing(drawn: Case, answer: Answer) -> bool:
    return not answer["causes"]


def _only(name: str, parameter: str, *, within: float, beside: str = "") -> Callable[[Case, Answer], bool]:
    """The cause alone, its parameter as near as this to the truth."""

    def right(drawn: Case, answer: Answer) -> bool:
        if not _alone(answer, name, beside=beside):
            return False
        return bool(abs(_values(answer, name, parameter)[0] - drawn.truth[parameter]) <= within)

    return right


def _clipped(sensor: Sensor, shaft: Array, level: float, rng: np.random.Generator, *, below: bool = True) -> Array:
    """The reading [deg] where both channels are cut at a share of their amplitude, on one side or both."""
    cut = np.clip(sensor.channels(np.radians(shaft)), -level if below else -np.inf, level)
    return sensor.angle_deg(cut, rng)


def clipping(rng: np.random.Generator) -> Case:
    shaft, level = a_turn(rng, points=int(rng.integers(50, 201))), rng.uniform(0.6, 0.9)
    reading = _clipped(some_sensor(rng, noise_deg=(0.02, 0.1)), shaft, level, rng)
    return case(shaft, reading, truth={"level_percent": 100.0 * level})


def square_wave(rng: np.random.Generator) -> Case:
    shaft, level = a_turn(rng, points=int(rng.integers(100, 361))), rng.uniform(0.1, 0.5)
    reading = _clipped(some_sensor(rng, noise_deg=(0.02, 0.1)), shaft, level, rng)
    return case(shaft, reading, truth={"level_percent": 100.0 * level})


def one_sided_clipping(rng: np.random.Generator) -> Case:
    shaft, level = a_turn(rng, points=int(rng.integers(100, 361))), rng.uniform(0.6, 0.9)
    return case(shaft, _clipped(some_sensor(rng, noise_deg=(0.02, 0.1)), shaft, level, rng, below=False))


def clipped_resolver(rng: np.random.Generator) -> Case:
    """Against a stepper's count, both ways, behind a coupling that lags."""
    turns, points = int(rng.integers(1, 4)), int(rng.choice([100, 200]))
    there = a_turn(rng, points=points, turns=turns)
    shaft = np.concatenate([there, there[::-1]])
    half, level = rng.uniform(0.1, 0.25), rng.uniform(0.6, 0.85)
    behind = np.repeat([-half, half], there.size)
    reading = _clipped(some_sensor(rng, noise_deg=(0.02, 0.06)), shaft + behind, level, rng)
    return case(shaft, reading, truth={"level_percent": 100.0 * level, "half_width_deg": half})


def _right_resolver(drawn: Case, answer: Answer) -> bool:
    if len(answer["causes"]) != 2 or "clipping" not in {one["name"] for one in answer["causes"]}:
        return False
    level = _values(answer, "clipping", "level_percent")[0]
    (other,) = [one for one in answer["causes"] if one["name"] != "clipping"]
    lags = {other["name"], *other["indistinguishable_from"]} & {"backlash", "hysteresis"}
    return bool(lags) and abs(level - drawn.truth["level_percent"]) <= 1.0


def table_of_firmware(rng: np.random.Generator) -> Case:
    """Even steps of the sensor's own reading; the reference is the reading less a correction."""
    entries = int(rng.choice([32, 50, 64, 100, 128, 256]))
    sensor, reading = some_sensor(rng), np.arange(entries) * (360.0 / entries)
    angle = np.radians(reading)
    order1 = np.degrees(sensor.offset[1] * np.cos(angle) - sensor.offset[0] * np.sin(angle))
    order2 = np.degrees((sensor.gain_ratio - 1.0) / 2.0 * np.sin(2.0 * angle) + sensor.phase * np.cos(angle) ** 2)
    noise = rng.uniform(0.01, 0.05) * rng.standard_normal(entries)
    return case(reading - order1 - order2 - noise, reading)


def motor_poles(rng: np.random.Generator) -> Case:
    slots, poles = MOTORS[int(rng.integers(len(MOTORS)))]
    points = int(rng.choice([one for one in (128, 200, 256, 360) if one > 4.3 * max(slots, poles)]))
    shaft = a_turn(rng, points=points)
    sizes = rng.uniform(0.1, 0.4, 4) * [1.0, 1.0, 0.5, 0.5]
    orders = np.array([slots, poles, 2 * slots, 2 * poles])
    lines = np.sin(np.radians(orders[:, None] * shaft) + rng.uniform(0.0, 2.0 * np.pi, (4, 1)))
    reading = some_sensor(rng, noise_deg=(0.01, 0.05)).reading_deg(shaft, rng) + sizes @ lines
    return case(shaft, reading, truth={"slots": slots, "poles": poles})


def _right_motor(drawn: Case, answer: Answer) -> bool:
    if not _alone(answer, "motor_poles"):
        return False
    told = {_values(answer, "motor_poles", "slots")[0], _values(answer, "motor_poles", "poles")[0]}
    return told == {drawn.truth["slots"], drawn.truth["poles"]}


def seam(rng: np.random.Generator) -> Case:
    """A turn that drifted, so that its end does not meet its beginning; the table begins elsewhere."""
    points = int(rng.choice([100, 128, 200, 256]))
    shaft, step = a_turn(rng, points=points), float(rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.3))
    # Between the last row and the first a wrong scale does the same.
    began = int(rng.integers(points // 8, points - points // 8))
    drift = step * ((np.arange(points) - began) % points) / points
    reading = some_sensor(rng, noise_deg=(0.01, 0.03)).reading_deg(shaft, rng) - drift
    return case(shaft, reading, truth={"step_deg": step, "at_deg": shaft[began], "point_deg": 360.0 / points})


def _right_seam(drawn: Case, answer: Answer) -> bool:
    """What does not close is told, within two points of where and a quarter of how much."""
    told = answer["causes"][0]["parameters"] if _alone(answer, "unnamed") else {}
    if "step_deg" not in told:
        return False
    away = (told["centre_deg"]["value"] - drawn.truth["at_deg"] + 180.0) % 360.0 - 180.0
    step = drawn.truth["step_deg"]
    return bool(
        abs(away) <= 2.0 * drawn.truth["point_deg"] and abs(told["step_deg"]["value"] - step) <= 0.25 * abs(step)
    )


def error_code(rng: np.random.Generator) -> Case:
    bits = int(rng.choice([10, 12, 14, 16]))
    shaft = a_turn(rng, points=int(rng.integers(100, 601)))
    sent = words(some_sensor(rng).reading_deg(shaft, rng), bits)
    code = int(rng.choice([0, 2**bits - 1, 2 ** (bits - 1), int(rng.integers(2**bits))]))
    hit = rng.choice(shaft.size, max(3, round(rng.uniform(0.02, 0.08) * shaft.size)), replace=False)
    sent[hit] = code
    return case(shaft, sent * (360.0 / 2**bits), truth={"word": code})


def stuck_bit(rng: np.random.Generator) -> Case:
    """A bit of the word that always reads 0 or 1, in sweeps of 40 readings to two turns of 600."""
    return _of_a_word(rng, lambda sent, bit: sent | (1 << bit) if rng.random() < 0.5 else sent & ~(1 << bit))


def misread_bit(rng: np.random.Generator) -> Case:
    """A bit that is read into the next one, so that its own code never occurs."""
    return _of_a_word(rng, lambda sent, bit: (sent & ~(1 << bit)) | ((sent >> bit & 1) << bit + 1), top=-1)


def _of_a_word(rng: np.random.Generator, change: Callable[[Any, int], Any], *, top: int = 0) -> Case:
    bits = int(rng.choice([10, 12, 14, 16]))
    shaft = a_turn(rng, points=int(rng.integers(40, 601)), turns=float(rng.choice([1.0, 2.0])))
    least = int(np.ceil(np.log2(1.0 / 360.0 * 2**bits)))  # A bit worth a degree or more.
    bit = int(rng.integers(least, bits + top))
    sent = change(words(some_sensor(rng).reading_deg(shaft, rng), bits), bit)
    return case(shaft, np.mod(sent, 2**bits) * (360.0 / 2**bits), truth={"bit": bit})


def multipole(rng: np.random.Generator) -> Case:
    """Errors of the period of a sensor with several pole pairs, in the angle of the shaft."""
    periods = int(rng.integers(3, 13))
    shaft = a_turn(rng, points=int(rng.choice([180, 360, 720])))
    of_period = np.radians(periods * shaft)
    offset = rng.uniform(0.015, 0.05, 2) * rng.choice([-1.0, 1.0], 2)
    gain, phase = 1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.02, 0.06), np.radians(rng.uniform(2.0, 6.0))
    read = np.arctan2(gain * np.sin(of_period + phase) + offset[1], np.cos(of_period) + offset[0])
    away = np.angle(np.exp(1j * (read - of_period))) / periods
    noise = rng.uniform(0.01, 0.05) * rng.standard_normal(shaft.size)
    return case(shaft, shaft + np.degrees(away) + noise, truth={"periods": periods})


def belt(rng: np.random.Generator) -> Case:
    """A sensor behind a belt: its pulley off centre, and the teeth in mesh."""
    ratio, teeth = int(rng.integers(3, 7)), int(rng.choice([12, 15, 16, 20]))
    points = int(rng.choice([360, 400, 500]))
    shaft = a_turn(rng, points=points, turns=2.0)
    error = rng.uniform(0.2, 0.5) * np.sin(np.radians(ratio * shaft) + rng.uniform(0.0, 2.0 * np.pi))
    error += rng.uniform(0.03, 0.08) * np.sin(np.radians(ratio * teeth * shaft) + rng.uniform(0.0, 2.0 * np.pi))
    reading = some_sensor(rng, noise_deg=(0.01, 0.05)).reading_deg(shaft + error, rng)
    return case(shaft, reading, truth={"order": ratio, "mesh": ratio * teeth})


def _right_belt(drawn: Case, answer: Answer) -> bool:
    """Both orders are told, with the mechanics among what may make them, and nothing else."""
    told = [
        value["value"]
        for one in answer["causes"]
        for key, value in one["parameters"].items()
        if key.split("_")[0] == "order"
    ]
    mechanics = all("mechanics" in names for names in _names(answer))
    return mechanics and {round(one) for one in told} == {drawn.truth["order"], drawn.truth["mesh"]}


def slips(rng: np.random.Generator) -> Case:
    """The reference loses or gains counts two or three times, anywhere."""
    points, turns = int(rng.choice([90, 180, 360])), int(rng.integers(3, 6))
    shaft = a_turn(rng, points=points, turns=turns)
    many = int(rng.integers(2, 4))
    places = np.sort(rng.choice(np.arange(1, 20), many, replace=False)) * shaft.size // 20
    steps = rng.choice([-1.0, 1.0], many) * rng.uniform(0.7, 5.0, many)
    slipped = np.sum(steps * (np.arange(shaft.size)[:, None] >= places), axis=1)
    reading = some_sensor(rng).reading_deg(shaft, rng)
    time_s = np.arange(shaft.size) * (5.0 / points)
    return case(shaft + slipped, reading, time_s=time_s, truth={"slips": many})


def _right_slips(drawn: Case, answer: Answer) -> bool:
    return _alone(answer, "index_slip") and len(_values(answer, "index_slip", "step_deg")) == drawn.truth["slips"]


def dead_zone(rng: np.random.Generator) -> Case:
    """The word holds its last value before a stretch of the turn and then jumps behind it."""
    width, bits = rng.uniform(3.0, 15.0), int(rng.choice([12, 14]))
    points = int(rng.choice([180, 360, 720]))
    shaft = a_turn(rng, points=points, turns=float(rng.choice([1.0, 2.0, 3.0])))
    start = rng.uniform(0.0, 360.0)
    reading = np.mod(some_sensor(rng).reading_deg(shaft, rng), 360.0)
    inside = np.mod(reading - start, 360.0) < width
    sent = words(np.where(inside, start, reading), bits)
    return case(shaft, sent * (360.0 / 2**bits), truth={"width_deg": width})


def scale_error(rng: np.random.Generator) -> Case:
    """Counts times a rounded factor: a turn of the shaft reads less or more than one."""
    factor = 1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.005, 0.03)
    points = int(rng.choice([36, 72, 100, 200]))
    shaft = a_turn(rng, points=points, turns=float(rng.choice([1.0, 2.0])))
    reading = np.unwrap(np.radians(some_sensor(rng).reading_deg(shaft, rng)))
    counted = np.mod(np.degrees(reading), 360.0) * factor
    return Case({"reference_deg": np.mod(shaft, 360.0), "measured_deg": counted}, {"factor": factor})


def typing_error(rng: np.random.Generator) -> Case:
    """One number of a small table is mistyped."""
    rows = int(rng.integers(16, 41))
    shaft = a_turn(rng, points=rows)
    reading = some_sensor(rng).reading_deg(shaft, rng)
    row = int(rng.integers(rows))
    reading[row] += rng.choice([-1.0, 1.0]) * rng.uniform(3.0, 20.0)
    return case(shaft, reading, truth={"row": row + 1})


def _right_row(drawn: Case, answer: Answer) -> bool:
    typed = [one for one in answer["setup"] if one["kind"] == "typing_error"]
    return not answer["causes"] and [one["rows"] for one in typed] == [[drawn.truth["row"]]]


def _right_drag(drawn: Case, answer: Answer) -> bool:
    """The motor's field alone, counted by the speed that it goes with."""
    return _alone(answer, "motor_field") and bool(_values(answer, "motor_field", "bx_mT_per_krpm"))


def _right_decimals(drawn: Case, answer: Answer) -> bool:
    """Both roundings and nothing else, the output's by its step."""
    told = {one["name"]: one for one in answer["causes"]}
    if set(told) != {"reference_quantisation", WORD}:
        return False
    return bool(np.isclose(told[WORD]["parameters"]["step_deg"]["value"], drawn.truth["step_deg"], rtol=1e-6))


def axial_magnet(rng: np.random.Generator) -> Case:
    """The reading swings by less than half a turn while the shaft goes round."""
    shaft = a_turn(rng, points=int(rng.integers(60, 361)), turns=float(rng.choice([1.0, 2.0])))
    at = np.radians(shaft)
    swing = 1.0 + rng.uniform(0.1, 0.7) * np.exp(1j * at) + rng.uniform(0.0, 0.1) * np.exp(-1j * at)
    noise = rng.uniform(0.05, 0.5) * rng.standard_normal(shaft.size)
    return case(shaft, np.degrees(np.angle(swing)) + rng.uniform(0.0, 360.0) + noise)


# New kinds come last: a kind's place is in the seeds of its draws, and some of these are tested as hard ones.
KINDS: dict[str, Kind] = {
    "clipping": Kind(clipping, _only("clipping", "level_percent", within=1.0)),
    "square_wave": Kind(square_wave, _only("clipping", "level_percent", within=2.0)),
    "one_sided_clipping": Kind(one_sided_clipping, lambda drawn, answer: _alone(answer, "clipping")),
    "clipped_resolver": Kind(clipped_resolver, _right_resolver),
    "table_of_firmware": Kind(table_of_firmware, _nothing),
    "motor_poles": Kind(motor_poles, _right_motor),
    "seam": Kind(seam, _right_seam),
    "error_code": Kind(error_code, _only("error_code", "word", within=0.0, beside=WORD)),
    "stuck_bit": Kind(stuck_bit, _only("word_bit", "bit", within=0.0, beside=WORD)),
    "misread_bit": Kind(misread_bit, _only("word_bit", "bit", within=0.0, beside=WORD)),
    "multipole": Kind(multipole, _only("multipole", "periods", within=0.0)),
    "belt": Kind(belt, _right_belt),
    "slips": Kind(slips, _right_slips),
    "dead_zone": Kind(dead_zone, _only("dead_zone", "width_deg", within=2.0, beside=WORD)),
    "scale_error": Kind(scale_error, _only("scale_error", "factor", within=0.001)),
    "typing_error": Kind(typing_error, _right_row),
    "axial_magnet": Kind(axial_magnet, lambda drawn, answer: False, lambda message: "axial" in message),
    "coarse_reference": Kind(coarse_reference, _only("reference_quantisation", "counts_per_turn", within=0.0)),
    "hand_turned": Kind(hand_turned, _nothing),
    "field_of_drag": Kind(field_of_drag, _right_drag),
    "printed": Kind(printed, _right_decimals),
}
