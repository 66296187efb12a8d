// Findings on chains, and their wording.
#include "diagnostics/chain_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/numeric/statistics.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

constexpr std::size_t names_shown = 4;

/// The parameters that fail, the worst first, and "a (1.20), b (1.10) and 3 more" of them.
struct Worst {
  std::vector<std::string> names;
  std::string text;
  bool empty() const { return names.empty(); }
};
Worst worst(std::vector<Summary> const& summaries, std::function<double(Summary const&)> const& badness,
            std::function<std::string(Summary const&)> const& show, double bar,
            double below = std::numeric_limits<double>::infinity()) {
  std::vector<Summary const*> bad;
  for (Summary const& s : summaries)
    if (badness(s) > bar && badness(s) <= below) bad.push_back(&s);
  std::stable_sort(bad.begin(), bad.end(), [&](Summary const* a, Summary const* b) { return badness(*a) > badness(*b); });
  Worst found;
  std::vector<std::string> shown;
  for (Summary const* each : bad) {
    found.names.push_back(each->name);
    shown.push_back(fmt::format("{} ({})", each->name, show(*each)));
  }
  found.text = first_listed(shown, names_shown);
  return found;
}

std::string chain_list(std::vector<std::size_t> const& chains) {
  std::string text = plural("chain", chains.size()) + " ";
  for (std::size_t i = 0; i < chains.size() && i < 8; ++i) text += fmt::format("{}{}", i == 0 ? "" : ", ", chains[i] + 1);
  return chains.size() > 8 ? text + ", ..." : text;
}

std::string percent(double share) { return fmt::format("{:.2g} %", 100 * share); }

void check_motion(ChainReport const& report, Findings& findings) {
  std::vector<std::size_t> stuck, poor;
  for (std::size_t c = 0; c < report.acceptance_rate.size(); ++c) {
    if (!(report.acceptance_rate[c] >= least_acceptance))
      stuck.push_back(c);
    else if (c < report.distinct_states.size() && report.distinct_states[c] < least_distinct)
      poor.push_back(c);
  }
  if (!stuck.empty()) {
    double most = 0;
    for (std::size_t const c : stuck) most = std::max(most, report.acceptance_rate[c]);
    findings.push_back({FindingCode::chain_did_not_move,
                        Severity::error,
                        {},
                        fmt::format("{} did not move: {} of the proposed moves were accepted{}", chain_list(stuck),
                                    most == 0           ? "none"
                                    : stuck.size() == 1 ? percent(most)
                                                        : "at most " + percent(most),
                                    report.adaptive ? "" : ", because the fixed proposal does not fit the posterior"),
                        report.adaptive ? "use a longer burn-in (burn_in), and check the counts of failed simulations"
                                        : "use proposal = adaptive, which adapts its size and shape during burn-in"});
  }
  if (!poor.empty()) {
    std::uint64_t least = least_distinct;
    for (std::size_t const c : poor) least = std::min(least, report.distinct_states[c]);
    findings.push_back(
        {FindingCode::few_distinct_states,
         Severity::error,
         {},
         fmt::format("{} visited only {} distinct states after burn-in, too few to describe a posterior", chain_list(poor), least),
         "run longer chains (samples)"});
  }
}

/// Chains of one side, and the range of their values but for the outermost tenth of each.
struct Side {
  std::vector<std::size_t> chains;
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
};

/// Where the chains of a parameter lie in two places with nothing between them: the side below and the one above.
std::optional<std::pair<Side, Side>> sides_of(Draws const& draws, std::string const& name) {
  auto const column = std::find(draws.names.begin(), draws.names.end(), name);
  if (column == draws.names.end() || draws.chains.size() < 2) return std::nullopt;
  auto const p = static_cast<std::size_t>(column - draws.names.begin());
  std::vector<Side> chains;
  for (std::size_t c = 0; c < draws.chains.size(); ++c) {
    std::vector<double> values;
    for (std::vector<double> const& row : draws.chains[c].values) values.push_back(row[p]);
    if (values.empty()) return std::nullopt;
    std::sort(values.begin(), values.end());
    chains.push_back({{c}, sorted_quantile(values, 0.05), sorted_quantile(values, 0.95)});
  }
  std::sort(chains.begin(), chains.end(), [](Side const& a, Side const& b) { return a.low < b.low; });
  std::size_t widest = 0;
  double gap = 0, reach = chains.front().high;
  for (std::size_t c = 1; c < chains.size(); ++c) {
    if (chains[c].low - reach > gap) {
      gap = chains[c].low - reach;
      widest = c;
    }
    reach = std::max(reach, chains[c].high);
  }
  if (widest == 0) return std::nullopt;
  std::pair<Side, Side> sides;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    Side& side = c < widest ? sides.first : sides.second;
    side.chains.push_back(chains[c].chains.front());
    side.low = std::min(side.low, chains[c].low);
    side.high = std::max(side.high, chains[c].high);
  }
  std::sort(sides.first.chains.begin(), sides.first.chains.end());
  std::sort(sides.second.chains.begin(), sides.second.chains.end());
  return sides;
}

