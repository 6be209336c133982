"""Mutations of what is made of a log without a reference: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_SMOOTHER = "tests/diagnosis/spin/test_smoother.py"
_STRETCHES = "tests/diagnosis/spin/test_stretches.py"
_MOTION = "tests/twin/test_estimated_motion.py"

SPINS: tuple[Mutation, ...] = tuple(
    Mutation(name, file, old, new, (test,))
    for name, file, old, new, test in (
        (
            "spins.torques_are_the_sensors",
            "diagnosis/spin/smoother.py",
            "    if torque:\n",
            "    if False:\n",
            f"{_SMOOTHER}::test_a_coast_tells_the_sensor_from_a_torque_of_the_same_order",
        ),
        (
            "spins.readings_far_off_count",
            "diagnosis/spin/smoother.py",
            "_FAR_OUT = 6.0",
            "_FAR_OUT = 1e9",
            f"{_SMOOTHER}::test_readings_far_off_are_left_out",
        ),
        (
            "spins.a_jerk_counts",
            "diagnosis/spin/of_log.py",
            "_FREE = 3.0",
            "_FREE = 1e9",
            f"{_SMOOTHER}::test_a_jerk_is_set_aside",
        ),
        (
            "spins.each_log_alone",
            "diagnosis/spin/of_log.py",
            "torque=bool(fast - slow > LEAST_SPEEDS * fast)",
            "torque=False",
            f"{_SMOOTHER}::test_two_logs_of_one_speed_each_tell_together_what_neither_tells",
        ),
        (
            "spins.rows_out_of_use_keep_their_torque",
            "diagnosis/spin/torques.py",
            "np.where(self._usable, of_used, along @ self._columns)",
            "of_used",
            f"{_SMOOTHER}::test_rows_out_of_use_lose_what_the_others_tell",
        ),
        (
            "spins.a_reading_far_off_counts_a_turn",
            "diagnosis/spin/stretches.py",
            "step = expected + wrap(step - expected)",
            "pass",
            f"{_STRETCHES}::test_a_reading_far_off_counts_no_turn",
        ),
        (
            "spins.a_gap_is_bridged",
            "diagnosis/spin/stretches.py",
            "_GAP = 20.0",
            "_GAP = 1e9",
            f"{_STRETCHES}::test_after_a_gap_a_stretch_begins_anew",
        ),
        (
            "spins.rows_left_out_end_no_stretch",
            "twin/estimated_motion.py",
            "broken = (np.diff(rows) != 1) | (np.diff(self.stretch[rows]) != 0)",
            "broken = np.diff(self.stretch[rows]) != 0",
            f"{_MOTION}::test_a_stretch_ends_where_rows_are_left_out",
        ),
    )
)
