// Rows, their values and draws of them. What is computed of the coordinates is compiled in parameter_space_kernels.cpp.
#include "likelihood/parameter_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "core/text/diagnostic.hpp"
#include "expression/pull_back.hpp"

namespace sysid {

std::string member_name(std::string const& name, std::string const& experiment) {
  if (experiment.empty()) return name;
  if (name.ends_with(']')) return name.substr(0, name.size() - 1) + "," + experiment + "]";
  return name + "[" + experiment + "]";
}

bool reads_own_parameters(Model const& model, NodeId root) {
  return model.graph.depends(root, [&](Node const& node) {
    return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter &&
           model.parameters[static_cast<std::size_t>(node.index)].per_experiment;
  });
}

bool reads_estimated(Model const& model, NodeId root) {
  return model.graph.depends(root, [&](Node const& node) {
    return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter &&
           model.parameters[static_cast<std::size_t>(node.index)].prior.has_value();
  });
}

bool is_standardised(Model const& model, Parameter const& parameter) {
  if (!parameter.per_experiment || !parameter.prior || !parameter.prior->row->gaussian) return false;
  Distribution const& prior = *parameter.prior;
  return !prior.lower && !prior.upper && prior.arguments.size() == 2 && model.graph.constant_value(prior.arguments[0]) == 0.0 &&
         model.graph.constant_value(prior.arguments[1]) == 1.0;
}

ParameterSpace::ParameterSpace(Model model, std::vector<ExperimentMember> experiments, std::vector<MemberCoordinate> standardised)
    : model_(std::move(model)), experiments_(std::move(experiments)), standardised_(std::move(standardised)) {
  lay_out();
  compile();
}

void ParameterSpace::lay_out() {
  row_of_.assign(experiments_.size(), std::vector<int>(model_.parameters.size(), -1));
  auto const add = [&](int p, int experiment, std::string name, std::optional<double> value) {
    Parameter const& parameter = model_.parameters[static_cast<std::size_t>(p)];
    FittedParameter row{{std::move(name), parameter.unit, parameter.span}, p, experiment, value};
    for (std::size_t e = 0; e < experiments_.size(); ++e)
      if (experiment < 0 || static_cast<int>(e) == experiment)
        row_of_[e][static_cast<std::size_t>(p)] = static_cast<int>(rows_.size());
    if (!value) sampled_.push_back(static_cast<int>(rows_.size()));
    rows_.push_back(std::move(row));
  };
  for (int p = 0; p < static_cast<int>(model_.parameters.size()); ++p) {
    Parameter const& parameter = model_.parameters[static_cast<std::size_t>(p)];
    std::optional<double> const fixed = parameter.value ? model_.graph.constant_value(*parameter.value) : std::nullopt;
    if (!parameter.per_experiment) {
      add(p, -1, parameter.name, fixed);
      continue;
    }
    for (int e = 0; e < static_cast<int>(experiments_.size()); ++e) {
      ExperimentMember const& member = experiments_[static_cast<std::size_t>(e)];
      std::optional<double> value = member.constants.empty() ? std::nullopt : member.constants[static_cast<std::size_t>(p)];
      if (!value) value = fixed;
      if (!value && !parameter.prior) value = std::nan("");
      add(p, e, member_name(parameter.name, member.name), value);
    }
  }
}

MemberCoordinate const* ParameterSpace::standardised(int coordinate) const {
  auto const found = std::find_if(standardised_.begin(), standardised_.end(),
                                  [&](MemberCoordinate const& each) { return each.coordinate == coordinate; });
  return found == standardised_.end() ? nullptr : &*found;
}

template <class Place>
void ParameterSpace::draw(std::span<int const> order, Place const& place, bool by_reference, Lanes values, int lane,
                          Stream& stream) const {
  auto const number = [&](NodeId node) {
    if (auto const constant = model_.graph.constant_value(node)) return *constant;
    return model_.graph.evaluate(node, [&](NodeId leaf) { return values(place(model_.graph[leaf].index), lane); });
  };
  for (int const p : order) {
    Distribution const& prior = *model_.parameters[static_cast<std::size_t>(p)].prior;
    std::vector<double> arguments;
    for (NodeId const argument : prior.arguments) arguments.push_back(number(argument));
    double const lower = prior.lower ? number(*prior.lower) : -infinity, upper = prior.upper ? number(*prior.upper) : infinity;
    if (ImproperReference const* const reference = by_reference && !prior.row->proper ? reference_of(place(p)) : nullptr) {
      double const natural = prior.row->lower == nullptr ? -infinity : 0;
      double const unit = rows_[static_cast<std::size_t>(place(p))].to_si(1);
      values(place(p), lane) = reference->draw(std::max(lower, natural), upper, unit, stream);
      continue;
    }
    values(place(p), lane) = sysid::draw(*prior.row, arguments, lower, upper, stream);
  }
}

ParameterSpace ParameterSpace::with_references(std::vector<ImproperReference> references) const {
  ParameterSpace space(model_, experiments_, standardised_);
  space.references_ = std::move(references);
  return space;
}

ImproperReference const* ParameterSpace::reference_of(int row) const {
  auto const found = std::find_if(references_.begin(), references_.end(), [&](ImproperReference const& each) {
    return sampled_[static_cast<std::size_t>(each.coordinate)] == row;
  });
  return found == references_.end() ? nullptr : &*found;
}

void ParameterSpace::log_reference(ConstLanes theta, std::span<double> out) const {
  log_prior(theta, out, true);
  LaneArray improper(1, theta.width());
  run(improper_, theta, improper);
  for (int w = 0; w < theta.width(); ++w) {
    double& sum = out[static_cast<std::size_t>(w)];
    sum -= improper(0, w);
    for (ImproperReference const& each : references_) sum += each.log_density(theta(each.coordinate, w));
    if (std::isnan(sum)) sum = -infinity;
  }
}

void ParameterSpace::sample_prior(StreamKey key, Lanes theta) const {
  LaneArray values(static_cast<int>(rows_.size()), theta.width());
  for (int w = 0; w < theta.width(); ++w) {
    Stream stream(key.with_index(key.index + static_cast<std::uint64_t>(w)));
    for (std::size_t r = 0; r < rows_.size(); ++r)
      if (rows_[r].value) values(static_cast<int>(r), w) = *rows_[r].value;
    // A drawn hyperparameter may make what depends on it impossible (a negative sd): the density is zero there, so the vector is
    // drawn again, which is the joint prior.
    for (int attempt = 0;; ++attempt) {
      try {
        for (int const p : model_.sampling_order) {
          bool const own = model_.parameters[static_cast<std::size_t>(p)].per_experiment;
          for (int e = 0; e < (own ? static_cast<int>(experiments_.size()) : 1); ++e)
            if (!rows_[static_cast<std::size_t>(row(e, p))].value)
              draw(
                  std::span(&p, 1), [&](int index) { return row(e, index); }, true, values, w, stream);
        }
        break;
      } catch (UserError const&) {
        if (attempt == 1000) throw;
      }
    }
  }
  run(unconstrain_, values, theta);
}

void ParameterSpace::log_prior(ConstLanes theta, std::span<double> out, bool jacobian) const {
  LaneArray densities(2, theta.width());
  run(prior_, theta, densities);
  for (int w = 0; w < theta.width(); ++w) {
    double const value = densities(jacobian ? 0 : 1, w);
    out[static_cast<std::size_t>(w)] = std::isnan(value) ? -infinity : value;
  }
}

bool ParameterSpace::log_prior_gradient(ConstLanes theta, std::span<double> out, Lanes gradient) const {
  std::optional<Kernel> const& kernel = prior_gradient_.get([&]() -> std::optional<Kernel> {
    Graph graph = densities_;
    if (!knows_derivatives(graph, {&density_, 1})) return std::nullopt;
    std::vector<NodeId> coordinates;
    for (int k = 0; k < dimension(); ++k) coordinates.push_back(graph.leaf(LeafKind::unconstrained, k));
    std::vector<NodeId> outputs{density_};
    NodeId const one = graph.constant(1);
    for (NodeId const slope : pull_back(graph, outputs, {&one, 1}, coordinates)) outputs.push_back(slope);
    return compile_kernel(graph, coordinates, outputs);
  });
  if (!kernel) return false;
  LaneArray values(1 + dimension(), theta.width());
  run(*kernel, theta, values);
  for (int w = 0; w < theta.width(); ++w) {
    out[static_cast<std::size_t>(w)] = std::isnan(values(0, w)) ? -infinity : values(0, w);
    for (int k = 0; k < dimension(); ++k) gradient(k, w) = values(1 + k, w);
  }
  return true;
}

LaneArray ParameterSpace::values(ConstLanes theta) const {
  LaneArray all(static_cast<int>(rows_.size()), theta.width());
  run(constrain_, theta, all);
  return all;
}

LaneArray ParameterSpace::values_of_declared(ConstLanes declared) const {
  LaneArray all(static_cast<int>(rows_.size()), declared.width());
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (rows_[r].value) std::fill(all.row(static_cast<int>(r)).begin(), all.row(static_cast<int>(r)).end(), *rows_[r].value);
  for (int k = 0; k < dimension(); ++k) {
    int const r = sampled_[static_cast<std::size_t>(k)];
    for (int w = 0; w < declared.width(); ++w) all(r, w) = rows_[static_cast<std::size_t>(r)].to_si(declared(k, w));
  }
  return all;
}

void ParameterSpace::constrain(ConstLanes theta, Lanes declared) const {
  LaneArray const all = values(theta);
  for (int k = 0; k < dimension(); ++k) {
    int const r = sampled_[static_cast<std::size_t>(k)];
    for (int w = 0; w < theta.width(); ++w) declared(k, w) = rows_[static_cast<std::size_t>(r)].from_si(all(r, w));
  }
}

void ParameterSpace::unconstrain(ConstLanes declared, Lanes theta) const { run(unconstrain_, values_of_declared(declared), theta); }

void ParameterSpace::slopes(ConstLanes theta, Lanes out) const { run(slope_, theta, out); }

void ParameterSpace::member_scales(ConstLanes theta, Lanes out) const { run(scales_, theta, out); }

void ParameterSpace::select(ConstLanes values, int experiment, Lanes parameters) const {
  for (int p = 0; p < static_cast<int>(model_.parameters.size()); ++p) {
    auto const from = values.row(row(experiment, p));
    std::copy(from.begin(), from.end(), parameters.row(p).begin());
  }
}

LaneArray ParameterSpace::of_new_experiment(ConstLanes declared, std::span<std::optional<double> const> constants,
                                            StreamKey key) const {
  LaneArray const known = values_of_declared(declared);
  LaneArray parameters(static_cast<int>(model_.parameters.size()), declared.width());
  std::vector<int> open;
  for (int const p : model_.sampling_order)
    if (model_.parameters[static_cast<std::size_t>(p)].per_experiment &&
        (constants.empty() || !constants[static_cast<std::size_t>(p)]))
      open.push_back(p);
  for (int p = 0; p < parameters.rows(); ++p) {
    Parameter const& parameter = model_.parameters[static_cast<std::size_t>(p)];
    auto const to = parameters.row(p);
    if (!parameter.per_experiment) {
      auto const from = known.row(row(0, p));
      std::copy(from.begin(), from.end(), to.begin());
      continue;
    }
    std::optional<double> value = constants.empty() ? std::nullopt : constants[static_cast<std::size_t>(p)];
    if (!value && parameter.value) value = model_.graph.constant_value(*parameter.value);
    std::fill(to.begin(), to.end(), value.value_or(std::nan("")));
  }
  for (int w = 0; w < declared.width() && !open.empty(); ++w) {
    Stream stream(key.with_index(key.index + static_cast<std::uint64_t>(w)));
    draw(
        open, [](int index) { return index; }, false, parameters, w, stream);
  }
  return parameters;
}

std::string ParameterSpace::dump() const {
  auto const coordinate = [&](int k) { return "u(" + infos_[static_cast<std::size_t>(k)].name + ")"; };
  return fmt::format("# coordinates to parameters\n{}\n# log prior: on the coordinates, of the declared parameters\n{}",
                     sysid::dump(constrain_, coordinate), sysid::dump(prior_, coordinate));
}

}  // namespace sysid
