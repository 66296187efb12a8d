// The rows of the table of checks, and the reasons why a check does not apply.
#include "app/fit/fit_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/fit/experiment_checks.hpp"
#include "app/fit/hierarchies.hpp"
#include "app/fit/other_readings.hpp"
#include "app/fit/particle_comparison.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/written_model.hpp"
#include "core/system/lazily.hpp"
#include "core/text/source.hpp"
#include "data/scored_samples.hpp"
#include "diagnostics/bound_check.hpp"
#include "diagnostics/identifiability/influence_check.hpp"
#include "diagnostics/inputs/input_checks.hpp"
#include "diagnostics/law/disturbance_terms.hpp"
#include "diagnostics/member_check.hpp"
#include "diagnostics/model_checks.hpp"
#include "diagnostics/prior_checks.hpp"
#include "diagnostics/verdict.hpp"
#include "model/linear_states.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

std::string always(FinishedFit const&) { return {}; }

// --- before sampling
std::string without_proper_prior(FinishedFit const& fit) {
  Parameter const* improper = fit.likelihood.model().improper();
  return improper == nullptr ? std::string() : fmt::format("the prior of `{}` is improper", improper->name);
}

// --- the model and the record
Findings parameter_use(FinishedFit& fit) {
  Findings findings = check_use(fit.likelihood.model(), fit.what.start,
                                switched_off_by_arguments(fit.session, fit.likelihood.model().name), fit.result.draws.is_optimum());
  if (fit.result.interrupted) return findings;
  auto const names = [](Findings const& of, FindingCode code, std::string const& parameter) {
    return std::ranges::any_of(
        of, [&](Finding const& each) { return each.code == code && std::ranges::find(each.names, parameter) != each.names.end(); });
  };
  // What nothing uses lies where its prior has it.
  std::erase_if(fit.report.findings, [&](Finding const& each) {
    return each.code == FindingCode::at_bound && std::ranges::all_of(each.names, [&](std::string const& name) {
             return names(findings, FindingCode::unused_parameter, name);
           });
  });
  Findings flat = check_influence(fit.likelihood.space(), fit.target, fit.result.draws);
  std::erase_if(flat, [&](Finding const& each) {
    return names(fit.report.findings, FindingCode::flat_direction, each.names.front()) ||
           names(findings, FindingCode::unused_parameter, each.names.front());
  });
  findings.insert(findings.end(), flat.begin(), flat.end());
  return findings;
}

Findings residuals(FinishedFit& fit) {
  FitCheck check = fit.likelihood.check_residuals(fit.result, fit.report.draws);
  fit.report.fit = std::move(check.lines);
  if (std::ranges::any_of(check.findings, &doubts_columns)) {
    Findings const otherwise = check_other_readings(fit);
    check.findings.insert(check.findings.begin(), otherwise.begin(), otherwise.end());
  }
  return std::move(check.findings);
}

std::string without_timing(FinishedFit const& fit) {
  Model const& model = fit.likelihood.model();
  if (model.dynamics == Dynamics::none) return "the model uses no input between samples";
  if (model.inputs.empty()) return "the model has no input";
  // Each shift is a fit of all of them, and a function of several past samples takes most shifts up.
  if (model.dynamics == Dynamics::discrete && !model.processes.empty())
    return "in discrete time, the inputs of Gaussian processes are not shifted";
  if (fit.preparation.modes.empty()) return "the search found no mode";
  bool const explains = std::none_of(fit.report.findings.begin(), fit.report.findings.end(),
                                     [](Finding const& each) { return each.code == FindingCode::worse_than_the_mean; });
  return explains ? "" : "the fit explains nothing of a channel";
}

bool solves_at_mode(FinishedFit const& fit, std::vector<Experiment> const& experiments, SolverSettings const& solver) {
  std::vector<double> log_likelihood(1);
  Ledger untold;
  fit.likelihood.make_target(experiments, solver, fit.session.interruptible())
      ->log_likelihood(to_lanes({theta_of(fit.preparation.modes.front())}), log_likelihood, untold);
  return std::isfinite(log_likelihood.front());
}

