// Findings on trajectories, and their wording.
#include "inference/nuts/trajectory_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/lanes.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"

namespace sysid::nuts {
namespace {

/// Where trajectories diverged in one parameter, beside its draws. Declared units.
struct Place {
  std::string name, unit;
  double low = 0, high = 0;  // half of the places lie between them
  double median = 0;         // of the draws
  double apart = 0;          // of the places' median from that of the draws, in shares of the draws: 0 to 0.5
};

/// Places [P x n], declared.
LaneArray declared_places(TrajectoryReport const& report) {
  int const dimension = report.target.dimension();
  std::vector<double> all;
  for (Tally const& tally : report.tallies) all.insert(all.end(), tally.places.begin(), tally.places.end());
  auto const width = static_cast<int>(all.size() / static_cast<std::size_t>(dimension));
  LaneArray theta(dimension, width), declared(dimension, width);
  for (int w = 0; w < width; ++w)
    for (int p = 0; p < dimension; ++p)
      theta(p, w) = all[static_cast<std::size_t>(w) * static_cast<std::size_t>(dimension) + static_cast<std::size_t>(p)];
  report.target.constrain(theta, declared);
  return declared;
}

Place place_in(TrajectoryReport const& report, LaneArray const& places, int p) {
  std::vector<double> here(places.row(p).begin(), places.row(p).end()), draws;
  for (sysid::Chain const& chain : report.draws.chains)
    for (std::vector<double> const& row : chain.values) draws.push_back(row[static_cast<std::size_t>(p)]);
  std::sort(here.begin(), here.end());
  std::sort(draws.begin(), draws.end());
  double const middle = sorted_quantile(here, 0.5);
  auto const [first, last] = std::equal_range(draws.begin(), draws.end(), middle);
  double const below = 0.5 * static_cast<double>((first - draws.begin()) + (last - draws.begin()));
  return {report.draws.names[static_cast<std::size_t>(p)],
          report.draws.units[static_cast<std::size_t>(p)],
          sorted_quantile(here, 0.25),
          sorted_quantile(here, 0.75),
          sorted_quantile(draws, 0.5),
          std::fabs(below / static_cast<double>(draws.size()) - 0.5)};
}

/// The parameter that tells most about where trajectories diverge.
Place place_of(TrajectoryReport const& report) {
  LaneArray const places = declared_places(report);
  Place best = place_in(report, places, 0);
  for (int p = 1; p < report.target.dimension(); ++p)
    if (Place each = place_in(report, places, p); each.apart > best.apart) best = std::move(each);
  return best;
}

std::string words_of(Place const& place) {
  std::string const unit = unit_after_number(place.unit);
  std::string const where = place.low == place.high ? fmt::format("where `{}` is {:.4g}{}", place.name, place.low, unit)
                                                    : fmt::format("half of them where `{}` lies between {:.4g} and {:.4g}{}",
                                                                  place.name, place.low, place.high, unit);
  return fmt::format("{} (posterior median {:.4g}{})", where, place.median, unit);
}

std::string remedy(double acceptance) {
  std::string const shorter = acceptance < 0.95 ? "acceptance = 0.95" : acceptance < 0.99 ? "acceptance = 0.99" : "";
  return (shorter.empty() ? std::string() : "use " + shorter + ", which takes shorter steps; if that does not help, ") +
         "sample with mh or tempering; if the members of a hierarchy have bounds, write it in the non-centred form (k = mean + "
         "spread*z)";
}

}  // namespace

Findings check_trajectories(TrajectoryReport const& report) {
  Tally sum;
  for (Tally const& tally : report.tallies) {
    sum.trajectories += tally.trajectories;
    sum.diverged += tally.diverged;
    sum.unsolved += tally.unsolved;
    sum.cut += tally.cut;
  }
  Findings findings;
  if (sum.trajectories == 0) return findings;
  auto const all = static_cast<double>(sum.trajectories);
  if (sum.diverged > 0) {
    Place const place = place_of(report);
    bool const many = static_cast<double>(sum.diverged - sum.unsolved) >= most_divergent * all;
    findings.push_back(
        {FindingCode::trajectories_diverge,
         many ? Severity::error : Severity::warning,
         {place.name},
         fmt::format("{} of {} trajectories diverged{}, so a part of the posterior may be missing from the draws: {}", sum.diverged,
                     sum.trajectories, sum.unsolved == 0 ? "" : fmt::format(" ({} where the model cannot be solved)", sum.unsolved),
                     words_of(place)),
         remedy(report.acceptance)});
  }
  if (static_cast<double>(sum.cut) >= most_cut * all)
    findings.push_back(
        {FindingCode::trajectories_cut,
         Severity::warning,
         {},
         fmt::format("{:.2g} % of the trajectories reached the maximum length of {} steps without a U-turn, so the draws are more "
                     "correlated than necessary",
                     100 * static_cast<double>(sum.cut) / all, (1 << report.depth) - 1),
         fmt::format("use a longer burn-in (burn_in), in which the metric is adapted{}; check for parameters that the data cannot "
                     "separate, and for discontinuities of the density, for which mh is better",
                     report.depth < 15 ? fmt::format(", or depth = {}", std::min(15, report.depth + 2)) : "")});
  return findings;
}

}  // namespace sysid::nuts
