// What the fuzzers do with bytes: all stages that see a user's text or data, with bounded work. Anything but an answer is a fault
// of ours and leaves as an exception or a signal.
#pragma once
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "check/check.hpp"
#include "check/elaborate/elaborate.hpp"
#include "core/numeric/unit.hpp"
#include "core/text/diagnostic.hpp"
#include "data/record.hpp"
#include "data/record_rows.hpp"
#include "data/table/table.hpp"
#include "likelihood/compiled_model.hpp"
#include "likelihood/process/process_model.hpp"
#include "load/modules.hpp"
#include "model/lags.hpp"
#include "simulate/simulator.hpp"
#include "syntax/format.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid::fuzz {

[[noreturn]] inline void fault(std::string const& what) { throw InternalError(what); }

/// Stands for the back ends: the checker knows their settings only.
inline constexpr SettingRow settings[] = {{"samples", SettingKind::integer, "1000", 1, 1e9, "", ""},
                                          {"quantile", SettingKind::real, "0.5", 0, 1, "", ""},
                                          {"proposal", SettingKind::word, "adaptive", 0, 0, "adaptive spherical", ""},
                                          {"start", SettingKind::flag, "yes", 0, 0, "", ""}};
inline constexpr BackendSettings backends[] = {{"mh", settings}, {"point", {}}};
inline constexpr BackendSettings selectors[] = {{"abc", {}}};
inline constexpr BackendSettings term_selectors[] = {{"spike_slab", {}}};
inline constexpr BackendSettings derivatives[] = {{"weak", {}}};

/// A refusal has a code, words, something to point at within the text, and can be shown.
inline void look_at(Diagnostics const& diagnostics, Source const& source) {
  for (Diagnostic const& diagnostic : diagnostics.all()) {
    if (diagnostic.code.empty() || diagnostic.message.empty()) fault("a message without a code or words");
    if (diagnostic.primary && diagnostic.primary->span.end > source.text().size()) fault("a message that points behind the text");
  }
  (void)render(diagnostics, source, true);
  (void)render_json(diagnostics, source);
}

/// One step of the model at parameters that need not make sense.
inline void simulate_one_step(Model model) {
  SolverSettings solver;
  if (model.implicit) solver.method = "ida";  // as the checker chooses
  if (!model.processes.empty()) {
    (void)ProcessModel(model, false, solver.method);
    remove_processes(model);
  }
  std::shared_ptr<CompiledModel const> const compiled = compile(model, false, solver.method);
  (void)dump_program(*compiled);
  int const history = data_lag(model);
  std::vector<double> time, samples;
  for (int i = -history; i < 2; ++i) {
    time.push_back(0.01 * i);
    samples.push_back(i < 0 ? 0 : 0.5 * (1 + i));
  }
  Experiment experiment;
  experiment.time = {0, 0.01};
  experiment.history.assign(model.channels.size(), std::vector<double>(static_cast<std::size_t>(history), 0.0));
  for (std::size_t i = 0; i < model.inputs.size(); ++i)
    experiment.inputs.push_back(InputSignal(InputRule::linear, time, samples).view(history, 2));
  experiment.measured.assign(model.channels.size(), {0.25, 0.5});
  experiment.scored = {1, 1};
  std::vector<double> const parameters(static_cast<std::size_t>(compiled->parameter_rows()), 0.75);
  int const lanes = 2;
  std::vector<double> batch;
  for (double const value : parameters) batch.insert(batch.end(), lanes, value);
  std::vector<double> sums(static_cast<std::size_t>(compiled->likelihood->sum_count() * lanes));
  std::vector<Outcome> outcome(lanes);
  Simulator const simulator(compiled->likelihood, Schedule(*compiled->likelihood, experiment, solver));
  simulator.sums(ConstLanes(batch.data(), static_cast<int>(parameters.size()), lanes),
                 Lanes(sums.data(), compiled->likelihood->sum_count(), lanes), outcome);
}

/// Text to tree to models to programs; the canonical layout on the way.
inline void text(std::string const& bytes) {
  Source source("fuzz.sysid", bytes);
  Diagnostics diagnostics;
  auto const tree = parse(source, diagnostics);
  if (tree.has_value() != diagnostics.all().empty()) fault("a tree and messages, or neither");
  look_at(diagnostics, source);
  if (!tree) return;
  std::string const canonical = unparse(*tree);
  Diagnostics none;
  if (parse(Source("canonical", canonical), none) != tree) fault("the printed tree reads as another");
  std::string const layout = formatted(source, none).value();
  if (formatted(Source("layout", layout), none) != layout) fault("the canonical layout is not its own layout");
  auto const modules = load_modules(*tree, source, diagnostics);
  look_at(diagnostics, source);
  if (diagnostics.has_errors()) return;
  auto const file = check(elaborate(*tree, modules, diagnostics),
                          {backends, selectors, term_selectors, derivatives, {"samples", {}}}, diagnostics);
  if (!file && !diagnostics.has_errors()) fault("a refusal without a message");
  look_at(diagnostics, source);
  if (!file) return;
  for (Model const& model : file->models) simulate_one_step(model);
}

/// CSV bytes to a table, its numbers and a record; a refusal is an answer. The first byte chooses the rule between samples.
inline void data(std::string const& bytes) {
  if (bytes.empty()) return;
  constexpr InputRule rules[] = {InputRule::zero_order, InputRule::linear, InputRule::cubic, InputRule::band_limited};
  unsigned const choice = static_cast<unsigned char>(bytes[0]);
  std::string const content = bytes.substr(1);
  std::vector<std::string> columns;
  try {
    Table const table = Table::parse("fuzz.csv", content);
    columns = table.columns();
    for (std::string const& column : columns)
      if (static_cast<int>(table.numbers(column).size()) != table.rows()) fault("a column of another length than the table");
  } catch (UserError const& refusal) {
    if (refusal.diagnostic().code.empty()) fault("a refusal without a code");
  }
  if (columns.empty()) return;
  static std::string const path = (std::filesystem::temp_directory_path() / fmt::format("sysid_fuzz_{}.csv", ::getpid())).string();
  std::ofstream(path, std::ios::binary) << content;
  RecordRequest request;
  request.path = path;
  if (choice & 4U)
    request.time = ColumnRequest{columns[0], unit_atom("ms"), std::nullopt, std::nullopt};
  else
    request.step = 0.01;
  InputRequest input;
  input.column = columns[(choice >> 3U) % columns.size()];
  input.rule = rules[choice % 4U];
  request.inputs = {input};
  request.measured = {ColumnRequest{columns.back(), unit_atom("degC"), unit_atom("K"), std::nullopt}, std::nullopt};
  Diagnostics diagnostics;
  auto const record = load(request, diagnostics);
  if (record.has_value() != diagnostics.all().empty()) fault("a record and messages, or neither");
  if (!record) return;
  for (double const s : {0.0, 0.5, 1.0}) (void)record->inputs[0].value(record->rows() - 2, s);
  try {
    (void)make_experiment(*record, "fuzz", 1, {1, 0});
  } catch (UserError const& refusal) {  // gaps in an input are refused where they are used
    if (refusal.diagnostic().code.empty()) fault("a refusal without a code");
  }
}

}  // namespace sysid::fuzz
