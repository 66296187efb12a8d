// Newton's law for the masses of a link: its force is the input minus the inertia force.
#include "mechanics/force_data.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/hypotenuse.hpp"
#include "mechanics/second_difference.hpp"

namespace sysid {

namespace {

constexpr double most_noise = 0.1, most_bent = 0.1;  // parts of the force's spread
constexpr int widest = 40;

using States = std::vector<std::vector<double>>;

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

/// The displacements of the masses that a link holds, in their order, and of its other end: empty where it is the ground.
struct Displacements {
  States held;
  std::vector<double> other;
};

/// Places and force at the scored rows, from displacements.
RestoringForce::Path differentiated(ForceModel const& link, Displacements const& samples, int half_width,
                                    Experiment const& experiment) {
  SecondDifference const difference(half_width);
  double const step = experiment.time[1] - experiment.time[0];
  std::vector<Derivatives> held;
  for (auto const& each : samples.held) held.push_back(derivatives(each, half_width, step));
  Derivatives const other = derivatives(samples.other, half_width, step);
  RestoringForce::Path out;
  for (std::size_t r = 0; r < held.front().value.size(); ++r) {
    int const row = static_cast<int>(r) + half_width;
    if (experiment.scored[static_cast<std::size_t>(row)] == 0) continue;
    std::vector<double> accelerations, inputs;
    for (std::size_t k = 0; k < held.size(); ++k) {
      accelerations.push_back(held[k].acceleration[r]);
      inputs.push_back(0);
      auto const input = link.input_of_held(k);
      for (int s = 1 - half_width; input && s < half_width; ++s)
        inputs.back() +=
            difference.smoothing[static_cast<std::size_t>(s + half_width - 1)] * around(experiment.inputs[*input], row + s);
    }
    double const force = link.balance(accelerations, inputs);
    double const place = held.front().value[r] - (other.value.empty() ? 0 : other.value[r]);
    if (!std::isfinite(force) || !std::isfinite(place)) continue;
    out.displacement.push_back(place);
    out.velocity.push_back(held.front().velocity[r] - (other.velocity.empty() ? 0 : other.velocity[r]));
    out.force.push_back(force);
  }
  return out;
}

/// Root mean square of the differences of two paths' forces at the scored rows half_width from the ends.
double distance(RestoringForce::Path const& smoothed, std::vector<double> const& force, int half_width,
                Experiment const& experiment) {
  double square = 0;
  std::size_t row = 0;
  for (std::size_t i = static_cast<std::size_t>(half_width); i + static_cast<std::size_t>(half_width) < force.size(); ++i) {
    if (experiment.scored[i] == 0 || row >= smoothed.force.size()) continue;
    double const by = smoothed.force[row++] - force[i];
    square += by * by;
  }
  return row == 0 ? INFINITY : std::sqrt(square / static_cast<double>(row));
}

void add_differentiated(ForceModel const& link, Displacements const& samples, Displacements const& of_model,
                        std::vector<double> const& force, Experiment const& experiment, RestoringForce& out) {
  out.why_no_data = "the samples are not equally spaced";
  if (!equidistant(experiment.time)) return;
  out.why_no_data = "smoothing that removes the noise of the samples would distort the force";
  double const step = experiment.time[1] - experiment.time[0], spread = spread_of(force);
  double noise = 0;  // of the force, where second differences have none but that of the samples
  for (std::size_t k = 0; k < samples.held.size(); ++k) {
    std::vector<double> residuals;
    for (std::size_t i = 0; i < force.size(); ++i)
      if (std::isfinite(samples.held[k][i])) residuals.push_back(samples.held[k][i] - of_model.held[k][i]);
    if (residuals.empty()) {
      out.why_no_data = "none of the samples was measured";
      return;
    }
    noise = hypotenuse(noise, link.link().held[k].scale * spread_of(residuals) / (step * step));
  }
  int half_width = 2;
  while (half_width <= widest && noise * SecondDifference(half_width).noise > most_noise * spread) ++half_width;
  if (half_width > widest || 2 * half_width + 1 >= static_cast<int>(force.size())) return;
  // What the same does to the trajectory of the model, whose force is known.
  RestoringForce::Path const smoothed = differentiated(link, of_model, half_width, experiment);
  if (!(distance(smoothed, force, half_width, experiment) <= most_bent * spread)) return;
  out.why_no_data.clear();
  out.half_width = half_width;
  out.data = differentiated(link, samples, half_width, experiment);
}

/// At the places where the model is: an accelerometer knows none.
void add_accelerations(ForceModel const& link, std::vector<MeasuredMotion> const& motions, States const& states,
                       std::vector<double> const& force, Experiment const& experiment, RestoringForce& out) {
  RestoringForce::Path path;
  std::vector<double> residuals;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (experiment.scored[i] == 0) continue;
    std::vector<double> accelerations, inputs;
    for (std::size_t k = 0; k < link.link().held.size(); ++k) {
      accelerations.push_back(motions[link.link().held[k].mass].acceleration[i]);
      auto const input = link.input_of_held(k);
      inputs.push_back(input ? experiment.inputs[*input].sample(static_cast<int>(i)) : 0);
    }
    double const measured = link.balance(accelerations, inputs);
    if (!std::isfinite(measured)) continue;
    residuals.push_back(measured - force[i]);
    path.displacement.push_back(link.elongation(states[i]));
    path.velocity.push_back(link.speed(states[i]));
    path.force.push_back(measured);
  }
  out.why_no_data = "the noise of the measured acceleration is as large as the force";
  if (residuals.empty() || !(spread_of(residuals) < spread_of(force))) return;
  out.why_no_data.clear();
  out.accelerometer = true;
  out.data = std::move(path);
}

}  // namespace

