"""One preset is one sensor: the same orders of the error from simulate, hardware and design."""

from __future__ import annotations

import numpy as np
import pytest

from tests.hardware_causes import orders
from twin.presets import preset_names, read_preset

TURNS = 8


@pytest.mark.parametrize("name", preset_names())
def test_a_preset_has_one_table_of_orders(name: str) -> None:
    chain = read_preset(name)
    expected = orders.of_expected(chain)
    noise_deg = chain.values["noise"]["rms_deg"]
    word_deg = 360.0 / 2 ** chain.values["output_quantisation"]["bits"]
    # An amplitude of white noise over n readings scatters by the RMS times sqrt(2 / n), the words' rounding included;
    # four of these. What few iterations and guard bits leave of order 1 to 6 is below a fifth of a word.
    readings = TURNS * orders.POINTS
    scatter = 4.0 * np.hypot(noise_deg, word_deg / np.sqrt(12.0)) * np.sqrt(2.0 / readings) + 0.2 * word_deg
    np.testing.assert_allclose(orders.of_simulate(chain, turns=TURNS), expected, atol=scatter)
    np.testing.assert_allclose(orders.of_hardware(chain, turns=TURNS), expected, atol=scatter)
    if chain.magnet is not None:
        # The design's series leaves out 1e-7 of the field.
        np.testing.assert_allclose(orders.of_design(chain), expected, atol=1e-5)
    assert np.max(expected) > 10.0 * scatter
