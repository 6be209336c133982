"""Mutations of what the words of a link show: what tells a fault, or takes it off the readings, broken."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_TESTS = "tests/twin/test_words.py"
_ANSWERS = "tests/diagnosis/test_word_faults.py"

WORDS = (
    Mutation(
        "error_code.a_frame_sent_again_is_a_code",
        "twin/link/error_code.py",
        "coded = far & ~_held(words, far)",
        "coded = far",
        (f"{_TESTS}::test_a_frame_that_is_sent_again_is_no_code",),
    ),
    Mutation(
        "error_code.words_alike_by_chance",
        "twin/link/error_code.py",
        "_log_choices(rows.size, apart) - ",
        "-",
        (f"{_TESTS}::test_wrong_words_that_agree_by_chance_are_no_code",),
    ),
    Mutation(
        "word_bit.no_gain_asked_for",
        "twin/link/word_bit.py",
        "likely > plain + _GAIN",
        "likely > -np.inf",
        (f"{_TESTS}::test_nothing_is_told_where_the_words_are_sound",),
    ),
    Mutation(
        "error_code.only_far_words",
        "twin/link/error_code.py",
        "holds & (far | (share > _ODDS * (1.0 - share) * by_angle))",
        "holds & far",
        (f"{_TESTS}::test_a_code_near_its_own_angle_is_the_code_where_the_noise_leaves_no_doubt",),
    ),
    Mutation(
        "error_code.every_word_like_it",
        "twin/link/error_code.py",
        "holds & (far | (share > _ODDS * (1.0 - share) * by_angle))",
        "holds",
        (f"{_TESTS}::test_a_code_near_its_own_angle_is_the_code_where_the_noise_leaves_no_doubt",),
    ),
    Mutation(
        "word_bit.the_smaller_zero_alone",
        "twin/link/word_bit.py",
        "(one.fault.into != 0.0, abs(float(wrap(one.expected.zero))))",
        "abs(float(wrap(one.expected.zero)))",
        (f"{_TESTS}::test_a_bit_held_at_0_is_told_as_such_beside_what_sends_the_same_words",),
    ),
    Mutation(
        "word_bit.either_half_of_the_turn",
        "twin/link/word_bit.py",
        "abs(float(wrap(expected.zero))) <= TAU / 4.0",
        "True",
        (f"{_TESTS}::test_a_highest_bit_that_is_held_leaves_half_a_turn_open",),
    ),
    Mutation(
        "word_bit.nothing_sends_the_same_words",
        "diagnosis/discovery/marks/words.py",
        "alike=fault.alike",
        "alike=()",
        (f"{_ANSWERS}::test_what_sends_the_same_words_is_told_with_its_zero",),
    ),
    Mutation(
        "words.the_sent_ones_err_like_the_decoded_ones",
        "diagnosis/report/facts.py",
        " + np.degrees(found.told_back)",
        "",
        (f"{_ANSWERS}::test_the_error_of_the_words_as_sent_stands_beside_that_of_the_decoded_ones",),
    ),
    Mutation(
        "word_bit.readings_stay",
        "twin/link/word_bit.py",
        "decoded = chosen if told else words.measured",
        "decoded = words.measured",
        (f"{_TESTS}::test_a_bit_is_told_and_the_readings_told_back",),
    ),
    Mutation(
        "dead_zone.readings_within_it_stand_anywhere",
        "twin/link/dead_zone.py",
        "or np.count_nonzero(held) < (1.0 - MISSED) * count",
        "",
        (f"{_TESTS}::test_a_stretch_of_wrong_words_is_no_dead_zone",),
    ),
    Mutation(
        "dead_zone.both_edges_are_free",
        "twin/link/dead_zone.py",
        "(standing - edges) * np.log",
        "(standing - 2) * np.log",
        (f"{_TESTS}::test_two_readings_within_a_zone_are_no_code",),
    ),
    Mutation(
        "scale_error.begins_anew_anywhere",
        "twin/link/scale_error.py",
        "if _gain_of_another_place(factor - 1.0, after, words.usable) > np.log(words.usable.sum()) - LIMIT_LOG_P:",
        "if False:",
        (f"{_TESTS}::test_a_ramp_that_begins_anew_elsewhere_is_no_scale",),
    ),
    Mutation(
        "dead_zone.runs_of_repeats_are_short",
        "twin/link/dead_zone.py",
        "if not own or not others:",
        "if True:",
        (f"{_TESTS}::test_the_longest_of_many_runs_of_repeated_frames_is_no_dead_zone",),
    ),
    Mutation(
        "dead_zone.edges_as_if_held",
        "twin/link/dead_zone.py",
        "lower = slack if low.any() else first_high",
        "lower = slack",
        (f"{_TESTS}::test_a_zone_is_told_by_its_edges",),
    ),
    Mutation(
        "words.one_fault_alone",
        "twin/words.py",
        "if not finders[name].several:",
        "if True:",
        (f"{_TESTS}::test_two_codes_are_two_faults",),
    ),
    Mutation(
        "sweep_checks.words_are_taken_as_they_are",
        "twin/sweep_checks.py",
        "return np.degrees(words.measured) if found else None",
        "return None",
        (f"{_TESTS}::test_a_sweep_that_only_follows_once_decoded_is_read",),
    ),
    Mutation(
        "words.a_known_fault_is_a_cause",
        "diagnosis/discovery/marks/words.py",
        "if not _same(self.words[one.keys[0]], own.get(one.keys[0]))",
        "if True",
        (f"{_ANSWERS}::test_a_known_fault_of_the_words_is_no_cause",),
    ),
    Mutation(
        "result.the_twin_has_sound_words",
        "diagnosis/discovery/result.py",
        ".with_values(self.words)",
        "",
        (f"{_ANSWERS}::test_a_bit_is_named_and_its_twin_errs_alike",),
    ),
    Mutation(
        "scale_error.counts_from_anywhere",
        "twin/link/scale_error.py",
        "word = np.mod(signal, TAU)",
        "word = np.mod(signal + 1.0, TAU)",
        ("tests/contract/test_effects.py::test_leading_signature",),
    ),
    Mutation(
        "scale_error.the_search_sets_out_without_it",
        "diagnosis/discovery/stages/initial_fit.py",
        "if not state.begun:",
        "if True:",
        (f"{_ANSWERS}::test_a_scale_is_told_with_its_interval",),
    ),
    Mutation(
        "index_slip.the_search_sets_out_without_them",
        "twin/reference/index_slip.py",
        "if len(jumps) < 2 or",
        "if True or",
        (f"{_ANSWERS}::test_two_slips_are_told_with_their_instants",),
    ),
    Mutation(
        "quantisation.any_grid_is_rounding",
        "diagnosis/discovery/stages/quantisation.py",
        "if state.bits is not None and not rounded(state.fit, state.sweep, state.step):",
        "if False:",
        (f"{_ANSWERS}::test_the_index_of_a_table_is_no_quantiser",),
    ),
    Mutation(
        "row_masks.gross_errors_of_few_come_back",
        "diagnosis/discovery/marks/row_masks.py",
        "mask |= gross_of_few(fit)",
        "pass",
        (f"{_ANSWERS}::test_a_typing_error_is_told_among_readings_that_rise_and_fall",),
    ),
)
