// Point estimates from the global search.
#include "inference/optimum.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "inference/backend/checkpoint.hpp"
#include "search/laplace.hpp"
#include "search/refit.hpp"
#include "search/search.hpp"

namespace sysid::optimum {
namespace {

std::vector<std::size_t> parameters_at_bound(Target const& target, Mode const& mode) {
  std::vector<std::size_t> found;
  for (std::size_t p = 0; p < target.parameters().size(); ++p)
    if (at_bound(target.parameters()[p], mode.declared[p])) found.push_back(p);
  return found;
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

FitResult run(std::string_view backend, Target const& target, ObjectiveKind objective_kind, Settings const& settings,
              RunContext& context) {
  FitResult result;
  result.settings = settings;
  // A search starts again from its beginning: what it would lose is seconds, and its end is the same.
  nlohmann::json const identity = checkpoint::identity(backend, settings, context.seed, target);
  if (context.resume) result.failure = checkpoint::refuse(*context.resume, identity);
  if (result.failure) return result;
  SearchResult found = context.modes.empty() ? search(target, objective_kind, context)
                                             : SearchResult{context.modes, context.mode_findings, {}, false};
  result.failure = found.failure;
  result.interrupted = found.interrupted;
  if (found.interrupted && context.checkpoint) context.checkpoint({{"identity", identity}});
  if (found.failure || found.interrupted) return result;
  result.modes = std::move(found.modes);
  Mode const& best = result.modes.front();
  result.findings = std::move(found.findings);
  result.search_told = true;
  std::vector<std::string> names, bound;
  for (std::size_t const p : parameters_at_bound(target, best)) {
    names.push_back(target.parameters()[p].name);
    bound.push_back(fmt::format("{} = {:.4g}", names.back(), best.declared[p]));
  }
  if (!names.empty()) {
    // Coordinates end there at infinity: of course they are flat.
    std::erase_if(result.findings, [](Finding const& each) { return each.code == FindingCode::flat_direction; });
    result.findings.push_back(
        {FindingCode::at_bound, Severity::warning, std::move(names),
         fmt::format("the optimum lies at a bound of the prior: {}; its sds are not meaningful", fmt::join(bound, ", ")),
         "widen the prior if the bound is not physical, or use mh, which describes the whole posterior"});
  }
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
