// The record lists the columns; each CSV file fills its own, in the order in which they were written.
#include "report/file/stored_report.hpp"
#include "report/file/selection.hpp"

#include <fmt/format.h>

#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "report/file/csv.hpp"
#include "report/file/number_table.hpp"
#include "report/file/replacement.hpp"
#include "report/file/report_cbor.hpp"
#include "report/file/stored_files.hpp"
#include "report/file/task_folder.hpp"

namespace sysid {

namespace {

namespace fs = std::filesystem;

/// A file whose columns are taken one after the other.
class Columns {
 public:
  explicit Columns(fs::path path) : path_(std::move(path)), table_(read_number_table(path_)), rows_(table_.rows()) {}

  std::vector<double> take(std::string const& name, std::size_t rows) {
    if (next_ >= table_.names.size() || table_.names[next_] != name)
      throw other(fmt::format("has no column `{}` in place {}", name, next_ + 1));
    if (rows_ != rows) throw other(fmt::format("has {} rows in place of {}", rows_, rows));
    return std::move(table_.columns[next_++]);
  }
  /// Leaves out those that hold no number of the record.
  void pass(std::string const& name) { (void)take(name, rows_); }
  void end() const {
    if (next_ != table_.names.size()) throw other(fmt::format("has {} columns in place of {}", table_.names.size(), next_));
  }

 private:
  UserError other(std::string const& what) const {
    return unusable_result(fmt::format("`{}` does not belong to this result: it {}", path_.string(), what));
  }
  fs::path path_;
  NumberTable table_;
  std::size_t rows_;
  std::size_t next_ = 0;
};

void read_chain(fs::path const& path, Draws const& draws, Chain& chain) {
  Columns columns(path);
  std::size_t const rows = chain.values.size();
  auto const fill = [&](char const* name, std::vector<double>& column) {
    if (column.empty())
      columns.pass(name);
    else
      column = columns.take(name, rows);
  };
  fill("lp__", chain.log_density);
  fill("accept_stat__", chain.acceptance);
  fill("log_prior__", chain.log_prior);
  fill("log_likelihood__", chain.log_likelihood);
  for (auto& row : chain.values) row.resize(draws.names.size());
  for (std::size_t p = 0; p < draws.names.size(); ++p) {
    std::vector<double> const values = columns.take(stan_name(draws.names[p]), rows);
    for (std::size_t d = 0; d < rows; ++d) chain.values[d][p] = values[d];
  }
  columns.end();
}

void read_prediction(fs::path const& path, Prediction& prediction) {
  Columns columns(path);
  std::size_t const rows = prediction.time.size();
  prediction.time = columns.take(prediction.rows ? "row" : "t", rows);
  for (PredictedQuantity& quantity : prediction.quantities) {
    auto const band = [&](std::string const& name, Band& into) {
      bool const there = !into.mean.empty();
      for (auto const& [end, column] : {std::pair("_mean", &into.mean), std::pair("_sd", &into.sd), std::pair("_q2.5", &into.lower),
                                        std::pair("_q97.5", &into.upper)}) {
        std::vector<double> values = columns.take(name + end, rows);
        if (there) *column = std::move(values);
      }
    };
    band(quantity.name, quantity.response);
    if (!quantity.noisy.mean.empty()) band(quantity.name + "_noisy", quantity.noisy);
    for (auto const& [part, column] : variance_columns(quantity.variance)) *column = columns.take(quantity.name + part, rows);
    if (!quantity.measured.empty()) quantity.measured = columns.take(quantity.name + "_measured", rows);
  }
  std::vector<double> const scored = columns.take("scored", rows);
  for (std::size_t i = 0; i < rows; ++i) prediction.scored[i] = scored[i] != 0 ? 1 : 0;
  columns.end();
}

void read_function(fs::path const& path, FunctionReport& function) {
  Columns columns(path);
  std::size_t const rows = function.grid.size();
  auto const fill = [&](std::string const& name, auto const& place) {
    std::vector<double> const values = columns.take(name, rows);
    for (std::size_t i = 0; i < rows; ++i) place(function.grid[i]) = values[i];
  };
  for (std::size_t d = 0; d < function.inputs.size(); ++d)
    fill(function.inputs[d].first, [d](FunctionPoint& point) -> double& { return point.inputs[d]; });
  fill("mean", [](FunctionPoint& point) -> double& { return point.mean; });
  fill("sd", [](FunctionPoint& point) -> double& { return point.sd; });
  fill("q5", [](FunctionPoint& point) -> double& { return point.q5; });
  fill("q95", [](FunctionPoint& point) -> double& { return point.q95; });
  columns.end();
}

void read_particles(fs::path const& path, SelectedModel& model) {
  Columns columns(path);
  std::size_t const rows = model.weight.size();
  model.weight = columns.take("weight__", rows);
  model.distance = columns.take("distance__", rows);
  columns.pass("population__");
  for (std::size_t d = 0; d < model.parameters.size(); ++d) {
    std::vector<double> const values = columns.take(stan_name(model.parameters[d].name), rows);
    for (std::size_t j = 0; j < rows; ++j) model.declared(static_cast<int>(d), static_cast<int>(j)) = values[j];
  }
  columns.end();
}

/// Draws of jumping chains are no particles: they are kept as draws alone.
void read_jump_draws(fs::path const& path, SelectedModel& model) {
  std::size_t const rows = model.weight.size();
  Draws draws;
  for (ParameterInfo const& parameter : model.parameters) draws.names.push_back(parameter.name);
  Chain chain;
  chain.values.resize(rows);
  chain.log_density.resize(rows);
  read_chain(path, draws, chain);
  model.log_density = chain.log_density;
  model.weight.assign(rows, 1.0 / static_cast<double>(rows));
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t d = 0; d < draws.names.size(); ++d)
      model.declared(static_cast<int>(d), static_cast<int>(j)) = chain.values[j][d];
}

}  // namespace

