// Draws weighted again by a finer solver, modes found again with it, and what is said of either.
#include "diagnostics/tolerance/tolerance_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/numeric/elementary.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "diagnostics/convergence.hpp"
#include "search/mode/moves.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

constexpr int first_draws = 200, more_draws = 2000;
constexpr double certain = 3;      // standard errors
constexpr double many_fail = 0.2;  // share of the draws
constexpr std::size_t most_named = 3;

using Moved = SolverCheck::Moved;

/// Of the mean of each parameter, over all draws; what has none is not counted as fewer.
std::vector<double> effective_draws(Draws const& draws, int parameters) {
  std::vector<double> all;
  for (int p = 0; p < parameters; ++p) all.push_back(ess_mean(chains_of(draws, static_cast<std::size_t>(p))));
  return all;
}

/// exp(fine - coarse) with a mean of 1; 0 where the finer solver fails. Their failed share goes to `failed`.
std::vector<double> weights_of(Target const& coarse, Target const& fine, ConstLanes theta, double& failed, Ledger& ledger) {
  std::vector<double> before(static_cast<std::size_t>(theta.width())), weights(before);
  coarse.log_likelihood(theta, before, ledger);
  fine.log_likelihood(theta, weights, ledger);
  double most = -INFINITY, sum = 0;
  int lost = 0;
  for (std::size_t w = 0; w < weights.size(); ++w) {
    weights[w] -= before[w];
    if (!std::isfinite(weights[w])) ++lost, weights[w] = -INFINITY;
    most = std::max(most, weights[w]);
  }
  failed = static_cast<double>(lost) / theta.width();
  for (double& weight : weights) sum += weight = std::isfinite(weight) ? elementary::exp(weight - most) : 0;
  for (double& weight : weights) weight *= sum > 0 ? theta.width() / sum : 0;
  return weights;
}

}  // namespace

bool Reweighting::usable() const { return effective >= 50 && effective >= 0.1 * draws; }

Reweighting reweigh(Target const& coarse, Target const& fine, Draws const& draws, int count, Ledger& ledger) {
  LaneArray const declared = spread(draws, count);
  int const n = declared.width(), dimension = coarse.dimension();
  LaneArray theta(dimension, n);
  coarse.unconstrain(declared, theta);
  Reweighting result;
  result.draws = n;
  std::vector<double> const weights = weights_of(coarse, fine, theta, result.failed, ledger);
  double squares = 0;
  for (double const weight : weights) squares += weight * weight;
  result.effective = squares > 0 ? static_cast<double>(n) * n / squares : 0;
  std::vector<double> const effective = effective_draws(draws, dimension);
  for (int p = 0; p < dimension; ++p) {
    double mean = 0, weighted = 0, variance = 0, influence = 0;
    for (int w = 0; w < n; ++w) {
      mean += declared(p, w) / n;
      weighted += weights[static_cast<std::size_t>(w)] * declared(p, w) / n;
    }
    for (int w = 0; w < n; ++w) {
      double const from_mean = declared(p, w) - mean;
      double const part = weights[static_cast<std::size_t>(w)] * (declared(p, w) - weighted) - from_mean;
      variance += from_mean * from_mean / n;
      influence += part * part / n;
    }
    bool const varies = variance > 0;
    double const known = effective[static_cast<std::size_t>(p)];
    double const fewer = std::isfinite(known) && known < n ? std::sqrt(n / std::max(1.0, known)) : 1;
    result.move.push_back(varies ? std::abs(weighted - mean) / std::sqrt(variance) : 0);
    result.error.push_back(varies ? fewer * std::sqrt(influence / variance / n) : 0);
  }
  return result;
}

