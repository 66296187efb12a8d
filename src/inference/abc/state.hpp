// Where a run stands between two batches of proposals: all that the next one needs, and all that a checkpoint holds.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/system/ledger.hpp"
#include "inference/abc/population.hpp"
#include "inference/backend/selector.hpp"

namespace sysid::abc {

struct State {
  Population last, next;                  // the last whole one, and the one in the making
  PopulationRecord record;                // of the one in the making
  std::vector<PopulationRecord> records;  // of whole ones
  struct Departure {
    int population = 0;      // the first one without the model; 0: it lives
    bool by_chance = false;  // that need not have been its distance
    Particles particles;     // its last ones
  };
  std::vector<Departure> departures;  // per model

  /// Of whole populations.
  std::uint64_t simulations() const;
};

/// What a checkpoint must have been made with to be gone on from: settings, seed, models and their parameters.
nlohmann::json identity(SelectionTarget const& candidates, Settings const& settings, std::uint64_t seed);

/// With its identity and the failures so far.
nlohmann::json store(State const& state, nlohmann::json const& identity, Ledger const& ledger);
/// Throws checkpoint::Mismatch or a JSON exception when it is not what `store` made for these candidates.
State restore(nlohmann::json const& stored, SelectionTarget const& candidates, Ledger& ledger);

}  // namespace sysid::abc
