// What a search or back end gets from the program that runs it.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/system/ledger.hpp"
#include "core/system/progress.hpp"
#include "result/finding.hpp"
#include "result/mode.hpp"

namespace sysid {

class Journal;

/// All that a run gets from outside, and the only way anything but the result leaves it.
struct RunContext {
  std::uint64_t seed;
  Progress& progress;
  /// Counts of this run's solves and failures; empty at the start, refilled from the checkpoint when resuming.
  Ledger& ledger;
  /// Asked between steps; true: checkpoint, return what there is. Empty: never.
  std::function<bool()> interrupted = {};
  /// Takes the whole state of the run; stored as CBOR it comes back exactly. Empty: no checkpoints.
  std::function<void(nlohmann::json const&)> checkpoint = {};
  /// Seconds between checkpoints; one more is made on interruption.
  double checkpoint_interval = 60;
  /// What `checkpoint` was last given by the same task: the run goes on to the same bytes as if it had never stopped.
  std::shared_ptr<nlohmann::json const> resume = {};
  /// Modes of the density that the row's `objective_kind` names, when a search has found them already: back ends start from these
  /// instead of searching again.
  std::vector<Mode> modes = {};
  Findings mode_findings = {};  // of that search
  /// Keeps the steps of a search; null: an interrupted one begins anew.
  Journal* journal = nullptr;
  /// Whether `checkpoint` is given the state at the end, too: for runs that are parts of one task.
  bool checkpoint_end = false;

  bool stop_requested() const { return interrupted && interrupted(); }
};

}  // namespace sysid
