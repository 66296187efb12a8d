// Point estimates from the global search.
#include "inference/optimum.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "diagnostics/bound_check.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/evidence/weighted_draws.hpp"
#include "search/global/search.hpp"
#include "search/journal.hpp"
#include "search/laplace.hpp"
#include "search/mode/at_bound.hpp"
#include "search/objective.hpp"
#include "search/settle.hpp"

namespace sysid::optimum {
namespace {

constexpr std::uint64_t bound_step = 8'000'000;  // of Purpose::start

std::string cure_at_bounds(Target const& target, std::vector<ModeAtBound> const& bounds) {
  std::string const widen = "widen the prior if the bound is not physical, or use mh, which describes the whole posterior";
  for (ModeAtBound const& each : bounds) {
    ParameterInfo const& parameter = target.parameters()[static_cast<std::size_t>(each.parameter)];
    if (each.upper || !(parameter.lower >= 0) || parameter.size_alone) continue;
    std::string const sign = wrong_sign_at_bound(parameter.name, parameter.lower);
    return parameter.lower > 0 ? widen + "; " + sign : sign + "; otherwise use mh, which describes the whole posterior";
  }
  return widen;
}

/// Whether and where the optimum lies at bounds.
Finding at_bounds(Target const& target, Mode const& best, std::vector<ModeAtBound> const& bounds) {
  std::vector<std::string> names, values, endless;
  for (ModeAtBound const& each : bounds) {
    ParameterInfo const& parameter = target.parameters()[static_cast<std::size_t>(each.parameter)];
    double const value = best.declared[static_cast<std::size_t>(each.parameter)];
    names.push_back(parameter.name);
    values.push_back(fmt::format("{} = {:.4g}{} ({} bound {})", parameter.name, value, unit_after_number(parameter.unit),
                                 each.upper ? "upper" : "lower", shortest(each.upper ? parameter.upper : parameter.lower)));
    if (each.unbounded)
      endless.push_back(fmt::format("`{}` approaches {:.4g}", parameter.name, each.upper ? parameter.upper : parameter.lower));
  }
  std::string const others = bounds.size() < best.declared.size()
                                 ? fmt::format(", and the other sds are computed with {} fixed there", quoted(names))
                                 : std::string();
  std::string const sds = fmt::format("{} not meaningful{}", names.size() == 1 ? "its sd is" : "their sds are", others);
  std::string message = fmt::format("the optimum lies at a bound of the prior: {}; {}", fmt::join(values, ", "), sds);
  if (!endless.empty())
    message = fmt::format("the density has no maximum, since it grows without end as {}: {}; {}", fmt::join(endless, " and as "),
                          fmt::join(values, ", "), sds);
  return {FindingCode::at_bound, Severity::warning, std::move(names), std::move(message),
          endless.empty() ? cure_at_bounds(target, bounds)
                          : "use mh, which describes the whole posterior, or a prior whose density is finite at the bound"};
}

/// Of an optimum that was not reached.
Finding not_reached(Mode const& mode) {
  return {FindingCode::optimum_not_reached,
          Severity::error,
          {},
          fmt::format(
              "the search ended before it reached an optimum: the next step is predicted to raise the log density by {:.2g}, {}",
              mode.gain, mode.stalled ? "but no step that was tried raises it" : "and the search has used up its rounds"),
          mode.stalled
              ? "make the solver more accurate, for example `solver = cvode(relative = 1e-9)`, fix parameters that the data "
                "do not determine, or sample with mh"
              : "fit again with `search = near(...)` to continue from this result, or sample with mh"};
}

/// A parameter whose posterior has another width or place than its normal distribution at the optimum.
struct Misfit {
  std::size_t parameter;
  double ratio, shift;  // of the widths, posterior over stated; of the mean, in sds of the posterior

