// The parametric part, linear coefficients and covariances of a model with Gaussian processes.
#include "likelihood/process/process_model.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "model/lags.hpp"

namespace sysid {
namespace {

bool is_leaf(Node const& node, LeafKind kind) { return node.operation == Operation::leaf && node.leaf_kind == kind; }

NodeId centre_of(Graph& graph, Channel const& channel) { return channel.noise.row->centre(graph, channel.noise.arguments); }

void add_parameters(Graph const& graph, std::span<NodeId const> roots, std::set<int>& found) {
  for (NodeId const id : graph.reachable(roots))
    if (is_leaf(graph[id], LeafKind::parameter)) found.insert(graph[id].index);
}

/// Parameters that something else than the centres of channels reads.
std::set<int> read_elsewhere(Model const& model, Graph& graph) {
  std::vector<NodeId> roots = model.memories;
  for (State const& state : model.states) roots.insert(roots.end(), {state.derivative, state.initial});
  for (Parameter const& parameter : model.parameters) {
    if (!parameter.prior) continue;
    roots.insert(roots.end(), parameter.prior->arguments.begin(), parameter.prior->arguments.end());
    if (parameter.prior->lower) roots.push_back(*parameter.prior->lower);
    if (parameter.prior->upper) roots.push_back(*parameter.prior->upper);
  }
  std::vector<NodeId> const of_processes = read_by(model.processes);
  roots.insert(roots.end(), of_processes.begin(), of_processes.end());
  for (Channel const& channel : model.channels) {
    NodeId const centre = centre_of(graph, channel);
    for (NodeId const argument : channel.noise.arguments)
      if (argument != centre) roots.push_back(argument);
  }
  std::set<int> found;
  add_parameters(graph, roots, found);
  return found;
}

/// Whether a derivative tells all of how `root` depends on a parameter: no jump, and no function that may have none, reads it.
bool smooth_in(Graph const& graph, NodeId root, int parameter) {
  auto const is_it = [&](Node const& node) { return is_leaf(node, LeafKind::parameter) && node.index == parameter; };
  for (NodeId const id : graph.reachable({&root, 1})) {
    switch (graph[id].operation) {
      case Operation::sign:
      case Operation::floor:
      case Operation::less:
      case Operation::less_equal:
      case Operation::equal:
      case Operation::conjunction:
      case Operation::disjunction:
      case Operation::negation:
      case Operation::call:
        if (graph.depends(id, is_it)) return false;
        break;
      default:
        break;
    }
  }
  return true;
}

}  // namespace

gaussian_process::Covariance covariance_of(Process const& process, int first_column) {
  std::vector<gaussian_process::Covariance> built;
  for (Process::Covariance const& each : process.covariance) {
    if (each.kind == Process::Covariance::Kind::kernel) {
      KernelUse const& kernel = process.kernels[static_cast<std::size_t>(each.left)];
      std::vector<int> columns;
      for (int const input : kernel.inputs) columns.push_back(first_column + input);
      built.emplace_back(*kernel.row, std::move(columns));
    } else {
      auto const& left = built[static_cast<std::size_t>(each.left)];
      auto const& right = built[static_cast<std::size_t>(each.right)];
      built.push_back(each.kind == Process::Covariance::Kind::sum ? left + right : left * right);
    }
  }
  std::vector<gaussian_process::Condition> conditions;
  for (ProcessCondition const& each : process.conditions) {
    gaussian_process::Condition condition{std::vector<double>(static_cast<std::size_t>(first_column)), -1};
    condition.point.insert(condition.point.end(), each.point.begin(), each.point.end());
    if (each.derivative >= 0) condition.derivative = first_column + each.derivative;
    conditions.push_back(std::move(condition));
  }
  return built.back().conditioned(std::move(conditions));
}

void ProcessModel::find_coefficients(std::vector<std::vector<int>>& of_channel) const {
  Graph graph = model_.graph;
  std::set<int> const elsewhere = read_elsewhere(model_, graph);
  std::vector<std::set<int>> read(model_.channels.size());
  for (std::size_t c = 0; c < read.size(); ++c) {
    NodeId const centre = centre_of(graph, model_.channels[c]);
    add_parameters(graph, {&centre, 1}, read[c]);
  }
  of_channel.assign(read.size(), {});
  for (int p = 0; p < static_cast<int>(model_.parameters.size()); ++p) {
    Parameter const& parameter = model_.parameters[static_cast<std::size_t>(p)];
    auto const readers = std::count_if(read.begin(), read.end(), [&](std::set<int> const& each) { return each.contains(p); });
    if (!parameter.prior || parameter.value || parameter.per_experiment || elsewhere.contains(p) || readers != 1) continue;
    Distribution const& prior = *parameter.prior;
    if (!prior.row->gaussian || prior.lower || prior.upper || !graph.constant_value(prior.arguments[0]) ||
        !graph.constant_value(prior.arguments[1]))
      continue;
    auto const c = static_cast<std::size_t>(
        std::find_if(read.begin(), read.end(), [&](std::set<int> const& each) { return each.contains(p); }) - read.begin());
    if (!smooth_in(graph, centre_of(graph, model_.channels[c]), p)) continue;
    // Linear in it, and jointly with those that are in already.
    NodeId const slope = graph.differentiate(centre_of(graph, model_.channels[c]), graph.leaf(LeafKind::parameter, p));
    std::set<int> of_slope;
    add_parameters(graph, {&slope, 1}, of_slope);
    bool const linear = !of_slope.contains(p) && std::none_of(of_channel[c].begin(), of_channel[c].end(),
                                                              [&](int other) { return of_slope.contains(other); });
    if (linear) of_channel[c].push_back(p);
  }
  // Back ends want something to sample, and a posterior that is normal they have exactly.
  std::size_t integrated = 0;
  for (std::vector<int> const& each : of_channel) integrated += each.size();
  auto const with_prior = std::count_if(model_.parameters.begin(), model_.parameters.end(),
                                        [](Parameter const& each) { return each.prior && !each.value; });
  if (integrated == static_cast<std::size_t>(with_prior)) of_channel.assign(read.size(), {});
}

/// The parametric part on its way.
struct ProcessModel::Writing {
  Model parametric;
  std::vector<NodeId> outputs;                      // hyper-parameters and sds of noise
  std::vector<std::vector<int>> arguments, slopes;  // of each channel, among parametric.derived

