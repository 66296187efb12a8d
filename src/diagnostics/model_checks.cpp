// Populations, and parameters without use.
#include "diagnostics/model_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/words.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/residual_checks.hpp"
#include "likelihood/output.hpp"

namespace sysid {

Findings check_hierarchy(Model const& model, Draws const& draws, Findings const& found, std::span<std::string const> non_centred) {
  auto const estimated = [&](NodeId argument) {
    return model.graph.depends(argument, [&](Node const& node) {
      return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter &&
             model.parameters[static_cast<std::size_t>(node.index)].prior.has_value();
    });
  };
  auto const member = std::find_if(model.parameters.begin(), model.parameters.end(), [&](Parameter const& parameter) {
    // The first argument is where the population lies, what follows is how wide it is.
    return parameter.per_experiment && parameter.prior && !parameter.prior->arguments.empty() &&
           std::find(non_centred.begin(), non_centred.end(), parameter.name) == non_centred.end() &&
           std::any_of(parameter.prior->arguments.begin() + 1, parameter.prior->arguments.end(), estimated);
  });
  if (member == model.parameters.end()) return {};
  if (draws.total() == 1)
    return {{FindingCode::optimum_of_hierarchy,
             Severity::warning,
             {member->name},
             fmt::format("the density may be unbounded as the spread of `{}` approaches 0, so an optimum is not meaningful",
                         member->name),
             "sample it with mh"}};
  bool const unmixed = std::any_of(found.begin(), found.end(), [](Finding const& each) {
    return each.code == FindingCode::chains_disagree || each.code == FindingCode::chains_not_quite_agreed ||
           each.code == FindingCode::ess_bulk_low || each.code == FindingCode::ess_tail_low ||
           each.code == FindingCode::chain_did_not_move || each.code == FindingCode::few_distinct_states;
  });
  if (!unmixed) return {};
  return {{FindingCode::hierarchy_narrows,
           Severity::note,
           {member->name},
           fmt::format(
               "the spread of `{}` is estimated: the posterior is narrow where the spread is small, and chains mix slowly there",
               member->name),
           fmt::format("write `{}` in the non-centred form: `parameter z per experiment ~ normal(0, sd = 1)`, `let {} = mean + "
                       "spread*z` (docs/methods/several_experiments.md), or sample it with tempering",
                       member->name, member->name)}};
}

Findings check_populations(Model const& model) {
  std::vector<ParameterRole> const roles = parameter_roles(model);
  std::vector<std::string> names;
  for (std::size_t p = 0; p < roles.size(); ++p)
    if (model.parameters[p].prior && roles[p] == ParameterRole::prior) names.push_back(model.parameters[p].name);
  if (names.empty()) return {};
  std::string const said = quoted(names);
  bool const one = names.size() == 1;
  return {{FindingCode::optimum_of_hierarchy, Severity::warning, std::move(names),
           fmt::format("the likelihood, which `ml` maximises, does not contain {}: {} value is where the search began, and {} sd "
                       "means nothing",
                       said, one ? "its" : "their", one ? "its" : "their"),
           "sample it with mh to estimate the population; the other parameters are not affected"}};
}

Findings check_use(Model const& model, StartRule const& start) {
  Findings findings;
  bool const own_start = start.kind == StartRule::Kind::record;
  Model read = model;  // as this fit reads it
  if (!own_start)
    for (State& state : read.states) state.initial = read.graph.constant(0);
  std::vector<ParameterRole> const roles = parameter_roles(read), roles_elsewhere = parameter_roles(model);
  for (std::size_t p = 0; p < roles.size(); ++p) {
    // Terms that vanish over the whole range of an unknown function are another finding.
    bool const idle = roles[p] == ParameterRole::none || roles[p] == ParameterRole::derived;
    if (!model.parameters[p].prior || model.parameters[p].coefficient || !idle) continue;
    std::string const& name = model.parameters[p].name;
    if (roles_elsewhere[p] == ParameterRole::response)
      findings.push_back(
          {FindingCode::unused_parameter,
           Severity::warning,
           {name},
           fmt::format("{} is used only in initial values, which `start = {}` replaces: its posterior equals its prior", name,
                       start_text(start)),
           "use `start = record`, which starts from the initial values, or remove the parameter"});
    else if (model.name.find('(') != std::string::npos)  // `osc(cubic = 0)`: terms are switched off on purpose
      findings.push_back(
          {FindingCode::unused_parameter,
           Severity::note,
           {name},
           fmt::format("{} appears in no term of `{}` with these arguments: its posterior equals its prior", name, model.name),
           ""});
    else
      findings.push_back({FindingCode::unused_parameter,
                          Severity::warning,
                          {name},
                          fmt::format("{} is used in no equation, no channel and no prior: its posterior equals its prior", name),
                          "remove it, or use it in an equation"});
  }
  return findings;
}

namespace {

constexpr std::uint64_t influence_step = 8;  // of Purpose::start

/// Whether priors of others read it, or nothing does but what no data measure.
bool acts_on_data_alone(Model const& model, std::vector<ParameterRole> const& roles, std::string const& name) {
  auto const declared = [&](std::string const& as) {
    return std::ranges::find_if(model.parameters, [&](Parameter const& each) { return each.name == as; });
  };
  auto found = declared(name);                                                            // `k[2]`, an element of a vector,
  if (found == model.parameters.end()) found = declared(name.substr(0, name.find('[')));  // or `k` of one experiment
  if (found == model.parameters.end() || found->coefficient) return false;
  auto const index = static_cast<int>(found - model.parameters.begin());
  ParameterRole const role = roles[static_cast<std::size_t>(index)];
  if (role != ParameterRole::response && role != ParameterRole::noise) return false;
  auto const reads = [&](NodeId node) {
    return model.graph.depends(node, [&](Node const& leaf) {
      return leaf.operation == Operation::leaf && leaf.leaf_kind == LeafKind::parameter && leaf.index == index;
    });
  };
  return std::ranges::none_of(model.parameters, [&](Parameter const& each) {
    return each.prior && (std::ranges::any_of(each.prior->arguments, reads) || (each.prior->lower && reads(*each.prior->lower)) ||
                          (each.prior->upper && reads(*each.prior->upper)));
  });
}

}  // namespace

Findings check_influence(Model const& model, Target const& target, std::vector<std::vector<double>> const& draws) {
  constexpr int looked_at = 24, most_values = 4096;
  constexpr double nothing = 1e-6;  // nats
  int const parameters = target.dimension(), width = looked_at;
  if (static_cast<int>(draws.size()) < width || parameters * width > most_values || target.is_expensive() ||
      target.is_estimated() || model.improper() != nullptr)
    return {};
  std::vector<ParameterRole> const roles = parameter_roles(model);
  std::vector<int> asked;
  for (int p = 0; p < parameters; ++p)
    if (acts_on_data_alone(model, roles, target.parameters()[static_cast<std::size_t>(p)].name)) asked.push_back(p);
  LaneArray of_prior(parameters, width), prior(parameters, width);
  target.sample_prior({1, Purpose::start, 0, influence_step}, of_prior);
  target.constrain(of_prior, prior);
  // The draws themselves first, then for each parameter the same with its value in a draw of the prior: within the posterior a
  // moment of switching, for one, changes nothing either, where it stays between two samples.
  LaneArray declared(parameters, width * (1 + static_cast<int>(asked.size())));
  LaneArray theta(parameters, declared.width());
  for (int block = 0; block * width < declared.width(); ++block)
    for (int w = 0; w < width; ++w) {
      auto const& draw = draws[static_cast<std::size_t>(w) * draws.size() / static_cast<std::size_t>(width)];
      for (int p = 0; p < parameters; ++p) declared(p, block * width + w) = draw[static_cast<std::size_t>(p)];
      if (block == 0) continue;
      int const moved = asked[static_cast<std::size_t>(block) - 1];
      declared(moved, block * width + w) = prior(moved, w);
    }
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
      idle = std::fabs(change) < nothing;  // not of two that failed
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
