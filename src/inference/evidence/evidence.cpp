// Rounds of importance and bridge sampling, and the choice between their numbers and Laplace's.
#include "inference/evidence/evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/numeric/hypotenuse.hpp"
#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "inference/evidence/bridge.hpp"
#include "inference/evidence/importance.hpp"
#include "inference/evidence/laplace.hpp"
#include "inference/evidence/smc.hpp"
#include "inference/evidence/weighted_draws.hpp"
#include "search/laplace.hpp"

namespace sysid::marginal {
namespace {

constexpr std::uint64_t scale_step = 5;  // of Purpose::start
constexpr int first_draws = 512;
constexpr int particles = 1000;
constexpr int most_fitted = 2400, most_bridged = 4000;  // draws
constexpr std::uint64_t most_simulations = 16384;
constexpr double precise = 0.02;   // nats: what no comparison needs better
constexpr double tolerable = 0.3;  // nats: a number with a larger error is none to lean on
constexpr double enough = 100;     // effective draws

/// Why a number with that error is none to compare models by; empty: it is.
std::string too_large(double error) {
  return error > tolerable ? fmt::format("its error is {:.2f}, above {}", error, tolerable) : "";
}

/// What both methods say after some rounds.
struct Estimates {
  ImportanceEstimate importance;
  BridgeEstimate bridge;
  int draws = 0;