namespace {

/// Named by its parameter, if it has one.
Moved named(Target const& target, int parameter, double move, double error) {
  ParameterInfo const& info = target.parameters()[static_cast<std::size_t>(parameter)];
  return {info.name, info.unit, move, error, 0, 0};
}

/// The largest first, and no more than are named.
void rank(std::vector<Moved>& moved) {
  std::stable_sort(moved.begin(), moved.end(), [](Moved const& a, Moved const& b) { return a.move > b.move; });
  if (moved.size() > most_named) moved.resize(most_named);
}

/// What weighted draws show; empty where they leave it open.
std::optional<SolverCheck> decided(Target const& target, Reweighting const& weighted) {
  if (weighted.failed > many_fail) return SolverCheck{.outcome = SolverCheck::Outcome::fails, .failed = weighted.failed};
  if (!weighted.usable()) return std::nullopt;
  SolverCheck check;
  bool small = true, large = false;
  for (std::size_t p = 0; p < weighted.move.size(); ++p) {
    double const move = weighted.move[p], margin = certain * weighted.error[p];
    small = small && move + margin <= tolerable_move;
    large = large || move - margin > tolerable_move;
    if (move - margin > tolerable_move) check.moved.push_back(named(target, static_cast<int>(p), move, weighted.error[p]));
  }
  if (small) return check;
  if (!large) return std::nullopt;
  check.outcome = SolverCheck::Outcome::mean_moves;
  rank(check.moved);
  return check;
}

std::vector<Mode> of_weight(std::vector<Mode> const& modes) {
  std::vector<Mode> weighty;
  for (Mode const& mode : modes)
    if (weighty.empty() || mode.share > weight_of_interest) weighty.push_back(mode);
  return weighty;
}

std::vector<double> sds_of(Draws const& draws, int parameters) {
  std::vector<double> sds;
  for (int p = 0; p < parameters; ++p) {
    std::vector<double> const values = draws.column(static_cast<std::size_t>(p));
    sds.push_back(std::sqrt(population_variance(values)));
  }
  return sds;
}

/// Where values move; `draws`: in their sds where they are of one mode.
SolverCheck found_again(Target const& fine, Draws const& draws, std::vector<Mode> const& modes, std::uint64_t seed,
                        Ledger& ledger) {
  std::vector<Mode> weighty = of_weight(modes);
  if (weighty.size() == 1) weighty.front().sd = sds_of(draws, fine.dimension());
  std::vector<double> gains;
  std::vector<Mode> const refined = refit(fine, ObjectiveKind::posterior, weighty, seed, ledger, {}, &gains);
  SolverCheck check;
  for (std::size_t m = 0; m < refined.size() && check.holds(); ++m) {
    for (Move const& move : moves_between(fine.parameters(), weighty[m], refined[m], gains[m])) {
      if (!std::isfinite(move.value)) return {.outcome = SolverCheck::Outcome::fails, .failed = 1};
      if (move.value > tolerable_move) check.moved.push_back(named(fine, move.parameter, move.value, 0));
    }
    if (!check.moved.empty()) check.outcome = SolverCheck::Outcome::mode_moves;
  }
  rank(check.moved);
  return check;
}

}  // namespace

SolverCheck check_draws(Target const& coarse, Target const& fine, Draws const& draws, std::vector<Mode> const& modes,
                        std::uint64_t seed, Ledger& ledger) {
  for (int const count : {first_draws, more_draws}) {
    Reweighting const weighted = reweigh(coarse, fine, draws, count, ledger);
    if (auto const check = decided(fine, weighted)) return *check;
    // More draws do not help weights that a few of them bear.
    if (static_cast<std::size_t>(count) >= draws.total() || weighted.effective < 0.02 * weighted.draws) break;
  }
  return found_again(fine, draws, modes, seed, ledger);
}

SolverCheck check_estimates(Target const& coarse, Target const& fine, Draws const& draws, Ledger& ledger) {
  constexpr int count = 1000;
  constexpr double likely = 1.5;  // standard errors: a margin as wide as that of computed likelihoods would see little
  Reweighting const weighted = reweigh(coarse, fine, draws, count, ledger);
  SolverCheck check;
  if (weighted.failed > many_fail) return {.outcome = SolverCheck::Outcome::fails, .failed = weighted.failed};
  for (std::size_t p = 0; p < weighted.move.size(); ++p)
    if (weighted.move[p] - likely * weighted.error[p] > tolerable_move)
      check.moved.push_back(named(fine, static_cast<int>(p), weighted.move[p], weighted.error[p]));
  if (check.moved.empty()) return check;
  check.outcome = SolverCheck::Outcome::mean_moves;
  rank(check.moved);
  return check;
}

