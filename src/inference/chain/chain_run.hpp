// What the runs of mh, nuts and tempering have in common: how one begins, is stored and resumed, and what it reports.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "inference/backend/backend.hpp"
#include "inference/chain/chain_record.hpp"

namespace sysid {

/// The part of a run's state that does not depend on how chains move.
struct ChainRun {
  std::vector<Mode> modes;
  Findings findings;  // of the search
  ChainRecord record;
};

/// Where chains begin, in the sampler's coordinates.
struct ChainStarts {
  LaneArray theta;                 // [P x chains]
  std::vector<int> mode_of_chain;  // all 0 at draws from the prior
};

/// Around the modes of a search over the prior, which then stand in `run` (`global`), or at draws from the prior. Nothing where the
/// search was interrupted or there is no start: `result` says which.
std::optional<ChainStarts> find_starts(Target const& target, bool global, int chains, RunContext& context, ChainRun& run,
                                       FitResult& result);

/// [P] of the sampler's coordinates, for proposals and metrics of chains that start all over the prior.
Eigen::VectorXd widths_of_prior(Target const& target, std::uint64_t seed);

/// A checkpoint: `run`, the identity it belongs to and the ledger; back ends add how their chains move.
nlohmann::json store(ChainRun const& run, Ledger const& ledger, nlohmann::json const& identity);
/// Throws checkpoint::Mismatch where `stored` has another number of chains or parameters.
void restore(nlohmann::json const& stored, Target const& target, int chains, ChainRun& run, Ledger& ledger);

/// Resumes where there is something to resume from, else begins. False: there is no state to go on from, and `result` says why; a
/// checkpoint of an interrupted search is then stored.
bool resume_or_begin(nlohmann::json const& identity, RunContext& context, FitResult& result,
                     std::function<void(nlohmann::json const&)> const& resume, std::function<bool()> const& begin);

/// Draws, acceptance, modes and the findings of the search; `stride` iterations stand between recorded ones, of which every
/// `thin`-th is kept.
void report(Target const& target, ChainRun const& run, std::uint64_t thin, std::uint64_t stride, bool global, FitResult& result);

/// Why samples, burn_in and thin do not go together; empty where they do.
std::string refuse_lengths(Settings const& settings);
/// The same, for a back end that writes out every thin-th iteration: also where these are too many.
std::string refuse_kept(Settings const& settings);
/// The same as the first, for a back end that keeps every iteration after burn-in in memory.
std::string refuse_unthinned(Settings const& settings);

/// Draws of all chains: more than any figure shows and any other program likes to read.
constexpr std::int64_t most_kept_draws = 10'000'000;

}  // namespace sysid
