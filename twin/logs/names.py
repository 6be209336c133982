"""What the name of a log's column says: which quantity it holds, in which unit, and on which side it may stand."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from twin.logs.units import COUNTS, UNITS, Unit, unit_of
from twin.sweep_columns import COLUMNS

_CHIP = re.compile(
    r"as5\d{3}|tle5\d{3}|tli\d{4}|ma[3-7]\d\d|mt6\d{3}|mlx\d+|a133\d|aeat\d*|kmz\d*|tmag\d*|mag(?=_|\d|$)"
)
_COUNTS_OF_CHIP = {
    "as5040": 2**10,
    "as5045": 2**12,
    "as5600": 2**12,
    "as5047": 2**14,
    "as5048": 2**14,
    "as5147": 2**14,
    "as5247": 2**14,
    "mt6701": 2**14,
    "mt6816": 2**14,
    "tle5012": 2**15,
    "mt6835": 2**21,
}
"""Counts of a turn that a part's register of the angle has, by its data sheet."""
_WORDS = {
    "reference": "ref reference true truth soll referenz nominal ideal expected heidenhain autocollimator "
    "goniometer theodolite protractor winkelmesser "
    "consigne theorique referencia riferimento nominale vero vera verdadero",
    "driven": "enc encoder stage stepper step steps microstep microsteps motor "
    "cmd commanded command target setpoint desired demand "
    "demanded wanted vorgabe mech mechanical shaft "
    "actual table rotary position_ref dividing index_table drehgeber welle moteur motore codeur codificador",
    "sensor": "meas measured measurement sensor dut hall magnetic magnet ist gemessen mess messung sensed tmr amr gmr "
    "capteur mesure mesuree sensore misura misurato medido medida",
    "read": "angle output out position pos reading theta phi winkel value rotor wert lage angolo angulo lecture "
    "lettura lectura posizione posicion valeur valore valor",
    "time": "t time timestamp ts zeit elapsed uptime millis micros clock temps tempo tiempo zeitstempel",
    "temperature": "temp temperature temperatur temperatura",
    "speed": "rpm speed velocity vel omega drehzahl geschwindigkeit vitesse velocita velocidad",
    "turn": "turn turns rev revolution revolutions lap umdrehung sweep cycle tour giro vuelta",
    "direction": "dir direction richtung drehrichtung sense sens senso sentido",
    "sin": "vy sin sine sinus",
    "cos": "vx cos cosine cosinus",
    "gap": "gap airgap luftspalt entrefer traferro",
    "mounting": "mounting",
    "current": "current amps iq strom courant corrente corriente",
    "magnitude": "magnitude",
    "agc": "agc",
    "status": "status",
    "frame": "frame frames framecounter",
    "error": "error err deviation dev abweichung fehler erreur errore",
    "correction": "correction corrections corr comp compensation korrektur correzione correccion",
    "other": "index idx seq sequence sample samples n no nr row i id flag flags diff mag_field "
    "voltage torque crc counter load power valid ok note comment",
}
"""Words of names, without accents, in English, German, French, Italian and Spanish."""
_MEANING = {word: role for role, words in _WORDS.items() for word in words.split()}
_SHORTEST_PART = 3
"""Letters of either word that a compound is made of, as Referenzwinkel and Istwert are."""
_ROLE_QUANTITY = {"time": "time", "temperature": "temperature", "speed": "speed", "gap": "length", "current": "current"}
_ANGLES = frozenset({"reference", "driven", "sensor", "read"})
_PARTED = (
    r"^(.*?)[\s_.]*[\[({<]\s*([^\])}>]+?)\s*[\])}>]\s*$",
    r"^(.+?)\s*(?:\s/|/\s|,|\bin\b)\s*(\S+)$",
    r"^(.+)/(\S+)$",
)
"""A unit in brackets, behind a slash, a comma or "in"."""
_AXES = {"x": "cos", "y": "sin"}
_BY_QUANTITY = {"time": "time", "temperature": "temperature", "speed": "speed"}
"""What a unit says where no word does."""
SURE, _LIKELY = 2, 1
"""What a word weighs that is said of one side alone, and one that is said of it more often."""
_OF_SENSOR = ("current", "magnitude", "agc", "status", "frame", "error", "correction")
_ORDER = (*_OF_SENSOR, "other", "temperature", "speed", "gap", "time", "direction", "sin", "cos", "mounting")
"""Roles that a name has before those of an angle: the speed of the encoder is a speed."""


@dataclass(frozen=True)
class Meaning:
    """What a name says. ``role``: a kind of column, "angle", or "" where it says nothing.

    ``reference`` and ``sensor`` weigh how much speaks for either side of an angle. ``unit`` is the stated one,
    ``counts`` whether it is a count of steps, ``turns`` which numbers of them may make a turn, if that is known;
    ``own`` the column of a sweep whose name it is, large or small; ``of_chip`` how many counts make a turn of the part
    that it names, 0 for none that is known.
    """

    role: str
    reference: int = 0
    sensor: int = 0
    unit: Unit | None = None
    counts: bool = False
    own: str | None = None
    turns: tuple[int, ...] = ()
    of_chip: int = 0