  bool bridged() const { return std::isfinite(bridge.log_evidence) && bridge.posterior_effective >= enough / 2; }
  /// By how much importance sampling gives more, beyond chance.
  double surplus() const {
    double const off = importance.log_evidence - bridge.log_evidence;
    double const chance = 3 * hypotenuse(importance.error, bridge.error) + precise;
    return !bridged() || std::fabs(off) < chance ? 0 : off;
  }
  /// Why the mean weight may miss mass; empty: it does not.
  std::string ill_weights() const {
    if (!std::isfinite(importance.log_evidence)) return "the density is zero at all draws of the mixture";
    if (bridge.posterior_effective < enough / 2)  // q follows the posterior's draws, and the error is taken from them too
      return fmt::format("the posterior's draws are equivalent to only {:.0f} independent ones", bridge.posterior_effective);
    if (importance.effective < enough)
      return fmt::format("{} weighted draws are equivalent to only {:.0f} independent ones", draws, importance.effective);
    if (bridge.unseen > std::max(0.01, 2 * importance.plain_error))
      return fmt::format("{:.0f} % of the posterior's draws have larger weights than any draw of the mixture", 100 * bridge.unseen);
    if (surplus() < 0) return fmt::format("bridge sampling gives {:.2f}", bridge.log_evidence);
    return too_large(importance.error);
  }
  std::string ill_bridge() const {
    if (!std::isfinite(bridge.log_evidence)) return "the mixture and the posterior do not overlap";
    if (bridge.posterior_effective < enough / 2)
      return fmt::format("the posterior's draws are equivalent to only {:.0f} independent ones", bridge.posterior_effective);
    // The mean of weights may miss mass but does not invent it.
    if (surplus() > 0)
      return fmt::format("the draws miss a part of the posterior: importance sampling gives {:.2f}", importance.log_evidence);
    return too_large(bridge.error);
  }
  bool precise_enough(EvidenceMethod method) const {
    bool const by_weights = importance.error <= precise && ill_weights().empty();
    bool const by_bridge = bridge.error <= precise && ill_bridge().empty();
    if (method == EvidenceMethod::importance) return by_weights;
    if (method == EvidenceMethod::bridge) return by_bridge;
    return by_weights || by_bridge;
  }
};

void by_importance(Estimates const& found, Evidence& evidence) {
  evidence.method = EvidenceMethod::importance;
  evidence.log_evidence = found.importance.log_evidence;
  evidence.error = found.importance.error;
  evidence.effective = std::min<double>(found.importance.effective, found.draws);
}

void by_bridge(Estimates const& found, Evidence& evidence) {
  evidence.method = EvidenceMethod::bridge;
  evidence.log_evidence = found.bridge.log_evidence;
  evidence.error = found.bridge.error;
  evidence.effective = found.bridge.posterior_effective;
}

void choose(Estimates const& found, EvidenceMethod method, Evidence& evidence) {
  std::string const weights = found.ill_weights(), bridge = found.ill_bridge();
  // Where neither is believed, weights near the modes say more than draws that have not moved.
  bool const importance_better = weights.empty() ? !bridge.empty() || found.importance.error < 1.5 * found.bridge.error
                                                 : !bridge.empty() && found.importance.effective >= enough;
  if (method == EvidenceMethod::importance || (method == EvidenceMethod::automatic && importance_better)) {
    by_importance(found, evidence);
    evidence.doubt = weights;
  } else {
    by_bridge(found, evidence);
    evidence.doubt = bridge;
  }
  if (!std::isfinite(*evidence.log_evidence)) {
    evidence.reason = evidence.doubt;
    evidence.log_evidence.reset(), evidence.error.reset();
    evidence.doubt.clear();
  }
}

std::vector<Component> components_of(std::vector<Mode> const& modes) {
  std::vector<Component> components;
  for (Mode const& mode : modes)
    if (std::isfinite(mode.log_density)) components.emplace_back(theta_of(mode), covariance_of(mode));
  return components;
}

/// Whether there was a mixture, and simulations to draw from it.
bool estimate(Target const& target, EvidenceTask const& task, std::vector<Mode> const& modes, Evidence& evidence, Ledger& ledger,
              std::function<bool()> const& stop) {
  std::uint64_t const share = task.method == EvidenceMethod::automatic ? task.simulations / 10 : task.simulations;
  auto const most = static_cast<int>(std::min(share, most_simulations));
  if (most < first_draws) return false;
  PosteriorSample const fitted = half_of(target, task.draws, false, most_fitted);
  PosteriorSample bridged = half_of(target, task.draws, true, most_bridged);
  Mixture const mixture = fit_mixture(components_of(modes), fitted.theta, task.seed, stop);
  if (mixture.empty() || bridged.size() == 0) return false;
  look_at(mixture, bridged);
  Objective const objective = make_objective(target, ObjectiveKind::posterior, task.seed, scale_step);
  MixtureSample sample;
  Estimates found;
  for (int count = first_draws; !(stop && stop()) && sample.size() + count <= most; count = sample.size()) {
    add_draws(objective, mixture, count, task.seed, sample, ledger, stop);
    found.draws = sample.size();
    found.bridge = bridge(sample, bridged);
    found.importance = importance(mixture, sample, bridged, found.bridge.log_evidence);
    if (found.precise_enough(task.method)) break;
  }
  if (found.draws == 0) return false;
  evidence.simulations = static_cast<std::uint64_t>(found.draws);
  choose(found, task.method, evidence);
  return true;
}

/// Why tempered SMC may have lost a part of the mass on its way; empty: nothing speaks against it. Its own error counts only what
/// its particles have seen, and they see nothing of a narrow mode that few of them have entered.
std::string doubt_by_laplace(Evidence const& evidence, bool laplace_passes) {
  double allowed = 2 * *evidence.error + 0.2;
  if (laplace_passes) allowed = std::min(allowed, 0.4);  // its own checks know it better than particles that may have been lost
  if (evidence.laplace && std::fabs(*evidence.laplace - *evidence.log_evidence) > allowed)
    return fmt::format("Laplace's approximation gives {:.1f}", *evidence.laplace);
  return "";
}

/// Whether two populations reached the posterior with the simulations that they may take together. What they differ by is an error
/// that neither can see.
bool temper(Target const& target, EvidenceTask const& task, std::uint64_t most, Evidence& evidence, Ledger& ledger,
            std::function<bool()> const& stop) {
  std::uint64_t const other_seed = Stream({task.seed, Purpose::evidence, 0, scale_step}).bits() >> 11;
  std::vector<Mode> const modes = task.objective_kind == ObjectiveKind::posterior ? task.modes : std::vector<Mode>();
  SmcEstimate const first = smc(target, particles, modes, most / 2, task.seed, ledger, stop);
  evidence.simulations += first.simulations;
  if (!first.finished) return false;
  SmcEstimate const second = smc(target, particles, modes, most / 2, other_seed, ledger, stop);
  evidence.simulations += second.simulations;
  if (!second.finished) return false;
  double const difference = second.log_evidence - first.log_evidence;
  evidence.method = EvidenceMethod::smc;
  evidence.log_evidence = log_of_mean(std::array{first.log_evidence, second.log_evidence});
  evidence.error = std::max(0.5 * hypotenuse(first.error, second.error), 0.5 * std::fabs(difference));
  evidence.effective = first.effective + second.effective;
  evidence.reason.clear();
  evidence.doubt = first.unmoved || second.unmoved ? "tempered SMC could not move its particles at some powers of the likelihood"
                                                   : too_large(*evidence.error);
  return true;
}

/// Weighted draws around the modes, in place of Laplace's number where they know it better.
void prefer_weighted(EvidenceMethod method, Evidence& evidence) {
  constexpr double better = 0.1;  // nats
  SampledEvidence const& sampled = evidence.sampled;
  if (!evidence.log_evidence || sampled.state != SampledEvidence::State::known) return;
  if (method != EvidenceMethod::importance && sampled.error > better) return;
  evidence.method = EvidenceMethod::importance;
  *evidence.log_evidence += sampled.above;
  // No draws of the posterior tell of tails that these draws do not reach: their own error may be far too small.
  evidence.error = std::max({sampled.error, std::fabs(evidence.along_axes), std::fabs(sampled.above) / 3});
  evidence.effective = sampled.effective;
  evidence.simulations = sampled.draws;
  evidence.doubt = too_large(*evidence.error);
}

/// How bridge sampling of the draws of the fit contradicts the populations; empty if it does not, nothing where it gives no number.
std::optional<std::string> doubt_by_draws(Target const& target, EvidenceTask const& task, Evidence& evidence, Ledger& ledger,
                                          std::function<bool()> const& stop) {
  Evidence bridged;
  std::vector<Mode> const modes = sampled_modes(target, task.objective_kind, task.modes, task.seed, ledger, stop);
  bool const known = estimate(target, task, modes, bridged, ledger, stop);
  evidence.simulations += bridged.simulations;
  if (!known || !bridged.log_evidence || !bridged.doubt.empty()) return std::nullopt;
  double const apart = std::fabs(*bridged.log_evidence - *evidence.log_evidence);
  if (apart < 3 * hypotenuse(*evidence.error, *bridged.error)) return "";
  return fmt::format("bridge sampling gives {:.2f} ± {:.2f}", *bridged.log_evidence, *bridged.error);
}

}  // namespace
}  // namespace sysid::marginal

