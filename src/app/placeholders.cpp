// What loggers and spreadsheets write where a sensor gave nothing. A spike of another size may be a measurement: it is left to the
// residuals.
#include "app/placeholders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/number.hpp"

namespace sysid {
namespace {

// Significant digits of a number as it was written, in whatever decimal multiple of its unit: "9999" of 9.999 and 9999.
std::string digits(double value) {
  std::string text = fmt::format("{:.11e}", std::fabs(value));
  text.resize(text.find('e'));
  std::erase(text, '.');
  text.erase(text.find_last_not_of('0') + 1);
  return text;
}

bool is_placeholder(double value) {
  if (!std::isfinite(value)) return false;  // of a channel without samples
  std::string const written = digits(value);
  if (written == "32767" || written == "32768" || written == "65535") return true;
  return written.size() >= 3 && written.find_first_not_of('9') == std::string::npos;
}

// The rows of `values` (NaN: missing) at which its number farthest from the rest stands, where that is a placeholder.
std::vector<std::size_t> placeholder_rows(std::vector<double> const& values) {
  constexpr double far = 10;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (double const value : values)
    if (!std::isnan(value)) low = std::min(low, value), high = std::max(high, value);
  for (double const suspect : {high, low}) {
    if (!is_placeholder(suspect)) continue;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] == suspect) rows.push_back(i);
      if (std::isnan(values[i]) || values[i] == suspect) continue;
      least = std::min(least, values[i]);
      most = std::max(most, values[i]);
    }
    // Where all others are one number nothing tells what is far.
    if (most > least && std::fabs(suspect - (least + most) / 2) > far * (most - least) / 2) return rows;
  }
  return {};
}

Finding finding(Experiment const& experiment, std::string const& name, std::string const& unit, double value,
                std::vector<std::size_t> const& rows, bool input) {
  constexpr std::size_t most_named = 5;
  std::vector<int> named;
  for (std::size_t const row : rows)
    if (named.size() < most_named) named.push_back(experiment.first_row + static_cast<int>(row));
  return {Severity::warning, "looks_missing",
          fmt::format("{} is {}{} in {} {}{} of {}, far from all its other samples: is it a missing value?", name, shortest(value),
                      unit.empty() || unit == "-" ? "" : " " + unit, rows.size() == 1 ? "row" : "rows", fmt::join(named, ", "),
                      rows.size() > most_named ? fmt::format(" and {} more", rows.size() - most_named) : "", experiment.name),
          input ? "an input acts at every row: fill the gap, or begin behind it; a zero or a held value is a guess, too"
                : "leave the cell empty or write `nan`: the row is then not scored"};
}

}  // namespace

Findings find_placeholders(Experiment const& experiment, Model const& model) {
  Findings findings;
  auto const look = [&](std::string const& name, std::string const& unit, std::vector<double> const& values, bool input) {
    std::vector<std::size_t> const rows = placeholder_rows(values);
    if (!rows.empty()) findings.push_back(finding(experiment, name, unit, values[rows.front()], rows, input));
  };
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    std::vector<double> values;
    for (int row = 0; row < experiment.inputs[i].rows(); ++row)
      values.push_back(model.inputs[i].from_si(experiment.inputs[i].sample(row)));
    look(model.inputs[i].name, model.inputs[i].unit_text(), values, true);
  }
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    std::vector<double> values;
    for (double const value : experiment.measured[c]) values.push_back(model.channels[c].from_si(value));
    look(model.channels[c].name, model.channels[c].unit_text(), values, false);
  }
  return findings;
}

}  // namespace sysid