// An exact step suits some rules between samples alone; the others are tried with adaptive steps, implicit ones where the model is
// stiff.
SolverSettings solver_along(FinishedFit const& fit, std::vector<Experiment> const& experiments) {
  SolverSettings const& solver = fit.preparation.solver;
  bool const suits = !solver.row().exact || std::ranges::all_of(experiments, [&](Experiment const& each) {
    return allows_exact_steps(each, fit.likelihood.model());
  });
  if (suits) return solver;
  SolverSettings const adaptive{.method = std::string(adaptive_solver().name)};
  return solves_at_mode(fit, experiments, adaptive) ? adaptive : SolverSettings{.method = std::string(stiff_solver().name)};
}

/// Of each experiment.
std::vector<LeftByFit> left_by(FinishedFit const& fit) {
  std::vector<LeftByFit> left;
  std::vector<Channel> const& channels = fit.likelihood.model().channels;
  for (Experiment const& experiment : experiments_of(fit.data)) {
    LeftByFit each;
    each.coloured = std::ranges::any_of(fit.report.findings, [&](Finding const& finding) {
      return (finding.code == FindingCode::residuals_not_white || finding.code == FindingCode::input_in_residuals) &&
             std::ranges::find(finding.names, experiment.name) != finding.names.end();
    });
    for (std::size_t c = 0; c < channels.size(); ++c) {
      int const scored = scored_count(experiment, c);
      for (FitLine const& line : fit.report.fit)
        if (line.channel == channels[c].name && line.experiment == experiment.name)
          each.squares += scored * find_score(line.scores, {ScoreKind::chi_squared}).value_or(0);
    }
    left.push_back(each);
  }
  return left;
}

Findings input_timing(FinishedFit& fit) {
  FitOfExperiments const remade{[&](std::vector<Experiment> experiments) {
                                  SolverSettings const solver = solver_along(fit, experiments);
                                  return fit.likelihood.make_target(std::move(experiments), solver, fit.session.interruptible());
                                },
                                [&](std::vector<Experiment> const& experiments, std::vector<double> const& sampled) {
                                  return fit.likelihood.log_densities(experiments, solver_along(fit, experiments), sampled);
                                }};
  return check_inputs(remade, fit.likelihood.model(), experiments_of(fit.data), fit.objective_kind, fit.preparation.modes.front(),
                      left_by(fit), fit.seed, fit.extra);
}

// --- the solver and unknown functions
std::string without_solver(FinishedFit const& fit) {
  if (!fit.likelihood.model().integrated()) return "the model has no differential equation";
  SolverSettings const& solver = fit.preparation.solver;
  return solver.row().exact ? fmt::format("`{}` is exact: it has no step to check", solver.method) : "";
}

// Draws are weighted again, an optimum is found again. A solver that was chosen has been compared with finer ones before, at the
// modes; one that the task states has not, so that several modes are found again, too.
Findings solver_accuracy(FinishedFit& fit) {
  Preparation const& preparation = fit.preparation;
  std::size_t const draws = fit.result.draws.total();
  auto const weighty = std::count_if(preparation.modes.begin(), preparation.modes.end(),
                                     [](Mode const& each) { return each.share > weight_of_interest; });
  Lazily<std::unique_ptr<Target>> kept;  // it holds all experiments once more
  auto const fine = [&]() -> Target const& {
    return *kept.get([&] {
      return fit.likelihood.make_target(experiments_of(fit.data), preparation.solver.finer(), fit.session.interruptible());
    });
  };
  SolverCheck check;
  if (fit.accuracy)
    check = *fit.accuracy;
  else if (draws > 1)
    check = check_draws(fit.target, fine(), fit.result.draws, preparation.modes, fit.seed, fit.extra);
  if (check.holds() && !fit.what.refine_solver && (draws == 1 || weighty > 1) && !preparation.modes.empty())
    check = check_modes(fine(), fit.objective_kind, preparation.modes, fit.seed, fit.extra);
  return tolerance_findings(check, preparation.solver, fit.what.refine_solver);
}

