// The pairs are found in the first-order system; forces are read off its acceleration, of the data off their second differences.
#include "app/restoring_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/diagnostic.hpp"
#include "report/plot.hpp"

namespace sysid {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Oscillator {
  std::size_t displacement, velocity;  // states
  NodeId acceleration;
  std::optional<std::size_t> input;
  NodeId gain = 0;     // d acceleration / d input
  NodeId at_rest = 0;  // acceleration without the input
  bool surface = false;
};

bool is_state(Node const& node) { return node.operation == Operation::leaf && node.leaf_kind == LeafKind::state; }

/// States that are the derivative of another one, by that one's index: [states], -1: none.
std::vector<int> velocities(Model const& model) {
  std::vector<int> of(model.states.size(), -1);
  for (std::size_t i = 0; i < model.states.size(); ++i)
    if (Node const& node = model.graph[model.states[i].derivative]; is_state(node)) of[i] = node.index;
  return of;
}

std::vector<Oscillator> oscillators(Model const& model, Graph& graph) {
  std::vector<Oscillator> out;
  if (model.dynamics != Dynamics::continuous) return out;
  std::vector<int> const velocity = velocities(model);
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (velocity[i] < 0) continue;
    auto const j = static_cast<std::size_t>(velocity[i]);
    // Of a chain of three the last two are no oscillator.
    bool const chained = velocity[j] >= 0 || std::find(velocity.begin(), velocity.end(), static_cast<int>(i)) != velocity.end();
    if (chained) continue;
    Oscillator each{i, j, model.states[j].derivative, {}, 0, 0, true};
    bool alone = true;
    std::vector<std::size_t> inputs;
    for (NodeId const id : graph.reachable({&each.acceleration, 1})) {
      Node const& node = graph[id];
      if (node.operation != Operation::leaf) continue;
      auto const index = static_cast<std::size_t>(node.index);
      if (node.leaf_kind == LeafKind::input) {
        inputs.push_back(index);
      } else if (node.leaf_kind == LeafKind::state) {
        bool const own = index == i || index == j;
        bool const of_other = velocity[index] >= 0 || std::find(velocity.begin(), velocity.end(), node.index) != velocity.end();
        alone = alone && (own || !of_other);
        each.surface = each.surface && own;
      } else if (node.leaf_kind != LeafKind::parameter) {
        alone = false;
      }
    }
    if (!alone || inputs.size() > 1) continue;
    each.at_rest = each.acceleration;
    if (!inputs.empty()) {
      each.input = inputs.front();
      NodeId const leaf = graph.leaf(LeafKind::input, static_cast<int>(inputs.front()));
      try {
        each.gain = graph.differentiate(each.acceleration, leaf);
      } catch (InternalError const&) {
        continue;  // a function without a derivative reads the input
      }
      if (graph.depends(each.gain, [](Node const& node) {
            return node.operation == Operation::leaf && node.leaf_kind != LeafKind::parameter;
          }))
        continue;
      each.at_rest = graph.substitute(each.acceleration,
                                      [&](NodeId id) { return id == leaf ? std::optional(graph.constant(0)) : std::nullopt; });
    }
    out.push_back(each);
  }
  return out;
}

/// The index of a state's quantity among those of a trajectory; -1: none.
int quantity_of(std::span<TrajectoryQuantity const> quantities, std::string const& name) {
  for (std::size_t q = 0; q < quantities.size(); ++q)
    if (quantities[q].channel < 0 && quantities[q].name == name) return static_cast<int>(q);
  return -1;
}

/// The draw whose trajectory of the quantity is nearest to the mean of all; -1: none is finite.
int central_draw(std::vector<std::vector<double>> const& trajectories) {
  std::vector<std::size_t> finite;
  for (std::size_t d = 0; d < trajectories.size(); ++d)
    if (std::all_of(trajectories[d].begin(), trajectories[d].end(), [](double v) { return std::isfinite(v); })) finite.push_back(d);
  if (finite.empty()) return -1;
  std::vector<double> mean(trajectories[finite.front()].size(), 0);
  for (std::size_t const d : finite)
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += trajectories[d][i] / static_cast<double>(finite.size());
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t const d : finite) {
    double distance = 0;
    for (std::size_t i = 0; i < mean.size(); ++i) distance += (trajectories[d][i] - mean[i]) * (trajectories[d][i] - mean[i]);
    if (distance < least) least = distance, best = static_cast<int>(d);
  }
  return best;
}

/// The mean of an input over the two steps around a sample, weighted as the second difference of a displacement weights what
/// accelerates it.
double around(InputSignal const& input, int row) {
  constexpr int parts = 8;
  double sum = 0, weights = 0;
  for (int k = 0; k < parts; ++k) {
    double const s = (k + 0.5) / parts;
    sum += s * input.value(row - 1, s) + (1 - s) * input.value(row, s);
    weights += 1;
  }
  return sum / weights;
}

