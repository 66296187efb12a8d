// Thresholds and words.
#include "app/judged_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/discovery.hpp"
#include "report/number.hpp"

namespace sysid {
namespace {

constexpr double tolerable_residual = 1.5;  // of the noise
constexpr double idle_sds = 2;              // a coefficient of the model may be zero
constexpr double lost_percent = 100;        // of the sd: no better than the mean

}  // namespace

Findings judged_findings(JudgedReport const& judged) {
  Findings findings;
  JudgedStructure const& best = judged.structures.front();
  auto const add = [&](Severity severity, char const* code, std::string message, char const* help) {
    findings.push_back({severity, code, std::move(message), help});
  };
  auto const regression = std::find_if(judged.structures.begin(), judged.structures.end(),
                                       [](JudgedStructure const& each) { return each.of_regression == 1; });
  if (regression != judged.structures.begin())
    add(Severity::warning, "simulation_prefers",
        fmt::format("simulation ranks `{}` first, the regression `{}`, which {}", best.terms, regression->terms,
                    regression->failure.empty()
                        ? fmt::format("has a probability of {} by the motion", probability_text(regression->probability))
                        : "was not judged: " + regression->failure),
        "the model that is written is the one that simulation ranks first; a record of other amplitude may decide");
  if (!best.failure.empty()) {
    add(Severity::warning, "not_refitted", fmt::format("no structure could be judged by simulation: {}", best.failure),
        "the coefficients are those of the regression: look at the record's length and step, and at terms that diverge");
    return findings;
  }
  std::string idle;
  for (JudgedCoefficient const& each : best.coefficients)
    if (!each.of_target && std::abs(each.value) < idle_sds * each.sd)
      idle += fmt::format("{}`{}`{}", idle.empty() ? "" : ", ", each.term, best.equations.size() > 1 ? " of " + each.target : "");
  if (!idle.empty())
    add(Severity::warning, "term_idle", fmt::format("by the motion the coefficient of {} is less than two sds from zero", idle),
        "leave it out of the dictionary, or take a record in which it moves more");
  if (!judged.whole)
    add(Severity::note, "followed_in_parts",
        fmt::format("the record is followed for {} at a time, each from a start of its own", significant(judged.longest, 3) + " s"),
        "expected of a chaotic motion; else a term or an input is missing");
  if (best.residual_over_noise > tolerable_residual)
    add(Severity::warning, "motion_unexplained",
        fmt::format("the residual of the simulated motion is {} times the measurement noise",
                    significant(best.residual_over_noise, 3)),
        "look for an input that was not recorded, a state that is missing, or add terms");
  if (best.bounded < best.draws)
    add(Severity::warning, "draws_not_bounded",
        fmt::format("{} of {} draws of the coefficients do not stay within ten times the range of the record in a free run",
                    best.draws - best.bounded, best.draws),
        "a term may destabilise where the record hardly goes: leave it out, or take a record of larger amplitude");
  std::optional<double> const far = best.percent(&JudgedChannel::horizon), free = best.percent(&JudgedChannel::free_run);
  if (free && !(*free < lost_percent))
    add(far && *far < lost_percent / 2 ? Severity::note : Severity::warning, "free_run_lost",
        fmt::format("a free run on {} is off by {} % of the sd; it follows for {} s", judged.aside,
                    std::isfinite(*free) ? significant(*free, 3) : "more than 1e4", significant(best.follows, 3)),
        "expected of a chaotic motion, which is foretold for a while only; else do not extrapolate");
  return findings;
}

}  // namespace sysid
