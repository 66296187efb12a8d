// The limits of these findings, and their wording.
#include "discovery/validation_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "discovery/discovery_verdict.hpp"
#include "result/discovery.hpp"

namespace sysid {
namespace {

constexpr double tolerable_residual = 1.5;  // of the noise
constexpr double idle_sds = 2;              // a coefficient of the model may be zero
constexpr double lost_percent = 70;         // of the sd: half of the variance
constexpr double lost_noises = 3;           // as small an error is no sign, however small the sd is
constexpr double foretold_percent = 50;     // of the sd, one dominant period ahead
constexpr double telling_percent = 10;      // noise that has a part in that
constexpr double small_residual = 0.7;      // of the noise that the regression took

bool explains_motion(ValidationReport const& validation) {
  ValidatedStructure const& best = validation.structures.front();
  return best.failure.empty() && validation.whole && best.residual_over_noise > 0 && best.residual_over_noise <= tolerable_residual;
}

std::optional<Finding> given_up(ValidationReport const& validation) {
  std::vector<std::string> names;
  for (ValidatedStructure const& each : validation.structures)
    if (each.given_up) names.push_back(each.terms);
  if (names.empty()) return std::nullopt;
  return Finding{
      FindingCode::not_refitted, Severity::warning, names,
      fmt::format("{} skipped: {} more simulations than are allowed for implicit equations, which are simulated one by one",
                  quoted(names) + (names.size() == 1 ? " is" : " are"), names.size() == 1 ? "it needs" : "they need"),
      "use fewer rows, or a smaller `top`, or remove the implicit terms from the dictionary"};
}

std::optional<Finding> idle_terms(ValidatedStructure const& best) {
  std::vector<std::string> idle, names;
  for (ValidatedCoefficient const& each : best.coefficients)
    if (!each.of_target && !each.inside && std::abs(each.value) < idle_sds * each.sd) {
      names.push_back(each.term);
      idle.push_back(fmt::format("`{}`{}", each.term, best.equations.size() > 1 ? " of " + each.target : ""));
    }
  if (idle.empty()) return std::nullopt;
  bool const one = idle.size() == 1;
  return Finding{FindingCode::term_idle, Severity::warning, std::move(names),
                 fmt::format("in the fit by simulation the {} of {} {} less than two sds from zero",
                             one ? "coefficient" : "coefficients", fmt::join(idle, ", "), one ? "is" : "are"),
                 fmt::format("remove {0} from the dictionary, or use a record in which {1} more", one ? "it" : "them",
                             one ? "it varies" : "they vary")};
}

std::optional<Finding> lost_free_run(ValidationReport const& validation) {
  ValidatedStructure const& best = validation.structures.front();
  FreeRun const run = free_run_of(validation);
  if (run != FreeRun::lost && run != FreeRun::chaotic) return std::nullopt;
  std::optional<double> const free = best.percent(&ValidatedChannel::free_run);
  std::string const size = std::isfinite(*free) && *free <= 1e4 ? significant(*free, 3) : "more than 1e4";
  std::string message = fmt::format(
      "the rms error of a free run on {} is {} % of the standard deviation of its samples; the run follows the record for {} s",
      validation.held_out, size, significant(best.follows, 3));
  double noise = 0;
  for (ValidatedChannel const& each : best.channels)
    if (each.sd > 0)
      noise = std::max(noise, 100 * (each.noise > 0 ? std::min(each.noise, each.residual) : each.residual) / each.sd);
  if (noise > telling_percent)
    message += fmt::format("; the noise of the record is {} % of that standard deviation", significant(noise, 3));
  if (run == FreeRun::chaotic)
    return Finding{FindingCode::free_run_lost,
                   Severity::note,
                   {validation.held_out},
                   std::move(message),
                   "nothing, if the motion is chaotic: it can be predicted for a short time only"};
  return Finding{FindingCode::free_run_lost,
                 Severity::warning,
                 {validation.held_out},
                 std::move(message),
                 "the error exceeds half the sd within one dominant period: do not extrapolate, and look for missing terms"};
}

void add_overestimated_noise(ValidatedStructure const& best, Findings& findings) {
  for (ValidatedChannel const& each : best.channels)
    if (each.residual < small_residual * each.noise)
      findings.push_back({FindingCode::noise_overestimated,
                          Severity::note,
                          {each.channel},
                          fmt::format("the residual of `{}` in simulation is {} times the noise that the regression assumed: the "
                                      "sds of the regression are overestimated",
                                      each.channel, significant(each.residual / each.noise, 3)),
                          fmt::format("state the noise: `noise({} = {}{})`", each.channel, significant(each.residual, 3),
                                      each.unit.empty() ? "" : fmt::format(" [{}]", each.unit))});
}

}  // namespace

FreeRun free_run_of(ValidationReport const& validation) {
  ValidatedStructure const& best = validation.structures.front();
  bool tested = false, lost = false;
  for (ValidatedChannel const& each : best.channels) {
    if (!each.free_run) continue;
    tested = true;
    // A motion that has come to rest has no sd but that of its noise.
    lost = lost || !(*each.free_run < std::max(lost_percent / 100 * each.sd, lost_noises * each.residual));
  }
  if (!tested || !lost) return tested ? FreeRun::follows : FreeRun::not_tested;
  std::optional<double> const far = best.percent(&ValidatedChannel::horizon);
  return far && *far < foretold_percent ? FreeRun::chaotic : FreeRun::lost;
}

Finding not_white(std::string const& channel, std::string const& experiment, ResidualMemory const& memory) {
  return {FindingCode::residuals_not_white,
          Severity::warning,
          {channel, experiment},
          fmt::format("the residuals of `{}` of `{}` in simulation are correlated in time ({} of {} lags outside the 99 % band)",
                      channel, experiment, memory.outside, memory.lags),
          "add the terms, the input or the state that are missing, unless the noise of this channel is coloured"};
}

void temper_by_simulation(ValidationReport const& validation, Findings& of_regression) {
  if (!explains_motion(validation)) return;
  for (Finding& each : of_regression) {
    if (each.code != FindingCode::unexplained_residual) continue;
    each.severity = Severity::note;
    each.message += fmt::format("; but the residual of the simulated motion is {} times the noise",
                                significant(validation.structures.front().residual_over_noise, 3));
    each.help = "use the equation, the coefficients and the sds of the simulation, not those of the regression";
  }
}

Findings validation_findings(ValidationReport const& validation) {
  Findings findings;
  ValidatedStructure const& best = validation.structures.front();
  auto const add = [&](FindingCode code, Severity severity, std::vector<std::string> names, std::string message, char const* help) {
    findings.push_back({code, severity, std::move(names), std::move(message), help});
  };
  auto const regression = std::find_if(validation.structures.begin(), validation.structures.end(),
                                       [](ValidatedStructure const& each) { return each.of_regression == 1; });
  // With parameters inside terms the regression's choice may have been replaced by the same terms from another start.
  if (best.failure.empty() && regression != validation.structures.begin() && regression != validation.structures.end())
    add(FindingCode::simulation_prefers, is_settled(validation) ? Severity::note : Severity::warning,
        {best.terms, regression->terms},
        fmt::format("simulation and regression rank different terms first: simulation `{}`; regression `{}`, {}", best.terms,
                    regression->terms,
                    regression->failure.empty()
                        ? fmt::format("whose probability by the simulated motion is {}", probability_text(regression->probability))
                        : "which could not be checked by simulation: " + regression->failure),
        "use the model that simulation ranks first, which `found.sysid` contains; a record of another amplitude may decide");
  auto const costly = given_up(validation);
  if (costly) findings.push_back(*costly);
  if (!best.failure.empty()) {
    if (costly) return findings;
    add(FindingCode::not_refitted, Severity::warning, {},
        fmt::format("no structure could be checked by simulation: {}", best.failure),
        "the coefficients are those of the regression: check the length and step of the record, and terms that diverge");
    return findings;
  }
  for (Finding& each : undecided_form(validation)) findings.push_back(std::move(each));
  for (Finding& each : other_terms(validation)) findings.push_back(std::move(each));
  if (auto idle = idle_terms(best)) findings.push_back(std::move(*idle));
  if (!validation.whole)
    add(FindingCode::followed_in_parts, Severity::note, {},
        fmt::format("the simulation follows the record for {} at a time, from a new start each time",
                    significant(validation.longest, 3) + " s"),
        "nothing, if the motion is chaotic; otherwise look for a missing term or input");
  if (best.residual_over_noise > tolerable_residual)
    add(FindingCode::motion_unexplained, Severity::warning, {},
        fmt::format("the residual of the simulated motion is {} times the measurement noise",
                    significant(best.residual_over_noise, 3)),
        "look for an input that was not recorded or a state that is missing, or add terms");
  if (best.bounded < best.draws)
    add(FindingCode::draws_not_bounded, Severity::warning, {},
        fmt::format("{} of {} draws of the coefficients do not stay within ten times the range of the record in a free run",
                    best.draws - best.bounded, best.draws),
        "a term may destabilise the motion where the record has few samples: remove it, or use a record of larger amplitude");
  if (auto lost = lost_free_run(validation)) findings.push_back(std::move(*lost));
  if (explains_motion(validation)) add_overestimated_noise(best, findings);
  return findings;
}

}  // namespace sysid