Report read_result(fs::path const& folder) {
  fs::path const path = folder / "report.cbor";
  if (summary_stands(folder) && !fs::exists(path))
    throw UserError(result_error("E6209", fmt::format("the results in `{}` have no `report.cbor`", folder.string()),
                                 run_again("they were written by an earlier version of sysid, or the file was lost: ")));
  read_whole_summary(folder);  // the columns are those that were written
  Report report = read_record(read_regular_file(path), path);
  for (std::size_t c = 0; c < report.draws.chains.size(); ++c)
    read_chain(folder / draws_file(c), report.draws, report.draws.chains[c]);
  std::vector<std::string> const prediction_names = prediction_files(report);
  for (std::size_t p = 0; p < report.predictions.size(); ++p) read_prediction(folder / prediction_names[p], report.predictions[p]);
  std::vector<std::string> const states_names = states_files(report);
  for (std::size_t e = 0; e < report.states.size(); ++e) read_prediction(folder / states_names[e], report.states[e]);
  if (report.discovery) {
    std::vector<Prediction>& runs = report.discovery->free_runs;
    std::vector<std::string> const names = free_run_files(report);
    for (std::size_t r = 0; r < runs.size(); ++r) read_prediction(folder / names[r], runs[r]);
  }
  std::vector<std::string> const function_names = function_files(report);
  for (std::size_t f = 0; f < report.functions.size(); ++f) read_function(folder / function_names[f], report.functions[f]);
  if (!report.selection) return report;
  SelectionReport& selection = *report.selection;
  if (selection.refined_draws.size() > selection.result.models.size())
    throw unusable_result(fmt::format("`{}` is damaged", path.string()));
  std::vector<std::string> const names = model_file_names(selection.result);
  for (std::size_t m = 0; m < names.size(); ++m) {
    SelectedModel& model = selection.result.models[m];
    if (model.weight.empty()) continue;
    if (selection.result.jumps)
      read_jump_draws(folder / model_draws_file(names[m]), model);
    else
      read_particles(folder / particles_file(names[m]), model);
  }
  for (std::size_t m = 0; m < selection.refined_draws.size(); ++m) {
    if (selection.result.models[m].died_in > 0 || selection.result.models[m].weight.empty()) continue;  // they have no files
    Draws& draws = selection.refined_draws[m];
    for (std::size_t c = 0; c < draws.chains.size(); ++c) read_chain(folder / refined_file(names[m], c), draws, draws.chains[c]);
  }
  return report;
}

}  // namespace sysid
