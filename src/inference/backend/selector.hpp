// Back ends that choose among models: a row of a table and one function to a SelectionResult, from a SelectionTarget (distances) or
// from a Target of each candidate (likelihoods).
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "likelihood/selection/selection_target.hpp"
#include "result/selection.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// A candidate as a back end sees it that selects by likelihood.
struct LikelihoodCandidate {
  std::string name;
  double prior = 0;  // probabilities of all sum to 1
  Target const* target = nullptr;
  double log_unit = 0;      // added to its log likelihood, so that the densities of all are in the same units
  std::vector<Mode> modes;  // of its posterior; none: the back end searches
  std::string excluded;     // why it takes no part: no finite likelihood was found; empty: it does
};

struct SelectorRow {
  std::string_view name;
  std::string_view summary;
  std::span<SettingRow const> settings;
  /// Why values that are each allowed do not go together; empty when they do.
  std::string (*refuse)(Settings const&);
  /// By distance; null for a back end that selects by likelihood.
  SelectionResult (*run)(SelectionTarget const&, Settings const&, RunContext&);
  /// By likelihood, noise included; null for one that selects by distance.
  SelectionResult (*run_by_likelihood)(std::span<LikelihoodCandidate const>, Settings const&, RunContext&) = nullptr;
};

}  // namespace sysid
