"""Mutations of what is held against the paper and against vendors' figures."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

_PUBLISHED = "tests/twin/test_published.py"
_DISTANCE = "tests/scenarios/test_distance.py"
_PAPER = "tests/scenarios/test_paper.py"

PAPER: tuple[Mutation, ...] = (
    *of_one_file(
        "twin/magnet/ring_sensor.py",
        _PUBLISHED,
        (
            "ring_sensor.does_not_tilt_with_the_die",
            "air_gap_mm=placement.air_gap_mm + up,",
            "air_gap_mm=placement.air_gap_mm + 0.0 * up,",
            "::test_both_sensors_see_magpylibs_field",
        ),
        (
            "ring_sensor.sees_along_x",
            "temperature_c=temperature_c)[:, 2]",
            "temperature_c=temperature_c)[:, 0]",
            "::test_both_sensors_see_magpylibs_field",
        ),
    ),
    *of_one_file(
        "twin/magnet/side_shaft.py",
        _PUBLISHED,
        (
            "side_shaft.counts_outwards",
            "np.stack([-field[:, 0], field[:, 1]])",
            "np.stack([field[:, 0], field[:, 1]])",
            "::test_side_shaft",
        ),
    ),
    *of_one_file(
        "scenarios/studies/design/distance.py",
        _DISTANCE,
        (
            "distance.everything_counts",
            "if followed(find(key, chain.effects))}",
            "if True}",
            "::test_what_does_not_depend_on_the_field_counts_for_nothing",
        ),
        (
            "distance.an_end_is_not_said",
            'return {0: "nearest", len(self.error_deg) - 1: "farthest"}.get(self.least)',
            "return None",
            "::test_an_end_of_the_distances_is_said_to_be_one",
        ),
    ),
    *of_one_file(
        "scenarios/studies/design/field.py",
        _DISTANCE,
        (
            "design_field.nothing_follows_the_field",
            "names=followed(effect), ratios",
            "names=(), ratios",
            "::test_the_least_is_where_saturation_and_hysteresis_balance",
        ),
    ),
    *of_one_file(
        "scenarios/commands/paper/search.py",
        _PAPER,
        (
            "paper_search.the_rule_is_not_passed_on",
            "None if method.band_rad is None else outside(readings, method.band_rad)",
            "None",
            "::test_the_discard_rule_slows_the_swarm_down",
        ),
        (
            "paper_search.each_method_has_seeds_of_its_own",
            "np.random.default_rng([seed, start])",
            "np.random.default_rng([seed, start, method.band_rad is None])",
            "::test_a_band_that_nobody_leaves_changes_nothing",
        ),
    ),
    *of_one_file(
        "scenarios/commands/paper/devices.py",
        _PAPER,
        (
            "paper_devices.volts_are_amplitudes",
            "vx=amplitude * sweep.vx, vy=amplitude * sweep.vy",
            "vx=sweep.vx, vy=sweep.vy",
            "::test_table_2_comes_back",
        ),
    ),
)
