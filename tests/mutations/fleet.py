"""Mutations of what is said of batches of devices: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_WHERE, _TESTS = "diagnosis/population", "tests/diagnosis/population"

_OF_POPULATIONS: tuple[Mutation, ...] = tuple(
    Mutation(f"fleet.{name}", f"{_WHERE}/{file}.py", old, new, (f"{_TESTS}/test_{tests}::{test}",))
    for name, file, old, new, tests, test in (
        (
            "lines_of_one",
            "candidates",
            "turned[0] = cosine - 1j * quadrature",
            "turned[0] = cosine + 1j * quadrature",
            "candidates.py",
            "test_columns_are_those_of_the_linearised_chain",
        ),
        (
            "one_candidate_a_line",
            "candidates",
            "        if same:\n",
            "        if False:\n",
            "candidates.py",
            "test_every_order_is_asked_for_once",
        ),
        (
            "halves_from_different_readings",
            "device",
            "(0, self.first), (1, ~self.first)",
            "(0, self.first), (1, self.first)",
            "device.py",
            "test_halves_agree_by_chance_alone",
        ),
        (
            "noise_is_whitened",
            "looks",
            "question = template.with_noise(question)",
            "question = question",
            "device.py",
            "test_halves_agree_by_chance_in_coloured_noise_too",
        ),
        (
            "noise_of_the_bench",
            "noise",
            "np.median([",
            "np.mean([",
            "noise.py",
            "test_structure_of_one_device_is_no_noise",
        ),
        (
            "odd_ones_drawn_in",
            "pooled",
            "np.minimum(1.0, limit / np.maximum(size, 1e-300))",
            "np.ones_like(size)",
            "pooled.py",
            "test_one_odd_device_hides_nothing",
        ),
        (
            "phase_from_the_sensor",
            "pooled",
            "np.exp(-1j * self.turned)",
            "np.exp(1j * self.turned)",
            "pooled.py",
            "test_each_way_of_sharing_a_phase_is_told",
        ),
        (
            "sign_of_physics",
            "pooled",
            "    if sign and mean[0] * sign <= 0.0:\n",
            "    if False:\n",
            "pooled.py",
            "test_a_sign_that_physics_forbids_is_no_cause",
        ),
        (
            "leaks",
            "pooled",
            "<= _LEAKED * evidence[place]",
            "<= 1e9",
            "pooled.py",
            "test_what_a_stronger_one_leaks_is_not_taken_with_it",
        ),
        (
            "sense_of_the_zero",
            "batch",
            "sensor_sense * one.order * np.radians",
            "-sensor_sense * one.order * np.radians",
            "pooled.py",
            "test_weak_causes_of_a_batch_come_back",
        ),
        (
            "own_errors_taken_out",
            "random_effects",
            "weights = 1.0 / (errors**2 + variance)\n    mean",
            "errors = 0.0 * errors\n    variance = float(np.var(values, ddof=1))\n"
            "    weights = np.full(values.size, 1.0 / variance)\n    mean",
            "random_effects.py",
            "test_devices_own_errors_are_taken_out",
        ),
        (
            "dependent_tests",
            "false_discovery",
            "(1.0 if independent else np.sum(1.0 / ranks))",
            "1.0",
            "false_discovery.py",
            "test_worked_example",
        ),
        (
            "robust_scatter",
            "robust_distance",
            "inside = values[squares <= limit]",
            "inside = values",
            "robust_distance.py",
            "test_odd_devices_do_not_widen_the_rest",
        ),
        (
            "cut_off_cloud",
            "robust_distance",
            "left = float(chdtr(count + 2, limit)) / _WITHIN",
            "left = 1.0",
            "robust_distance.py",
            "test_normal_devices_have_the_distances_of_chi_squared",
        ),
        (
            "steps_tried",
            "changes",
            " + float(np.log(steps.size + 1)), 0.0)",
            ", 0.0)",
            "population.py",
            "test_chance_of_a_change_is_no_more_than_it_says",
        ),
        (
            "zero_set_again",
            "corrections",
            "about = curvature[:, rest][:, :, rest] - pulled",
            "about = curvature[:, rest][:, :, rest] - 0.0 * pulled",
            "population.py",
            "test_corrections_leave_what_the_readings_show",
        ),
        (
            "usual_devices_tell_the_spread",
            "population",
            "within if len(within) >= FEWEST_DEVICES else usable",
            "usable",
            "population.py",
            "test_odd_devices_are_found_with_what_they_are_odd_in",
        ),
    )
)

_OF_THE_COMMAND: tuple[Mutation, ...] = (
    Mutation(
        "fleet.content_of_files",
        "scenarios/studies/fleet/run.py",
        'whole.update(hashlib.file_digest(file, "sha256").digest())',
        "pass",
        ("tests/scenarios/test_fleet.py::test_other_devices_are_another_study",),
    ),
    Mutation(
        "fleet.readings_count_once",
        "scenarios/studies/fleet/run.py",
        "if content and content in first:",
        "if False:",
        ("tests/scenarios/test_fleet.py::test_files_that_cannot_be_used_are_listed_with_the_reason",),
    ),
    Mutation(
        "fleet.numbers_by_size",
        "scenarios/studies/fleet/order.py",
        "(1, int(part), part) if part.isdecimal()",
        "(1, 0, part) if part.isdecimal()",
        ("tests/scenarios/test_fleet.py::test_numbers_in_names_are_the_order",),
    ),
)

FLEET: tuple[Mutation, ...] = (*_OF_POPULATIONS, *_OF_THE_COMMAND)
