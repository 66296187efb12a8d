// The rows, with the severities that each may have: which one it has is decided where it is made.
#include "result/finding_table.hpp"

#include <algorithm>
#include <iterator>

namespace sysid {
namespace {

constexpr Severities error{Severity::error}, warning{Severity::warning}, note{Severity::note};
constexpr Severities error_or_warning{Severity::error, Severity::warning}, warning_or_note{Severity::warning, Severity::note};
constexpr Severities any{Severity::error, Severity::warning, Severity::note};

constexpr FindingRow rows[] = {
    {FindingCode::chain_did_not_move, "chain_did_not_move", error},
    {FindingCode::few_distinct_states, "few_distinct_states", error},
    {FindingCode::chains_disagree, "chains_disagree", error},
    {FindingCode::chains_not_quite_agreed, "chains_not_quite_agreed", error},
    {FindingCode::ess_bulk_low, "ess_bulk_low", error},
    {FindingCode::ess_tail_low, "ess_tail_low", error},
    {FindingCode::replicas_do_not_mix, "replicas_do_not_mix", warning},
    {FindingCode::trajectories_diverge, "trajectories_diverge", error_or_warning},
    {FindingCode::trajectories_cut, "trajectories_cut", warning},
    {FindingCode::no_diagnostics, "no_diagnostics", error},
    {FindingCode::integration_step, "integration_step", any},
    {FindingCode::linearisation_matters, "linearisation_matters", error_or_warning},
    {FindingCode::likelihood_too_noisy, "likelihood_too_noisy", error_or_warning},
    {FindingCode::particles_degenerate, "particles_degenerate", warning_or_note},
    {FindingCode::noise_in_lines, "noise_in_lines", note},
    {FindingCode::step_not_settled, "step_not_settled", any},
    {FindingCode::stiff_prior, "stiff_prior", warning},
    {FindingCode::slower_solver, "slower_solver", note},
    {FindingCode::noise_size, "noise_size", error},
    {FindingCode::made_from_earlier, "made_from_earlier", warning},
    {FindingCode::looks_missing, "looks_missing", warning},
    {FindingCode::column_constant, "column_constant", warning_or_note},
    {FindingCode::sensor_stuck, "sensor_stuck", warning},
    {FindingCode::time_gap, "time_gap", warning},
    {FindingCode::time_scales_apart, "time_scales_apart", warning},
    {FindingCode::times_rounded, "times_rounded", warning},
    {FindingCode::rate_contradicted, "rate_contradicted", warning_or_note},
    {FindingCode::column_used_twice, "column_used_twice", warning},
    {FindingCode::sign_reversed, "sign_reversed", warning},
    {FindingCode::samples_repeated, "samples_repeated", error},
    {FindingCode::unit_in_name, "unit_in_name", warning_or_note},
    {FindingCode::unit_in_file, "unit_in_file", warning},
    {FindingCode::samples_far_off, "samples_far_off", warning},
    {FindingCode::explains_little, "explains_little", error_or_warning},
    {FindingCode::worse_than_the_mean, "worse_than_the_mean", error_or_warning},
    {FindingCode::failed_solves, "failed_solves", error_or_warning},
    {FindingCode::failed_predictions, "failed_predictions", any},
    {FindingCode::undefined_in_band, "undefined_in_band", any},
    {FindingCode::second_mode, "second_mode", warning},
    {FindingCode::flat_direction, "flat_direction", warning_or_note},
    {FindingCode::piles_up_at_bound, "piles_up_at_bound", warning},
    {FindingCode::at_bound, "at_bound", warning},
    {FindingCode::optimum_not_reached, "optimum_not_reached", error},
    {FindingCode::widths_not_normal, "widths_not_normal", error_or_warning},
    {FindingCode::residual_offset, "residual_offset", warning},
    {FindingCode::residual_trend, "residual_trend", warning},
    {FindingCode::residuals_not_white, "residuals_not_white", warning},
    {FindingCode::input_in_residuals, "input_in_residuals", warning},
    {FindingCode::noise_law, "noise_law", warning},
    {FindingCode::disturbance_follows_states, "disturbance_follows_states", warning},
    {FindingCode::input_timing, "input_timing", warning},
    {FindingCode::input_rule, "input_rule", warning_or_note},
    {FindingCode::experiments_disagree, "experiments_disagree", warning},
    {FindingCode::member_far_off, "member_far_off", warning},
    {FindingCode::optimum_of_hierarchy, "optimum_of_hierarchy", warning},
    {FindingCode::hierarchy_narrows, "hierarchy_narrows", note},
    {FindingCode::diagnostics_on_thinned, "diagnostics_on_thinned", note},
    {FindingCode::new_experiment, "new_experiment", note},
    {FindingCode::constraint_drift, "constraint_drift", warning_or_note},
    {FindingCode::interrupted, "interrupted", error},
    {FindingCode::no_finite_start, "no_finite_start", error},
    {FindingCode::checkpoint_mismatch, "checkpoint_mismatch", error},
    {FindingCode::not_identifiable, "not_identifiable", error_or_warning},
    {FindingCode::nearly_confounded, "nearly_confounded", warning_or_note},
    {FindingCode::barely_narrowed, "barely_narrowed", warning_or_note},
    {FindingCode::disturbance_and_noise, "disturbance_and_noise", warning_or_note},
    {FindingCode::prior_fails, "prior_fails", any},
    {FindingCode::prior_far_from_data, "prior_far_from_data", warning},
    {FindingCode::prior_at_rest, "prior_at_rest", warning},
    {FindingCode::initial_far_off, "initial_far_off", warning},
    {FindingCode::candidates_alike, "candidates_alike", warning},
    {FindingCode::length_and_inputs, "length_and_inputs", warning},
    {FindingCode::input_band, "input_band", warning},
    {FindingCode::model_lost_by_chance, "model_lost_by_chance", warning},
    {FindingCode::few_effective_particles, "few_effective_particles", warning},
    {FindingCode::budget_spent, "budget_spent", warning},
    {FindingCode::selection_ended, "selection_ended", note},
    {FindingCode::reads_noise, "reads_noise", note},
    {FindingCode::distances_equal, "distances_equal", warning},
    {FindingCode::probabilities_disagree, "probabilities_disagree", warning},
    {FindingCode::threshold_above_noise, "threshold_above_noise", warning},
    {FindingCode::not_polished, "not_polished", warning},
    {FindingCode::width_of_threshold, "width_of_threshold", note},
    {FindingCode::averaged_over_models, "averaged_over_models", note},
    {FindingCode::weights_not_confirmed, "weights_not_confirmed", warning},
    {FindingCode::counted_once, "counted_once", note},
    {FindingCode::without_noise, "without_noise", note},
    {FindingCode::no_population, "no_population", error},
    {FindingCode::model_not_visited, "model_not_visited", error_or_warning},
    {FindingCode::jumps_rarely_accepted, "jumps_rarely_accepted", warning},
    {FindingCode::posterior_not_covered, "posterior_not_covered", error},
    {FindingCode::visits_disagree, "visits_disagree", error},
    {FindingCode::probabilities_imprecise, "probabilities_imprecise", warning},
    {FindingCode::coverage_low, "coverage_low", warning},
    {FindingCode::ranks_not_uniform, "ranks_not_uniform", error_or_warning},
    {FindingCode::replications_failed, "replications_failed", error_or_warning},
    {FindingCode::replications_fail_checks, "replications_fail_checks", warning_or_note},
    {FindingCode::ranks_of_dependent_draws, "ranks_of_dependent_draws", warning_or_note},
    {FindingCode::prior_redrawn, "prior_redrawn", warning_or_note},
    {FindingCode::backends_disagree, "backends_disagree", error_or_warning},
    {FindingCode::fitted_rows_predicted, "fitted_rows_predicted", note},
    {FindingCode::from_doubtful_fit, "from_doubtful_fit", any},
    {FindingCode::prior_contradicted, "prior_contradicted", warning},
    {FindingCode::optimum_alone, "optimum_alone", note},
    {FindingCode::searched_near, "searched_near", note},
    {FindingCode::improper_posterior, "improper_posterior", error},
    {FindingCode::propriety_not_checked, "propriety_not_checked", warning},
    {FindingCode::outside_range, "outside_range", warning},
    {FindingCode::basis_inaccurate, "basis_inaccurate", warning},
    {FindingCode::far_outside, "far_outside", warning},
    {FindingCode::duplicate_inputs, "duplicate_inputs", note},
    {FindingCode::length_beyond_range, "length_beyond_range", note},
    {FindingCode::unused_parameter, "unused_parameter", warning_or_note},
    {FindingCode::not_measured, "not_measured", error},
    {FindingCode::unequal_steps, "unequal_steps", error},
    {FindingCode::steps_interpolated, "steps_interpolated", warning_or_note},
    {FindingCode::too_few_rows, "too_few_rows", error},
    {FindingCode::record_at_rest, "record_at_rest", error},
    {FindingCode::nothing_to_explain, "nothing_to_explain", error},
    {FindingCode::no_term_left, "no_term_left", error},
    {FindingCode::term_always_zero, "term_always_zero", warning},
    {FindingCode::term_not_finite, "term_not_finite", warning},
    {FindingCode::terms_repeat, "terms_repeat", note},
    {FindingCode::terms_collinear, "terms_collinear", warning_or_note},
    {FindingCode::terms_nearly_collinear, "terms_nearly_collinear", warning_or_note},
    {FindingCode::terms_interchangeable, "terms_interchangeable", warning_or_note},
    {FindingCode::unexplained_residual, "unexplained_residual", warning_or_note},
    {FindingCode::residual_correlated, "residual_correlated", warning_or_note},
    {FindingCode::derivative_smoothed, "derivative_smoothed", note},
    {FindingCode::windows_missing, "windows_missing", note},
    {FindingCode::selection_not_settled, "selection_not_settled", warning_or_note},
    {FindingCode::equation_no_model, "equation_no_model", warning},
    {FindingCode::candidates_left_out, "candidates_left_out", warning},
    {FindingCode::form_undecided, "form_undecided", warning},
    {FindingCode::other_terms_fit, "other_terms_fit", warning_or_note},
    {FindingCode::simulation_prefers, "simulation_prefers", warning_or_note},
    {FindingCode::not_refitted, "not_refitted", warning},
    {FindingCode::term_idle, "term_idle", warning},
    {FindingCode::followed_in_parts, "followed_in_parts", note},
    {FindingCode::motion_unexplained, "motion_unexplained", warning},
    {FindingCode::noise_overestimated, "noise_overestimated", note},
    {FindingCode::draws_not_bounded, "draws_not_bounded", warning},
    {FindingCode::free_run_lost, "free_run_lost", warning_or_note},
    {FindingCode::parameter_changed, "parameter_changed", warning},
    {FindingCode::noise_changed, "noise_changed", warning},
    {FindingCode::filter_restarted, "filter_restarted", warning},
    {FindingCode::innovation_size, "innovation_size", warning},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < std::size(rows); ++i)
    if (static_cast<std::size_t>(rows[i].code) != i) return false;
  return rows[std::size(rows) - 1].code == FindingCode::innovation_size;
}
static_assert(in_order(), "a row for every code, in the order of FindingCode");

}  // namespace

std::span<FindingRow const> finding_table() { return rows; }

FindingRow const& row_of(FindingCode code) { return rows[static_cast<std::size_t>(code)]; }

std::string_view word(FindingCode code) { return row_of(code).word; }

std::optional<FindingCode> finding_code(std::string_view word) {
  auto const* const found = std::find_if(std::begin(rows), std::end(rows), [&](FindingRow const& row) { return row.word == word; });
  return found == std::end(rows) ? std::nullopt : std::optional(found->code);
}

}  // namespace sysid
