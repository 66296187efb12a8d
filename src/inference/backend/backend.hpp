// How the program sees a back end: a row of a table (what it is, what it needs, its settings) and one function from a Target to a
// FitResult. Nothing of the language passes: names and units come from Target::parameters, settings from the checked table.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/setting/settings.hpp"
#include "likelihood/target.hpp"
#include "result/draws.hpp"
#include "result/finding.hpp"
#include "result/mode.hpp"
#include "result/summary.hpp"
#include "search/objective_kind.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// What a back end asks of a model beyond a prior and a likelihood; a model that lacks it is refused before the first step.
struct Needs {
  bool proper_prior = false;      // every prior can be drawn from
  bool exact_likelihood = false;  // unbiased estimates of it will not do
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
  /// A point, in the sampler's coordinates, whose density is higher than that of all `modes`: the search has missed one. Empty: no
  /// such point was met, or none was looked for.
  std::vector<double> higher_place;
  bool search_told = false;  // `findings` hold those of the search, or what stands in their place
  bool interrupted = false;
  /// Set when there is no result at all (no finite start, a checkpoint of another run): an error for the user, with the reason.
  std::optional<Finding> failure;
};

struct BackendRow {
  std::string_view name;
  std::string_view summary;
  Needs needs;
  ObjectiveKind objective_kind;  // what its modes are modes of
  std::span<SettingRow const> settings;
  /// Why values that are each allowed do not go together ("burn_in must be smaller than samples"); empty when they do.
  std::string (*refuse)(Settings const&);
  FitResult (*run)(Target const&, Settings const&, RunContext&);
};

/// One summary per parameter: the back end's own, or of the unthinned chains where they were kept, else of the draws.
std::vector<Summary> summarise(FitResult const& result);

}  // namespace sysid
