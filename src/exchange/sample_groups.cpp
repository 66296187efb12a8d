// Rows to arrays.
#include "exchange/sample_groups.hpp"

#include <algorithm>

#include "exchange/draws_group.hpp"

namespace sysid {
namespace {

std::vector<double> flat(std::vector<std::vector<double>> const& trajectories, RowsOfExperiment const& rows) {
  std::vector<double> values;
  values.reserve(trajectories.size() * rows.rows.size());
  for (auto const& trajectory : trajectories)
    for (int const row : rows.rows) values.push_back(trajectory[static_cast<std::size_t>(row)]);
  return values;
}

}  // namespace

std::string labelled(std::string const& name, std::string const& label) { return label.empty() ? name : name + "[" + label + "]"; }

RowsOfExperiment scored_rows(Experiment const& experiment, Dynamics dynamics, std::string const& label) {
  RowsOfExperiment rows{labelled("row", label), dynamics == Dynamics::none ? "" : labelled("time", label), {}};
  for (std::size_t i = 0; i < experiment.scored.size(); ++i)
    if (experiment.scored[i] != 0) rows.rows.push_back(static_cast<int>(i));
  return rows;
}

void add_rows(NetcdfGroup& group, Experiment const& experiment, RowsOfExperiment const& rows) {
  std::vector<std::int64_t> numbers;
  std::vector<double> times;
  double const scale = experiment.time_unit ? experiment.time_unit->scale : 1;
  for (int const row : rows.rows) {
    numbers.push_back(experiment.first_row + row);
    times.push_back(experiment.time[static_cast<std::size_t>(row)] / scale);
  }
  group.add_dimension({rows.dimension, {}, std::move(numbers), {}});
  if (!rows.time.empty())
    group.add(
        {rows.time, {rows.dimension}, std::move(times), unit_attribute(experiment.time_unit ? experiment.time_unit->text : "s")});
}

Attributes row_attributes(std::string const& unit, RowsOfExperiment const& rows) {
  Attributes attributes = unit_attribute(unit);
  if (!rows.time.empty()) attributes.emplace_back("coordinates", rows.time);
  return attributes;
}

void add_inputs(NetcdfGroup& group, Model const& model, Experiment const& experiment, RowsOfExperiment const& rows,
                std::string const& label) {
  for (std::size_t u = 0; u < model.inputs.size(); ++u) {
    std::vector<double> values;
    for (int const row : rows.rows) values.push_back(model.inputs[u].from_si(experiment.inputs[u].sample(row)));
    group.add({labelled(model.inputs[u].name, label),
               {rows.dimension},
               std::move(values),
               row_attributes(model.inputs[u].unit_text(), rows)});
  }
}

void add_constants(NetcdfGroup& group, Model const& model, ExperimentUse const& use, std::string const& label) {
  for (std::size_t p = 0; p < use.constants.size(); ++p)
    if (use.constants[p])
      group.add({labelled(model.parameters[p].name, label),
                 {},
                 std::vector<double>{model.parameters[p].from_si(*use.constants[p])},
                 unit_attribute(model.parameters[p].unit_text())});
}

void add_measured(NetcdfGroup& group, Model const& model, Experiment const& experiment, RowsOfExperiment const& rows,
                  std::string const& suffix, std::string const& label) {
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    if (experiment.measured[c].empty()) continue;
    std::vector<double> values;
    for (int const row : rows.rows)
      values.push_back(model.channels[c].from_si(experiment.measured[c][static_cast<std::size_t>(row)]));
    group.add({labelled(model.channels[c].name + suffix, label),
               {rows.dimension},
               std::move(values),
               row_attributes(model.channels[c].unit_text(), rows)});
  }
}

void add_trajectories(NetcdfGroup& group, Model const& model, std::span<TrajectoryQuantity const> quantities,
                      Trajectory::Result const& result, RowsOfExperiment const& rows, std::string const& label) {
  std::vector<std::string> const dimensions = {"chain", "draw", rows.dimension};
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    TrajectoryQuantity const& quantity = quantities[q];
    Attributes const attributes = row_attributes(quantity.unit, rows);
    if (quantity.channel >= 0) {
      auto const& noisy = result.noisy[static_cast<std::size_t>(quantity.channel)];
      if (!noisy.empty()) group.add({labelled(quantity.name, label), dimensions, flat(noisy, rows), attributes});
      group.add({labelled(quantity.name + "_response", label), dimensions, flat(result.drawn(q), rows), attributes});
      continue;
    }
    // A state that a channel of its name observes is there as the channel's response.
    bool const there = std::any_of(model.channels.begin(), model.channels.end(),
                                   [&](Channel const& channel) { return channel.name == quantity.name; });
    if (!there) group.add({labelled(quantity.name, label), dimensions, flat(result.drawn(q), rows), attributes});
  }
}

}  // namespace sysid
