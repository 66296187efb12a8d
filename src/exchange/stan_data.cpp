// Matrices by rows, from the schedule that the likelihood itself runs on.
#include "exchange/stan_data.hpp"

#include <fmt/format.h>

#include <cmath>

#include "exchange/stan_names.hpp"

namespace sysid {
namespace {

using Json = nlohmann::ordered_json;

std::string column_name(Model const& model, UniformLeaf const& leaf) {
  auto const index = static_cast<std::size_t>(leaf.index);
  std::string const name = leaf.kind == LeafKind::time         ? std::string("time")
                           : leaf.kind == LeafKind::measured   ? model.channels[index].name
                           : leaf.kind == LeafKind::input_rate ? model.inputs[index].name + "'"
                                                               : model.inputs[index].name;
  return leaf.lag > 0 ? fmt::format("{} {} samples before", name, leaf.lag) : name;
}

std::string column_names(Model const& model, StanColumns const& columns) {
  std::vector<std::string> names;
  for (UniformLeaf const& leaf : columns.leaves()) names.push_back(column_name(model, leaf));
  return fmt::format("{}", fmt::join(names, ", "));
}

StanDataNames data_names(std::string const& suffix, std::vector<std::string>& taken) {
  auto const name = [&](char const* word) { return stan_identifier(word + suffix, taken); };
  StanDataNames names;
  names.samples = name("samples");
  names.measured = name("measured");
  names.scored = name("scored");
  names.stages = name("stages");
  names.h = name("h");
  names.count = name("N");
  return names;
}

std::string declarations(StanFit const& fit, StanColumns const& columns, StanDataNames const& names) {
  std::string text =
      fmt::format("  int<lower=1> {0};\n  matrix[{0}, {1}] {2};\n  matrix[{0}, {3}] {4};\n  matrix[{0}, {3}] {5};\n", names.count,
                  columns.count(), names.samples, fit.model().channels.size(), names.measured, names.scored);
  if (fit.steps()) {
    std::string const intervals = fmt::format("{} - 1", names.count);
    text += fmt::format("  matrix[{0}, {1}] {2};\n  vector[{0}] {3};\n",
                        fit.exact() ? intervals : fmt::format("({}) * substeps", intervals), 3 * columns.count(), names.stages,
                        names.h);
  }
  return text;
}

// A sample of an input that is never read where it is missing.
double finite(double value) { return std::isfinite(value) ? value : 0.0; }

void add_samples(Schedule const& schedule, StanColumns const& columns, Experiment const& experiment, StanDataNames const& names,
                 Json& values) {
  Json samples = Json::array(), measured = Json::array(), scored = Json::array();
  for (int i = 0; i < schedule.last_summed(); ++i) {
    Json sample = Json::array(), row = Json::array(), flags = Json::array();
    for (UniformLeaf const& leaf : columns.leaves()) sample.push_back(finite(schedule.at_sample(leaf, i)));
    for (std::size_t c = 0; c < experiment.measured.size(); ++c) {
      bool const there = schedule.summed(static_cast<int>(c), i);
      row.push_back(there ? experiment.measured[c][static_cast<std::size_t>(i)] : 0.0);
      flags.push_back(there ? 1 : 0);
    }
    samples.push_back(sample);
    measured.push_back(row);
    scored.push_back(flags);
  }
  values[names.count] = schedule.last_summed();
  values[names.samples] = samples;
  values[names.measured] = measured;
  values[names.scored] = scored;
}

void add_steps(Schedule const& schedule, StanColumns const& columns, StanFit const& fit, StanDataNames const& names, Json& values) {
  // Of exact steps those that pass for equal are, so that the program computes what hangs on their length once.
  LeafKind const length = fit.exact() ? LeafKind::step_length : LeafKind::step_size;
  Json stages = Json::array(), h = Json::array();
  for (int i = 0; i + 1 < schedule.last_summed(); ++i)
    for (int k = 0; k < fit.substeps(); ++k) {
      Json row = Json::array();
      for (Stage const stage : {Stage::begin, Stage::middle, Stage::end})
        for (UniformLeaf leaf : columns.leaves()) {
          leaf.stage = stage;
          // What observations alone read has no value between the samples.
          row.push_back(leaf.kind == LeafKind::measured || leaf.lag > 0 ? 0.0 : schedule.at_step(leaf, i, k));
        }
      stages.push_back(row);
      h.push_back(schedule.at_step({length, 0, Stage::begin, 0}, i, k));
    }
  values[names.stages] = stages;
  values[names.h] = h;
}

}  // namespace

StanData stan_data(StanFit const& fit, StanColumns const& columns, std::vector<std::string>& taken) {
  StanData data{fmt::format("data {{\n  // columns: {}\n", column_names(fit.model(), columns)), Json::object(), {}};
  if (fit.steps() && !fit.exact()) {
    data.block += "  int<lower=1> substeps;\n";
    data.values["substeps"] = fit.substeps();
  }
  for (ExperimentData const& each : fit.data) {
    StanDataNames const names = data_names(fit.data.size() > 1 ? "_" + each.use.name : "", taken);
    Schedule const schedule(*fit.compiled->likelihood, each.experiment, fit.steps() ? fit.solver : SolverSettings{});
    data.block += declarations(fit, columns, names);
    add_samples(schedule, columns, each.experiment, names, data.values);
    if (fit.steps()) add_steps(schedule, columns, fit, names, data.values);
    data.names.push_back(names);
  }
  data.block += "}\n";
  return data;
}

}  // namespace sysid
