// Compared by times and numbers, so that a copy of a file is found as well.
#include "experiment/repeated_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/text/words.hpp"

namespace sysid {
namespace {

constexpr std::size_t fewest_samples = 10, fewest_numbers = 5;
constexpr double nearly_all = 0.98;
constexpr double rounding = 1e-12;  // relative: the same numbers may be read in different units

bool alike(double a, double b) { return std::fabs(a - b) <= rounding * std::max(std::fabs(a), std::fabs(b)); }

struct Common {
  std::size_t samples = 0, equal = 0;  // at times that both have; of these with the same number
  std::set<double> numbers;

  bool repeated() const {
    return equal >= fewest_samples && numbers.size() >= fewest_numbers &&
           static_cast<double>(equal) >= nearly_all * static_cast<double>(samples);
  }
};

Common common_samples(Experiment const& one, Experiment const& other, std::size_t channel) {
  Common common;
  if (one.measured[channel].empty() || other.measured[channel].empty()) return common;
  for (std::size_t i = 0, j = 0; i < one.time.size() && j < other.time.size();) {
    if (!alike(one.time[i], other.time[j])) {
      one.time[i] < other.time[j] ? ++i : ++j;
      continue;
    }
    if (one.is_scored(channel, i) && other.is_scored(channel, j)) {
      ++common.samples;
      if (alike(one.measured[channel][i], other.measured[channel][j])) {
        ++common.equal;
        if (common.numbers.size() < fewest_numbers) common.numbers.insert(one.measured[channel][i]);
      }
    }
    ++i, ++j;
  }
  return common;
}

Finding repeated(CheckedFile const& file, ExperimentData const& one, ExperimentData const& other, std::string const& channel,
                 std::size_t count) {
  DataBlock const& first = file.data[static_cast<std::size_t>(one.use.data)];
  DataBlock const& second = file.data[static_cast<std::size_t>(other.use.data)];
  bool const one_file = first.path == second.path;
  return {FindingCode::samples_repeated,
          Severity::error,
          {one.experiment.name, other.experiment.name, channel},
          fmt::format("{} and {} have {} of {} in common{}: each of these counts twice, and the sds come out too small",
                      one.experiment.name, other.experiment.name, counted(count, "sample"), channel,
                      one_file ? " (they read the same file)" : ""),
          fmt::format("leave {} out of the task{}{}", other.experiment.name,
                      one.use.part >= 0 || other.use.part >= 0 ? ", or choose ranges of rows that do not overlap" : "",
                      one_file ? "" : fmt::format("; or correct the `file` of `{}`", second.name))};
}

}  // namespace

Findings find_repeated_samples(CheckedFile const& file, std::vector<ExperimentData> const& data, Model const& model) {
  Findings findings;
  for (std::size_t a = 0; a < data.size(); ++a)
    for (std::size_t b = a + 1; b < data.size(); ++b)
      for (std::size_t c = 0; c < model.channels.size(); ++c) {
        Common const common = common_samples(data[a].experiment, data[b].experiment, c);
        if (!common.repeated()) continue;
        findings.push_back(repeated(file, data[a], data[b], model.channels[c].name, common.equal));
        break;  // one channel of the two is enough
      }
  return findings;
}

}  // namespace sysid