SolverCheck check_modes(Target const& fine, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                        Ledger& ledger) {
  std::vector<Mode> const weighty = of_weight(modes);
  std::vector<double> gains;
  std::vector<Mode> const refined = refit(fine, objective_kind, weighty, seed, ledger, {}, &gains);
  double most = 0;
  for (std::size_t m = 0; m < refined.size(); ++m) {
    SolverCheck values{.outcome = SolverCheck::Outcome::mode_moves}, widths{.outcome = SolverCheck::Outcome::width_moves};
    for (Move const& move : moves_between(fine.parameters(), refined[m], weighty[m], gains[m])) {
      auto const p = static_cast<std::size_t>(move.parameter);
      most = std::max(most, move.value);
      if (!std::isfinite(move.value)) return {.outcome = SolverCheck::Outcome::fails, .failed = 1};
      if (move.value > tolerable_move) values.moved.push_back(named(fine, move.parameter, move.value, 0));
      if (move.size() <= tolerable_move) continue;
      widths.moved.push_back(named(fine, move.parameter, move.size(), 0));
      widths.moved.back().sd = weighty[m].sd[p];
      widths.moved.back().finer_sd = refined[m].sd[p];
    }
    for (SolverCheck* check : {&values, &widths}) {
      if (check->moved.empty()) continue;
      rank(check->moved);
      return *check;
    }
  }
  auto const apart = static_cast<int>(merged(refined).size()), before = static_cast<int>(refined.size());
  SolverCheck check;
  check.most = most;
  if (apart < before) {
    check.outcome = SolverCheck::Outcome::modes_merge;
    check.modes = before;
    check.apart = apart;
  }
  return check;
}

namespace {

std::string sds(double value) {
  return value > 1000 ? "more than 1000" : value >= 10 ? fmt::format("{:.0f}", value) : fmt::format("{:.2g}", value);
}

/// "k moves by 0.35 sd", "the mean of k moves by 0.35 +- 0.04 sd, the mean of m by 0.2 +- 0.03 sd".
std::string moves_text(SolverCheck const& check, bool conditional) {
  bool const mean = check.outcome == SolverCheck::Outcome::mean_moves;
  std::string text;
  for (Moved const& each : check.moved) {
    bool const first = text.empty();
    text += fmt::format("{}{}{}{}by {}{} sd", first ? "" : ", ", mean ? "the mean of " : "", each.parameter,
                        first ? (conditional ? " would move " : " moves ") : " ", sds(each.move),
                        mean ? fmt::format(" +- {:.1g}", each.error) : std::string());
  }
  return text;
}

std::string what_happens(SolverCheck const& check, bool conditional) {
  auto const verb = [&](char const* now, char const* then) { return std::string(conditional ? then : now); };
  switch (check.outcome) {
    case SolverCheck::Outcome::holds:
      return {};
    case SolverCheck::Outcome::mean_moves:
    case SolverCheck::Outcome::mode_moves:
      return moves_text(check, conditional);
    case SolverCheck::Outcome::width_moves: {
      Moved const& worst = check.moved.front();
      std::string const unit = unit_after_number(worst.unit);
      return fmt::format("the optimum {} the same, but the curvature around it {}: the sd of {} {} {:.2g}{} in place of {:.2g}{}",
                         verb("stays", "would stay"), verb("changes", "would change"), worst.parameter, verb("is", "would be"),
                         worst.finer_sd, unit, worst.sd, unit);
    }
    case SolverCheck::Outcome::modes_merge:
      return fmt::format("only {} of the {} modes that were found {} distinct", check.apart, check.modes,
                         verb("remain", "would remain"));
    case SolverCheck::Outcome::fails:
      return check.failed < 1
                 ? fmt::format("the simulations of {:.0f} % of the draws {}", 100 * check.failed, verb("fail", "would fail"))
                 : "the simulation " + verb("fails", "would fail") + " at the result";
  }
  return {};
}

std::string cure(SolverCheck const& check, SolverSettings const& solver, bool chosen) {
  std::string const kind = solver.fixed_step() ? "`substeps`" : "the tolerances";
  if (check.outcome == SolverCheck::Outcome::fails && !solver.fixed_step())
    return fmt::format("a tighter tolerance needs more steps between two samples: fit again with more `steps` (now {})",
                       solver.steps);
  std::string const other = solver.other_methods();
  if (!solver.finer().within_limits())
    return other.empty() ? "this solver cannot be made finer: the model may be chaotic on this record; fit a shorter part of it"
                         : fmt::format("this solver cannot be made finer: fit with {}", other);
  SolverSettings const needed = fine_enough(solver, check.largest());
  std::string const finer = needed.option();
  constexpr int too_many = 16;  // times as many steps as now, by a method of low order
  if (solver.fixed_step() && solver.row().order < SolverSettings{}.row().order && needed.substeps > too_many * solver.substeps)
    return fmt::format("fit with `solver = {}`, whose steps are chosen automatically: {} would need `substeps = {}`",
                       SolverSettings{}.method, solver.method, needed.substeps);
  return chosen ? fmt::format("fit again with `{}` or finer", finer)
                : fmt::format("fit again with `{}`, or remove {}, which {} then chosen automatically", finer, kind,
                              solver.fixed_step() ? "is" : "are");
}

}  // namespace

