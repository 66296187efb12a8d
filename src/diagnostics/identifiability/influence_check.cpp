// One batch: the draws as they are, then the same with one parameter after another moved to where its prior has it.
#include "diagnostics/identifiability/influence_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "likelihood/output.hpp"

namespace sysid {
namespace {

constexpr std::uint64_t influence_step = 8;  // of Purpose::start
constexpr int looked_at = 24, most_values = 4096;
constexpr double no_change = 1e-6;  // nats

/// Whether no prior of another parameter reads it, and something does that data measure.
bool acts_on_data_alone(Model const& model, std::vector<ParameterRole> const& roles, int parameter) {
  if (model.parameters[static_cast<std::size_t>(parameter)].coefficient) return false;
  ParameterRole const role = roles[static_cast<std::size_t>(parameter)];
  if (role != ParameterRole::response && role != ParameterRole::noise) return false;
  auto const reads = [&](NodeId node) {
    return model.graph.depends(node, [&](Node const& leaf) {
      return leaf.operation == Operation::leaf && leaf.leaf_kind == LeafKind::parameter && leaf.index == parameter;
    });
  };
  return std::ranges::none_of(model.parameters, [&](Parameter const& each) {
    return each.prior && (std::ranges::any_of(each.prior->arguments, reads) || (each.prior->lower && reads(*each.prior->lower)) ||
                          (each.prior->upper && reads(*each.prior->upper)));
  });
}

/// The draws themselves first, then for each coordinate that is asked of the same with its value in a draw of the prior: within the
/// posterior a moment of switching, for one, changes nothing either, where it stays between two samples.
LaneArray moved_draws(Target const& target, LaneArray const& draws, std::vector<int> const& asked) {
  int const parameters = target.dimension(), width = draws.width();
  LaneArray of_prior(parameters, width), prior(parameters, width);
  target.sample_prior({1, Purpose::start, 0, influence_step}, of_prior);
  target.constrain(of_prior, prior);
  LaneArray declared(parameters, width * (1 + static_cast<int>(asked.size())));
  for (int block = 0; block * width < declared.width(); ++block)
    for (int w = 0; w < width; ++w) {
      for (int p = 0; p < parameters; ++p) declared(p, block * width + w) = draws(p, w);
      if (block == 0) continue;
      int const moved = asked[static_cast<std::size_t>(block) - 1];
      declared(moved, block * width + w) = prior(moved, w);
    }
  return declared;
}

}  // namespace

Findings check_influence(ParameterSpace const& space, Target const& target, Draws const& draws) {
  Model const& model = space.model();
  int const parameters = target.dimension(), width = looked_at;
  if (draws.total() < static_cast<std::size_t>(width) || parameters * width > most_values || target.is_expensive() ||
      target.is_estimated() || model.improper() != nullptr)
    return {};
  std::vector<ParameterRole> const roles = parameter_roles(model);
  std::vector<int> asked;
  for (int p = 0; p < parameters; ++p)
    if (acts_on_data_alone(model, roles, parameter_of(space, p))) asked.push_back(p);
  if (asked.empty()) return {};
  LaneArray const declared = moved_draws(target, spread(draws, width), asked);
  LaneArray theta(parameters, declared.width());
  target.unconstrain(declared, theta);
  std::vector<double> value(static_cast<std::size_t>(declared.width()));
  Ledger untold;
  target.log_likelihood(theta, value, untold);
  Findings findings;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    bool idle = true;
    for (int w = 0; w < width && idle; ++w) {
      double const change =
          value[(k + 1) * static_cast<std::size_t>(width) + static_cast<std::size_t>(w)] - value[static_cast<std::size_t>(w)];
      idle = std::fabs(change) < no_change;  // not of two that failed
    }
    if (!idle) continue;
    std::string const& name = target.parameters()[static_cast<std::size_t>(asked[k])].name;
    findings.push_back(
        {FindingCode::flat_direction,
         Severity::warning,
         {name},
         fmt::format("the data do not determine {}: the likelihood does not depend on it, and its posterior is its prior", name),
         "fix it to a value, give it a narrower prior, or measure something that depends on it"});
  }
  return findings;
}

}  // namespace sysid
