// Where a run stands between two batches of moves: all that the next one needs, and all that a checkpoint holds.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/system/ledger.hpp"
#include "inference/jump/moves.hpp"
#include "inference/jump/pilot.hpp"
#include "inference/jump/plan.hpp"
#include "inference/jump/tally.hpp"

namespace sysid::jump {

/// Weights of proposals of a model, over the largest.
struct Weights {
  double highest = 0, sum = 0, squares = 0, count = 0;  // highest: log; nothing counted: 0 of all

  void add(double log_weight);
  /// log of their mean, and its standard error; -infinity, infinity where none is positive.
  double log_mean() const;
  double error() const;
  /// The part of their number that they are worth; 0 where none is positive.
  double worth() const;
};

/// Kept draws of a model: parameters one after another, chain after chain within an iteration.
struct KeptDraws {
  std::vector<double> theta, log_density;
};

struct State {
  std::vector<std::optional<Pilot>> pilots;  // per candidate; the first without one is next
  nlohmann::json chains_of_pilot;            // of that one; null: none yet
  std::vector<int> live;                     // candidates that take part, once all pilots are known; models below are of these
  std::vector<double> bias, scale;           // [M]
  std::uint64_t next = 0;                    // iteration
  std::vector<Place> places;                 // [chains]; of `live`
  Tally burn_in, tally;
  std::vector<Weights> weights;                                                    // [M]
  std::vector<KeptDraws> draws;                                                    // [M]
  std::vector<double> visits;                                                      // [M] iterations after burn-in
  std::vector<double> walks, walks_accepted;                                       // [M] of the present phase
  std::vector<double> jumps_in, jumps_in_accepted, jumps_out, jumps_out_accepted;  // [M] between models, after burn-in
  std::vector<std::uint64_t> simulations;                                          // [M]
};

nlohmann::json identity(std::span<LikelihoodCandidate const> candidates, Settings const& settings, std::uint64_t seed);

nlohmann::json store(State const& state, nlohmann::json const& identity, Ledger const& ledger);
/// Throws checkpoint::Mismatch or a JSON exception when it is not what `store` made for these candidates.
State restore(nlohmann::json const& stored, std::span<LikelihoodCandidate const> candidates, Plan const& plan, Ledger& ledger);

}  // namespace sysid::jump
