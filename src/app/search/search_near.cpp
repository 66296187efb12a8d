// Replaces values in draws of the prior by those of an earlier fit.
#include "app/search/search_near.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/session/fit_end.hpp"
#include "app/session/stored_draws.hpp"
#include "data/cell/unit_text.hpp"

namespace sysid {
namespace {

constexpr int starts_where_all_is_known = 8;
constexpr int starts_with_something_new = 48;
constexpr std::uint64_t near_step = 3'000'000;  // a stream of its own among those of Purpose::start

/// `N/m` and `N m^-1` are one unit: a number means the same in both.
bool is_same_unit(std::string const& now, std::string const& then) {
  if (now == then) return true;
  auto const left = unit_of_text(now), right = unit_of_text(then);
  return left && right && left->dimension == right->dimension && left->offset == right->offset &&
         std::fabs(left->scale / right->scale - 1) < 1e-12 && !cycles_against_radians(*left, *right);
}

/// Per parameter of the target its column among the earlier draws; -1: it is new, or counts in another unit now.
std::vector<int> columns_there(Target const& target, Draws const& earlier) {
  std::vector<int> columns;
  for (ParameterInfo const& parameter : target.parameters()) {
    auto const place = std::find(earlier.names.begin(), earlier.names.end(), parameter.name);
    auto const column = static_cast<std::size_t>(place - earlier.names.begin());
    bool const known =
        place != earlier.names.end() && (column >= earlier.units.size() || is_same_unit(parameter.unit, earlier.units[column]));
    columns.push_back(known ? static_cast<int>(column) : -1);
  }
  return columns;
}

/// Whether the prior of now allows each of these values [P x W], declared, beside others that are drawn from it: a value outside
/// its bounds has no place on their scale.
LaneArray allowed(Target const& target, LaneArray const& values, LaneArray const& drawn) {
  int const count = values.width();
  LaneArray allowed(target.dimension(), count), theta(target.dimension(), count);
  for (int p = 0; p < target.dimension(); ++p) {
    LaneArray beside = drawn;
    std::copy(values.row(p).begin(), values.row(p).end(), beside.row(p).begin());
    target.unconstrain(beside, theta);
    for (int w = 0; w < count; ++w) allowed(p, w) = std::isfinite(theta(p, w)) ? 1 : 0;
  }
  return allowed;
}

}  // namespace

LaneArray starts_near(Target const& target, Draws const& earlier, std::uint64_t seed) {
  std::vector<int> const columns = columns_there(target, earlier);
  auto const coefficient = [&](int p) { return target.parameters()[static_cast<std::size_t>(p)].coefficient; };
  bool something_new = false;
  for (int p = 0; p < target.dimension(); ++p)
    something_new = something_new || (columns[static_cast<std::size_t>(p)] < 0 && !coefficient(p));
  int const count = something_new ? starts_with_something_new : starts_where_all_is_known;
  LaneArray prior(target.dimension(), count), drawn(target.dimension(), count), starts(target.dimension(), count);
  target.sample_prior({seed, Purpose::start, 0, near_step}, prior);
  // A function that the earlier model had not is none at the start.
  for (int p = 0; p < target.dimension(); ++p)
    if (columns[static_cast<std::size_t>(p)] < 0 && coefficient(p)) std::fill(prior.row(p).begin(), prior.row(p).end(), 0.0);
  target.constrain(prior, drawn);
  LaneArray values = drawn;
  LaneArray const spread_draws = spread(earlier, count - 1);
  std::vector<double> const best = best_draw(earlier);
  for (int w = 0; w < count; ++w)
    for (int p = 0; p < target.dimension(); ++p) {
      int const column = columns[static_cast<std::size_t>(p)];
      if (column < 0) continue;
      values(p, w) = w == 0 || column >= spread_draws.rows() ? best[static_cast<std::size_t>(column)]
                                                             : spread_draws(column, (w - 1) % spread_draws.width());
    }
  // Values are replaced before they are placed: where members of a hierarchy lie on their scale depends on the spread.
  LaneArray const kept = allowed(target, values, drawn);
  for (int w = 0; w < count; ++w)
    for (int p = 0; p < target.dimension(); ++p)
      if (kept(p, w) == 0) values(p, w) = drawn(p, w);
  target.unconstrain(values, starts);
  for (int w = 0; w < count; ++w)
    for (int p = 0; p < target.dimension(); ++p)
      if (!std::isfinite(starts(p, w))) starts(p, w) = prior(p, w);
  return starts;
}

SearchResult search_near(Session& session, int earlier, Target const& target, ObjectiveKind objective_kind, RunContext& context) {
  LaneArray const starts = starts_near(target, fitted_model(session, earlier).draws, context.seed);
  SearchResult result = search_from(target, objective_kind, starts, context);
  std::string const& name = session.file.tasks[static_cast<std::size_t>(earlier)].name;
  if (!result.modes.empty())
    result.findings.push_back({FindingCode::searched_near,
                               Severity::note,
                               {name},
                               fmt::format("the search began only at the result of `{}` and may have missed other modes", name),
                               "fit again without `search = near(...)` before you use the numbers"});
  return result;
}

}  // namespace sysid
