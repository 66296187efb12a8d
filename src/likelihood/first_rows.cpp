// Cuts by counting scored rows.
#include "likelihood/first_rows.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {
namespace {

bool scored_at(Experiment const& experiment, std::size_t row) {
  for (std::size_t c = 0; c < experiment.measured.size(); ++c)
    if (experiment.is_scored(c, row)) return true;
  return false;
}

int scored_rows(Experiment const& experiment) {
  int count = 0;
  for (std::size_t i = 0; i < experiment.time.size(); ++i) count += scored_at(experiment, i) ? 1 : 0;
  return count;
}

/// Rows up to the one that is the so many-th to be scored.
int rows_until(Experiment const& experiment, int scored) {
  auto const rows = static_cast<int>(experiment.time.size());
  int seen = 0;
  for (int i = 0; i < rows; ++i) {
    seen += scored_at(experiment, static_cast<std::size_t>(i)) ? 1 : 0;
    if (seen >= scored) return i + 1;
  }
  return rows;
}

}  // namespace

int most_scored_rows(std::span<Experiment const> experiments) {
  int most = 0;
  for (Experiment const& each : experiments) most = std::max(most, scored_rows(each));
  return most;
}

FirstRows first_rows(std::span<Experiment const> experiments, double share, int least) {
  FirstRows result{{}, 1};
  double kept = 0, all = 0;
  for (Experiment const& each : experiments) {
    int const rows = static_cast<int>(each.time.size());
    auto const wanted = static_cast<int>(std::ceil(share * scored_rows(each)));
    int const count = std::clamp(rows_until(each, std::max(wanted, least)), std::min(rows, 2), rows);
    result.experiments.push_back(count < rows ? slice(each, 0, count) : each);
    kept += count;
    all += rows;
  }
  if (all > 0) result.share = kept / all;
  return result;
}

}  // namespace sysid
