// By names: those of the source are ours.
#include "discovery/simulated_structure.hpp"

#include <algorithm>
#include <cmath>

#include "check/expression/scope.hpp"
#include "core/text/diagnostic.hpp"
#include "discovery/coefficient_names.hpp"
#include "load/load.hpp"

namespace sysid {
namespace {

constexpr int highest_order = 100;

template <class Named>
std::size_t index_of(std::vector<Named> const& all, std::string const& name) {
  auto const found = std::find_if(all.begin(), all.end(), [&](Named const& each) { return each.name == name; });
  if (found == all.end()) throw InternalError("the source of a discovery lacks `" + name + "`");
  return static_cast<std::size_t>(found - all.begin());
}

SolverSettings solver_of(CheckedFile const& file) {
  for (Task const& task : file.tasks)
    if (auto const* fit = std::get_if<FitTask>(&task.what)) return fit->solver;
  throw InternalError("the source of a discovery has no fit");
}

std::pair<int, int> state_of(CheckedDictionary const& dictionary, std::string const& name) {
  for (int order = 0; order <= highest_order; ++order)
    for (std::size_t s = 0; s < dictionary.states.size(); ++s)
      if (primed_name(dictionary.states[s].name, order) == name) return {static_cast<int>(s), order};
  throw InternalError("the source of a discovery has another state, `" + name + "`");
}

}  // namespace

std::vector<int> ValidatedModel::fitted() const {
  std::vector<int> all;
  for (Coefficient const& each : coefficients) all.push_back(each.parameter);
  for (Inner const& each : inner) all.push_back(each.parameter);
  return all;
}

Eigen::VectorXd ValidatedModel::begin() const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(coefficients.size() + inner.size()));
  Eigen::Index row = 0;
  for (Coefficient const& each : coefficients) values(row++) = each.start;
  for (Inner const& each : inner) values(row++) = each.start;
  return values;
}

Experiment ValidatedModel::view(Experiment const& of_dictionary) const {
  Experiment own = of_dictionary;
  own.inputs.clear();
  own.measured.clear();
  own.has_lags.clear();
  for (std::size_t const i : inputs) own.inputs.push_back(of_dictionary.inputs[i]);
  for (std::size_t const c : channels) own.measured.push_back(of_dictionary.measured[c]);
  return own;
}

Eigen::MatrixXd ValidatedModel::starts(std::vector<Segment> const& segments, StartGuess& guess) const {
  Eigen::MatrixXd all(static_cast<Eigen::Index>(states.size()), static_cast<Eigen::Index>(segments.size()));
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (std::size_t x = 0; x < states.size(); ++x)
      all(static_cast<Eigen::Index>(x), static_cast<Eigen::Index>(s)) =
          guess.value(segments[s].experiment, segments[s].first, states[x].first, states[x].second);
  return all;
}

ValidatedModel validated_model(FoundSource const& source, FoundStructure const& structure) {
  ValidatedModel out;
  Source text((source.results / "found.sysid").string(), source.text({structure}));
  Diagnostics diagnostics;
  auto const file = load(text, diagnostics);
  if (!file) {
    out.failure = "no model: " + diagnostics.all().front().message;
    return out;
  }
  Model const& model = file->models.front();
  if (!model.integrated()) {
    out.failure = "it has no motion to simulate: it contains no derivative";
    return out;
  }
  out.solver = solver_of(*file);
  out.compiled = compile(model, true, out.solver.method);
  out.centres = compile_centres(*out.compiled);
  out.others.assign(model.parameters.size(), 1);
  for (std::size_t p = 0; p < model.parameters.size(); ++p)
    if (model.parameters[p].value) out.others[p] = model.graph.evaluate(*model.parameters[p].value, [](NodeId) { return 0.0; });
  CheckedDictionary const& dictionary = source.dictionary;
  for (std::size_t k = 0; k < dictionary.inner.size(); ++k)
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      if (model.parameters[p].name != dictionary.inner[k].quantity.name) continue;
      out.others[p] = structure.inner.empty() ? source.inner[k] : structure.inner[k];
      out.inner.push_back({k, static_cast<int>(p), out.others[p]});
    }
  for (std::size_t e = 0; e < structure.equations.size(); ++e) {
    regression::Support const& support = *structure.equations[e];
    std::vector<std::string> const names = coefficient_names(dictionary, static_cast<int>(e));
    for (std::size_t i = 0; i < support.terms.size(); ++i) {
      auto const term = static_cast<std::size_t>(support.terms[i]);
      auto const row = static_cast<Eigen::Index>(i);
      double const start = structure.refined.empty() ? support.coefficient(row) : structure.refined[e](row);
      out.coefficients.push_back({e, term, static_cast<int>(index_of(model.parameters, names[term])), support.coefficient(row),
                                  std::sqrt(support.covariance(row, row)), start});
    }
  }
  for (Quantity const& input : model.inputs) out.inputs.push_back(index_of(dictionary.measured.inputs, input.name));
  for (Channel const& channel : model.channels) out.channels.push_back(index_of(dictionary.measured.channels, channel.name));
  for (State const& state : model.states) out.states.push_back(state_of(dictionary, state.name));
  return out;
}

}  // namespace sysid
