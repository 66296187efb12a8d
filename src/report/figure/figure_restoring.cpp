// The restoring force of an oscillator: loops along the record, and the surface over displacement and velocity.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/figure/figures.hpp"

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
      " Points: from the measured samples, differentiated twice by parabolas through {} of them each, and from the input under the "
      "same smoothing.",
      2 * force.half_width + 1);
}

}  // namespace

Figure loop_figure(RestoringForce const& force) {
  auto const [first, last] = window(force.model);
  int const width = column_width;
  bool const whole = last - first == force.model.force.size();
  std::vector<Key> keys = {{Key::line, model, whole ? "model" : "model around the largest displacement"}};
  if (!force.data.force.empty()) keys.insert(keys.begin(), {Key::points, data, "data"});
  int const height = 236 + legend_height(keys, 10, width - 14);
  // Points of the data outside this may be noise that was differentiated.
  auto const extent = [&](std::vector<double> const& of_model, std::vector<double> const& of_data) {
    auto const [low, high] = finite_range(of_model);
    std::pair<double, double> const wide{low - 0.25 * (high - low), high + 0.25 * (high - low)};
    std::vector<double> inside;
    for (double const v : of_data)
      if (v >= wide.first && v <= wide.second) inside.push_back(v);
    return inside.empty() ? std::pair{low, high} : cover({low, high}, finite_range(inside));
  };
  auto const y_extent = extent(force.model.force, force.data.force);
  Axis const y = axis(y_extent.first, y_extent.second, 5, 0.05);
  Figure out;
  out.topic = Topic::fit;
  out.name = figure_name("loop", force);
  out.title = fmt::format("Restoring force of {} on {}", force.displacement, force.experiment);
  out.script = preamble(out.name, width, height) + legend(keys, 10, width - 14.0, height - 12.0, width, height);
  struct Side {
    char const* name;
    std::string const &label, &unit;
    std::vector<double> const &of_model, &of_data;
  };
  Side const sides[] = {
      {"displacement", force.displacement, force.displacement_unit, force.model.displacement, force.data.displacement},
      {"velocity", force.velocity, force.velocity_unit, force.model.velocity, force.data.velocity}};
  double const step = (width - 70.0) / 2;
  for (std::size_t k = 0; k < 2; ++k) {
    Side const& side = sides[k];
    auto const x_extent = extent(side.of_model, side.of_data);
    Axis const x = axis(x_extent.first, x_extent.second, 4, 0.04);
    double const left = 70 + static_cast<double>(k) * step;
    Panel p = panel_at(left, k == 0 ? left + step - 30 : width - 14.0, 44, height - 28.0, x, y);
    p.x_label = axis_label(side.label, side.unit, x);
    p.y_numbers = k == 0;
    if (k == 0) p.y_label = axis_label(force_name(force), force.force_unit, y);
    std::vector<std::vector<double>> lines, points;
    for (std::size_t i = first; i < last; ++i) lines.push_back({x.scaled(side.of_model[i]), y.scaled(force.model.force[i])});
    std::size_t const stride = (force.data.force.size() + 2 * shown_points - 1) / (2 * shown_points);
    for (std::size_t i = 0; i < force.data.force.size(); i += stride)
      points.push_back({x.scaled(side.of_data[i]), y.scaled(force.data.force[i])});
    out.script += data_block(fmt::format("{}_model", side.name), lines);
    std::string plots = fmt::format("${}_model using 1:2 with lines lw 1 lc rgb '{}'\n", side.name, model);
    if (!points.empty()) {
      out.script += data_block(fmt::format("{}_data", side.name), points);
      plots = fmt::format("${}_data using 1:2 with points pt 7 ps 0.2 lc rgb '{}', ", side.name, data) + plots;
    }
    out.script += panel(p, width, height) + "plot " + plots;
    if (k == 0) out.script += end_legend();
  }
  out.script += "unset multiplot\n";
  out.caption = fmt::format(
      "Restoring force on {} along the record: {}. A line or a curve over the displacement shows a spring, a slope over the "
      "velocity a damper; loops that remain open in slow motion show hysteresis.{}",
      force.displacement, force.per_mass ? "minus the acceleration" : "the input minus the inertia force, in the unit of the input",
      where_data_come_from(force));
  if (!whole) out.caption += fmt::format(" Shown of the model are {} samples around the largest displacement.", last - first);
  return out;
}

