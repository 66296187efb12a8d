// Rows, coordinates and the joint prior. The model's expressions speak of its own parameters; here each is read as the row that the
// experiment has for it.
#include "likelihood/parameter_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/numeric/not_finite.hpp"
#include "core/text/diagnostic.hpp"
#include "expression/pull_back.hpp"
#include "function/primitive.hpp"
#include "likelihood/output.hpp"

namespace sysid {
namespace {

bool is_parameter(Node const& node) { return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter; }

/// The coordinates of the sampled rows that the scale of a prior reads, as an expression of rows.
std::vector<int> population_of(Graph const& graph, Distribution const& prior, std::vector<int> const& coordinate_of) {
  std::vector<int> read;
  std::optional<NodeId> const scale = scale_argument(prior);
  if (!scale) return read;
  for (NodeId const node : graph.reachable({&*scale, 1}))
    if (is_parameter(graph[node])) read.push_back(coordinate_of[static_cast<std::size_t>(graph[node].index)]);
  return read;
}

/// The prior with every parameter of the model replaced.
Distribution substituted(Graph& graph, Distribution use, std::function<std::optional<NodeId>(NodeId)> const& replacement) {
  for (NodeId& argument : use.arguments) argument = graph.substitute(argument, replacement);
  if (use.lower) use.lower = graph.substitute(*use.lower, replacement);
  if (use.upper) use.upper = graph.substitute(*use.upper, replacement);
  return use;
}

}  // namespace

std::string member_name(std::string const& name, std::string const& experiment) {
  if (experiment.empty()) return name;
  if (name.ends_with(']')) return name.substr(0, name.size() - 1) + "," + experiment + "]";
  return name + "[" + experiment + "]";
}

bool reads_own_parameters(Model const& model, NodeId root) {
  return model.graph.depends(root, [&](Node const& node) {
    return is_parameter(node) && model.parameters[static_cast<std::size_t>(node.index)].per_experiment;
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

void ParameterSpace::compile() {
  Graph graph = model_.graph;
  std::vector<NodeId> value, leaves, coordinates, backward(sampled_.size());
  std::vector<int> coordinate_of(rows_.size(), -1);
  for (std::size_t k = 0; k < sampled_.size(); ++k) {
    coordinate_of[static_cast<std::size_t>(sampled_[k])] = static_cast<int>(k);
    coordinates.push_back(graph.leaf(LeafKind::unconstrained, static_cast<int>(k)));
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    leaves.push_back(graph.leaf(LeafKind::parameter, static_cast<int>(r)));
    value.push_back(rows_[r].value ? graph.constant(*rows_[r].value) : leaves.back());
  }
  // A shared parameter's prior reads shared parameters only, whose rows are the same for every experiment.
  auto const read_from = [&](std::vector<NodeId> const& nodes, FittedParameter const& row) {
    return [&graph, &nodes, this, e = std::max(row.experiment, 0)](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = graph[leaf];
      if (node.leaf_kind != LeafKind::parameter) return std::nullopt;
      return nodes[static_cast<std::size_t>(this->row(e, node.index))];
    };
  };
  NodeId with_jacobian = graph.constant(0), without = graph.constant(0), improper = graph.constant(0);
  std::vector<Constrained> constrained;
  std::vector<NodeId> scales;
  infos_.resize(sampled_.size());
  std::vector<bool> const sizes = sizes_alone(model_);
  auto const add = [&](int r) {
    FittedParameter const& row = rows_[static_cast<std::size_t>(r)];
    if (row.value) return;
    auto const k = static_cast<std::size_t>(coordinate_of[static_cast<std::size_t>(r)]);
    Distribution const& prior = *model_.parameters[static_cast<std::size_t>(row.parameter)].prior;
    Distribution const use = substituted(graph, prior, read_from(value, row));
    MemberCoordinate const* const member = standardised(static_cast<int>(k));
    Support const allowed = support(graph, use);
    Coordinate const moved = member != nullptr
                                 ? constrain_member(graph, allowed, location_scale(graph, use), *member, coordinates[k])
                                 : sysid::constrain(graph, allowed, coordinates[k]);
    value[static_cast<std::size_t>(r)] = moved.value;
    // The declared density is per declared unit; d(declared)/du = d(SI)/du / scale.
    NodeId const scale = graph.constant(elementary::log(row.to_si(1)));
    NodeId const density = graph.add(
        member != nullptr ? log_density_of_member(graph, use, *member, coordinates[k]) : log_density(graph, use, moved.value),
        scale);
    without = graph.add(without, density);
    NodeId const on_line = graph.add(density, graph.subtract(moved.log_jacobian, scale));
    with_jacobian = graph.add(with_jacobian, on_line);
    if (!use.row->proper) improper = graph.add(improper, on_line);

    std::vector<NodeId> known = leaves;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (rows_[i].value) known[i] = value[i];
    Distribution const by_rows = substituted(graph, prior, read_from(known, row));
    Support const bounds = support(graph, by_rows);
    NodeId const leaf = leaves[static_cast<std::size_t>(r)];
    std::optional<LocationScale> population;
    if (member != nullptr) population = location_scale(graph, by_rows);
    backward[k] =
        member != nullptr ? unconstrain_member(graph, bounds, *population, *member, leaf) : sysid::unconstrain(graph, bounds, leaf);
    if (std::vector<int> of = population_of(graph, by_rows, coordinate_of); !of.empty()) {
      members_.push_back({static_cast<int>(k), std::move(of)});
      scales.push_back(*scale_argument(use));
    }
    auto const number = [&](std::optional<NodeId> const& bound, double fallback) {
      auto const constant = bound ? graph.constant_value(*bound) : std::nullopt;
      return constant ? row.from_si(*constant) : fallback;
    };
    constrained.push_back({r, static_cast<int>(k), bounds, moved.log_jacobian, member, population});
    infos_[k] = {row.name,
                 row.unit_text(),
                 number(bounds.lower, -infinity),
                 number(bounds.upper, infinity),
                 model_.parameters[static_cast<std::size_t>(row.parameter)].coefficient,
                 use.row->proper                ? Improper::no
                 : bounds.lower || bounds.upper ? Improper::half_line
                                                : Improper::line,
                 sizes[static_cast<std::size_t>(row.parameter)]};
  };
  for (int const p : model_.sampling_order) {
    if (!model_.parameters[static_cast<std::size_t>(p)].per_experiment)
      add(row(0, p));
    else
      for (int e = 0; e < static_cast<int>(experiments_.size()); ++e) add(row(e, p));
  }
  constrain_ = compile_kernel(graph, coordinates, value);
  unconstrain_ = compile_kernel(graph, leaves, backward);
  scales_ = compile_kernel(graph, coordinates, scales);
  NodeId const densities[] = {with_jacobian, without};
  prior_ = compile_kernel(graph, coordinates, densities);
  improper_ = compile_kernel(graph, coordinates, {&improper, 1});
  densities_ = graph;
  density_ = with_jacobian;
  compile_slopes(graph, constrained, coordinates, value);
}

/// By its own coordinate a value's derivative is what the log Jacobian is the logarithm of, smooth at 0; by others it has one
/// through its bounds, or through its population.
void ParameterSpace::compile_slopes(Graph& graph, std::span<Constrained const> constrained, std::span<NodeId const> coordinates,
                                    std::span<NodeId const> value) {
  std::vector<std::map<int, NodeId>> slopes(rows_.size());  // by coordinate
  for (auto const& [r, coordinate, bounds, log_jacobian, member, population] : constrained) {
    std::map<int, NodeId>& here = slopes[static_cast<std::size_t>(r)];
    NodeId const size = graph.call(exp_function, log_jacobian);
    here.emplace(coordinate, bounds.upper && !bounds.lower ? graph.negate(size) : size);
    NodeId const own = coordinates[static_cast<std::size_t>(coordinate)];
    NodeId const moved = member != nullptr ? constrain_member(graph, bounds, *population, *member, own).value
                                           : sysid::constrain(graph, bounds, own).value;
    for (NodeId const leaf : graph.reachable({&moved, 1})) {
      if (!is_parameter(graph[leaf])) continue;
      NodeId const by_bound = graph.substitute(graph.differentiate(moved, leaf), [&](NodeId other) -> std::optional<NodeId> {
        return is_parameter(graph[other]) ? std::optional(value[static_cast<std::size_t>(graph[other].index)]) : std::nullopt;
      });
      for (auto const& [through, slope] : slopes[static_cast<std::size_t>(graph[leaf].index)]) {
        NodeId& sum = here.try_emplace(through, graph.constant(0)).first->second;
        sum = graph.add(sum, graph.multiply(by_bound, slope));
      }
    }
  }
  std::vector<NodeId> values;
  for (int r = 0; r < static_cast<int>(rows_.size()); ++r) {
    std::vector<int>& read = coordinates_of_.emplace_back();
    for (auto const& [coordinate, slope] : slopes[static_cast<std::size_t>(r)]) {
      read.push_back(coordinate);
      slopes_.push_back({r, coordinate});
      values.push_back(slope);
    }
  }
  slope_ = compile_kernel(graph, coordinates, values);
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
