// A fit of a made record by the task's own back end, and the places of the true values among its draws.
#include "app/calibration/replicate.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/fit/fit.hpp"
#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/interrupt.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

bool is_optimum(BackendRow const& backend) { return backend.objective_kind != ObjectiveKind::posterior; }

/// One thread, no files: replications share the threads.
RunOptions alone(RunOptions options) {
  options.execution.threads = 1;
  options.resume = options.force = options.figures = false;
  options.interrupt_after = 0;
  options.seed.reset();
  return options;
}

void add_code(std::vector<std::string>& codes, Finding const& finding) {
  std::string code(word(finding.code));
  if (std::find(codes.begin(), codes.end(), code) == codes.end()) codes.push_back(std::move(code));
}

/// draws: all of them; ranks: how many of `thinned` of them, evenly spread. Draws that equal the true value are divided by chance.
TruePlace place_among(std::vector<double> const& draws, double truth, int thinned, Stream& stream) {
  auto const all = static_cast<double>(draws.size());
  double below = 0, equal = 0;
  for (double const each : draws) {
    below += each < truth;
    equal += each == truth;
  }
  TruePlace place{truth, mean(draws), std::sqrt(sample_variance(draws)), (below + 0.5 * equal) / all, 0};
  std::uint64_t ties = 0;
  for (int i = 0; i < thinned; ++i) {
    auto const at = static_cast<std::size_t>((i + 0.5) / thinned * all);
    place.rank += draws[at] < truth;
    ties += draws[at] == truth;
  }
  if (ties > 0) place.rank += static_cast<int>(stream.below(ties + 1));
  return place;
}

/// Where an optimum with its sd, which a reader takes for a normal distribution, has the true value.
TruePlace place_in_normal(double optimum, double sd, double truth, int thinned) {
  double const below = sd > 0 ? 0.5 * elementary::erfc((optimum - truth) / sd / std::numbers::sqrt2)
                              : 0.5 + 0.5 * (truth > optimum) - 0.5 * (truth < optimum);
  return {truth, optimum, sd, below, std::min(thinned, static_cast<int>(below * (thinned + 1)))};
}

std::vector<double> log_likelihoods(Draws const& draws) {
  std::vector<double> all;
  for (Chain const& chain : draws.chains) all.insert(all.end(), chain.log_likelihood.begin(), chain.log_likelihood.end());
  return all;
}

}  // namespace

std::vector<QuantityName> ranked_quantities(Session& session, CalibrationPlan const& plan) {
  auto const compiled = session.compiled(plan.what, plan.what.solver.method);
  std::vector<QuantityName> quantities;
  auto const space = parameter_space(compiled->model, plan.what.experiments);
  for (ParameterInfo const& each : space->infos())
    if (!each.coefficient) quantities.push_back({each.name, each.unit});
  if (!is_optimum(*plan.backend)) quantities.push_back({"log likelihood", "", false});
  return quantities;
}

Replicator::Replicator(Session& session, CalibrationPlan const& plan)
    : plan_(plan),
      options_(alone(session.options)),
      session_(session.source, session.file, options_, progress_, nowhere_, nowhere_),
      model_(session.file.models[static_cast<std::size_t>(plan.what.model)]),
      data_(load_experiments(session, plan.what.experiments, model_, plan.what.start, plan.what.prediction, plan.what.solver)),
      maker_(session_, plan.what, data_) {}

// Up to 2^53, so that it may be written into a file as it stands.
std::uint64_t Replicator::seed_of(int number) const {
  return Stream({plan_.seed, Purpose::calibration, static_cast<std::uint64_t>(number), 0}).bits() >> 11;
}

Replicator::Tried Replicator::try_prior(int some) {
  Tried tried;
  for (int number = 0; number < some; ++number) {
    auto const made = maker_.make(seed_of(number));
    tried.failed += made ? made->redrawn : RecordMaker::most_draws;
    tried.draws += made ? made->redrawn + 1 : RecordMaker::most_draws;
  }
  return tried;
}

