// On a short record a wrong frequency may fit worse than no motion; on its first periods it does not.
#include "search/global/second_look.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/order.hpp"
#include "core/numeric/statistics.hpp"
#include "search/local_searches.hpp"
#include "search/mode_findings.hpp"
#include "search/refit.hpp"
#include "search/search_step.hpp"

namespace sysid {
namespace {

constexpr double clearly_higher = 3;  // nats
constexpr int finer_at_second_look = 2;

}  // namespace

bool leaves_motion(Target const& target, Mode const& mode) {
  constexpr double much = 0.3;    // of the correlation from one sample to the next
  constexpr double far_off = 30;  // medians
  Ledger untold;
  LaneArray rows(target.residual_count(), 1);
  target.residuals(to_lanes({theta_of(mode)}), rows, untold);
  std::vector<double> sizes;
  for (int r = 0; r < rows.rows(); ++r) sizes.push_back(std::fabs(rows(r, 0)));
  sort_numbers(sizes);
  double const limit = far_off * sorted_quantile(sizes, 0.5);
  auto const residual = [&](int r) { return std::fabs(rows(r, 0)) > limit ? 0 : rows(r, 0); };
  double square = 0, product = 0;
  for (int r = 0; r < rows.rows(); ++r) {
    square += residual(r) * residual(r);
    if (r > 0) product += residual(r) * residual(r - 1);
  }
  return std::fabs(product) > much * square;
}

std::optional<GrownModes> second_look(Target const& target, ObjectiveKind objective_kind, ShorterRecords const& records,
                                      RunContext& context, std::vector<Mode> const& modes) {
  auto const stop = [&] { return context.stop_requested(); };
  if (modes.empty() || target.is_estimated() || !records.ordered || !can_grow(target, records)) return {};
  if (!kept_answer(context.journal, stop, [&] { return leaves_motion(target, modes.front()); }) || stop()) return {};
  GrownModes grown = search_growing(target, objective_kind, records, context, finer_at_second_look);
  if (stop() || grown.modes.empty()) return {};
  double const best = highest(grown.modes);
  auto const followed = [&](Target const& to, std::vector<Mode> const& from) {
    return refit(to, objective_kind, from, context.seed, context.ledger, stop, nullptr, context.journal);
  };
  if (grown.finer == 0) return best > highest(modes) + clearly_higher ? std::optional(std::move(grown)) : std::nullopt;
  auto const finer = records.make(1, grown.finer).target;
  double const known = highest(followed(*finer, modes));
  if (stop() || !(best > known + clearly_higher)) return {};
  // The solver of the first search suffices if from its modes, too, the finer one comes to the place.
  std::vector<Eigen::VectorXd> places;
  for (Mode const& each : grown.modes) places.push_back(theta_of(each));
  std::vector<Mode> coarse =
      modes_from(target, objective_kind, to_lanes(places), -infinity, context.seed, context.ledger, stop, context.journal).modes;
  bool const suffices = !stop() && highest(followed(*finer, coarse)) > best - clearly_higher;
  if (stop()) return {};
  if (suffices) {
    grown.modes = std::move(coarse);
    grown.finer = 0;
  }
  return grown;
}

}  // namespace sysid
