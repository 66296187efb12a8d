// The restoring force of an oscillator: loops along the record, and the surface over displacement and velocity.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/small_multiples.hpp"
#include "report/figure/surface.hpp"

namespace sysid {

namespace {

using namespace plot;

/// So many samples still show single loops.
constexpr std::size_t loop_samples = 500;
constexpr int shown_turns = 24;
/// So many points leave the surface to be seen.
constexpr std::size_t shown_points = 400;

std::string figure_name(std::string_view what, RestoringForce const& force) {
  return identifier(fmt::format("{}_{}_{}", what, force.experiment, force.name));
}

std::string force_name(RestoringForce const& force) { return force.per_mass ? "force per mass" : "restoring force"; }

/// [first, last): around the largest displacement, where a hysteresis is widest, no more turns than can be told apart.
std::pair<std::size_t, std::size_t> window(RestoringForce::Path const& path) {
  std::vector<double> const& displacement = path.displacement;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < displacement.size(); ++i)
    if (!(std::fabs(displacement[i]) <= std::fabs(displacement[largest]))) largest = i;
  std::size_t first = largest, last = largest + 1;
  int turns = 0;
  auto const turns_at = [&](std::size_t i) { return path.velocity[i - 1] * path.velocity[i] < 0 ? 1 : 0; };
  while (last - first < loop_samples && turns < shown_turns && (first > 0 || last < displacement.size())) {
    if (last < displacement.size()) turns += turns_at(last++);
    if (first > 0) turns += turns_at(first--);
  }
  return {first, last};
}

std::string where_data_come_from(RestoringForce const& force) {
  if (!force.why_no_data.empty()) return fmt::format(" The data are not shown: {}.", force.why_no_data);
  if (force.accelerometer) return " Points: force from the measured accelerations, at the states of the model.";
  return fmt::format(
      " Points: from the measured samples, differentiated twice by local parabolas through {} samples each, and from the input, "
      "smoothed in the same way.",
      2 * force.half_width + 1);
}

/// Of the model, and of the data as far as they lie near it: points outside this may be noise that was differentiated.
std::pair<double, double> shared_range(std::vector<double> const& of_model, std::vector<double> const& of_data) {
  auto const [low, high] = finite_range(of_model);
  std::pair<double, double> const wide{low - 0.25 * (high - low), high + 0.25 * (high - low)};
  std::vector<double> inside;
  for (double const v : of_data)
    if (v >= wide.first && v <= wide.second) inside.push_back(v);
  return inside.empty() ? std::pair{low, high} : cover({low, high}, finite_range(inside));
}

/// What one panel of loops has as its abscissa.
struct Abscissa {
  char const* name;
  std::string const &label, &unit;
  std::vector<double> const &of_model, &of_data;
};

/// Tables and series over an abscissa: of the model the samples [first, last), of the data evenly thinned ones.
void add_loops(Plot& plot, RestoringForce const& force, Abscissa const& over, std::size_t first, std::size_t last) {
  auto const at = [&](double abscissa, double value) {
    return std::vector<double>{plot.panel.x.scaled(abscissa), plot.panel.y.scaled(value)};
  };
  Table of_model{fmt::format("{}_model", over.name), {}}, of_data{fmt::format("{}_data", over.name), {}};
  for (std::size_t i = first; i < last; ++i) of_model.rows.push_back(at(over.of_model[i], force.model.force[i]));
  std::size_t const stride = (force.data.force.size() + 2 * shown_points - 1) / (2 * shown_points);
  for (std::size_t i = 0; i < force.data.force.size(); i += stride)
    of_data.rows.push_back(at(over.of_data[i], force.data.force[i]));
  if (!of_data.rows.empty()) plot.series.push_back(points(of_data.name, 2, 0.2, data));
  plot.series.push_back(line(of_model.name, 2, 1, model));
  plot.tables.push_back(std::move(of_model));
  if (!of_data.rows.empty()) plot.tables.push_back(std::move(of_data));
}

std::string loop_caption(RestoringForce const& force, std::string_view where) {
  return fmt::format(
      "Restoring force on {} along the record{}: {}. A line or a curve over the displacement shows a spring, a slope over the "
      "velocity a damper; loops that remain open in slow motion show hysteresis.{}",
      force.displacement, where,
      force.per_mass ? "minus the acceleration" : "the input minus the inertia force, in the unit of the input",
      where_data_come_from(force));
}

Rows mesh_of(RestoringForce const& force, Axis const& x, Axis const& y, Axis const& z) {
  Rows mesh;
  for (std::size_t i = 0; i < force.surface.size(); ++i) {
    for (std::size_t j = 0; j < force.surface[i].size(); ++j)
      mesh.push_back({x.scaled(force.grid_displacement[i]), y.scaled(force.grid_velocity[j]), z.scaled(force.surface[i][j])});
    mesh.emplace_back();
  }
  return mesh;
}

/// Evenly thinned points of a path, those within the axes.
Rows points_of(RestoringForce::Path const& path, Axis const& x, Axis const& y, Axis const& z) {
  Rows points;
  std::size_t const stride = (path.force.size() + shown_points - 1) / shown_points;
  for (std::size_t i = 0; i < path.force.size(); i += stride) {
    std::vector<double> const at = {x.scaled(path.displacement[i]), y.scaled(path.velocity[i]), z.scaled(path.force[i])};
    if (at[0] >= x.low && at[0] <= x.high && at[1] >= y.low && at[1] <= y.high && at[2] >= z.low && at[2] <= z.high)
      points.push_back(at);
  }
  return points;
}

}  // namespace