  int record(NodeId value) {
    parametric.derived.push_back({{}, value, true});
    return static_cast<int>(parametric.derived.size()) - 1;
  }
};

ProcessModel::ProcessModel(Model model, bool free_start, std::string const& method) : model_(std::move(model)), reduced_(model_) {
  std::vector<std::vector<int>> coefficients;
  find_coefficients(coefficients);
  std::size_t const channels = model_.channels.size();
  Writing writing{model_, {}, std::vector<std::vector<int>>(channels), std::vector<std::vector<int>>(channels)};
  writing.parametric.derived.clear();
  remove_processes(writing.parametric);
  for (std::size_t c = 0; c < channels; ++c) add_channel(static_cast<int>(c), coefficients[c], writing);
  std::erase_if(reduced_.sampling_order,
                [&](int p) { return !reduced_.parameters[static_cast<std::size_t>(p)].prior.has_value(); });
  compile_covariance_parameters(writing);
  parametric_ = compile(std::move(writing.parametric), free_start, method);
  find_records(writing);
}

void ProcessModel::add_channel(int index, std::vector<int> const& coefficients, Writing& writing) {
  auto const c = static_cast<std::size_t>(index);
  Graph& graph = writing.parametric.graph;
  std::vector<NodeId>& outputs = writing.outputs;
  std::optional<gaussian_process::Covariance> covariance;
  ProcessChannel process_channel{index, {*gaussian_process::find_kernel("constant"), {}}, {}, 0, {}, 0, {}, {}};
  for (Process const& process : model_.processes) {
    if (process.channel != index) continue;
    auto own = covariance_of(process, static_cast<int>(writing.arguments[c].size()));
    covariance = covariance ? *covariance + own : std::move(own);
    for (NodeId const argument : process.arguments) writing.arguments[c].push_back(writing.record(argument));
    for (KernelUse const& kernel : process.kernels)
      for (NodeId const hyper_parameter : kernel.hyper_parameters) {
        process_channel.hyper_parameters.push_back(static_cast<int>(outputs.size()));
        outputs.push_back(hyper_parameter);
      }
  }
  if (!covariance) throw InternalError("a channel without a process");
  process_channel.covariance = std::move(*covariance);
  Channel& channel = writing.parametric.channels[c];
  NodeId const centre = centre_of(graph, channel);
  for (NodeId const argument : channel.noise.arguments)
    if (argument != centre) {
      process_channel.noise_sd = static_cast<int>(outputs.size());
      outputs.push_back(argument);
    }
  for (int const p : coefficients) {
    Parameter& fixed = reduced_.parameters[static_cast<std::size_t>(p)];
    auto const number = [&](std::size_t i) { return graph.constant_value(fixed.prior->arguments[i]).value(); };
    process_channel.coefficients.push_back({p, number(0), number(1)});
    writing.slopes[c].push_back(writing.record(graph.differentiate(centre_of(graph, channel), graph.leaf(LeafKind::parameter, p))));
    fixed.value = fixed.prior->arguments[0];
    fixed.prior.reset();
  }
  channels_.push_back(std::move(process_channel));
}

void ProcessModel::compile_covariance_parameters(Writing& writing) {
  Graph& graph = writing.parametric.graph;
  std::vector<NodeId> leaves;
  for (std::size_t p = 0; p < model_.parameters.size(); ++p) leaves.push_back(graph.leaf(LeafKind::parameter, static_cast<int>(p)));
  // Parameters that are fixed for all experiments need no rows of their own.
  for (NodeId& output : writing.outputs)
    output = graph.substitute(output, [&](NodeId leaf) -> std::optional<NodeId> {
      return model_.parameters[static_cast<std::size_t>(graph[leaf].index)].value_of_all();
    });
  covariance_parameters_ = compile_kernel(graph, leaves, writing.outputs);
}

/// Where the compiled model records centres, arguments of the processes and slopes by the coefficients.
void ProcessModel::find_records(Writing const& writing) {
  for (int r = 0; r < static_cast<int>(parametric_->records.size()); ++r) {
    CompiledModel::Record const& one = parametric_->records[static_cast<std::size_t>(r)];
    if (one.kind == CompiledModel::Record::Kind::centre) channels_[static_cast<std::size_t>(one.index)].centre = r;
    if (one.kind != CompiledModel::Record::Kind::derived) continue;
    auto const among = [&](std::vector<int> const& all) { return std::find(all.begin(), all.end(), one.index) != all.end(); };
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      if (among(writing.arguments[c])) channels_[c].arguments.push_back(r);
      if (among(writing.slopes[c])) channels_[c].slopes.push_back(r);
    }
  }
}

std::vector<std::string> ProcessModel::marginalised() const {
  std::vector<std::string> names;
  for (std::size_t p = 0; p < model_.parameters.size(); ++p)
    if (model_.parameters[p].prior && !reduced_.parameters[p].prior) names.push_back(model_.parameters[p].name);
  return names;
}

LaneArray ProcessModel::parameters_of_covariance(ConstLanes parameters) const {
  LaneArray out(covariance_parameters_.outputs, parameters.width());
  run(covariance_parameters_, parameters, out);
  return out;
}

}  // namespace sysid
