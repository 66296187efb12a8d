// Each reason not to prefer the disturbance in one sentence, the surest first.
#include "app/disturbed/disturbance_advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>

namespace sysid {
namespace {

/// Faults that the record shows by itself.
constexpr FindingCode of_record[] = {FindingCode::looks_missing, FindingCode::sensor_stuck,      FindingCode::time_gap,
                                     FindingCode::times_rounded, FindingCode::rate_contradicted, FindingCode::samples_repeated};
/// Those that residuals show: a force that was not measured may resemble them in a fit without it.
constexpr FindingCode of_residuals[] = {FindingCode::initial_far_off, FindingCode::residual_offset, FindingCode::residual_trend,
                                        FindingCode::input_timing, FindingCode::input_rule};

using NamedCodes = std::vector<std::string>;

/// Those among `wanted`, in back-quotes, each once.
void add_named(Findings const& found, std::span<FindingCode const> wanted, NamedCodes& named) {
  for (Finding const& each : found) {
    std::string const quoted = fmt::format("`{}`", word(each.code));
    if (std::ranges::find(wanted, each.code) != wanted.end() && std::ranges::find(named, quoted) == named.end())
      named.push_back(quoted);
  }
}

}  // namespace

std::string advice_on_disturbance(std::string const& size, FoundByBoth const& found, ExplainedShares const& shares) {
  NamedCodes faults, doubts;
  add_named(found.without, of_record, faults);
  add_named(found.with, of_record, faults);
  add_named(found.with, of_residuals, faults);
  add_named(found.without, of_residuals, doubts);
  if (!faults.empty())
    return fmt::format(
        "the evidence is higher with the disturbance ({}), but the disturbance may only compensate for an error that the findings "
        "name ({}): correct this error first, then compare again; until then use neither fit\n",
        size, fmt::join(faults, ", "));
  auto const missing = std::ranges::find(found.with, FindingCode::disturbance_follows_states, &Finding::code);
  if (missing != found.with.end())
    return fmt::format("the disturbance stands in for a missing term ({}): add the term before you use either fit; {}: {}\n", size,
                       "with the term, compare again with and without the disturbance", missing->message);
  if (shares.replaced())
    return fmt::format(
        "the disturbance replaces what the equations explain ({}): without it they explain {:.2g} % of the variance of the "
        "channels with the parameters of the fit with the disturbance, and {:.2g} % with those of the fit without it; use neither "
        "fit: check the times, delays, signs and scales of the columns, then the equations\n",
        size, 100 * *shares.with, 100 * *shares.without);
  std::string const also = doubts.empty() ? ""
                                          : fmt::format(
                                                "; the fit without it has {}, which a force that was not measured can also cause: "
                                                "first check the cause that this finding names",
                                                fmt::join(doubts, ", "));
  return fmt::format("the record prefers the model with the disturbance: {}{}\n", size, also);
}

}  // namespace sysid
