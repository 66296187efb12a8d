// How the program sees a back end: a row of a table (what it is, what it needs, its settings) and one function from a Target to a
// FitResult. Nothing of the language passes: names and units come from Target::parameters, settings from the checked table.
#pragma once
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/ledger.hpp"
#include "core/progress.hpp"
#include "core/settings.hpp"
#include "inference/aim.hpp"
#include "inference/convergence.hpp"
#include "inference/draws.hpp"
#include "inference/finding.hpp"
#include "likelihood/target.hpp"

namespace sysid {

/// What a back end asks of a model beyond a prior and a likelihood; a model that lacks it is refused before the first step.
struct Needs {
  bool proper_prior = false;  // every prior can be drawn from
};

/// An optimum and its Gaussian (Laplace) approximation.
struct Mode {
  std::vector<double> theta;       // [P], sampler's coordinates
  std::vector<double> declared;    // [P], declared units
  std::vector<double> sd;          // [P], declared units, to first order in the width
  std::vector<double> covariance;  // [P x P] by rows, sampler's coordinates
  double log_density = 0;          // of the objective at theta, all constants kept
  double log_mass = 0;       // log integral of its Laplace approximation: over the sampler's coordinates where the objective is
                             // the density there, else over the declared parameters
  double share = 0;          // of the sum of all modes' masses; of `ml`, of their likelihoods
  int hits = 0;              // local searches that ended here
  std::vector<double> flat;  // [K x P] moves of the declared parameters, a tenth of a prior width at most, that nothing
                             // resists: widths along them are the prior's; empty: well defined
};

/// All that a run gets from outside, and the only way anything but the result leaves it.
struct RunContext {
  std::uint64_t seed;
  Progress& progress;
  /// Counts of this run's solves and failures; empty at the start, refilled from the checkpoint when resuming.
  Ledger& ledger;
  /// Asked between steps; true: checkpoint, return what there is. Empty: never.
  std::function<bool()> interrupted = {};
  /// Takes the whole state of the run; anything stored as JSON text or CBOR comes back exactly. Empty: no checkpoints.
  std::function<void(nlohmann::json const&)> checkpoint = {};
  /// Seconds between checkpoints; one more is made on interruption.
  double checkpoint_interval = 60;
  /// What `checkpoint` was last given by the same task: the run goes on to the same bytes as if it had never stopped.
  std::optional<nlohmann::json> resume = {};
  /// Modes of the density that the row's `aim` names, when a search has found them already: back ends start from these instead of
  /// searching again.
  std::vector<Mode> modes = {};
  Findings mode_findings = {};  // of that search

  bool stop_requested() const { return interrupted && interrupted(); }
};

/// A proposal as frozen after burn-in: x' = x + scale L z, one move in ten with 0.2 scale when `adaptive`.
struct FrozenProposal {
  std::vector<int> chains;     // that use it, from 0
  std::vector<double> factor;  // L, lower triangle of [P x P] by rows
  double scale = 1;
};

struct FitResult {
  /// Kept draws, declared values. `map` and `ml`: one chain of one draw, the optimum.
  Draws draws;
  /// unthinned[p]: parameter p at every iteration after burn-in, for diagnostics; empty when memory forbade it (a finding says so).
  std::vector<ChainValues> unthinned;
  std::vector<Summary> summaries;              // of the parameters, where the back end has taken them already
  std::vector<double> acceptance_rate;         // per chain, after burn-in (during it, when interrupted before its end)
  std::vector<std::uint64_t> distinct_states;  // per chain, after burn-in
  std::vector<Mode> modes;                     // by falling share; of `map` and `ml` by falling density
  std::vector<FrozenProposal> proposals;
  Settings settings;
  Findings findings;
  bool search_told = false;  // `findings` hold those of the search, or what stands in their place
  bool interrupted = false;
  /// Set when there is no result at all (no finite start, a checkpoint of another run): an error for the user, with the reason.
  std::optional<Finding> failure;
};

struct BackendRow {
  std::string_view name;
  std::string_view summary;
  Needs needs;
  Aim aim;  // what its modes are modes of
  std::span<SettingRow const> settings;
  /// Why values that are each allowed do not go together ("burn_in must be smaller than samples"); empty when they do.
  std::string (*refuse)(Settings const&);
  FitResult (*run)(Target const&, Settings const&, RunContext&);
};

std::span<BackendRow const> backends();
BackendRow const* find_backend(std::string_view name);

/// One summary per parameter: the back end's own, or of the unthinned chains where they were kept, else of the draws.
std::vector<Summary> summarise(FitResult const& result);

}  // namespace sysid
