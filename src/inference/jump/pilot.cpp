// A pilot: chains, mixture, evidence.
#include "inference/jump/pilot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/interrupt.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/chain/mh.hpp"
#include "inference/evidence/sample.hpp"
#include "search/laplace.hpp"

namespace sysid::jump {
namespace {

using json = nlohmann::json;

constexpr std::int64_t pilot_chains = 4;
constexpr int most_fitted = 3000;        // draws that a mixture is fitted to
constexpr int weighted = 512;            // draws of it that give the first evidence
constexpr std::uint64_t scale_step = 5;  // of Purpose::start

/// Pilots four and sixteen times as long are made where proposals are worth less than this part of their number.
constexpr double enough = 0.1;
constexpr int most_lengthened = 2;

/// Says of which model the chains are.
class PilotProgress : public Progress {
 public:
  PilotProgress(Progress& to, std::string const& model) : to_(to), model_(model) {}
  void begin(std::string_view what, std::uint64_t total) override {
    to_.begin(fmt::format("pilot of {}: {}", model_, what), total);
  }
  void expect(std::uint64_t total) override { to_.expect(total); }
  void advance(std::uint64_t done, std::string_view note) override { to_.advance(done, note); }
  void end(bool finished) override { to_.end(finished); }

 private:
  Progress& to_;
  std::string const& model_;
};

Settings settings_for(Plan const& plan, int lengthened) {
  std::int64_t samples = plan.pilot;
  for (int i = 0; i < lengthened; ++i) samples *= 4;
  Settings settings(mh::settings());
  settings.set("samples", samples);
  settings.set("burn_in", samples / 4);
  settings.set("chains", pilot_chains);
  settings.set("thin", std::max<std::int64_t>(1, samples * pilot_chains / (2 * most_fitted)));
  return settings;
}

/// Draws of the pilot on the sampler's coordinates.
struct PilotDraws {
  LaneArray theta;
  std::vector<double> log_density;  // of prior times likelihood
};

/// Those of all chains at one place next to each other: what is fitted to the first of them is tried on the last.
PilotDraws in_order(Target const& target, Draws const& draws) {
  std::vector<std::vector<double> const*> rows;
  std::vector<double> density;
  std::size_t const length = draws.chains.front().values.size();
  for (std::size_t i = 0; i < length; ++i)
    for (Chain const& chain : draws.chains) rows.push_back(&chain.values[i]), density.push_back(chain.log_density[i]);
  LaneArray declared(target.dimension(), static_cast<int>(rows.size())), theta(declared.rows(), declared.width());
  for (std::size_t w = 0; w < rows.size(); ++w)
    for (int p = 0; p < declared.rows(); ++p) declared(p, static_cast<int>(w)) = (*rows[w])[static_cast<std::size_t>(p)];
  target.unconstrain(declared, theta);
  // A value that was rounded onto its bound has no finite coordinate.
  std::vector<int> finite;
  for (int w = 0; w < theta.width(); ++w) {
    bool all = std::isfinite(density[static_cast<std::size_t>(w)]);
    for (int p = 0; p < theta.rows(); ++p) all = all && std::isfinite(theta(p, w));
    if (all) finite.push_back(w);
  }
  PilotDraws kept{LaneArray(theta.rows(), static_cast<int>(finite.size())), {}};
  for (std::size_t w = 0; w < finite.size(); ++w) {
    kept.log_density.push_back(density[static_cast<std::size_t>(finite[w])]);
    for (int p = 0; p < theta.rows(); ++p) kept.theta(p, static_cast<int>(w)) = theta(p, finite[w]);
  }
  return kept;
}

/// log of the mean of density over proposal.
double log_mean_weight(std::vector<double> const& log_density, std::vector<double> const& log_mixture) {
  std::vector<double> logs;
  for (std::size_t i = 0; i < log_density.size(); ++i) {
    logs.push_back(log_density[i] - log_mixture[i]);
    if (!(logs.back() < infinity)) logs.back() = -infinity;
  }
  return log_of_mean(logs);
}

/// Of a model without parameters.
Pilot of_point(LikelihoodCandidate const& candidate, Ledger& ledger) {
  LaneArray const theta(0, 1);
  double prior = 0, likelihood = 0;
  candidate.target->log_prior(theta, {&prior, 1});
  candidate.target->log_likelihood(theta, {&likelihood, 1}, ledger);
  double const log_evidence = prior + likelihood + candidate.log_unit;
  if (std::isfinite(log_evidence)) return {{}, log_evidence, {}};
  return {{}, -infinity, "its simulation does not stay finite"};
}

struct Weighed {
  Pilot pilot;
  double worth = 0;  // part of their number that draws of the mixture are worth
};

/// The mean weight of draws of a mixture is the evidence. Their effective part is its square over the mean square of the weights,
/// which is the evidence times their mean over the posterior: the pilot's draws see large weights that few draws of the mixture do
/// not. Nothing when interrupted.
std::optional<Weighed> weigh(LikelihoodCandidate const& candidate, marginal::Mixture mixture, PilotDraws const& draws,
                             RunContext const& context, Ledger& ledger) {
  Objective const objective = make_objective(*candidate.target, ObjectiveKind::posterior, context.seed, scale_step);
  marginal::MixtureSample sample;
  marginal::add_draws(objective, mixture, weighted, context.seed, sample, ledger, context.interrupted);
  if (context.stop_requested()) return std::nullopt;
  double const log_evidence = log_mean_weight(sample.log_density, sample.log_mixture);
  if (!std::isfinite(log_evidence)) return Weighed{Pilot{{}, -infinity, "no draw near its modes has a finite likelihood"}, 1};
  double const of_posterior = log_mean_weight(draws.log_density, mixture.log_density(mixture.log_terms(draws.theta)));
  return Weighed{Pilot{std::move(mixture), log_evidence + candidate.log_unit, {}}, elementary::exp(log_evidence - of_posterior)};
}

/// One pilot with its chains. Nothing when interrupted; what was counted is in both ledgers otherwise.
std::optional<Weighed> explore_once(LikelihoodCandidate const& candidate, Settings const& settings, RunContext& context,
                                    RunContext& own, Ledger& weighing) {
  Target const& target = *candidate.target;
  FitResult const chains = mh::run(target, settings, own);
  if (chains.interrupted) return std::nullopt;
  if (chains.failure && chains.failure->code == FindingCode::checkpoint_mismatch)
    throw checkpoint::Mismatch(fmt::format("its chains of `{}` belong to another run", candidate.name));
  if (chains.failure || chains.draws.total() == 0)
    return Weighed{Pilot{{}, -infinity, chains.failure ? chains.failure->message : "its pilot has no draws"}, 1};
  std::vector<Component> modes;
  for (Mode const& mode : chains.modes)
    if (std::isfinite(mode.log_density) && mode.share > 1e-3) modes.emplace_back(theta_of(mode), covariance_of(mode));
  PilotDraws const draws = in_order(target, chains.draws);
  marginal::Mixture mixture = marginal::fit_mixture(modes, draws.theta, context.seed, context.interrupted);
  if (context.stop_requested()) return std::nullopt;
  if (mixture.empty()) return Weighed{Pilot{{}, -infinity, "its pilot has too few draws for a proposal"}, 1};
  return weigh(candidate, std::move(mixture), draws, context, weighing);
}

}  // namespace

std::optional<Pilot> explore(LikelihoodCandidate const& candidate, Plan const& plan, RunContext& context, KeptPilot const& kept) {
  if (!candidate.excluded.empty()) return Pilot{{}, -infinity, candidate.excluded};
  try {
    // Nothing is counted of a pilot that is interrupted and begins again; its chains hold their own counts.
    if (candidate.target->dimension() == 0) {
      Ledger spent;
      Pilot point = of_point(candidate, spent);
      context.ledger.merge(spent);
      return point;
    }
    int lengthened = 0;
    Ledger before;  // of shorter pilots
    std::shared_ptr<json const> chains;
    if (kept.stored) {
      lengthened = std::clamp(kept.stored->at("lengthened").get<int>(), 0, most_lengthened);
      before = checkpoint::decode_ledger(kept.stored->at("before"));
      chains = std::make_shared<json const>(kept.stored->at("chains"));
    }
    for (;; ++lengthened, chains = nullptr) {
      Ledger spent, weighing;
      PilotProgress progress(context.progress, candidate.name);
      RunContext own{.seed = context.seed,
                     .progress = progress,
                     .ledger = spent,
                     .interrupted = context.interrupted,
                     .checkpoint =
                         [&](json const& state) {
                           kept.save({{"lengthened", lengthened}, {"before", checkpoint::encode(before)}, {"chains", state}});
                         },
                     .checkpoint_interval = context.checkpoint_interval,
                     .resume = chains,
                     .modes = candidate.modes};
      std::optional<Weighed> found = explore_once(candidate, settings_for(plan, lengthened), context, own, weighing);
      if (!found) return std::nullopt;
      before.merge(spent);
      before.merge(weighing);
      if (found->worth < enough && lengthened < most_lengthened) continue;
      context.ledger.merge(before);
      return std::move(found->pilot);
    }
  } catch (Interrupted const&) {
    return std::nullopt;
  }
}

json store(Pilot const& pilot) {
  json parts = json::array();
  for (marginal::Mixture::Part const& part : pilot.mixture.parts()) {
    Eigen::MatrixXd const& root = part.shape.root;
    parts.push_back({checkpoint::encode(std::span<double const>(part.shape.centre.data(), static_cast<std::size_t>(root.rows()))),
                     checkpoint::encode(std::span<double const>(root.data(), static_cast<std::size_t>(root.size()))),
                     checkpoint::encode(std::vector<double>{part.shape.log_volume, part.normal, part.student})});
  }
  return {{"parts", std::move(parts)},
          {"log_evidence", checkpoint::encode(std::vector<double>{pilot.log_evidence})},
          {"excluded", pilot.excluded}};
}

Pilot restore_pilot(json const& stored, int dimension) {
  auto const size = static_cast<std::size_t>(dimension);
  std::vector<marginal::Mixture::Part> parts;
  for (json const& each : stored.at("parts")) {
    std::vector<double> const centre = checkpoint::decode(each.at(0), size), root = checkpoint::decode(each.at(1), size * size),
                              numbers = checkpoint::decode(each.at(2), 3);
    Component shape(Eigen::Map<Eigen::VectorXd const>(centre.data(), dimension), Eigen::MatrixXd::Identity(dimension, dimension));
    shape.root = Eigen::Map<Eigen::MatrixXd const>(root.data(), dimension, dimension);
    shape.log_volume = numbers[0];
    parts.push_back({std::move(shape), numbers[1], numbers[2]});
  }
  Pilot pilot{marginal::Mixture(std::move(parts)), checkpoint::decode(stored.at("log_evidence"), 1).front(),
              stored.at("excluded").get<std::string>()};
  if (pilot.excluded.empty() && (!std::isfinite(pilot.log_evidence) || pilot.mixture.empty() != (dimension == 0)))
    throw checkpoint::Mismatch("its proposals do not fit its models");
  return pilot;
}

}  // namespace sysid::jump
