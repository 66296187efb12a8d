// Words for what populations show.
#include "inference/abc/findings.hpp"
#include "core/system/failed_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace sysid::abc {
namespace {

/// An effective number of particles below which means and probabilities are not worth their digits.
constexpr double small_ess = 100;

/// A part of failed prior draws that deserves a word.
constexpr double many_failures = 0.2;

void add_deaths(SelectionResult const& result, Findings& findings) {
  for (SelectedModel const& model : result.models) {
    if (!model.by_chance) continue;
    auto const t = static_cast<std::size_t>(model.died_in - 1);
    auto const m = static_cast<std::size_t>(&model - result.models.data());
    std::string const before =
        t == 0 ? std::string()
               : fmt::format(", after {} particles in the population before", result.populations[t - 1].models[m].particles);
    findings.push_back({FindingCode::model_lost_by_chance,
                        Severity::warning,
                        {model.name},
                        fmt::format("`{}` died in population {}, possibly by chance: none of {} proposals was accepted{}",
                                    model.name, model.died_in, result.populations[t].models[m].proposed, before),
                        "use more `particles`, or repeat with other seeds: its probability may be larger than 0"});
  }
}

/// Draws of a model's priors that do not stay finite: its prior ends there.
void add_failures(SelectionResult const& result, Findings& findings) {
  PopulationRecord const& first = result.populations.front();
  for (std::size_t m = 0; m < result.models.size(); ++m) {
    auto const& record = first.models[m];
    double const lost = static_cast<double>(record.failed) / static_cast<double>(std::max<std::uint64_t>(1, record.proposed));
    if (lost <= many_failures) continue;
    findings.push_back({FindingCode::failed_solves,
                        Severity::warning,
                        {result.models[m].name},
                        fmt::format("{} of the {} draws of the priors of `{}` did not stay finite, which truncates its priors",
                                    record.failed == record.proposed ? "all" : fmt::format("{}", record.failed), record.proposed,
                                    result.models[m].name),
                        "narrow the priors, or use a finer solver if the integration fails"});
  }
}

/// The threshold cannot fall: so many particles are at this very distance. Those of models without parameters have no other.
std::optional<Finding> equal_distances(SelectionResult const& result) {
  std::vector<std::string> names;
  bool others = false, elsewhere = false;
  for (SelectedModel const& model : result.models) {
    if (model.died_in > 0) continue;
    bool const here = std::count(model.distance.begin(), model.distance.end(), result.threshold) > 0;
    if (!model.parameters.empty())
      (here ? others : elsewhere) = true;
    else if (here)
      names.push_back(model.name);
  }
  if (!others && !elsewhere) return std::nullopt;  // nothing could lie at another distance
  if (others || names.empty())
    return Finding{
        FindingCode::distances_equal,
        Severity::warning,
        {},
        fmt::format("the threshold cannot fall below {:.6g}: too many particles have exactly this distance", result.threshold),
        "check that the simulation depends on the parameters"};
  std::string const fixed = fmt::format("`{}`", fmt::join(names, "`, `"));
  return Finding{
      FindingCode::distances_equal, Severity::warning, std::move(names),
      fmt::format("the threshold cannot fall below {:.6g}: all particles of {} have exactly this distance, because their "
                  "simulation depends on no parameter",
                  result.threshold, fixed),
      "as long as the threshold cannot fall, smaller distances of the other models do not increase their probabilities: compare "
      "the likelihoods, or set a smaller threshold with `schedule`"};
}

}  // namespace

Finding no_population(PopulationRecord const& record, double threshold, int particles, std::string const& stopped_by,
                      Ledger const& ledger) {
  bool const bounded = std::isfinite(threshold);
  std::uint64_t const beyond = record.simulated - record.failed - static_cast<std::uint64_t>(record.accepted);
  std::string const places = failed_places(ledger);
  std::string const failed = record.failed == 0 ? std::string()
                                                : fmt::format(" ({} did not stay finite{})", record.failed,
                                                              places.empty() ? "" : fmt::format(": {}", places));
  std::string const what =
      bounded ? fmt::format("came within the first threshold {}", threshold) : std::string("could be simulated");
  std::string help = "raise the limit that was reached (`simulations`, `wall_time`), or use fewer `particles`";
  if (record.simulated == 0 && record.proposed > 0)
    help =
        "the densities of the priors are not finite at their own draws: give them widths within the range of floating-point "
        "numbers";
  else if (beyond > record.failed && bounded)
    help = "raise the first threshold, or check priors, units and the input rule with `sysid check`";
  else if (record.failed > 0)
    help = "the priors lie where the models do not stay finite: narrow them, or use a finer solver";
  return {FindingCode::no_population,
          Severity::error,
          {},
          fmt::format("{} of {} draws from the priors {}{}, but the first population needs {}: {}", record.accepted,
                      record.proposed, what, failed, particles, stopped_by),
          help};
}

Findings check_populations(SelectionResult const& result, Plan const& plan) {
  Findings findings;
  add_deaths(result, findings);
  PopulationRecord const& last = result.populations.back();
  if (last.ess < small_ess)
    findings.push_back(
        {FindingCode::few_effective_particles,
         Severity::warning,
         {},
         fmt::format("the effective number of particles in the last population is {:.0f} of {}", last.ess, last.accepted),
         "use more `particles`"});
  bool const equal = result.populations.size() > 1 && result.threshold == result.next_threshold &&
                     result.threshold != plan.target && plan.schedule.empty();
  // Whatever is proposed is as near as can be: the distance tells nothing.
  bool const none_refused = static_cast<std::uint64_t>(last.accepted) >= last.simulated - last.failed;
  auto const all_zero = [&] {
    return std::all_of(result.models.begin(), result.models.end(), [](SelectedModel const& model) {
      return std::all_of(model.distance.begin(), model.distance.end(), [](double distance) { return distance == 0; });
    });
  };
  if (equal || (result.threshold == 0 && none_refused && all_zero()))
    if (auto finding = equal_distances(result)) findings.push_back(std::move(*finding));
  add_failures(result, findings);
  if (result.ran_out || !std::isfinite(result.threshold))
    findings.push_back({FindingCode::budget_spent,
                        Severity::warning,
                        {},
                        fmt::format("the run stopped before its stopping rule was met: {}{}", result.stopped_by,
                                    std::isfinite(result.threshold) ? "" : "; its only population is a sample of the priors"),
                        "raise the limit that was reached (`simulations`, `wall_time`, `populations`), use fewer `particles`, or "
                        "stop at a larger `target` or "
                        "`relative_change`"});
  return findings;
}

}  // namespace sysid::abc
