// A pilot: chains, mixture, evidence.
#include "inference/jump/pilot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
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

Settings settings_for(Plan const& plan) {
  Settings settings(mh::settings());
  settings.set("samples", plan.pilot);
  settings.set("burn_in", plan.pilot / 4);
  settings.set("chains", pilot_chains);
  settings.set("thin", std::max<std::int64_t>(1, plan.pilot * pilot_chains / (2 * most_fitted)));
  return settings;
}

/// On the sampler's coordinates, those of all chains at one place next to each other: what is fitted to the first of them is tried
/// on the last.
LaneArray in_order(Target const& target, Draws const& draws) {
  std::vector<std::vector<double> const*> rows;
  std::size_t length = draws.chains.front().values.size();
  for (std::size_t i = 0; i < length; ++i)
    for (Chain const& chain : draws.chains) rows.push_back(&chain.values[i]);
  LaneArray declared(target.dimension(), static_cast<int>(rows.size())), theta(declared.rows(), declared.width());
  for (std::size_t w = 0; w < rows.size(); ++w)
    for (int p = 0; p < declared.rows(); ++p) declared(p, static_cast<int>(w)) = (*rows[w])[static_cast<std::size_t>(p)];
  target.unconstrain(declared, theta);
  // A value that was rounded onto its bound has no finite coordinate.
  std::vector<int> finite;
  for (int w = 0; w < theta.width(); ++w) {
    bool all = true;
    for (int p = 0; p < theta.rows(); ++p) all = all && std::isfinite(theta(p, w));
    if (all) finite.push_back(w);
  }
  LaneArray kept(theta.rows(), static_cast<int>(finite.size()));
  for (std::size_t w = 0; w < finite.size(); ++w)
    for (int p = 0; p < theta.rows(); ++p) kept(p, static_cast<int>(w)) = theta(p, finite[w]);
  return kept;
}

double log_mean_weight(marginal::MixtureSample const& sample) {
  double highest = -infinity, sum = 0;
  std::vector<double> logs;
  for (int k = 0; k < sample.size(); ++k) {
    auto const i = static_cast<std::size_t>(k);
    logs.push_back(sample.log_density[i] - sample.log_mixture[i]);
    if (!(logs.back() < infinity)) logs.back() = -infinity;
    highest = std::max(highest, logs.back());
  }
  if (highest == -infinity) return highest;
  for (double const each : logs) sum += elementary::exp(each - highest);
  return highest + elementary::log(sum / static_cast<double>(logs.size()));
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

/// Nothing when interrupted.
std::optional<Pilot> weigh(LikelihoodCandidate const& candidate, marginal::Mixture mixture, RunContext const& context,
                           Ledger& ledger) {
  Objective const objective = make_objective(*candidate.target, ObjectiveKind::posterior, context.seed, scale_step);
  marginal::MixtureSample sample;
  marginal::add_draws(objective, mixture, weighted, context.seed, sample, ledger, context.interrupted);
  if (context.stop_requested()) return std::nullopt;
  double const log_evidence = log_mean_weight(sample) + candidate.log_unit;
  if (!std::isfinite(log_evidence)) return Pilot{{}, -infinity, "no draw near its modes has a finite likelihood"};
  return Pilot{std::move(mixture), log_evidence, {}};
}

}  // namespace

std::optional<Pilot> explore(LikelihoodCandidate const& candidate, Plan const& plan, RunContext& context, KeptPilot const& kept) {
  if (!candidate.excluded.empty()) return Pilot{{}, -infinity, candidate.excluded};
  Target const& target = *candidate.target;
  try {
    // Nothing is counted of a pilot that is interrupted and begins again; its chains hold their own counts.
    Ledger spent, weighing;
    auto const counted = [&](std::optional<Pilot> pilot) {
      if (pilot) context.ledger.merge(spent), context.ledger.merge(weighing);
      return pilot;
    };
    if (target.dimension() == 0) return counted(of_point(candidate, weighing));
    RunContext own{.seed = context.seed,
                   .progress = context.progress,
                   .ledger = spent,
                   .interrupted = context.interrupted,
                   .checkpoint = kept.save,
                   .checkpoint_interval = context.checkpoint_interval,
                   .resume = kept.stored,
                   .modes = candidate.modes};
    FitResult const chains = mh::run(target, settings_for(plan), own);
    if (chains.interrupted) return std::nullopt;
    if (chains.failure && chains.failure->code == FindingCode::checkpoint_mismatch)
      throw checkpoint::Mismatch(fmt::format("its chains of `{}` belong to another run", candidate.name));
    if (chains.failure || chains.draws.total() == 0)
      return counted(Pilot{{}, -infinity, chains.failure ? chains.failure->message : "its pilot has no draws"});
    std::vector<Component> modes;
    for (Mode const& mode : chains.modes)
      if (std::isfinite(mode.log_density) && mode.share > 1e-3) modes.emplace_back(theta_of(mode), covariance_of(mode));
    marginal::Mixture mixture = marginal::fit_mixture(modes, in_order(target, chains.draws), context.seed, context.interrupted);
    if (context.stop_requested()) return std::nullopt;
    if (mixture.empty()) return counted(Pilot{{}, -infinity, "its pilot has too few draws for a proposal"});
    return counted(weigh(candidate, std::move(mixture), context, weighing));
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
