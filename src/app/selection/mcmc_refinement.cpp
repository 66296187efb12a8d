// One run of `mh` for each model with enough probability.
#include "app/selection/mcmc_refinement.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "diagnostics/convergence.hpp"
#include "inference/chain/mh.hpp"
#include "search/stored_values.hpp"

namespace sysid {
namespace {

Settings settings_for(std::int64_t samples) {
  Settings settings(mh::settings());
  settings.set("samples", samples);
  settings.set("burn_in", samples / 5);
  settings.set("thin", std::max<std::int64_t>(1, samples / 2500));
  return settings;
}

}  // namespace

McmcRefinement refine_with_chains(Session& session, std::vector<Candidate> const& candidates,
                                  std::vector<CandidatePosterior> const& posteriors, std::int64_t samples, std::uint64_t seed,
                                  KeptChains const& kept, SelectionReport& selection) {
  McmcRefinement refinement;
  selection.refined.resize(candidates.size());
  selection.refined_draws.resize(candidates.size());
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    SelectedModel const& model = selection.result.models[k];
    if (model.probability < worth_a_look) continue;
    auto const missed = [&](std::string const& why) {
      refinement.findings.push_back({FindingCode::not_polished,
                                     Severity::warning,
                                     {model.name},
                                     fmt::format("`polish` has no draws of `{}`: {}", model.name, why),
                                     "use the particles of this model, or fit it with `mh`"});
    };
    if (candidates[k].space->dimension() == 0) continue;  // one point, which is known
    if (posteriors[k].modes.empty()) {
      missed("no local search from its particles ends at a finite likelihood");
      continue;
    }
    if (posteriors[k].given_up) {
      missed(
          "the search for its mode was stopped, because according to the likelihood another model is at least exp(30) times as "
          "probable");
      continue;
    }
    auto const target = likelihood_target(session, candidates[k], posteriors[k].solver, session.abandonable());
    Ledger extra;
    RunContext context{.seed = seed,
                       .progress = session.progress,
                       .ledger = extra,
                       .interrupted = [&] { return session.interrupted(); },
                       .checkpoint = [&](nlohmann::json const& state) { kept.save(k, state); },
                       .checkpoint_interval = kept.interval,
                       .resume = kept.stored(k),
                       .modes = posteriors[k].modes,
                       .checkpoint_end = true};
    FitResult chains = mh::run(*target, settings_for(samples), context);
    if (chains.failure && chains.failure->code == FindingCode::checkpoint_mismatch)
      throw checkpoint::Mismatch(fmt::format("its chains of `{}` belong to another run", model.name));
    if (chains.interrupted) {
      refinement.interrupted = true;
      return refinement;
    }
    if (chains.failure || chains.draws.total() == 0) {
      missed(chains.failure ? chains.failure->message : std::string("no draws"));
      continue;
    }
    selection.refined[k] = summarise(chains);
    selection.refined_draws[k] = std::move(chains.draws);
    for (Finding finding : chains.findings) {
      if (finding.severity == Severity::note) continue;
      finding.names.insert(finding.names.begin(), model.name);
      finding.message = fmt::format("polishing `{}`: {}", model.name, finding.message);
      refinement.findings.push_back(std::move(finding));
    }
  }
  return refinement;
}

}  // namespace sysid