/// Root mean square of deviations from the mean.
double spread_of(std::vector<double> const& values) {
  double mean = 0, square = 0;
  for (double const v : values) mean += v / static_cast<double>(values.size());
  for (double const v : values) square += (v - mean) * (v - mean) / static_cast<double>(values.size());
  return std::sqrt(square);
}

/// The rows up to the last that is looked at: more scored samples than this show nothing more of a force.
std::size_t looked_at(Experiment const& experiment) {
  constexpr int samples = 4000;
  int scored = 0;
  std::size_t rows = 0;
  while (rows < experiment.scored.size() && scored < samples) scored += experiment.scored[rows++];
  return rows;
}

class Along {
 public:
  Along(Model const& model, Graph const& graph, Oscillator const& oscillator, ConstLanes parameters, int draw)
      : graph_(graph), oscillator_(oscillator) {
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      auto const fixed = model.parameters[p].value ? graph.constant_value(*model.parameters[p].value) : std::nullopt;
      double const given = parameters(static_cast<int>(p), draw);
      parameters_.push_back(std::isfinite(given) || !fixed ? given : *fixed);
    }
    gain_ = oscillator.input ? value(oscillator.gain, {}) : nan;
  }

  /// SI; states: of the model.
  double value(NodeId root, std::vector<double> const& states) const {
    return graph_.evaluate(root, [&](NodeId id) {
      Node const& node = graph_[id];
      auto const index = static_cast<std::size_t>(node.index);
      if (node.leaf_kind == LeafKind::parameter) return parameters_[index];
      return node.leaf_kind == LeafKind::state && index < states.size() ? states[index] : nan;
    });
  }
  /// What the acceleration without the input is as a force. An input may push the other way, as the acceleration of a ground does:
  /// the force still pulls back.
  double force(double acceleration) const { return oscillator_.input ? -acceleration / std::fabs(gain_) : -acceleration; }
  /// And what was measured of it, with the input there, which is an acceleration of gain * input.
  double force(double acceleration, double input) const {
    return oscillator_.input ? (gain_ > 0 ? input : -input) - acceleration / std::fabs(gain_) : -acceleration;
  }
  double restoring(std::vector<double> const& states) const { return force(value(oscillator_.at_rest, states)); }

 private:
  Graph const& graph_;
  Oscillator const& oscillator_;
  std::vector<double> parameters_;
  double gain_ = nan;
};

/// The channel that shows the displacement and what it adds to it; nothing when none does.
struct Shown {
  std::size_t channel;
  double offset;
};
std::optional<Shown> shown_displacement(Model const& model, Graph& graph, Oscillator const& oscillator, Along const& along,
                                        Experiment const& experiment) {
  NodeId const leaf = graph.leaf(LeafKind::state, static_cast<int>(oscillator.displacement));
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    if (experiment.measured[c].empty() || model.channels[c].noise.row->discrete) continue;
    NodeId const centre = model.channels[c].noise.row->centre(graph, model.channels[c].noise.arguments);
    if (!graph.depends(centre, is_state)) continue;
    NodeId slope = 0;
    try {
      slope = graph.differentiate(centre, leaf);
    } catch (InternalError const&) {
      continue;
    }
    bool const reads_else = graph.depends(centre, [&](Node const& node) {
      return node.operation == Operation::leaf && node.leaf_kind != LeafKind::parameter &&
             !(is_state(node) && node.index == static_cast<int>(oscillator.displacement));
    });
    if (reads_else || !graph.is_constant(slope, 1)) continue;
    double const offset = along.value(centre, std::vector<double>(model.states.size(), 0.0));
    if (std::isfinite(offset)) return Shown{c, offset};
  }
  return std::nullopt;
}

/// Whether samples are as far apart as the first two, to a millionth.
bool equidistant(std::vector<double> const& time) {
  for (std::size_t i = 2; i < time.size(); ++i)
    if (std::fabs(time[i] - time[i - 1] - (time[1] - time[0])) > 1e-6 * (time[1] - time[0])) return false;
  return time.size() > 2;
}