Findings tolerance_findings(SolverCheck const& check, SolverSettings const& solver, bool chosen) {
  if (check.holds()) return {};
  std::vector<std::string> names;
  for (Moved const& each : check.moved) names.push_back(each.parameter);
  if (solver.as_model)
    return {{FindingCode::integration_step, Severity::note, std::move(names),
             fmt::format("{} is part of the model: with {}, {}", solver.text(), solver.finer_words(), what_happens(check, true)),
             "use the estimates only with this integrator; for another one, fit again"}};
  return {{FindingCode::integration_step, Severity::error, std::move(names),
           fmt::format("the integration {} changes the result: with {}, {}", solver.fixed_step() ? "step" : "tolerance",
                       solver.finer_words(), what_happens(check, false)),
           cure(check, solver, chosen)}};
}

Findings linearisation_findings(SolverCheck const& check) {
  constexpr double matters = 1.0 / 3, decides = 1;  // sds
  bool const moves = check.outcome == SolverCheck::Outcome::mean_moves || check.outcome == SolverCheck::Outcome::mode_moves;
  if (check.holds() || (moves && std::fabs(check.largest()) < matters)) return {};
  std::vector<std::string> names;
  for (Moved const& each : check.moved) names.push_back(each.parameter);
  bool const severe = check.outcome == SolverCheck::Outcome::fails || (moves && std::fabs(check.largest()) > decides);
  return {
      {FindingCode::linearisation_matters, severe ? Severity::error : Severity::warning, std::move(names),
       fmt::format("the linearisation of the filter changes the result: with `filter = unscented`, {}", what_happens(check, false)),
       "fit with `filter = unscented`, which does not linearise; if the result then still depends on the filter, the "
       "disturbance is too large for a filter that describes the states by mean and covariance: use `filter = particle`"}};
}

SolverSettings fine_enough(SolverSettings const& solver, double move) {
  constexpr double aim = tolerable_move / 2;
  SolverSettings result = solver.finer();
  double const fall = solver.fixed_step() ? static_cast<double>(1 << solver.row().order) : 100;
  for (double left = move / fall; left > aim && result.finer().within_limits(); left /= fall) result = result.finer();
  return result;
}

}  // namespace sysid
