// The kernels of a parameter space. The model's expressions speak of its own parameters; here each is read as the row that the
// experiment has for it.
#include <algorithm>
#include <functional>
#include <map>

#include "core/numeric/not_finite.hpp"
#include "function/primitive.hpp"
#include "likelihood/output.hpp"
#include "likelihood/parameter_space.hpp"

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

/// What grows while the sampled rows are added, each after those that its prior reads.
struct ParameterSpace::Compilation {
  Graph graph;
  std::vector<NodeId> coordinates, leaves, value;  // [D], [rows] of values that are given, [rows] from the coordinates
  std::vector<NodeId> backward, scales;            // [D] from the leaves; of the members' priors
  std::vector<int> coordinate_of;                  // [rows]; -1: fixed
  NodeId with_jacobian, without, improper;         // sums of log densities
  std::vector<Constrained> constrained;

  /// An expression of the model as a row reads it. A shared parameter's prior reads shared parameters only, whose rows are the same
  /// for every experiment.
  std::function<std::optional<NodeId>(NodeId)> read_from(std::vector<NodeId> const& nodes, ParameterSpace const& space,
                                                         FittedParameter const& row) const {
    return [this, &nodes, &space, e = std::max(row.experiment, 0)](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = graph[leaf];
      if (node.leaf_kind != LeafKind::parameter) return std::nullopt;
      return nodes[static_cast<std::size_t>(space.row(e, node.index))];
    };
  }
};

ParameterSpace::Compilation ParameterSpace::begin_compilation() const {
  Compilation all;
  all.graph = model_.graph;
  all.backward.resize(sampled_.size());
  all.coordinate_of.assign(rows_.size(), -1);
  for (std::size_t k = 0; k < sampled_.size(); ++k) {
    all.coordinate_of[static_cast<std::size_t>(sampled_[k])] = static_cast<int>(k);
    all.coordinates.push_back(all.graph.leaf(LeafKind::unconstrained, static_cast<int>(k)));
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    all.leaves.push_back(all.graph.leaf(LeafKind::parameter, static_cast<int>(r)));
    all.value.push_back(rows_[r].value ? all.graph.constant(*rows_[r].value) : all.leaves.back());
  }
  all.with_jacobian = all.without = all.improper = all.graph.constant(0);
  return all;
}

void ParameterSpace::compile() {
  Compilation all = begin_compilation();
  infos_.resize(sampled_.size());
  for (int const p : model_.sampling_order) {
    bool const own = model_.parameters[static_cast<std::size_t>(p)].per_experiment;
    for (int e = 0; e < (own ? static_cast<int>(experiments_.size()) : 1); ++e)
      if (int const r = row(e, p); !rows_[static_cast<std::size_t>(r)].value) add_row(r, all);
  }
  std::vector<bool> const sizes = sizes_alone(model_);
  for (std::size_t k = 0; k < infos_.size(); ++k)
    infos_[k].size_alone = sizes[static_cast<std::size_t>(parameter_of(*this, static_cast<int>(k)))];
  Graph& graph = all.graph;
  constrain_ = compile_kernel(graph, all.coordinates, all.value);
  unconstrain_ = compile_kernel(graph, all.leaves, all.backward);
  scales_ = compile_kernel(graph, all.coordinates, all.scales);
  NodeId const densities[] = {all.with_jacobian, all.without};
  prior_ = compile_kernel(graph, all.coordinates, densities);
  improper_ = compile_kernel(graph, all.coordinates, {&all.improper, 1});
  densities_ = graph;
  density_ = all.with_jacobian;
  compile_slopes(graph, all.constrained, all.coordinates, all.value);
}

/// Its value and its density, from the coordinates.
void ParameterSpace::add_row(int r, Compilation& all) {
  Graph& graph = all.graph;
  FittedParameter const& row = rows_[static_cast<std::size_t>(r)];
  auto const k = static_cast<std::size_t>(all.coordinate_of[static_cast<std::size_t>(r)]);
  NodeId const own = all.coordinates[k];
  Distribution const& prior = *model_.parameters[static_cast<std::size_t>(row.parameter)].prior;
  Distribution const use = substituted(graph, prior, all.read_from(all.value, *this, row));
  MemberCoordinate const* const member = standardised(static_cast<int>(k));
  Support const allowed = support(graph, use);
  Coordinate const moved = member != nullptr ? constrain_member(graph, allowed, location_scale(graph, use), *member, own)
                                             : sysid::constrain(graph, allowed, own);
  all.value[static_cast<std::size_t>(r)] = moved.value;
  // The declared density is per declared unit; d(declared)/du = d(SI)/du / scale.
  NodeId const scale = graph.constant(elementary::log(row.to_si(1)));
  NodeId const density =
      graph.add(member != nullptr ? log_density_of_member(graph, use, *member, own) : log_density(graph, use, moved.value), scale);
  all.without = graph.add(all.without, density);
  NodeId const on_line = graph.add(density, graph.subtract(moved.log_jacobian, scale));
  all.with_jacobian = graph.add(all.with_jacobian, on_line);
  if (!use.row->proper) all.improper = graph.add(all.improper, on_line);
  add_inverse(r, use, moved.log_jacobian, all);
}

/// Its coordinate from values that are given, and what is known of it without any. use: its prior, from the coordinates.
void ParameterSpace::add_inverse(int r, Distribution const& use, NodeId log_jacobian, Compilation& all) {
  Graph& graph = all.graph;
  FittedParameter const& row = rows_[static_cast<std::size_t>(r)];
  auto const k = static_cast<std::size_t>(all.coordinate_of[static_cast<std::size_t>(r)]);
  Parameter const& parameter = model_.parameters[static_cast<std::size_t>(row.parameter)];
  MemberCoordinate const* const member = standardised(static_cast<int>(k));
  std::vector<NodeId> known = all.leaves;
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].value) known[i] = all.value[i];
  Distribution const by_rows = substituted(graph, *parameter.prior, all.read_from(known, *this, row));
  Support const bounds = support(graph, by_rows);
  NodeId const leaf = all.leaves[static_cast<std::size_t>(r)];
  std::optional<LocationScale> population;
  if (member != nullptr) population = location_scale(graph, by_rows);
  all.backward[k] =
      member != nullptr ? unconstrain_member(graph, bounds, *population, *member, leaf) : sysid::unconstrain(graph, bounds, leaf);
  if (std::vector<int> of = population_of(graph, by_rows, all.coordinate_of); !of.empty()) {
    members_.push_back({static_cast<int>(k), std::move(of)});
    all.scales.push_back(*scale_argument(use));
  }
  auto const number = [&](std::optional<NodeId> const& bound, double fallback) {
    auto const constant = bound ? graph.constant_value(*bound) : std::nullopt;
    return constant ? row.from_si(*constant) : fallback;
  };
  all.constrained.push_back({r, static_cast<int>(k), bounds, log_jacobian, member, population});
  infos_[k] = {.name = row.name,
               .unit = row.unit_text(),
               .lower = number(bounds.lower, -infinity),
               .upper = number(bounds.upper, infinity),
               .coefficient = parameter.coefficient,
               .improper = use.row->proper                ? Improper::no
                           : bounds.lower || bounds.upper ? Improper::half_line
                                                          : Improper::line};
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

}  // namespace sysid