def meaning_of(name: str) -> Meaning:
    """What a column's name says."""
    own = name.strip().lower()
    if own in COLUMNS:
        return _own(own)
    return _OF_EITHER.get(name.strip()) or _of_words(name)


def _of_words(name: str) -> Meaning:
    """What the words and the unit of a name say."""
    bare, unit, counts = _parted(name)
    words = _words(bare)
    roles = {_MEANING[word] for word in words if word in _MEANING}
    if words and words[-1] in _AXES and unit is None and "read" not in roles:
        return Meaning(_AXES[words[-1]])
    chip = _CHIP.search(bare.lower())
    if chip:
        roles.add("sensor")
    quantity = unit.quantity if unit else None
    if "current" in roles and _MEANING.get(words[-1]) != "current" and quantity != "current":
        # The current angle is the one at this moment.
        roles.discard("current")
    for role in _ORDER:
        wanted = _ROLE_QUANTITY.get(role)
        if role in roles and (unit is None or wanted is None or wanted == quantity):
            return Meaning(role, unit=unit)
    if "turn" in roles and not roles & _ANGLES and unit is None:
        return Meaning("turn")
    # A single letter behind a name may tell several of a kind apart: sensor_a.
    if unit is not None and quantity not in ("angle", *_BY_QUANTITY) and len(unit.name) > 1:
        return Meaning("other")
    if roles & _ANGLES or quantity == "angle" or counts:
        reference = SURE if "reference" in roles else _LIKELY if "driven" in roles else 0
        sensor = SURE if "sensor" in roles else _LIKELY if "read" in roles and not reference else 0
        of_chip = _COUNTS_OF_CHIP.get(chip[0], 0) if chip else 0
        return Meaning("angle", reference, sensor, unit if quantity == "angle" else None, counts, of_chip=of_chip)
    return Meaning(_BY_QUANTITY.get(quantity or "", ""), unit=unit)


_OF_EITHER = {"T": Meaning("other")}
"""Names of two quantities, of which none is guessed: a temperature as often as a time."""


def _own(own: str) -> Meaning:
    """The meaning of a name of the project's own, whose unit it ends in."""
    roles = {
        "time_s": ("time", "s"),
        "temperature_c": ("temperature", "C"),
        "speed_rpm": ("speed", "rpm"),
        "air_gap_mm": ("gap", "mm"),
        "mounting_deg": ("mounting", "deg"),
        "current_a": ("current", "A"),
        "vx": ("cos", ""),
        "vy": ("sin", ""),
    }
    if own in ("reference_deg", "measured_deg"):
        sides = (3, 0) if own == "reference_deg" else (0, 3)
        return Meaning("angle", *sides, unit=UNITS["deg"], own=own)
    role, unit = roles.get(own, (own, ""))
    return Meaning(role, unit=UNITS.get(unit), own=own)


def _parted(name: str) -> tuple[str, Unit | None, bool]:
    """The name without its unit, the unit, and whether it is a count."""
    text = name.strip()
    for pattern in _PARTED:
        found = re.match(pattern, text)
        if found and (unit := unit_of(found[2])):
            return found[1], unit, False
        if found and found[2].lower() in COUNTS:
            return found[1], None, True
    rate = re.match(r"^(.*?)[\s_]*(rad|deg|rev)_(?:per_)?s(?:ec)?$", text, re.IGNORECASE)
    if rate:
        return rate[1], UNITS[f"{rate[2].lower()}/s"], False
    head, last = _last_word(text)
    if last in COUNTS:
        return head, None, True
    unit = unit_of(last)
    if unit is None or (not head and last in _MEANING and unit.quantity == "angle"):
        return text, None, False
    alone = len(last) == 1 and not re.search(r"[\s_.\-]\S$", text)
    return (text, None, False) if alone else (head or text, unit, False)


def _last_word(text: str) -> tuple[str, str]:
    """What stands before the last word of a name, and that word in small letters: ``encDeg``, ``enc_deg``, ``deg``."""
    behind = re.match(r"^(.+)_([a-z]A)$", text)
    if behind and unit_of(behind[2]):
        # A unit of a small and a large letter is one word: ``current_mA``.
        return behind[1], behind[2].lower()
    found = re.match(r"^(.*?)[\s_.\-]*([A-Z]?[^\W\d_A-Z]+|[A-Z]+|°C?)$", text)
    return (found[1], found[2].lower()) if found else (text, "")


def _words(bare: str) -> list[str]:
    """The words of a name in small letters without accents, also of ``encAngle``, ``ENC_ANGLE`` and ``Sollwinkel``."""
    plain = "".join(letter for letter in unicodedata.normalize("NFKD", bare) if not unicodedata.combining(letter))
    found = [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-zß]+", plain)]
    return [part for word in found for part in _parts(word)]


def _parts(word: str) -> tuple[str, ...]:
    """The two words that one is made of, where it is none that is known by itself."""
    if word in _MEANING:
        return (word,)
    for end in range(_SHORTEST_PART, len(word) - _SHORTEST_PART + 1):
        parts = word[:end], word[end:]
        if all(part in _MEANING for part in parts):
            return parts
    return (word,)
