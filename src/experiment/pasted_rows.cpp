#include "experiment/pasted_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>
#include <unordered_map>
#include <vector>

namespace sysid {
namespace {

constexpr std::size_t fewest_rows = 10, fewest_different = 5;

/// The columns that the model reads.
std::vector<std::vector<double>> columns_of(Experiment const& experiment, bool timed) {
  std::vector<std::vector<double>> columns;
  if (timed) columns.push_back(experiment.time);
  for (InputSignal const& input : experiment.inputs) {
    std::vector<double>& column = columns.emplace_back(experiment.time.size());
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = input.sample(static_cast<int>(i));
  }
  for (std::vector<double> const& channel : experiment.measured)
    if (!channel.empty()) columns.push_back(channel);
  return columns;
}

struct RepeatedRows {
  std::size_t begin = 0, end = 0, lag = 0;  // rows begin..end-1 are those `lag` before
};

/// Each longest part of which all rows are equal to the last ones like them, one after the other.
std::vector<RepeatedRows> repeated_rows(std::vector<std::vector<double>> const& columns, std::size_t rows) {
  auto const equal = [&](std::size_t a, std::size_t b) {
    return std::all_of(columns.begin(), columns.end(), [&](std::vector<double> const& column) { return column[a] == column[b]; });
  };
  std::unordered_map<std::size_t, std::size_t> last;  // by a digest of the row
  std::vector<RepeatedRows> parts;
  for (std::size_t i = 0; i < rows; ++i) {
    std::size_t digest = 0;
    for (std::vector<double> const& column : columns) digest = digest * 1000003U + std::hash<double>()(column[i]);
    auto const [before, is_new] = last.try_emplace(digest, i);
    std::size_t const lag = i - before->second;
    before->second = i;
    if (is_new || !equal(i, i - lag)) continue;
    if (!parts.empty() && parts.back().end == i && parts.back().lag == lag)
      ++parts.back().end;
    else
      parts.push_back({i, i + 1, lag});
  }
  return parts;
}

/// Different numbers of the channel that has the most of them.
std::size_t different_numbers(Experiment const& experiment, RepeatedRows const& part) {
  std::size_t most = 0;
  for (std::vector<double> const& channel : experiment.measured) {
    if (channel.empty()) continue;
    auto const begin = channel.begin() + static_cast<std::ptrdiff_t>(part.begin);
    most = std::max(most, std::set<double>(begin, begin + static_cast<std::ptrdiff_t>(part.end - part.begin)).size());
  }
  return most;
}

bool pasted(Experiment const& experiment, RepeatedRows const& part, bool dynamic) {
  constexpr std::size_t fewest_behind = 20;
  std::size_t const rows = part.end - part.begin, numbers = different_numbers(experiment, part);
  if (rows < fewest_rows || rows > part.lag || numbers < fewest_different) return false;
  if (experiment.scored[part.begin - part.lag] == 0) return false;  // counted once
  return !dynamic || (rows >= fewest_behind && rows == part.lag && 10 * numbers >= 8 * rows && part.end < experiment.time.size());
}

}  // namespace

Findings find_pasted_rows(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  bool const timed = file.data[static_cast<std::size_t>(data.use.data)].time.has_value();
  bool const dynamic = model.dynamics != Dynamics::none;
  if (dynamic && timed) return {};
  Experiment const& experiment = data.experiment;
  Findings findings;
  for (RepeatedRows const& part : repeated_rows(columns_of(experiment, timed), experiment.time.size())) {
    if (!pasted(experiment, part, dynamic)) continue;
    auto const rows = [&](std::size_t begin, std::size_t end) {
      return fmt::format("{} to {}", experiment.first_row + static_cast<int>(begin),
                         experiment.first_row + static_cast<int>(end) - 1);
    };
    findings.push_back(
        {FindingCode::samples_repeated,
         Severity::error,
         {experiment.name},
         fmt::format("rows {} of {} repeat rows {} in all columns that are used: each of these counts twice, and the "
                     "sds come out too small",
                     rows(part.begin, part.end), experiment.name, rows(part.begin - part.lag, part.end - part.lag)),
         fmt::format("if they were pasted twice, remove rows {} from the file", rows(part.begin, part.end))});
  }
  return findings;
}

}  // namespace sysid