/// What to do about chains that disagree by far. apart: they stay in different places.
std::string instead_of_disagreement(bool apart, bool exchanges) {
  std::string const start = "do not use the means and sds; ";
  if (exchanges)
    return start +
           "run longer chains or more temperatures, and check for a second mode or for parameters that the data cannot separate";
  if (apart)
    return start +
           "there may be several modes: sample with tempering, whose chains cross between them, or, if only one mode is physically "
           "possible, narrow the priors to it";
  return start +
         "run longer chains, or sample with tempering, which moves along ridges where the data cannot separate parameters, and "
         "check for a second mode";
}

void check_agreement(ChainReport const& report, Findings& findings) {
  auto const rhat_of = [](Summary const& s) { return s.rhat; };
  auto const show = [](Summary const& s) { return fmt::format("{:.3f}", s.rhat); };
  Worst const bad = worst(report.summaries, rhat_of, show, rhat_threshold);
  if (bad.empty()) return;
  Worst const far = worst(report.summaries, rhat_of, show, rhat_far_above),
              near = worst(report.summaries, rhat_of, show, rhat_threshold, rhat_far_above);
  bool const far_above = !far.empty();
  std::optional<std::pair<Side, Side>> sides;
  if (far_above && report.draws != nullptr) sides = sides_of(*report.draws, far.names.front());
  std::string const places =
      sides ? fmt::format("; {} lies between {:.4g} and {:.4g} in {}, between {:.4g} and {:.4g} in {}", far.names.front(),
                          sides->first.low, sides->first.high, chain_list(sides->first.chains), sides->second.low,
                          sides->second.high, chain_list(sides->second.chains))
            : std::string();
  findings.push_back({far_above ? FindingCode::chains_disagree : FindingCode::chains_not_quite_agreed, Severity::error, bad.names,
                      far_above
                          ? fmt::format("the chains disagree: R-hat of {} is far above {}{}{}", far.text, rhat_threshold,
                                        near.empty() ? "" : fmt::format(", and R-hat of {} is also above it", near.text), places)
                          : fmt::format("the chains have not converged yet: R-hat of {} is above {}", bad.text, rhat_threshold),
                      far_above ? instead_of_disagreement(sides.has_value(), report.exchanges) : "run longer chains (samples)"});
}

void check_size(ChainReport const& report, Findings& findings) {
  auto const check = [&](FindingCode code, std::string const& what, std::function<double(Summary const&)> const& ess) {
    auto const shortfall = [&](Summary const& s) { return ess_threshold / ess(s); };
    Worst const bad = worst(
        report.summaries, shortfall, [&](Summary const& s) { return fmt::format("{:.0f}", ess(s)); }, 1);
    if (bad.empty()) return;
    double most = 1;
    for (Summary const& s : report.summaries)
      if (shortfall(s) > most) most = shortfall(s);
    findings.push_back(
        {code, Severity::error, bad.names,
         fmt::format("too few independent draws for the {}: effective sample size of {}, below {}", what, bad.text, ess_threshold),
         fmt::format("run chains about {:.2g} times as long (samples), or more of them (chains)", std::ceil(10 * most) / 10)});
  };
  check(FindingCode::ess_bulk_low, "means", [](Summary const& s) { return s.ess_bulk; });
  check(FindingCode::ess_tail_low, "5 and 95 % quantiles", [](Summary const& s) { return s.ess_tail; });
}

void check_defined(ChainReport const& report, Findings& findings) {
  auto const undefined = [](Summary const& s) {
    return std::isnan(s.rhat) || std::isnan(s.ess_bulk) || std::isnan(s.ess_tail) ? 1.0 : 0.0;
  };
  Worst const bad = worst(
      report.summaries, undefined, [](Summary const& s) { return fmt::format("mean {:.4g}", s.mean); }, 0.5);
  if (bad.empty()) return;
  findings.push_back({FindingCode::no_diagnostics, Severity::error, bad.names,
                      fmt::format("convergence cannot be judged, because all draws are equal, too few or not finite: {}", bad.text),
                      "run longer chains (samples), and check the counted failures"});
}

}  // namespace

Findings check_chains(ChainReport const& report) {
  // What merely follows from an earlier finding is not said: a chain that stands still has no R-hat worth reading, and chains that
  // tell different stories have no effective sample size.
  Findings findings;
  check_motion(report, findings);
  if (!findings.empty()) return findings;
  check_agreement(report, findings);
  if (!findings.empty() && findings.front().code == FindingCode::chains_disagree) return findings;
  check_size(report, findings);
  check_defined(report, findings);
  return findings;
}

}  // namespace sysid
