// Findings on chains, and their wording.
#include "diagnostics/chain_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

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
                        fmt::format("the chain did not move: {} accepted {} of the proposed moves{}", chain_list(stuck),
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

void check_agreement(ChainReport const& report, Findings& findings) {
  auto const rhat_of = [](Summary const& s) { return s.rhat; };
  auto const show = [](Summary const& s) { return fmt::format("{:.3f}", s.rhat); };
  Worst const bad = worst(report.summaries, rhat_of, show, rhat_threshold);
  if (bad.empty()) return;
  Worst const far = worst(report.summaries, rhat_of, show, rhat_far_above),
              near = worst(report.summaries, rhat_of, show, rhat_threshold, rhat_far_above);
  bool const far_above = !far.empty();
  findings.push_back(
      {far_above ? FindingCode::chains_disagree : FindingCode::chains_not_quite_agreed, Severity::error, bad.names,
       far_above ? fmt::format("the chains disagree: R-hat of {} is far above {}{}", far.text, rhat_threshold,
                               near.empty() ? "" : fmt::format(", and R-hat of {} is also above it", near.text))
                 : fmt::format("the chains have not converged yet: R-hat of {} is above {}", bad.text, rhat_threshold),
       far_above ? "do not use the means and sds; run longer chains, and check for a second mode or for parameters that "
                   "the data cannot separate"
                 : "run longer chains (samples)"});
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
  check(FindingCode::ess_tail_low, "5 and 95 % limits", [](Summary const& s) { return s.ess_tail; });
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
  if (findings.empty()) check_defined(report, findings);
  return findings;
}

}  // namespace sysid