double ForceModel::force(double elongation, double speed) const {
  if (coupled()) return -link_.scale * accelerations_.by_link(link_.mass, link_.other, elongation, speed);
  std::vector<double> states = accelerations_.rest();
  states[mass().displacement] = elongation;
  states[mass().velocity] = speed;
  return force(states);
}

double ForceModel::force(std::vector<double> const& states) const {
  if (coupled()) return force(elongation(states), speed(states));
  return -link_.scale * accelerations_.value(mass().at_rest, states);
}

double ForceModel::difference(std::vector<double> const& states, std::size_t Mass::*of) const {
  return states[mass().*of] - (link_.other ? states[accelerations_.masses()[*link_.other].*of] : 0);
}
double ForceModel::elongation(std::vector<double> const& states) const { return difference(states, &Mass::displacement); }
double ForceModel::speed(std::vector<double> const& states) const { return difference(states, &Mass::velocity); }

std::optional<std::size_t> ForceModel::input_of_held(std::size_t k) const {
  return accelerations_.masses()[link_.held[k].mass].input;
}

double ForceModel::balance(std::vector<double> const& accelerations, std::vector<double> const& inputs) const {
  double sum = 0;
  for (std::size_t k = 0; k < link_.held.size(); ++k) {
    std::size_t const i = link_.held[k].mass;
    double const steady = coupled() ? accelerations_.value(accelerations_.masses()[i].at_rest, accelerations_.rest()) : 0;
    sum += link_.held[k].scale * (accelerations_.gain(i) * inputs[k] - accelerations[k] + steady);
  }
  return sum;
}

RestoringForce::Path ForceModel::along(States const& states, Experiment const& experiment) const {
  RestoringForce::Path out;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (experiment.scored[i] == 0) continue;
    out.displacement.push_back(elongation(states[i]));
    out.velocity.push_back(speed(states[i]));
    out.force.push_back(force(states[i]));
  }
  return out;
}

void add_data(ForceModel const& link, std::vector<MeasuredMotion> const& motions, States const& states,
              Experiment const& experiment, RestoringForce& out) {
  auto const& held = link.link().held;
  if (held.empty()) {
    out.why_no_data =
        "the connections between these masses and the ground form a closed loop, so the motion does not determine each force "
        "separately";
    return;
  }
  std::vector<double> force;
  for (auto const& at : states) force.push_back(link.force(at));
  if (std::none_of(held.begin(), held.end(), [&](Link::Held const& each) { return motions[each.mass].acceleration.empty(); }))
    return add_accelerations(link, motions, states, force, experiment, out);
  Displacements samples, of_model;
  auto const column = [&](std::size_t mass) {
    std::vector<double> values;
    for (auto const& at : states) values.push_back(at[link.masses()[mass].displacement]);
    return values;
  };
  out.why_no_data = held.size() == 1 && !link.link().other
                        ? "no channel measures the displacement alone, and no channel measures the acceleration"
                        : "the force needs several displacements, and some of these have no channel of their own";
  for (Link::Held const& each : held) {
    if (motions[each.mass].displacement.empty()) return;
    samples.held.push_back(motions[each.mass].displacement);
    of_model.held.push_back(column(each.mass));
  }
  if (auto const other = link.link().other) {
    if (motions[*other].displacement.empty()) return;
    samples.other = motions[*other].displacement;
    of_model.other = column(*other);
  }
  add_differentiated(link, samples, of_model, force, experiment, out);
}

}  // namespace sysid
