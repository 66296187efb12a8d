// CSV that R, Python and CmdStan's own tools read.
#include "report/file/csv.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>

#include "core/text/number.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {

std::string csv_field(std::string const& text) {
  if (text.find_first_of(",\"\n\r#") == std::string::npos) return text;
  std::string out = "\"";
  for (char const c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::string stan_name(std::string const& name) {
  std::string out;
  for (char const c : name) {
    if (c == '.') out += ':';
    if (c == '[' || c == ',') out += '.';
    if (c != '.' && c != '[' && c != ',' && c != ']' && c != ' ') out += c;
  }
  return out;
}

namespace {

std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

std::string units(std::vector<std::string> const& names, std::vector<std::string> const& values) {
  std::string out = "# units =";
  for (std::size_t i = 0; i < names.size(); ++i) out += fmt::format("{} {} [{}]", i == 0 ? "" : ",", names[i], values[i]);
  return out + "\n";
}

/// As `shortest` has it, and a comma.
void add_cell(std::string& out, double value) {
  if (std::isfinite(value))
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("{},"), value);
  else
    out += shortest(value) + ',';
}

double value_at(std::vector<double> const& values, std::size_t i) {
  return i < values.size() ? values[i] : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::string csv_head(Report const& report, std::string_view model) {
  std::string out;
  auto const add = [&](std::string_view name, std::string const& value) {
    out += fmt::format("# {} = {}\n", name, one_line(value));
  };
  add("program", "sysid");
  add("format", std::to_string(stored_form));
  add("sysid_version", report.version);
  add("model", model.empty() ? report.model_name : std::string(model));
  add("task", report.task);
  add("what", report.what);
  add("seed", std::to_string(report.seed));
  for (DataInfo const& data : report.data) add("data", fmt::format("{} ({}) sha256 {}", data.name, data.file, data.sha256));
  for (auto const& [name, value] : report.settings) add("setting " + name, setting_text(value));
  return out;
}

std::string draws_csv(Report const& report, int chain) {
  Chain const& draws = report.draws.chains[static_cast<std::size_t>(chain)];
  std::string out = csv_head(report);
  out += fmt::format("# id = {}\n# num_samples = {}\n", chain + 1, draws.values.size());
  out += units(report.draws.names, report.draws.units);
  out += "lp__,accept_stat__,log_prior__,log_likelihood__";
  for (std::string const& name : report.draws.names) out += "," + csv_field(stan_name(name));
  out += '\n';
  for (std::size_t d = 0; d < draws.values.size(); ++d) {
    for (auto* const column : {&draws.log_density, &draws.acceptance, &draws.log_prior, &draws.log_likelihood})
      add_cell(out, value_at(*column, d));
    for (double const value : draws.values[d]) add_cell(out, value);
    out.back() = '\n';
  }
  return out;
}

std::string predict_csv(Report const& report, Prediction const& prediction) {
  std::string out = csv_head(report);
  out += fmt::format("# experiment = {}\n", one_line(prediction.experiment));
  std::vector<std::string> names, unit_texts;
  std::vector<std::vector<double> const*> columns;
  std::string header = prediction.rows ? "row" : "t";
  auto const add_column = [&](std::string const& name, std::vector<double> const& values) {
    header += "," + csv_field(name);
    columns.push_back(&values);
  };
  auto const add_band = [&](std::string const& name, Band const& band) {
    add_column(name + "_mean", band.mean);
    add_column(name + "_sd", band.sd);
    add_column(name + "_q2.5", band.lower);
    add_column(name + "_q97.5", band.upper);
  };
  for (PredictedQuantity const& quantity : prediction.quantities) {
    names.push_back(quantity.name);
    unit_texts.push_back(quantity.unit);
    add_band(quantity.name, quantity.response);
    if (!quantity.noisy.mean.empty()) add_band(quantity.name + "_noisy", quantity.noisy);
    for (auto const& [part, column] : variance_columns(quantity.variance)) add_column(quantity.name + part, *column);
    if (!quantity.measured.empty()) add_column(quantity.name + "_measured", quantity.measured);
  }
  out += units(names, unit_texts) + header + ",scored\n";
  for (std::size_t i = 0; i < prediction.time.size(); ++i) {
    add_cell(out, prediction.time[i]);
    for (std::vector<double> const* column : columns) add_cell(out, value_at(*column, i));
    out += prediction.scored[i] != 0 ? "1\n" : "0\n";
  }
  return out;
}

std::string pointwise_csv(Report const& report) {
  std::string out = csv_head(report);
  std::vector<PointwiseScores> const& all = report.criteria->pointwise;
  for (std::size_t s = 0; s < all.size(); ++s)
    out += fmt::format("# series {} = {} on {}\n", s + 1, one_line(all[s].channel), one_line(all[s].experiment));
  out += "series,row,log_density,p_waic,elpd_loo,pareto_k,elpd_block,elpd_future\n";
  for (std::size_t s = 0; s < all.size(); ++s)
    for (std::size_t i = 0; i < all[s].rows.size(); ++i) {
      fmt::format_to(std::back_inserter(out), "{},{},", s + 1, all[s].rows[i]);
      for (auto* const column :
           {&all[s].log_density, &all[s].p_waic, &all[s].elpd_loo, &all[s].pareto_k, &all[s].elpd_block, &all[s].elpd_future})
        add_cell(out, (*column)[i]);
      out.back() = '\n';
    }
  return out;
}

}  // namespace sysid
