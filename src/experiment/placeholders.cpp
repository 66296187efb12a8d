// What loggers and spreadsheets write where a sensor gave nothing. A spike of another size may be a measurement: it is left to the
// residuals.
#include "experiment/placeholders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/text/number.hpp"
#include "core/text/words.hpp"

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

struct Suspect {
  double value;
  std::vector<std::size_t> rows;
};

// Placeholders among `values` (NaN: missing) that are far from all values that are none.
std::vector<Suspect> suspects(std::vector<double> const& values) {
  constexpr double far = 10;
  std::vector<Suspect> found;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    if (!is_placeholder(values[i])) {
      least = std::min(least, values[i]);
      most = std::max(most, values[i]);
      continue;
    }
    auto same = std::find_if(found.begin(), found.end(), [&](Suspect const& each) { return each.value == values[i]; });
    if (same == found.end()) same = found.insert(found.end(), {values[i], {}});
    same->rows.push_back(i);
  }
  // Where all others are one number nothing tells what is far.
  std::erase_if(found, [&](Suspect const& each) {
    return !(most > least) || std::fabs(each.value - (least + most) / 2) <= far * (most - least) / 2;
  });
  return found;
}

Finding finding(ExperimentData const& data, ColumnUse const& column, std::string const& unit, Suspect const& suspect, bool input) {
  constexpr std::size_t most_named = 5;
  std::vector<std::string> rows;
  for (std::size_t const row : suspect.rows) rows.push_back(std::to_string(data.experiment.first_row + static_cast<int>(row)));
  return {FindingCode::looks_missing,
          Severity::warning,
          {column.column, data.use.name},
          fmt::format("column `{}` of {} is {:.12g}{} in {} {}, far from all its other numbers: a missing value?", column.column,
                      data.use.name, suspect.value, unit_after_number(unit), plural("row", rows.size()),
                      first_listed(rows, most_named)),
          input ? "an input acts at every row: interpolate the missing samples, or begin after them; if a pulse saturated the "
                  "recorder, the true values are larger"
                : "leave the cell empty or write `NA`: the row is then not scored"};
}

}  // namespace

Findings find_placeholders(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  Experiment const& experiment = data.experiment;
  Findings findings;
  auto const look = [&](ColumnUse const& column, Quantity const& quantity, std::vector<double> values, bool input) {
    std::string unit = quantity.unit_text();
    for (double& value : values) value = quantity.from_si(value);
    if (column.unit && quantity.unit) {
      unit = column.unit->text;
      for (double& value : values) value = convert(value, *quantity.unit, *column.unit);
    }
    for (Suspect const& suspect : suspects(values)) findings.push_back(finding(data, column, unit, suspect, input));
  };
  for (DataInputUse const& column : block.inputs)
    for (std::size_t i = 0; i < model.inputs.size(); ++i) {
      if (model.inputs[i].name != column.input) continue;
      std::vector<double> values;
      for (int row = 0; row < experiment.inputs[i].rows(); ++row) values.push_back(experiment.inputs[i].sample(row));
      look(column, model.inputs[i], std::move(values), true);
    }
  bool const goes_on = model.dynamics == Dynamics::discrete;
  for (DataMeasureUse const& column : block.measured)
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      if (model.channels[c].name != column.channel) continue;
      std::vector<double> values = experiment.measured[c];
      for (std::size_t i = 0; i < values.size(); ++i)
        if (!goes_on && experiment.scored[i] == 0) values[i] = std::nan("");
      look(column, model.channels[c], std::move(values), false);
    }
  return findings;
}

}  // namespace sysid