std::optional<Replication> Replicator::run(int number) {
  Replication replication;
  replication.number = number;
  replication.seed = seed_of(number);
  try {
    auto const made = maker_.make(replication.seed);
    if (!made) {
      replication.redrawn = RecordMaker::most_draws;
      replication.failure = "none of the prior draws could be simulated";
      return replication;
    }
    replication.redrawn = made->redrawn;
    replication.settled = made->settled;
    for (auto const& [block, record] : made->of_blocks) session_.replace_record(block, model_, record);
    fit(*made, replication);
  } catch (UserError const& error) {
    replication.failure = error.diagnostic().message;
  } catch (Interrupted const&) {
    return std::nullopt;
  }
  if (interrupt_requested()) return std::nullopt;
  return replication;
}

void Replicator::fit(MadeRecords const& made, Replication& replication) {
  auto const fitted = fit_unkept(session_, plan_.index, *plan_.task, plan_.what, replication.seed, made.truth, plan_.backend);
  if (!fitted) throw Interrupted();
  Report const& report = fitted->report;
  replication.solves = report.ledger.solves();
  for (Finding const& finding : report.findings) {
    if (finding.severity == Severity::error) add_code(replication.failed, finding);
    if (finding.severity == Severity::warning) add_code(replication.warned, finding);
  }
  bool const optimum = is_optimum(*plan_.backend);
  if (!optimum && report.draws.total() < static_cast<std::size_t>(plan_.draws)) {
    replication.failure = "the fit kept too few draws to rank the true values";
    return;
  }
  // Of no rank, which NaN would have too: it is below nothing.
  if (optimum)
    for (std::size_t p = 0; p < made.truth.size(); ++p)
      if (Summary const& each = report.summary[p]; !each.coefficient && !(std::isfinite(each.mean) && std::isfinite(each.sd))) {
        replication.failure = "the optimum or its sd is not finite";
        return;
      }
  if (!optimum && std::isnan(fitted->log_likelihood)) {
    replication.failure = "the likelihood of the true values is not a number";
    return;
  }
  Stream ties({replication.seed, Purpose::calibration, 0, 2});
  for (std::size_t p = 0; p < made.truth.size(); ++p) {
    Summary const& summary = report.summary[p];
    if (summary.coefficient) continue;
    replication.places.push_back(optimum ? place_in_normal(summary.mean, summary.sd, made.truth[p], plan_.draws)
                                         : place_among(report.draws.column(p), made.truth[p], plan_.draws, ties));
    if (optimum) continue;
    double const worth = std::isfinite(summary.ess_bulk) ? summary.ess_bulk : 1;
    replication.independent = replication.places.size() == 1 ? worth : std::min(replication.independent, worth);
  }
  if (!optimum) replication.places.push_back(place_among(log_likelihoods(report.draws), fitted->log_likelihood, plan_.draws, ties));
}

json store(Replication const& replication) {
  json places = json::array();
  for (TruePlace const& each : replication.places) places.push_back({each.truth, each.mean, each.sd, each.below, each.rank});
  return {{"number", replication.number},           {"seed", replication.seed},
          {"redrawn", replication.redrawn},         {"failure", replication.failure},
          {"failed", replication.failed},           {"warned", replication.warned},
          {"independent", replication.independent}, {"solves", replication.solves},
          {"settled", replication.settled},         {"places", std::move(places)}};
}

Replication restore_replication(json const& stored) {
  Replication out;
  stored.at("number").get_to(out.number);
  stored.at("seed").get_to(out.seed);
  stored.at("redrawn").get_to(out.redrawn);
  stored.at("failure").get_to(out.failure);
  stored.at("failed").get_to(out.failed);
  stored.at("warned").get_to(out.warned);
  stored.at("independent").get_to(out.independent);
  stored.at("solves").get_to(out.solves);
  stored.at("settled").get_to(out.settled);
  for (json const& each : stored.at("places"))
    out.places.push_back({each.at(0).get<double>(), each.at(1).get<double>(), each.at(2).get<double>(), each.at(3).get<double>(),
                          each.at(4).get<int>()});
  return out;
}

}  // namespace sysid
