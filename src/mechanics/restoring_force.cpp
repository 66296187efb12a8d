// Forces are read off the accelerations of the model; those of the data off their second differences, or off accelerometers.
#include "mechanics/restoring_force.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/statistics.hpp"
#include "mechanics/coupling.hpp"
#include "mechanics/force_data.hpp"
#include "mechanics/measured_motion.hpp"

namespace sysid {

namespace {

constexpr std::size_t most_forces = 3;  // of earlier records, after which no further one is looked at
constexpr std::size_t most_links = 12;  // of one record

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

/// The rows up to the last that is looked at: more scored samples than this show nothing more of a force.
std::size_t examined(Experiment const& experiment) {
  constexpr int samples = 4000;
  int scored = 0;
  std::size_t rows = 0;
  while (rows < experiment.scored.size() && scored < samples) scored += experiment.scored[rows++];
  return rows;
}

/// "m/s^2" of a displacement in m.
std::string acceleration_unit(std::string const& displacement) {
  if (displacement.empty() || displacement == "-") return displacement.empty() ? "" : "1/s^2";
  return displacement.find_first_of(" /*") == std::string::npos ? displacement + "/s^2" : "(" + displacement + ")/s^2";
}

/// The states of one draw along the rows that are looked at, [rows][states], SI; empty where not all states are among the
/// quantities.
std::vector<std::vector<double>> states_along(Model const& model, std::span<TrajectoryQuantity const> quantities,
                                              Trajectory::Result const& result, int draw, std::size_t rows) {
  std::vector<std::vector<double>> states(rows, std::vector<double>(model.states.size()));
  for (std::size_t s = 0; s < model.states.size(); ++s) {
    int const column = quantity_of(quantities, model.states[s].name);
    if (column < 0) return {};
    auto const& values = result.values[static_cast<std::size_t>(column)][static_cast<std::size_t>(draw)];
    for (std::size_t i = 0; i < rows; ++i) states[i][s] = model.states[s].to_si(values[i]);
  }
  return states;
}

bool all_finite(std::vector<double> const& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// A grid over what the model's path reaches; none where the force has no value somewhere on it.
void add_surface(ForceModel const& link, RestoringForce& force) {
  constexpr int lines = 17;
  auto const [left, right] = finite_range(force.model.displacement);
  auto const [slow, fast] = finite_range(force.model.velocity);
  if (!(fast > slow && right > left)) return;
  std::vector<double> places, speeds;
  for (int i = 0; i < lines; ++i) {
    places.push_back(left + (right - left) * i / (lines - 1));
    speeds.push_back(slow + (fast - slow) * i / (lines - 1));
  }
  std::vector<std::vector<double>> surface;
  for (double const q : places) {
    surface.emplace_back();
    for (double const v : speeds) surface.back().push_back(link.force(q, v));
    if (!all_finite(surface.back())) return;
  }
  force.grid_displacement = std::move(places);
  force.grid_velocity = std::move(speeds);
  force.surface = std::move(surface);
}

/// Names and units; the numbers stay SI until `to_declared`.
RestoringForce named_force(Model const& model, std::vector<Mass> const& masses, Link const& link, Experiment const& experiment) {
  RestoringForce force;
  State const &place = model.states[masses[link.mass].displacement], &speed = model.states[masses[link.mass].velocity];
  force.experiment = experiment.name;
  force.name = force.displacement = place.name;
  force.velocity = speed.name;
  if (link.other) {
    State const &other = model.states[masses[*link.other].displacement], &other_speed = model.states[masses[*link.other].velocity];
    force.name += "_" + other.name;
    force.displacement += " − " + other.name;
    force.velocity += " − " + other_speed.name;
  }
  force.displacement_unit = place.unit_of_numbers();
  force.velocity_unit = speed.unit_of_numbers();
  force.per_mass = !link.input;
  force.force_unit = link.input ? model.inputs[*link.input].unit_of_numbers() : acceleration_unit(force.displacement_unit);
  return force;
}

void to_declared(Model const& model, std::vector<Mass> const& masses, Link const& link, RestoringForce& force) {
  State const &place = model.states[masses[link.mass].displacement], &speed = model.states[masses[link.mass].velocity];
  double const force_scale = link.input ? model.inputs[*link.input].from_si(1) : place.from_si(1);
  for (RestoringForce::Path* path : {&force.model, &force.data}) {
    for (double& each : path->displacement) each = place.from_si(each);
    for (double& each : path->velocity) each = speed.from_si(each);
    for (double& each : path->force) each *= force_scale;
  }
  for (double& each : force.grid_displacement) each = place.from_si(each);
  for (double& each : force.grid_velocity) each = speed.from_si(each);
  for (auto& row : force.surface)
    for (double& each : row) each *= force_scale;
}

}  // namespace

void add_restoring_forces(Model const& model, std::span<TrajectoryQuantity const> quantities, Trajectory::Result const& result,
                          ConstLanes parameters, Experiment const& experiment, std::vector<RestoringForce>& forces) {
  if (forces.size() >= most_forces) return;
  Graph graph = model.graph;
  std::vector<Mass> const all = masses(model, graph);
  if (all.empty()) return;
  int const shown = quantity_of(quantities, model.states[all.front().displacement].name);
  int const draw = shown < 0 ? -1 : central_draw(result.values[static_cast<std::size_t>(shown)]);
  if (draw < 0 || draw >= parameters.width()) return;
  auto const states = states_along(model, quantities, result, draw, examined(experiment));
  if (states.empty()) return;
  Accelerations const accelerations(model, graph, all, parameters, draw);
  std::vector<MeasuredMotion> motions;
  for (Mass const& mass : all) motions.push_back(measured_motion(model, graph, mass, accelerations, states, experiment));
  std::size_t const before = forces.size();
  for (Link const& link : links_of(accelerations, states)) {
    if (forces.size() - before == most_links) return;
    ForceModel const of_model(accelerations, link);
    RestoringForce force = named_force(model, all, link, experiment);
    force.model = of_model.along(states, experiment);
    auto const [low, high] = finite_range(force.model.force);
    // What does not move has no loop.
    if (!all_finite(force.model.force) || force.model.force.size() < 10 || !(high > low)) continue;
    add_data(of_model, motions, states, experiment, force);
    if (of_model.has_surface()) add_surface(of_model, force);
    to_declared(model, all, link, force);
    forces.push_back(std::move(force));
  }
}

}  // namespace sysid
