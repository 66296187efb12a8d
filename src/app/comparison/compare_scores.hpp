// Predictive scores of fits side by side, and weights computed from them.
#pragma once
#include <compare>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "result/comparison.hpp"

namespace sysid {

/// One that is scored, whatever order a model has its channels in.
struct ScoredSample {
  std::string channel;
  int experiment = 0;  // its place in the data
  int row = 0;         // of the file

  auto operator<=>(ScoredSample const&) const = default;
};

/// A fit's pointwise scores, as its folder has them.
struct ScoredFit {
  std::string name, model;
  std::string identity = {};  // fits that agree in it are of one and the same model
  bool in_time = false;
  bool one_step = false;                      // from measured past samples
  int draws = 0;                              // that its scores are of
  int doubtful = 0;                           // samples with k above largest_k(draws)
  std::vector<ScoredSample> samples;          // sorted
  std::vector<double> elpd_loo, elpd_future;  // NaN where there is no score
};

/// Nothing of a fit without draws. summary: verified, with all its files. UserError (E6209) where the file is not as it is written.
std::optional<ScoredFit> scored_fit(std::string const& name, std::string const& model, std::filesystem::path const& folder,
                                    nlohmann::json const& summary);

/// Nothing of fewer than two; of records in time by leave-future-out over the rows that all reach, by leave-one-out where a fit
/// reaches none. Fits whose samples are not those of the first are left out, and named. A fit that gives a sample no density at all
/// has the score -infinity and no weight. A model that was fitted more than once
/// counts once, by its first fit, whose weights the others show.
ComparedScores compare_scores(std::vector<ScoredFit> const& fits);

}  // namespace sysid
