// Which sampler for which posterior.
#include "inference/automatic.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "inference/chain/independence.hpp"
#include "inference/chain/ridge.hpp"
#include "inference/table.hpp"
#include "search/global/search.hpp"
#include "search/laplace.hpp"
#include "search/mode_findings.hpp"

namespace sysid::automatic {
namespace {

/// Above it moves by differences of archived states are slow.
constexpr int most_for_tempering = 20;
/// Random walks of 80,000 iterations over more parameters are worth less than 1,000 independent draws: 0.33/P each.
constexpr int most_for_walks = 25;
/// Independence moves that are worth more need no other help.
constexpr double worth_enough = 0.01;
/// Between modes they are the only ones that jump.
constexpr double worth_jumping = 0.1;
constexpr std::uint64_t choosing_step = 9'000'000;  // of Purpose::start

double worth_of_normals(Target const& target, std::vector<Mode> const& modes, std::uint64_t seed, Ledger& ledger) {
  Objective const objective = make_objective(target, ObjectiveKind::posterior, seed, choosing_step);
  std::vector<metropolis::Independence::Component> components;
  for (Mode const& mode : modes)
    if (mode.share > notable_share) components.push_back({mode.share, theta_of(mode), covariance_of(mode)});
  return metropolis::worth_of_draws(objective, metropolis::Independence(components), seed, ledger);
}

}  // namespace

Choice choose(Target const& target, std::vector<Mode> const& modes, std::uint64_t seed, Ledger& ledger) {
  if (target.is_estimated())
    return {"mh", "the likelihood is estimated by particles, and mh with unbiased estimates samples the exact posterior"};
  auto const notable = std::count_if(modes.begin(), modes.end(), [](Mode const& each) { return each.share > notable_share; });
  int const count = target.dimension();
  if (notable > 1) {
    std::string const modes_of_weight =
        fmt::format("{} modes have more than {:.0f} % of the posterior mass each", notable, 100 * notable_share);
    if (count > most_for_tempering)
      return {"mh", fmt::format("{}: independence moves jump between them, and {} parameters are too many for tempering",
                                modes_of_weight, count)};
    if (target.is_expensive())
      return {"mh", modes_of_weight + ": independence moves jump between them, and each density is too expensive for tempering"};
    double const worth = worth_of_normals(target, modes, seed, ledger);
    if (worth >= worth_jumping)
      return {"mh", fmt::format("{}: 100 draws from the normal distributions at them count as {:.0f} independent draws from the "
                                "posterior, so that moves to such draws jump between them",
                                modes_of_weight, 100 * worth)};
    return {"tempering", modes_of_weight + ", and replicas cross between them"};
  }
  if (!modes.front().flat.empty())
    return {"mh", "at its mode the posterior is flat in one direction, and mh has proposals that follow this direction"};
  if (target.derivatives() == DerivativeSource::differences)
    return {
        "mh",
        fmt::format(
            "it needs no derivatives; for this model they would be finite differences, with {:.0f} simulations for each gradient",
            target.derivative_cost())};
  if (count <= most_for_walks)
    return {"mh", fmt::format("one well-defined mode in {} parameters, where its moves are cheapest", count)};
  double const worth = worth_of_normals(target, modes, seed, ledger);
  if (worth < worth_enough)
    return {"nuts", fmt::format("{} parameters, whose posterior is not normal: 100 draws from the normal distribution at the mode "
                                "count as only {:.2g} independent draws from the posterior",
                                count, 100 * worth)};
  return {"mh",
          fmt::format("100 draws from the normal distribution at the mode count as {:.0f} independent draws from the posterior",
                      100 * worth)};
}

FitResult run(Target const& target, Settings const& settings, RunContext& context) {
  if (context.modes.empty()) {
    SearchResult found = search(target, ObjectiveKind::posterior, context);
    if (found.interrupted || found.failure) {
      FitResult result;
      result.settings = settings;
      result.failure = found.failure;
      result.interrupted = found.interrupted;
      return result;
    }
    context.modes = std::move(found.modes);
    context.mode_findings = std::move(found.findings);
  }
  Ledger looked;
  BackendRow const& chosen = *find_backend(choose(target, context.modes, context.seed, looked).backend);
  return chosen.run(target, Settings(chosen.settings), context);
}

}  // namespace sysid::automatic
