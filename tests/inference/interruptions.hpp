// Runs that are stopped and resumed: their results are, to the byte, those of a run that never stopped.
#pragma once
#include <doctest/doctest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "inference/targets.hpp"

namespace sysid::testing {

using BackendRun = FitResult (*)(Target const&, Settings const&, RunContext&);

inline bool same_draws(FitResult const& a, FitResult const& b) {
  if (a.draws.chains.size() != b.draws.chains.size() || a.unthinned != b.unthinned) return false;
  for (std::size_t c = 0; c < a.draws.chains.size(); ++c) {
    Chain const &x = a.draws.chains[c], &y = b.draws.chains[c];
    if (x.values != y.values || x.log_density != y.log_density || x.log_likelihood != y.log_likelihood ||
        x.log_prior != y.log_prior || x.acceptance != y.acceptance)
      return false;
  }
  return true;
}

/// A run that never stopped.
struct Unbroken {
  FitResult result;
  std::uint64_t solves = 0;
  int questions = 0;    // whether to stop: one before every batch
  nlohmann::json last;  // the state at its end
};

constexpr std::uint64_t interrupted_seed = 9;

inline Unbroken unbroken(BackendRun run, Target const& target, Settings const& settings) {
  Unbroken whole;
  Bench bench(interrupted_seed);
  bench.context.interrupted = [&] { return ++whole.questions < 0; };
  bench.context.checkpoint_end = true;
  bench.context.checkpoint = [&](nlohmann::json const& state) { whole.last = state; };
  whole.result = run(target, settings, bench.context);
  whole.solves = bench.ledger.solves();
  return whole;
}

inline void check_resumed(BackendRun run, Target const& target, Settings const& settings, Unbroken const& whole,
                          nlohmann::json const& saved) {
  Bench bench(interrupted_seed);
  bench.context.resume = std::make_shared<nlohmann::json const>(nlohmann::json::from_cbor(nlohmann::json::to_cbor(saved)));
  FitResult const resumed = run(target, settings, bench.context);
  CHECK_FALSE(resumed.interrupted);
  CHECK(same_draws(whole.result, resumed));
  CHECK(whole.result.acceptance_rate == resumed.acceptance_rate);
  CHECK(whole.result.distinct_states == resumed.distinct_states);
  CHECK(whole.result.findings == resumed.findings);
  CHECK(whole.solves == bench.ledger.solves());
  REQUIRE(whole.result.proposals.size() == resumed.proposals.size());
  for (std::size_t i = 0; i < resumed.proposals.size(); ++i) CHECK(whole.result.proposals[i].factor == resumed.proposals[i].factor);
}

/// Stops after each of these numbers of questions.
inline void check_stops(BackendRun run, Target const& target, Settings const& settings, Unbroken const& whole,
                        std::vector<int> const& limits) {
  for (int const limit : limits) {
    CAPTURE(limit);
    nlohmann::json saved;
    int asked = 0;
    Bench bench(interrupted_seed);
    bench.context.interrupted = [&] { return ++asked > limit; };
    bench.context.checkpoint = [&](nlohmann::json const& state) { saved = state; };
    FitResult const part = run(target, settings, bench.context);
    REQUIRE(part.interrupted);
    CHECK(part.draws.total() < whole.result.draws.total());
    check_resumed(run, target, settings, whole, saved);
  }
}

/// Gives up each of these batches, counted from the last one of a whole run, 0.
inline void check_given_up(BackendRun run, TestTarget const& target, Settings const& settings,
                           std::vector<int> const& before_last) {
  GivenUp const never(target, -1);
  Unbroken const whole = unbroken(run, never, settings);
  for (int const before : before_last) {
    CAPTURE(before);
    nlohmann::json saved;
    Bench bench(interrupted_seed);
    bench.context.checkpoint = [&](nlohmann::json const& state) { saved = state; };
    GivenUp const given_up(target, never.batches - before);
    REQUIRE(run(given_up, settings, bench.context).interrupted);
    check_resumed(run, target, settings, whole, saved);
  }
}

}  // namespace sysid::testing
