// Offsets, their limits, and what is said of them.
#include "diagnostics/tolerance/filter_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

/// Nats. An evidence may be off by the first. By the second the weights of draws may change, by the third the result is another.
constexpr double tolerable_offset = 2, tolerable_change = 1, decisive_change = 3;
constexpr double sure_errors = 2;    // standard errors
constexpr double known_error = 0.5;  // nats
/// sd of the log of one estimate, beyond which a few of them do not show how much they scatter.
constexpr double known_sd = 1.2;
/// Nats: the mean of estimates exceeds the likelihood by more in less than one case of a hundred.
constexpr double rarely_exceeded = 5;

std::string words_of(FilterComparison const& comparison, ComparedPlaces const& places) {
  std::string text;
  if (comparison.worst >= 0) {
    FilterOffset const& worst = comparison.offsets[static_cast<std::size_t>(comparison.worst)];
    bool const below = worst.value > 0;
    std::string const size = worst.known ? fmt::format("{:.1f} +- {:.1f}", std::fabs(worst.value), worst.error)
                                         : fmt::format("at least {:.0f}", below ? worst.least() : -worst.most());
    text = fmt::format("its log likelihood is {} {} what particles estimate at a {}", size, below ? "below" : "above", places.one);
  }
  if (comparison.change > 0) {
    std::string const change = fmt::format("by at least {:.1f} from one {} to another", comparison.change, places.one);
    text = text.empty() ? fmt::format("the difference of its log likelihood from what particles estimate changes {}", change)
                        : fmt::format("{}, and the difference changes {}", text, change);
  }
  return text + places.rows;
}

/// Infinite limits give none.
double least_change(FilterOffset const& a, FilterOffset const& b) {
  if (a.known && b.known) return std::fabs(a.value - b.value) - sure_errors * std::hypot(a.error, b.error);
  double const change = std::max(a.least() - b.most(), b.least() - a.most());
  return std::isfinite(change) ? change : 0;
}

bool is_confirmed(FilterComparison const* comparison) {
  return comparison != nullptr && comparison->holds() && comparison->known();
}

}  // namespace

double FilterOffset::least() const { return known ? value - sure_errors * error : value - rarely_exceeded; }

/// Of a log-normal estimate of that sd, the log of the mean is half the variance above the middle, and a few estimates show little
/// of it; four times as much, and as many sds as no estimate lies away.
double FilterOffset::most() const {
  if (!std::isfinite(sd)) return infinity;
  return known ? value + sure_errors * error : value + 2 * sd * sd + rarely_exceeded * sd;
}

FilterOffset filter_offset(std::span<double const> estimates, double filter) {
  double const middle = log_of_mean(estimates);
  if (!std::isfinite(middle - filter)) return {.value = -infinity, .error = infinity, .sd = infinity};
  FilterOffset offset;
  offset.value = middle - filter;
  std::vector<double> parts;
  for (double const each : estimates) parts.push_back(elementary::exp(each - middle));
  offset.error = std::sqrt(sample_variance(parts) / static_cast<double>(parts.size()));
  bool const alive = std::ranges::all_of(estimates, [](double each) { return std::isfinite(each); });
  offset.sd = alive ? std::sqrt(sample_variance(estimates)) : infinity;
  offset.known = offset.error <= known_error && offset.sd <= known_sd;
  return offset;
}

bool FilterComparison::known() const {
  return !offsets.empty() && 2 * std::ranges::count_if(offsets, &FilterOffset::known) >= std::ssize(offsets);
}

FilterComparison compare_filter(std::vector<FilterOffset> offsets) {
  FilterComparison result;
  double farthest = tolerable_offset;
  for (std::size_t a = 0; a < offsets.size(); ++a) {
    double const beyond = std::max(offsets[a].least(), -offsets[a].most());
    if (beyond > farthest) {
      farthest = beyond;
      result.worst = static_cast<int>(a);
    }
    for (std::size_t b = 0; b < a; ++b) {
      double const change = least_change(offsets[a], offsets[b]);
      if (change > std::max(tolerable_change, result.change)) result.change = change;
    }
  }
  result.offsets = std::move(offsets);
  return result;
}

bool same_offsets(FilterComparison const& a, FilterComparison const& b) {
  for (std::size_t k = 0; k < a.offsets.size(); ++k) {
    FilterOffset const &one = a.offsets[k], &other = b.offsets[k];
    if (!one.known || !other.known) continue;
    if (std::fabs(one.value - other.value) - sure_errors * std::hypot(one.error, other.error) > tolerable_change) return false;
  }
  return true;
}

Finding filter_finding(FilterComparison const& own, FilterRule filter, FilterComparison const* unscented,
                       ComparedPlaces const& places) {
  std::string help = "fit with `filter = unscented`, which particles confirm at the same places";
  if (!is_confirmed(unscented))
    help = fmt::format("fit with `mh` and `filter = particle`, which assumes nothing of the distribution of the states{}",
                       unscented == nullptr ? ""
                       : unscented->holds() ? "; whether `filter = unscented` is better is not known"
                                            : "; `filter = unscented` is wrong, too");
  return {FindingCode::linearisation_matters,
          own.change > decisive_change ? Severity::error : Severity::warning,
          {},
          fmt::format("the filter `{}`, which describes random states by mean and covariance, does not suit this model: {}",
                      filter_name(filter), words_of(own, places)),
          std::move(help)};
}

}  // namespace sysid