std::string without_linearisation(FinishedFit const& fit) {
  Model const& model = fit.likelihood.model();
  if (fit.what.filter != FilterRule::automatic && fit.what.filter != FilterRule::extended)
    return fmt::format("the filter is `{}`", filter_name(fit.what.filter));
  return find_nonlinear_in_states(model) ? "" : "the model is linear in its states, so that the filter is exact";
}

Findings linearisation(FinishedFit& fit) {
  auto const other = fit.likelihood.with_filter(FilterRule::unscented, experiments_of(fit.data), fit.preparation.solver,
                                                fit.session.interruptible());
  SolverCheck const check = fit.result.draws.total() > 1
                                ? check_draws(fit.target, *other, fit.result.draws, fit.preparation.modes, fit.seed, fit.extra)
                                : check_modes(*other, fit.objective_kind, fit.preparation.modes, fit.seed, fit.extra);
  return linearisation_findings(check);
}

std::string without_terms(FinishedFit const& fit) { return without_disturbance_terms(fit.likelihood.model(), fit.report.states); }

Findings disturbance_terms(FinishedFit& fit) {
  return check_disturbance_terms(fit.likelihood.model(), fit.report.states,
                                 [&](std::string const& name) { return mentions(fit.session.source, name); });
}

Findings particles(FinishedFit& fit) { return fit.likelihood.check_particles(fit.result); }

std::string without_finite_sums(FinishedFit const& fit) {
  return fit.likelihood.model().expansions.empty() ? "the model has no unknown function that is approximated by a finite sum" : "";
}

Findings functions(FinishedFit& fit) { return fit.likelihood.check_functions(fit.result); }

// --- the posterior
std::string without_hierarchy(FinishedFit const& fit) {
  auto const& parameters = fit.likelihood.model().parameters;
  bool const any =
      std::any_of(parameters.begin(), parameters.end(), [](Parameter const& each) { return each.per_experiment && each.prior; });
  return any ? "" : "no parameter is estimated per experiment";
}

Findings hierarchy(FinishedFit& fit) {
  if (fit.objective_kind == ObjectiveKind::likelihood) {
    Findings const found = check_populations(fit.likelihood.model());
    // What the likelihood does not contain is of course flat in it.
    auto const of_population = [&](std::string const& name) {
      return !found.empty() && std::find(found.front().names.begin(), found.front().names.end(), name) != found.front().names.end();
    };
    std::erase_if(fit.report.findings, [&](Finding const& each) {
      return each.code == FindingCode::flat_direction && std::all_of(each.names.begin(), each.names.end(), of_population);
    });
    return found;
  }
  std::vector<std::string> non_centred;
  if (ParameterSpace const* const space = fit.likelihood.with_hierarchies())
    non_centred = parameters_of(*space, fit.preparation.standardised);
  Findings found = check_hierarchy(fit.likelihood.model(), fit.result.draws, fit.report.findings, non_centred);
  for (Finding& each : check_members(fit.likelihood.space(), fit.report.draws)) found.push_back(std::move(each));
  return found;
}

Findings failed_solves(FinishedFit& fit) { return failure_findings(fit.sampling); }

Findings bounds(FinishedFit& fit) {
  constexpr double nothing = 90;  // nmse [%] and above
  std::vector<FitLine> const& lines = fit.report.fit;
  bool const explains_nothing = !lines.empty() && std::ranges::all_of(lines, [](FitLine const& line) {
    return find_score(line.scores, {ScoreKind::nmse}).value_or(0) >= nothing;
  });
  return check_bounds(fit.target.parameters(), fit.result.draws, fit.report.priors, explains_nothing);
}

// --- the fitted rows
std::string without_constraints(FinishedFit const& fit) {
  return fit.likelihood.model().invariants.empty() ? "no constraint of the model was differentiated" : "";
}