  bool wrong() const { return ratio > 1.5 || ratio < 0.5; }
  bool notable() const { return wrong() || ratio > 1.3 || ratio < 0.75 || std::fabs(shift) > 0.65; }
  double size() const { return std::max(std::fabs(std::log(ratio)), 0.4 * std::fabs(shift)); }
};

/// skipped: their sds are known to mean nothing. The largest first.
std::vector<Misfit> misfits(Mode const& best, WeightedDraws const& draws, std::vector<ModeAtBound> const& skipped) {
  std::vector<Misfit> found;
  for (std::size_t p = 0; p < best.sd.size(); ++p) {
    bool flat =
        std::any_of(skipped.begin(), skipped.end(), [&](ModeAtBound const& each) { return each.parameter == static_cast<int>(p); });
    for (std::size_t at = p; at < best.flat.size(); at += best.sd.size()) flat = flat || best.flat[at] != 0;
    if (flat || !(best.sd[p] > 0)) continue;
    Misfit const each{p, draws.sd[p] / best.sd[p], (draws.mean[p] - best.declared[p]) / draws.sd[p]};
    if (each.notable()) found.push_back(each);
  }
  std::stable_sort(found.begin(), found.end(), [](Misfit const& a, Misfit const& b) { return a.size() > b.size(); });
  return found;
}

Finding widths_wrong(Target const& target, Mode const& best, WeightedDraws const& draws, std::vector<Misfit> const& found) {
  std::vector<std::string> names;
  for (Misfit const& each : found) names.push_back(target.parameters()[each.parameter].name);
  std::size_t const p = found.front().parameter;
  bool const wrong = std::any_of(found.begin(), found.end(), [](Misfit const& each) { return each.wrong(); });
  ParameterInfo const& worst = target.parameters()[p];
  std::string const others =
      found.size() > 1 ? fmt::format("; the same holds for {}", counted(found.size() - 1, "further parameter")) : "";
  return {FindingCode::widths_not_normal, wrong ? Severity::error : Severity::warning, std::move(names),
          fmt::format("the posterior is not normal around its optimum: {} {} = {:.3g} ± {:.2g}{}, the "
                      "Laplace approximation {:.3g} ± {:.2g}{}{}{}",
                      draws.walked && !draws.confirmed ? "an ensemble of short chains gives" : "weighted draws give", worst.name,
                      draws.mean[p], draws.sd[p], unit_after_number(worst.unit), best.declared[p], best.sd[p],
                      unit_after_number(worst.unit), others,
                      draws.confirmed ? "" : "; these draws are too few to determine the sds, which may be larger still"),
          "fit with mh to get the sds of the posterior; use only the optimum of this result"};
}

/// Of a posterior that weighted draws do not describe, and that was too dear for walkers.
Finding widths_unknown() {
  return {FindingCode::widths_not_normal,
          Severity::warning,
          {},
          "whether the posterior has the stated sds is not known: the posterior is not normal around its optimum, and weighted "
          "draws do not determine its width",
          "fit with mh to get the sds of the posterior; use only the optimum of this result"};
}

/// A place that is not on the hill of the best mode, or on a part of it that the search has not climbed.
bool is_higher(Target const& target, Eigen::VectorXd const& place, Mode const& best, std::uint64_t seed, Ledger& ledger) {
  constexpr double higher = 1;  // nats
  Objective const objective = make_objective(target, ObjectiveKind::declared_posterior, seed, bound_step);
  return objective.log_density(to_lanes({place}), ledger).front() > best.log_density + higher;
}

/// Whether the posterior has the widths of the normal distribution at its highest mode. Several modes are a finding of their own.
/// higher: set where draws have found a higher place.
std::optional<Finding> check_widths(Target const& target, std::vector<Mode> const& modes, std::vector<ModeAtBound> const& at_bound,
                                    RunContext& context, std::vector<double>& higher) {
  Ledger extra;
  auto const stop = [&] { return context.stop_requested(); };
  std::vector<Mode> const sampled = sampled_modes(target, ObjectiveKind::declared_posterior, modes, context.seed, extra, stop);
  bool const one = sampled.size() == 1;
  WeightedDraws const draws = weighted_draws(target, sampled, context.seed, extra, stop, one ? &modes.front() : nullptr);
  if (draws.draws == 0 || draws.sd.empty()) return std::nullopt;
  bool const endless = std::ranges::any_of(at_bound, &ModeAtBound::unbounded);
  if (!endless && is_higher(target, draws.highest, modes.front(), context.seed, extra))
    higher.assign(draws.highest.begin(), draws.highest.end());
  if (!one) return std::nullopt;
  std::vector<Misfit> const found = misfits(modes.front(), draws, at_bound);
  bool const some = !found.empty() && (draws.confirmed || draws.walked || found.front().wrong());
  if (some) return widths_wrong(target, modes.front(), draws, found);
  // What walkers find as wide as stated is, though the weights are poor, as they are with many parameters.
  if (draws.confirmed || draws.walked || !at_bound.empty() || !modes.front().flat.empty()) return std::nullopt;
  return widths_unknown();
}

void write_draw(Target const& target, Mode const& mode, RunContext& context, FitResult& result) {
  for (ParameterInfo const& parameter : target.parameters()) {
    result.draws.names.push_back(parameter.name);
    result.draws.units.push_back(parameter.unit);
  }
  result.draws.parameter_count = target.dimension();
  LaneArray const theta = to_lanes({theta_of(mode)});
  double log_prior = 0, declared_prior = 0, log_likelihood = 0;
  target.log_prior(theta, {&log_prior, 1}, true);
  target.log_prior(theta, {&declared_prior, 1}, false);
  target.log_likelihood(theta, {&log_likelihood, 1}, context.ledger);
  result.draws.chains.push_back({{mode.declared}, {declared_prior}, {log_likelihood}, {log_prior + log_likelihood}, {1.0}});
}

/// What is known, or what a search finds that keeps its steps; nothing where a checkpoint holds another search.
std::optional<SearchResult> modes_for(Target const& target, ObjectiveKind objective_kind, nlohmann::json const& identity,
                                      RunContext& context, FitResult& result) {
  if (!context.modes.empty()) return SearchResult{context.modes, context.mode_findings, {}, false};
  if (!context.checkpoint && !context.resume) return search(target, objective_kind, context);
  std::optional<SearchResult> found;
  result.failure = checkpoint::read([&] {
    auto const save = [&](nlohmann::json const& steps) {
      if (context.checkpoint) context.checkpoint({{"identity", identity}, {"journal", steps}});
    };
    Journal journal(save, context.checkpoint_interval, context.resume ? &context.resume->at("journal") : nullptr);
    context.journal = &journal;
    found = search(target, objective_kind, context);
    if (found->interrupted) journal.save();
  });
  context.journal = nullptr;
  return result.failure ? std::nullopt : found;
}

FitResult run(std::string_view backend, Target const& target, ObjectiveKind objective_kind, Settings const& settings,
              RunContext& context) {
  FitResult result;
  result.settings = settings;
  nlohmann::json const identity = checkpoint::identity(backend, settings, context.seed, target);
  if (context.resume) result.failure = checkpoint::refuse(*context.resume, identity);
  if (result.failure) return result;
  std::optional<SearchResult> searched = modes_for(target, objective_kind, identity, context, result);
  if (!searched) return result;
  SearchResult found = std::move(*searched);
  result.failure = found.failure;
  result.interrupted = found.interrupted;
  if (found.failure || found.interrupted) return result;
  result.modes = std::move(found.modes);
  Mode const& best = result.modes.front();
  result.findings = std::move(found.findings);
  result.search_told = true;
  // By a gradient, searches end where it is small: what Newton's step promises then is of the differences of its curvature.
  if (best.gain > (target.is_expensive() ? 10 * large_gain : large_gain)) result.findings.push_back(not_reached(best));
  std::vector<ModeAtBound> const at_bound = modes_at_bounds(make_objective(target, objective_kind, context.seed, bound_step), best);
  if (!at_bound.empty()) {
    auto const there = [&](std::string const& name) {
      return std::any_of(at_bound.begin(), at_bound.end(), [&](ModeAtBound const& each) {
        return target.parameters()[static_cast<std::size_t>(each.parameter)].name == name;
      });
    };
    // Coordinates end there at infinity: of course they are flat.
    std::erase_if(result.findings, [&](Finding const& each) {
      return each.code == FindingCode::flat_direction && std::all_of(each.names.begin(), each.names.end(), there);
    });
    result.findings.push_back(at_bounds(target, best, at_bound));
  }
  if (objective_kind == ObjectiveKind::declared_posterior)
    if (std::optional<Finding> misfit = check_widths(target, result.modes, at_bound, context, result.higher_place))
      result.findings.push_back(std::move(*misfit));
  write_draw(target, best, context, result);
  // One draw has no spread: the standard deviations are those of the Laplace approximation.
  result.summaries = summarise(result);
  for (std::size_t p = 0; p < result.summaries.size(); ++p) {
    Summary& summary = result.summaries[p];
    summary.sd = best.sd[p];
    summary.mad = summary.q5 = summary.q95 = std::nan("");
  }
  return result;
}

}  // namespace

FitResult run_map(Target const& target, Settings const& settings, RunContext& context) {
  return run("map", target, ObjectiveKind::declared_posterior, settings, context);
}

FitResult run_ml(Target const& target, Settings const& settings, RunContext& context) {
  return run("ml", target, ObjectiveKind::likelihood, settings, context);
}

}  // namespace sysid::optimum
