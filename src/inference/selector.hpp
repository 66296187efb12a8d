// Back ends that choose among models: a row of a table and one function from a SelectionTarget to a SelectionResult.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "inference/backend.hpp"
#include "likelihood/selection_target.hpp"

namespace sysid {

/// What a population has come to.
struct PopulationRecord {
  double threshold = 0;
  std::uint64_t proposed = 0, simulated = 0, failed = 0;  // up to the last accepted proposal
  int accepted = 0;
  double ess = 0;  // 1 / sum w^2
  struct OfModel {
    std::uint64_t proposed = 0, failed = 0;
    int particles = 0;
    double probability = 0;  // sum of weights
    double nearest = 0;      // smallest distance; infinite without particles
  };
  std::vector<OfModel> models;

  /// Worden et al. (8.21): a part of the particles, which is no probability after the second population.
  double share(int model) const;
  /// Accepted part of the proposals; 1 before the first.
  double acceptance() const;
};

/// A weighted parameter of one model, declared unit.
struct WeightedSummary {
  std::string name, unit;
  double mean = 0, sd = 0, median = 0, q5 = 0, q95 = 0;
};

struct SelectedModel {
  std::string name;
  double prior = 0, probability = 0, share = 0;
  int died_in = 0;         // the first population without it; 0: it lives
  bool by_chance = false;  // when it died, that need not have been its distance
  std::vector<ParameterInfo> parameters;
  LaneArray theta, declared;             // [D x particles]; of a dead model: its last ones
  std::vector<double> weight, distance;  // weights sum to 1 within the model
  std::vector<WeightedSummary> summaries;
};

struct SelectionResult {
  std::vector<SelectedModel> models;  // in the user's order
  std::vector<PopulationRecord> populations;
  double threshold = 0;       // that all particles satisfy
  double next_threshold = 0;  // that another population would have had
  std::string stopped_by;     // in words
  bool ran_out = false;       // a budget ended it, not its own rule
  Settings settings;
  Findings findings;
  bool interrupted = false;
  std::optional<Finding> failure;
};

struct SelectorRow {
  std::string_view name;
  std::string_view summary;
  std::span<SettingRow const> settings;
  /// Why values that are each allowed do not go together; empty when they do.
  std::string (*refuse)(Settings const&);
  SelectionResult (*run)(SelectionTarget const&, Settings const&, RunContext&);
};

std::span<SelectorRow const> selectors();
SelectorRow const* find_selector(std::string_view name);

/// Mean, sd, median and quantiles under weights that sum to 1; values and weights of one length. The sd is that of the weighted
/// particles, without a correction for their number; a quantile is the smallest value with at least that weight up to it.
WeightedSummary summarise_weighted(std::string name, std::string unit, std::span<double const> values,
                                   std::span<double const> weights);

/// Indices of `count` of the weighted items, each drawn in proportion to its weight by systematic resampling with one uniform
/// number.
std::vector<int> resample(std::span<double const> weights, int count, double uniform);

}  // namespace sysid