Findings all_rows(FinishedFit const& fit, Findings FittedRows::*part) {
  Findings all;
  for (FittedRows const& rows : fit.rows) all.insert(all.end(), (rows.*part).begin(), (rows.*part).end());
  return all;
}

Findings constraint_drift(FinishedFit& fit) { return all_rows(fit, &FittedRows::drift); }

// Of derived quantities that do not change along a record, and whose summary is of all draws.
Findings undefined_draws(Draws const& draws) {
  Findings findings;
  for (auto c = static_cast<std::size_t>(draws.parameter_count); c < draws.names.size(); ++c) {
    std::vector<double> const values = draws.column(c);
    auto const undefined = std::ranges::count_if(values, [](double each) { return !std::isfinite(each); });
    if (undefined == 0) continue;
    Severity const severity = failure_severity(static_cast<std::uint64_t>(undefined), values.size());
    findings.push_back({FindingCode::undefined_in_band,
                        severity == Severity::error ? Severity::warning : severity,  // the others are what they are
                        {draws.names[c]},
                        values.size() == 1 ? fmt::format("{} is undefined at the optimum", draws.names[c])
                                           : fmt::format("{} is undefined at {} of {} draws, so it has no mean and no quantiles",
                                                         draws.names[c], undefined, values.size()),
                        "check for a root or a logarithm of a negative number, or a division by zero"});
  }
  return findings;
}

Findings bands(FinishedFit& fit) {
  Findings all = all_rows(fit, &FittedRows::bands);
  for (Finding& each : undefined_draws(fit.report.draws)) all.push_back(std::move(each));
  return all;
}

Findings priors(FinishedFit& fit) {
  if (fit.objective_kind != ObjectiveKind::likelihood) return check_priors(fit.report);
  return check_priors(fit.report, Maxima{fit.result.modes, fit.target.parameters()});
}

constexpr FitCheckRow rows[] = {
    {"prior_size", true, &without_proper_prior, nullptr},
    {"parameter_use", true, &always, &parameter_use},
    {"residuals", false, &always, &residuals},
    {"input_timing", false, &without_timing, &input_timing},
    {"shared_parameters", false, &without_shared_parameters, &check_shared_parameters},
    {"solver_accuracy", false, &without_solver, &solver_accuracy},
    {"linearisation", false, &without_linearisation, &linearisation, true},
    {"against_particles", false, &without_particle_comparison, &compare_with_particles, true, false, true},
    {"particles", false, &always, &particles, true, true},
    {"disturbance_terms", false, &without_terms, &disturbance_terms, true},
    {"finite_sums", false, &without_finite_sums, &functions},
    {"hierarchy", false, &without_hierarchy, &hierarchy},
    {"failed_solves", true, &always, &failed_solves},
    {"bounds", false, &always, &bounds},
    {"constraint_drift", false, &without_constraints, &constraint_drift},
    {"bands", false, &always, &bands},
    {"priors", false, &always, &priors},
};

bool concerns(FitCheckRow const& row, FinishedFit const& fit) {
  Model const& model = fit.likelihood.model();
  bool const by_particles = fit.what.filter == FilterRule::particle;
  if ((row.of_filters && !model.filtered()) || (row.of_particles && !by_particles)) return false;
  return !row.of_moments || (!by_particles && find_nonlinear_in_states(model));
}

}  // namespace

std::span<FitCheckRow const> fit_check_rows() { return rows; }

void run_fit_checks(FinishedFit& fit) {
  for (FitCheckRow const& row : rows) {
    if (!concerns(row, fit)) continue;
    std::string const skipped = fit.result.interrupted && !row.of_interrupted ? "the fit was interrupted" : row.inapplicable(fit);
    fit.report.checks.push_back({std::string(row.name), skipped});
    if (!skipped.empty() || row.run == nullptr) continue;
    for (Finding& finding : row.run(fit)) fit.report.findings.push_back(std::move(finding));
  }
}

}  // namespace sysid