namespace sysid {

Evidence estimate_evidence(Target const& target, EvidenceTask const& task, Ledger& ledger, std::function<bool()> const& stop) {
  if (task.method == EvidenceMethod::none) {
    Evidence none{{}, "the task has `evidence = none`"};
    none.method = EvidenceMethod::none;
    return none;
  }
  bool const draws = task.draws.total() > 1, sampled = task.method != EvidenceMethod::laplace && draws;
  Evidence evidence = laplace_evidence(target, task.objective_kind, task.modes, task.seed, ledger, stop, !sampled);
  if (task.objective_kind == ObjectiveKind::likelihood || target.dimension() == 0) return evidence;
  evidence.laplace = evidence.log_evidence;
  evidence.without_laplace = evidence.reason;
  bool const laplace_passes = evidence.laplace && evidence.doubt.empty();
  if (task.method == EvidenceMethod::laplace) return evidence;
  if (task.method == EvidenceMethod::smc) {
    constexpr std::uint64_t most = 1'000'000;
    if (!marginal::temper(target, task, most, evidence, ledger, stop))
      evidence.doubt = fmt::format("tempered SMC did not reach the posterior with {} simulations", evidence.simulations);
    else if (evidence.doubt.empty()) {
      // Laplace's approximation may be as wrong as the populations: it is asked where there are no good draws.
      auto const by_draws = draws ? marginal::doubt_by_draws(target, task, evidence, ledger, stop) : std::nullopt;
      evidence.doubt = by_draws ? *by_draws : marginal::doubt_by_laplace(evidence, laplace_passes);
    }
    return evidence;
  }
  if (!draws) {
    marginal::prefer_weighted(task.method, evidence);
    if (task.method == EvidenceMethod::bridge) evidence.doubt = "bridge sampling needs draws of the posterior";
    if (task.method == EvidenceMethod::importance && evidence.log_evidence && evidence.method != EvidenceMethod::importance)
      evidence.doubt = "importance sampling has no usable weighted draws around the modes";
    return evidence;
  }
  Evidence by_draws = evidence;
  by_draws.reason.clear();
  std::vector<Mode> const modes = sampled_modes(target, task.objective_kind, task.modes, task.seed, ledger, stop);
  bool const known = marginal::estimate(target, task, modes, by_draws, ledger, stop);
  bool const believed = known && by_draws.log_evidence && by_draws.doubt.empty();
  if (task.method == EvidenceMethod::automatic && !believed && known && !target.is_expensive()) {
    Evidence tempered = evidence;
    tempered.simulations = by_draws.simulations;
    if (marginal::temper(target, task, task.simulations / 2, tempered, ledger, stop) && tempered.doubt.empty() &&
        marginal::doubt_by_laplace(tempered, laplace_passes).empty())
      return tempered;
    by_draws.simulations = tempered.simulations;
  }
  if (known && by_draws.log_evidence) return by_draws;
  evidence.doubt = known ? by_draws.reason : "the fit has too few draws, or has taken too few simulations, to estimate it";
  return evidence;
}

}  // namespace sysid