/// Displacement, velocity and force of samples of the displacement, SI.
RestoringForce::Path differentiated(std::vector<double> const& samples, int half_width, Oscillator const& oscillator,
                                    Along const& along, Experiment const& experiment) {
  SecondDifference const difference(half_width);
  double const step = experiment.time[1] - experiment.time[0], points = 2 * half_width + 1;
  double second = 0, fourth = 0, sixth = 0;
  for (int k = -half_width; k <= half_width; ++k) {
    double const square = 1.0 * k * k;
    second += square;
    fourth += square * square;
    sixth += square * square * square;
  }
  RestoringForce::Path out;
  for (int i = half_width; i + half_width < static_cast<int>(samples.size()); ++i) {
    double place = 0, slope = 0, curvature = 0, driven = 0;
    for (int k = -half_width; k <= half_width; ++k) {
      double const y = samples[static_cast<std::size_t>(i + k)];
      curvature += difference.weights[static_cast<std::size_t>(k + half_width)] * y;
      // Of a cubic: a parabola's slope is that of a line, which is too flat wherever the curvature is still right.
      slope += k * (sixth - fourth * k * k) / (second * sixth - fourth * fourth) * y;
      place += (fourth - k * k * second) / (points * fourth - second * second) * y;
    }
    if (!std::isfinite(curvature) || experiment.scored[static_cast<std::size_t>(i)] == 0) continue;
    if (oscillator.input)
      for (int k = 1 - half_width; k < half_width; ++k)
        driven += difference.smoothing[static_cast<std::size_t>(k + half_width - 1)] *
                  around(experiment.inputs[*oscillator.input], i + k);
    out.displacement.push_back(place);
    out.velocity.push_back(slope / step);
    out.force.push_back(along.force(curvature / (step * step), driven));
  }
  return out;
}

/// The force of the data, at the least smoothing that leaves a tenth of the force's spread as noise, where that does not bend it.
void add_data(RestoringForce& out, std::vector<std::vector<double>> const& states, Oscillator const& oscillator, Along const& along,
              Shown const& shown, Experiment const& experiment) {
  constexpr double most_noise = 0.1, most_bent = 0.1;  // parts of the force's spread
  constexpr int widest = 40;
  if (!equidistant(experiment.time)) {
    out.why_no_data = "its samples are not equally far apart";
    return;
  }
  std::vector<double> samples, of_model, residuals, force;
  for (std::size_t i = 0; i < states.size(); ++i) {
    samples.push_back(experiment.measured[shown.channel][i] - shown.offset);
    of_model.push_back(states[i][oscillator.displacement]);
    if (std::isfinite(samples[i])) residuals.push_back(samples[i] - of_model[i]);
    force.push_back(along.restoring(states[i]));
  }
  if (residuals.empty()) {
    out.why_no_data = "none of its samples was measured";
    return;
  }
  double const noise = spread_of(residuals), step = experiment.time[1] - experiment.time[0], spread = spread_of(force);
  double const per_acceleration = std::fabs(along.force(1.0) - along.force(0.0));
  int half_width = 2;
  while (half_width <= widest &&
         noise * SecondDifference(half_width).noise / (step * step) * per_acceleration > most_noise * spread)
    ++half_width;
  out.why_no_data = "the smoothing that their noise asks for would bend the force";
  if (half_width > widest || 2 * half_width + 1 >= static_cast<int>(samples.size())) return;
  // What the same does to the trajectory of the model, whose force is known.
  std::vector<double> whole = of_model;
  RestoringForce::Path const smoothed = differentiated(whole, half_width, oscillator, along, experiment);
  double bent = 0;
  std::size_t row = 0;
  for (int i = half_width; i + half_width < static_cast<int>(whole.size()); ++i) {
    if (experiment.scored[static_cast<std::size_t>(i)] == 0) continue;
    double const by = smoothed.force[row++] - force[static_cast<std::size_t>(i)];
    bent += by * by;
  }
  if (row == 0 || !(std::sqrt(bent / static_cast<double>(row)) <= most_bent * spread)) return;
  out.why_no_data.clear();
  out.half_width = half_width;
  out.data = differentiated(samples, half_width, oscillator, along, experiment);
}

std::string unit_of(Quantity const& quantity) {
  if (!quantity.unit) return "";
  return quantity.unit->text.empty() ? format_dimension(quantity.unit->dimension) : quantity.unit->text;
}

/// "m/s^2" of a displacement in m.
std::string acceleration_unit(std::string const& displacement) {
  if (displacement.empty() || displacement == "-") return displacement.empty() ? "" : "1/s^2";
  return displacement.find_first_of(" /*") == std::string::npos ? displacement + "/s^2" : "(" + displacement + ")/s^2";
}

}  // namespace

SecondDifference::SecondDifference(int half_width) {
  double const points = 2 * half_width + 1;
  double second = 0, fourth = 0;
  for (int k = -half_width; k <= half_width; ++k) second += k * k, fourth += 1.0 * k * k * k * k;
  double const squares = fourth - second * second / points;
  double sum = 0;
  for (int k = -half_width; k <= half_width; ++k) {
    weights.push_back(2 * (k * k - second / points) / squares);
    sum += weights.back() * weights.back();
  }
  noise = std::sqrt(sum);
  // s_(k+1) = w_k + 2 s_k - s_(k-1), beginning with nothing.
  double before = 0, now = 0;
  for (int k = 0; k + 2 < static_cast<int>(points); ++k) {
    double const next = weights[static_cast<std::size_t>(k)] + 2 * now - before;
    smoothing.push_back(next);
    before = now;
    now = next;
  }
}