Figure surface_figure(RestoringForce const& force) {
  std::vector<double> values;
  for (auto const& row : force.surface) values.insert(values.end(), row.begin(), row.end());
  auto const [low, high] = finite_range(values);
  constexpr double edge = 0.002;  // lest the outer lines of the mesh are cut by their rounding
  Axis const x = axis(force.grid_displacement.front(), force.grid_displacement.back(), 3, edge),
             y = axis(force.grid_velocity.front(), force.grid_velocity.back(), 3, edge), z = axis(low, high, 4, 0.02);
  int const width = column_width, height = 310;
  Figure out;
  out.topic = Topic::fit;
  out.name = figure_name("surface", force);
  out.title = fmt::format("Restoring-force surface of {} on {}", force.displacement, force.experiment);
  bool const has_data = !force.data.force.empty();
  RestoringForce::Path const& path = has_data ? force.data : force.model;
  std::vector<Key> const keys = {{Key::points, has_data ? data : contrast, has_data ? "data" : "trajectory of the model"},
                                 {Key::line, model, "model"}};
  out.script = preamble(out.name, width, height) + legend(keys, 10, width - 14.0, height - 12.0, width, height);
  std::vector<std::vector<double>> mesh, points;
  for (std::size_t i = 0; i < force.surface.size(); ++i) {
    for (std::size_t j = 0; j < force.surface[i].size(); ++j)
      mesh.push_back({x.scaled(force.grid_displacement[i]), y.scaled(force.grid_velocity[j]), z.scaled(force.surface[i][j])});
    mesh.emplace_back();
  }
  std::size_t const stride = (path.force.size() + shown_points - 1) / shown_points;
  for (std::size_t i = 0; i < path.force.size(); i += stride) {
    std::vector<double> const at = {x.scaled(path.displacement[i]), y.scaled(path.velocity[i]), z.scaled(path.force[i])};
    if (at[0] >= x.low && at[0] <= x.high && at[1] >= y.low && at[1] <= y.high && at[2] >= z.low && at[2] <= z.high)
      points.push_back(at);
  }
  out.script += data_block("mesh", mesh) + (points.empty() ? "" : data_block("points", points));
  auto const ticks = [](char which, Axis const& axis, char const* offset) {
    std::string list;
    for (auto const& [place, number] : axis.ticks) list += fmt::format("{}'{}' {:.10g}", list.empty() ? "" : ", ", number, place);
    return fmt::format("set {0}tics offset {3} textcolor rgb '{1}' ({2})\n", which, ink, list, offset);
  };
  // gnuplot's own labels lie over the numbers of their axes, or are left out in the view below.
  int labels = 0;
  auto const label = [&](std::string const& text, char const* place) {
    return fmt::format("set label {} {} at screen {} textcolor rgb '{}'\n", 300 + ++labels, quote(shortened(text, 190)), place,
                       ink);
  };
  out.script += fmt::format(
      "set xrange [{:.10g}:{:.10g}]\nset yrange [{:.10g}:{:.10g}]\nset zrange [{:.10g}:{:.10g}]\nset xyplane at {:.10g}\n"
      "set view 50,25,1.08,0.9\nset border 127 lw 0.7\nset grid noxtics noytics noztics\n",
      x.low, x.high, y.low, y.high, z.low, z.high, z.low);
  out.script += ticks('x', x, "0,-0.2") + ticks('y', y, "0,-0.2") + ticks('z', z, "0.4,0");
  out.script += label(axis_label(force.displacement, force.displacement_unit, x), "0.3,0.07 center");
  out.script += label(axis_label(force.velocity, force.velocity_unit, y), "0.98,0.1 right");
  out.script += label(axis_label(force_name(force), force.force_unit, z), "0.02,0.68 left");
  out.script += fmt::format(
      "splot $mesh using 1:2:3 with lines lw 0.8 lc rgb '{}'{}\nunset multiplot\n", model,
      points.empty() ? "" : fmt::format(", $points using 1:2:3 with points pt 7 ps 0.2 lc rgb '{}'", has_data ? data : contrast));
  out.caption = fmt::format(
      "The restoring force of the model over the displacement and velocity reached in the record. Without points nearby it is "
      "extrapolated by the model.{}",
      has_data ? where_data_come_from(force) : where_data_come_from(force) + " Points: trajectory of the model.");
  return out;
}

}  // namespace sysid
