"""How it is told that readings do not say which way sensor and output count."""

from __future__ import annotations

from diagnosis.report.statements import senses_words
from tests.diagnosis.report.test_console import an_answer, shown


def test_a_mirrored_description_is_said_to_fit_as_well() -> None:
    answer = an_answer()
    assert senses_words(answer) == ""
    parameters = answer["extended"]["parameters"]
    own = {key: entry["value"] for key, entry in parameters.items()}
    mirrored = {**own, "Vy_over_Ay": 0.00712, "beta_deg": -0.1691, "zero_deg": -33.1201}
    answer["senses"] = {"sensor": 1, "output": 1, "decided": False, "log_odds": 0.3, "mirrored": mirrored}
    said = "The mirrored twin (s = -1, h = -1) fits as well, "
    said += "with offset y 0.712 %, phase -0.1691 deg and zero -33.1201 deg"
    assert senses_words(answer) == said
    assert said in " ".join(shown(answer, 160).split())
    assert senses_words({**answer, "motion": {}}) == said.replace(
        ", phase -0.1691 deg and zero -33.1201", " and phase -0.1691"
    )
    # Of a sensor that was turned between recordings the mirrored twin is another one.
    mirrored["Vx_over_Ax"] = parameters["Vx_over_Ax"]["high"] + 0.002
    assert "fits as well, with offset x " in senses_words(answer)
    answer["senses"] |= {"decided": True, "mirrored": None}
    assert senses_words(answer) == ""


def test_the_signs_of_a_sensor_that_counts_backwards_are_explained() -> None:
    """Reading = shaft + 120 deg, with s = h = -1: the zero is -120 deg there, and 120 deg with s = h = 1."""
    senses = {"sensor": -1, "output": -1, "decided": True, "log_odds": 6.3, "mirrored": None}
    said = senses_words({"senses": senses})
    assert "zero are those of s = -1, h = -1, in which the reading is h (s x shaft + zero)" in said
    assert said.endswith("s = +1, h = +1 has them with the opposite sign")
    assert "zero" not in senses_words({"senses": senses, "motion": {}})
    assert senses_words({"senses": senses | {"sensor": 1, "output": 1}}) == ""