std::vector<RestoringForce> restoring_forces(Model const& model, std::span<TrajectoryQuantity const> quantities,
                                             Trajectory::Result const& result, ConstLanes parameters,
                                             Experiment const& experiment) {
  std::vector<RestoringForce> out;
  Graph graph = model.graph;
  for (Oscillator const& oscillator : oscillators(model, graph)) {
    State const& displacement = model.states[oscillator.displacement];
    State const& velocity = model.states[oscillator.velocity];
    std::vector<int> columns;
    for (State const& state : model.states) columns.push_back(quantity_of(quantities, state.name));
    if (std::find(columns.begin(), columns.end(), -1) != columns.end()) continue;
    auto const& moved = result.values[static_cast<std::size_t>(columns[oscillator.displacement])];
    int const draw = central_draw(moved);
    if (draw < 0 || draw >= parameters.width()) continue;
    Along const along(model, graph, oscillator, parameters, draw);

    std::vector<std::vector<double>> states(looked_at(experiment), std::vector<double>(model.states.size()));
    for (std::size_t s = 0; s < model.states.size(); ++s) {
      auto const& values = result.values[static_cast<std::size_t>(columns[s])][static_cast<std::size_t>(draw)];
      for (std::size_t i = 0; i < states.size(); ++i) states[i][s] = model.states[s].to_si(values[i]);
    }
    RestoringForce force;
    force.experiment = experiment.name;
    force.displacement = displacement.name;
    force.displacement_unit = unit_of(displacement);
    force.velocity = velocity.name;
    force.velocity_unit = unit_of(velocity);
    force.per_mass = !oscillator.input;
    force.force_unit = oscillator.input ? unit_of(model.inputs[*oscillator.input]) : acceleration_unit(force.displacement_unit);
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (experiment.scored[i] == 0) continue;
      force.model.displacement.push_back(states[i][oscillator.displacement]);
      force.model.velocity.push_back(states[i][oscillator.velocity]);
      force.model.force.push_back(along.restoring(states[i]));
    }
    auto const [low, high] = plot::range(force.model.force);
    bool const finite = std::all_of(force.model.force.begin(), force.model.force.end(), [](double v) { return std::isfinite(v); });
    // What does not move has no loop.
    if (!finite || force.model.force.size() < 10 || !(high > low)) continue;
    if (auto const shown = shown_displacement(model, graph, oscillator, along, experiment))
      add_data(force, states, oscillator, along, *shown, experiment);
    else
      force.why_no_data = "no channel measures the displacement alone";

    if (oscillator.surface) {
      constexpr int lines = 17;
      auto const [left, right] = plot::range(force.model.displacement);
      auto const [slow, fast] = plot::range(force.model.velocity);
      std::vector<double> at(model.states.size(), 0.0);
      for (int i = 0; i < lines; ++i) {
        force.grid_displacement.push_back(left + (right - left) * i / (lines - 1));
        force.grid_velocity.push_back(slow + (fast - slow) * i / (lines - 1));
      }
      for (double const q : force.grid_displacement) {
        force.surface.emplace_back();
        for (double const v : force.grid_velocity) {
          at[oscillator.displacement] = q;
          at[oscillator.velocity] = v;
          force.surface.back().push_back(along.restoring(at));
        }
      }
      bool const whole = fast > slow && right > left &&
                         std::all_of(force.surface.begin(), force.surface.end(), [](std::vector<double> const& row) {
                           return std::all_of(row.begin(), row.end(), [](double v) { return std::isfinite(v); });
                         });
      if (!whole) force.surface.clear(), force.grid_displacement.clear(), force.grid_velocity.clear();
    }
    // Declared units.
    double const force_scale = oscillator.input ? model.inputs[*oscillator.input].from_si(1) : displacement.from_si(1);
    for (RestoringForce::Path* path : {&force.model, &force.data}) {
      for (double& each : path->displacement) each = displacement.from_si(each);
      for (double& each : path->velocity) each = velocity.from_si(each);
      for (double& each : path->force) each *= force_scale;
    }
    for (double& each : force.grid_displacement) each = displacement.from_si(each);
    for (double& each : force.grid_velocity) each = velocity.from_si(each);
    for (auto& row : force.surface)
      for (double& each : row) each *= force_scale;
    out.push_back(std::move(force));
  }
  return out;
}

}  // namespace sysid
