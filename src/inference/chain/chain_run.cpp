// The beginning, storing and reporting of a run of chains.
#include "inference/chain/chain_run.hpp"

#include <fmt/format.h>

#include "inference/backend/checkpoint.hpp"
#include "search/global/chain_starts.hpp"
#include "search/global/search.hpp"
#include "search/objective.hpp"

namespace sysid {

std::optional<ChainStarts> find_starts(Target const& target, bool global, int chains, RunContext& context, ChainRun& run,
                                       FitResult& result) {
  if (!global) {
    std::optional<LaneArray> drawn = prior_starts(target, chains, context);
    if (drawn) return ChainStarts{std::move(*drawn), std::vector<int>(static_cast<std::size_t>(chains), 0)};
    result.failure = no_finite_start(context.ledger, 1000);
    return std::nullopt;
  }
  SearchResult found = context.modes.empty() ? search(target, ObjectiveKind::posterior, context)
                                             : SearchResult{context.modes, context.mode_findings, {}, false};
  result.interrupted = found.interrupted;
  result.failure = found.failure;
  if (found.interrupted || found.failure) return std::nullopt;
  ChainStarts starts;
  starts.mode_of_chain = spread_over_modes(found.modes, chains);
  starts.theta = overdispersed_starts(target, found.modes, starts.mode_of_chain, context);
  run.modes = std::move(found.modes);
  run.findings = std::move(found.findings);
  return starts;
}

Eigen::VectorXd widths_of_prior(Target const& target, std::uint64_t seed) {
  LaneArray draws(target.dimension(), 1000);
  target.sample_prior({seed, Purpose::start, 0, 0}, draws);
  return make_objective(target, ObjectiveKind::posterior, draws).scale;
}

nlohmann::json store(ChainRun const& run, Ledger const& ledger, nlohmann::json const& identity) {
  nlohmann::json modes = nlohmann::json::array();
  for (Mode const& mode : run.modes) modes.push_back(checkpoint::encode(mode));
  return {{"identity", identity},
          {"modes", modes},
          {"findings", checkpoint::encode(run.findings)},
          {"record", run.record.store()},
          {"ledger", checkpoint::encode(ledger)}};
}

void restore(nlohmann::json const& stored, Target const& target, int chains, ChainRun& run, Ledger& ledger) {
  for (auto const& mode : stored.at("modes")) {
    run.modes.push_back(checkpoint::decode_mode(mode));
    if (run.modes.back().theta.size() != static_cast<std::size_t>(target.dimension()))
      throw checkpoint::Mismatch("its modes differ in dimension");
  }
  run.findings = checkpoint::decode_findings(stored.at("findings"));
  run.record = ChainRecord::restore(stored.at("record"), target.dimension(), chains);
  ledger = checkpoint::decode_ledger(stored.at("ledger"));
}

bool resume_or_begin(nlohmann::json const& identity, RunContext& context, FitResult& result,
                     std::function<void(nlohmann::json const&)> const& resume, std::function<bool()> const& begin) {
  if (context.resume) {
    result.failure = checkpoint::refuse(*context.resume, identity);
    if (result.failure) return false;
    // A run stopped during its search has nothing but its identity to resume from.
    if (context.resume->contains("record")) {
      result.failure = checkpoint::read([&] { resume(*context.resume); });
      return !result.failure;
    }
  }
  if (begin()) return true;
  if (result.interrupted && context.checkpoint) context.checkpoint({{"identity", identity}});
  return false;
}

void report(Target const& target, ChainRun const& run, std::uint64_t thin, std::uint64_t stride, bool global, FitResult& result) {
  run.record.write(target, thin / stride, stride == 1, result);
  result.acceptance_rate = run.record.acceptance_rate();
  result.distinct_states = run.record.distinct_states();
  result.modes = run.modes;
  result.findings = run.findings;
  result.search_told = global;
}

std::string refuse_lengths(Settings const& settings) {
  std::int64_t const samples = settings.integer("samples"), burn_in = settings.integer("burn_in"), thin = settings.integer("thin");
  if (burn_in >= samples)
    return fmt::format("burn_in ({}) must be smaller than samples ({}), which counts all iterations", burn_in, samples);
  if (thin > samples - burn_in)
    return fmt::format("thin ({}) is more than the {} iterations left after burn-in, so no draw would be kept", thin,
                       samples - burn_in);
  return {};
}

std::string refuse_kept(Settings const& settings) {
  if (std::string why = refuse_lengths(settings); !why.empty()) return why;
  std::int64_t const kept =
      (settings.integer("samples") - settings.integer("burn_in")) / settings.integer("thin") * settings.integer("chains");
  // All of them are held in memory and written out.
  if (kept <= most_kept_draws) return {};
  return fmt::format("{} draws would be kept, more than {}: increase `thin`, or use fewer samples", kept, most_kept_draws);
}

std::string refuse_unthinned(Settings const& settings) {
  if (std::string const why = refuse_lengths(settings); !why.empty()) return why;
  std::int64_t const kept = (settings.integer("samples") - settings.integer("burn_in")) * settings.integer("chains");
  if (kept <= most_kept_draws) return {};
  return fmt::format("{} iterations would be kept in memory, more than {}: use fewer samples", kept, most_kept_draws);
}

}  // namespace sysid
