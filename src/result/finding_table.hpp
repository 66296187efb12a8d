// The codes of findings: one enumerator and one row each, in the order of docs/errors/findings.md, which has a section for every
// row. Adding a finding is an enumerator, a row and a section.
#pragma once
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>

#include "core/text/diagnostic.hpp"

namespace sysid {

enum class FindingCode {
  chain_did_not_move,
  few_distinct_states,
  chains_disagree,
  chains_not_quite_agreed,
  ess_bulk_low,
  ess_tail_low,
  replicas_do_not_mix,
  trajectories_diverge,
  trajectories_cut,
  no_diagnostics,
  integration_step,
  linearisation_matters,
  likelihood_too_noisy,
  particles_degenerate,
  noise_in_lines,
  step_not_settled,
  stiff_prior,
  slower_solver,
  noise_size,
  made_from_earlier,
  looks_missing,
  column_constant,
  sensor_stuck,
  time_gap,
  time_scales_apart,
  times_rounded,
  rate_contradicted,
  column_used_twice,
  sign_reversed,
  samples_repeated,
  unit_in_name,
  unit_in_file,
  samples_far_off,
  explains_little,
  worse_than_the_mean,
  failed_solves,
  failed_predictions,
  undefined_in_band,
  second_mode,
  flat_direction,
  piles_up_at_bound,
  at_bound,
  optimum_not_reached,
  widths_not_normal,
  residual_offset,
  residual_trend,
  residuals_not_white,
  input_in_residuals,
  noise_law,
  disturbance_follows_states,
  input_timing,
  input_rule,
  experiments_disagree,
  member_far_off,
  optimum_of_hierarchy,
  hierarchy_narrows,
  diagnostics_on_thinned,
  new_experiment,
  constraint_drift,
  interrupted,
  no_finite_start,
  checkpoint_mismatch,
  not_identifiable,
  nearly_confounded,
  barely_narrowed,
  disturbance_and_noise,
  prior_fails,
  prior_far_from_data,
  prior_at_rest,
  initial_far_off,
  candidates_alike,
  length_and_inputs,
  input_band,
  model_lost_by_chance,
  few_effective_particles,
  budget_spent,
  selection_ended,
  reads_noise,
  distances_equal,
  probabilities_disagree,
  threshold_above_noise,
  not_polished,
  width_of_threshold,
  averaged_over_models,
  weights_not_confirmed,
  counted_once,
  without_noise,
  no_population,
  model_not_visited,
  jumps_rarely_accepted,
  posterior_not_covered,
  visits_disagree,
  probabilities_imprecise,
  coverage_low,
  ranks_not_uniform,
  replications_failed,
  replications_fail_checks,
  ranks_of_dependent_draws,
  prior_redrawn,
  backends_disagree,
  fitted_rows_predicted,
  from_doubtful_fit,
  prior_contradicted,
  optimum_alone,
  searched_near,
  improper_posterior,
  propriety_not_checked,
  outside_range,
  basis_inaccurate,
  far_outside,
  duplicate_inputs,
  length_beyond_range,
  unused_parameter,
  not_measured,
  unequal_steps,
  steps_interpolated,
  too_few_rows,
  record_at_rest,
  nothing_to_explain,
  no_term_left,
  term_always_zero,
  term_not_finite,
  terms_repeat,
  terms_collinear,
  terms_nearly_collinear,
  terms_interchangeable,
  unexplained_residual,
  residual_correlated,
  derivative_smoothed,
  windows_missing,
  selection_not_settled,
  equation_no_model,
  candidates_left_out,
  form_undecided,
  other_terms_fit,
  simulation_prefers,
  not_refitted,
  term_idle,
  followed_in_parts,
  motion_unexplained,
  noise_overestimated,
  draws_not_bounded,
  free_run_lost,
  parameter_changed,
  noise_changed,
  filter_restarted,
  innovation_size,
};

/// The severities that a finding may have; several where the size of what was found decides, or the task it was found in.
class Severities {
 public:
  constexpr Severities(std::initializer_list<Severity> all) {
    for (Severity const each : all) bits_ |= bit(each);
  }
  constexpr bool contains(Severity severity) const { return (bits_ & bit(severity)) != 0; }

 private:
  static constexpr unsigned bit(Severity severity) { return 1U << static_cast<unsigned>(severity); }
  unsigned bits_ = 0;
};

struct FindingRow {
  FindingCode code;
  std::string_view word;  // as summaries hold it and `sysid explain` takes it; heads its section in docs/errors/findings.md
  Severities severities;
};

/// In the order of FindingCode.
std::span<FindingRow const> finding_table();

FindingRow const& row_of(FindingCode code);
std::string_view word(FindingCode code);
std::optional<FindingCode> finding_code(std::string_view word);

}  // namespace sysid