Figure loop_figure(RestoringForce const& force, std::string_view where) {
  auto const [first, last] = window(force.model);
  bool const whole = last - first == force.model.force.size();
  Legend legend{{{Key::line, model, whole ? "model" : "model around the largest displacement"}}};
  if (!force.data.force.empty()) legend.keys.insert(legend.keys.begin(), {Key::points, data, "data"});
  int const height = 236 + legend.height();
  Drawing drawing{figure_name("loop", force), column_width, height, std::move(legend)};
  auto const y_range = shared_range(force.model.force, force.data.force);
  Axis const y = axis(y_range.first, y_range.second, 5, 0.05);
  Abscissa const abscissae[] = {
      {"displacement", force.displacement, force.displacement_unit, force.model.displacement, force.data.displacement},
      {"velocity", force.velocity, force.velocity_unit, force.model.velocity, force.data.velocity}};
  for (std::size_t k = 0; k < std::size(abscissae); ++k) {
    Abscissa const& over = abscissae[k];
    auto const x_range = shared_range(over.of_model, over.of_data);
    Plot plot{panel_beside(k, std::size(abscissae), 14, 44, height - 28.0, axis(x_range.first, x_range.second, 4, 0.04), y)};
    plot.panel.x_label = axis_label(over.label, over.unit, plot.panel.x);
    plot.panel.y_numbers = k == 0;
    if (k == 0) plot.panel.y_label = axis_label(force_name(force), force.force_unit, y);
    add_loops(plot, force, over, first, last);
    drawing.plots.push_back(std::move(plot));
  }
  Figure out{drawing.name, fmt::format("Restoring force of {} on {}", force.displacement, force.experiment),
             loop_caption(force, where), script(drawing), Topic::fit};
  if (!whole)
    out.caption += fmt::format(" The line of the model shows only the {} samples around the largest displacement.", last - first);
  return out;
}

Figure surface_figure(RestoringForce const& force, std::string_view where) {
  std::vector<double> values;
  for (auto const& row : force.surface) values.insert(values.end(), row.begin(), row.end());
  auto const [low, high] = finite_range(values);
  constexpr double edge = 0.002;  // lest the outer lines of the mesh are cut by their rounding
  Axis const x = axis(force.grid_displacement.front(), force.grid_displacement.back(), 3, edge),
             y = axis(force.grid_velocity.front(), force.grid_velocity.back(), 3, edge), z = axis(low, high, 4, 0.02);
  bool const has_data = !force.data.force.empty();
  std::string_view const point_colour = has_data ? data : contrast;
  plot::Surface const surface{
      figure_name("surface", force),
      {{{Key::points, point_colour, has_data ? "data" : "trajectory of the model"}, {Key::line, model, "model"}}},
      {x, axis_label(force.displacement, force.displacement_unit, x)},
      {y, axis_label(force.velocity, force.velocity_unit, y)},
      {z, axis_label(force_name(force), force.force_unit, z)},
      mesh_of(force, x, y, z),
      points_of(has_data ? force.data : force.model, x, y, z),
      point_colour};
  Figure out{surface.name, fmt::format("Restoring-force surface of {} on {}", force.displacement, force.experiment), "",
             script(surface), Topic::fit};
  out.caption = fmt::format(
      "The restoring force of the model over the displacement and velocity reached in the record{}. Without points nearby it is "
      "extrapolated by the model.{}",
      where, has_data ? where_data_come_from(force) : where_data_come_from(force) + " Points: trajectory of the model.");
  return out;
}

}  // namespace sysid
