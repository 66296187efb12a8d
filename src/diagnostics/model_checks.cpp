// Populations, and parameters without use.
#include "diagnostics/model_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "data/start_rule.hpp"
#include "likelihood/output.hpp"
#include "likelihood/parameter_space.hpp"

namespace sysid {

Findings check_hierarchy(Model const& model, Draws const& draws, Findings const& found, std::span<std::string const> non_centred) {
  auto const estimated = [&](NodeId argument) { return reads_estimated(model, argument); };
  auto const member = std::find_if(model.parameters.begin(), model.parameters.end(), [&](Parameter const& parameter) {
    // The first argument is where the population lies, what follows is how wide it is.
    return parameter.per_experiment && parameter.prior && !parameter.prior->arguments.empty() &&
           std::find(non_centred.begin(), non_centred.end(), parameter.name) == non_centred.end() &&
           std::any_of(parameter.prior->arguments.begin() + 1, parameter.prior->arguments.end(), estimated);
  });
  if (member == model.parameters.end()) return {};
  if (draws.is_optimum())
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

Findings check_use(Model const& model, StartRule const& start, std::function<bool(std::string const& name)> const& switched_off,
                   bool optimum) {
  Findings findings;
  char const* const so = optimum ? "the data do not determine it: its value and sd in this result say nothing about it"
                                 : "its posterior equals its prior";
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
           fmt::format("{} is used only in initial values, which `start = {}` replaces: {}", name, start_text(start), so),
           "use `start = record`, which starts from the initial values, or remove the parameter"});
    else if (switched_off && switched_off(name))  // `osc(cubic = 0)`, on purpose
      findings.push_back({FindingCode::unused_parameter,
                          Severity::note,
                          {name},
                          fmt::format("{} appears in no term of `{}` with these arguments: {}", name, model.name, so),
                          ""});
    else
      findings.push_back({FindingCode::unused_parameter,
                          Severity::warning,
                          {name},
                          fmt::format("{} is used in no equation, no channel and no prior: {}", name, so),
                          "remove it, or use it in an equation"});
  }
  return findings;
}

void name_negative_values(Model const& model, Findings& findings) {
  std::vector<std::string> negative;
  std::vector<ParameterRole> const roles = parameter_roles(model);
  for (std::size_t p = 0; p < roles.size(); ++p) {
    Parameter const& each = model.parameters[p];
    auto const node = each.value_of_all();
    bool const from_zero = !each.unit || each.unit->offset == 0;
    if (roles[p] != ParameterRole::response || !node || !from_zero) continue;
    double const value = model.graph.constant_value(*node).value_or(0);
    if (value < 0)
      negative.push_back(fmt::format("{} = {}{}", each.name, shortest(each.from_si(value)), unit_after_number(each.unit_text())));
  }
  constexpr std::size_t most_named = 3;
  if (negative.empty() || negative.size() > most_named) return;
  for (Finding& each : findings)
    if (each.code == FindingCode::explains_little || each.code == FindingCode::worse_than_the_mean)
      each.help += fmt::format("; check the sign of what the model fixes at a negative value: {}", fmt::join(negative, ", "));
}

}  // namespace sysid
