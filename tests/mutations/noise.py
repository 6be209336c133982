"""Mutations of the noise: each part of its description left out of the estimate, or out of what is simulated."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_FITTING = "diagnosis/discovery/fitting/noise"
_KINDS = "tests/diagnosis/discovery/fitting/test_noise.py"
_BESIDE = "tests/diagnosis/discovery/fitting/test_noise_beside_causes.py"
_TWIN = "tests/twin/test_noise.py"
_ESTIMATED = f"{_KINDS}::test_is_estimated_to_its_sampling_error"
_SIMULATED = f"{_KINDS}::test_twin_simulates_what_was_fitted"
_EVEN = f"{_KINDS}::test_p_of_the_check_is_even"

NOISE: tuple[Mutation, ...] = (
    Mutation(
        "noise.tail_not_estimated",
        f"{_FITTING}/distribution.py",
        "offered = (TAIL, *conditions)",
        "offered = tuple(conditions)",
        (f"{_ESTIMATED}[t with 4 degrees of freedom]",),
    ),
    Mutation(
        "noise.condition_not_estimated",
        f"{_FITTING}/estimate.py",
        "if _NEEDS[name] in provided",
        "if False",
        (f"{_ESTIMATED}[louder backward]",),
    ),
    Mutation(
        "noise.tail_taken_for_a_condition",
        f"{_FITTING}/distribution.py",
        "weight = (1.0 + inverse_dof) / (1.0 + inverse_dof * square)",
        "weight = np.ones_like(square)",
        (f"{_KINDS}::test_even_noise_is_called_even[4.0-60]", f"{_ESTIMATED}[t with 4 degrees of freedom]"),
    ),
    Mutation(
        "noise.readings_set_aside_forgotten",
        f"{_FITTING}/distribution.py",
        " - self.readings.size * float(np.log1p(-beyond))",
        "",
        (f"{_KINDS}::test_readings_set_aside_do_not_hide_the_tail",),
    ),
    Mutation(
        "noise.colour_of_the_nearest_member",
        f"{_FITTING}/colour.py",
        "_HALVINGS = 5",
        "_HALVINGS = 0",
        (f"{_ESTIMATED}[AR(1) + white]", f"{_ESTIMATED}[1/f]"),
    ),
    Mutation(
        "noise.parameters_keep_what_they_took",
        f"{_FITTING}/colour.py",
        "(self.rows + self.prior_residual.size - len(self.columns))",
        "self.rows",
        (f"{_KINDS}::test_rms_is_that_of_the_noise_not_of_what_a_fit_leaves",),
    ),
    Mutation(
        "noise.tail_not_drawn",
        "twin/noise/sequences.py",
        "rng.standard_t(dof, shape)",
        "rng.standard_normal(shape)",
        (f"{_EVEN}[t with 4 degrees of freedom]", f"{_TWIN}::test_tails_are_those_of_student"),
    ),
    Mutation(
        "noise.condition_left_out_of_the_bootstrap",
        "diagnosis/discovery/proof/bootstrap.py",
        "return 1.0 if noise.scale.even else",
        "return 1.0 if True else",
        (f"{_EVEN}[louder on one side]", f"{_EVEN}[louder backward]"),
    ),
    Mutation(
        "noise.condition_left_out_of_the_twin",
        "twin/hall/noise.py",
        "if not noise.scale.even:",
        "if False:",
        (f"{_TWIN}::test_scale_follows_the_condition", f"{_SIMULATED}[louder backward]"),
    ),
    Mutation(
        "noise.flicker_left_out_of_the_twin",
        "twin/hall/noise.py",
        '"flicker_exponent": noise.flicker_exponent,',
        '"flicker_exponent": 0.0,',
        (f"{_SIMULATED}[1/f]",),
    ),
    Mutation(
        "noise.spectrum_of_each_channel",
        "twin/hall/noise.py",
        '"rotating_frame": 0.0 if noise.white and np.isinf(noise.dof) else 1.0,',
        '"rotating_frame": 0.0,',
        (f"{_SIMULATED}[1/f]", f"{_SIMULATED}[t with 4 degrees of freedom]"),
    ),
    Mutation(
        "noise.stretch_simulated_twice",
        "diagnosis/discovery/proof/bootstrap.py",
        "quietest = float(np.min(variance))",
        "quietest = 1.0",
        (f"{_BESIDE}::test_jitter_of_the_reference_is_simulated_once",),
    ),
    Mutation(
        "noise.jitter_taken_for_the_noise's_white_share",
        "diagnosis/discovery/proof/bootstrap.py",
        "coloured = min((1.0 - ahead.white_share) / (quietest * float(np.mean(1.0 / variance))), 1.0)",
        "coloured = 1.0 - ahead.white_share",
        (f"{_BESIDE}::test_jitter_is_not_taken_for_a_white_share_of_the_noise",),
    ),
    Mutation(
        "noise.rounding_simulated_twice",
        f"{_FITTING}/rounding.py",
        "return replace(noise, rms_rad=noise.rms_rad * ahead / total, white_share=1.0 - coloured)",
        "return noise",
        (f"{_BESIDE}::test_noise_ahead_of_a_grid_is_told_from_rounding",),
    ),
    Mutation(
        "noise.rounding_taken_for_white_noise_ahead_of_it",
        f"{_FITTING}/rounding.py",
        "coloured = min((1.0 - noise.white_share) * (total / ahead) ** 2, 1.0)",
        "coloured = 1.0 - noise.white_share",
        (f"{_BESIDE}::test_noise_ahead_of_a_grid_is_told_from_rounding",),
    ),
)
