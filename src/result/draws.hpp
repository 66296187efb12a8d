// Posterior draws as every reader sees them: per chain, a table of declared values beside what the sampler recorded.
#pragma once
#include <limits>
#include <string>
#include <vector>

#include "core/numeric/lanes.hpp"

namespace sysid {

/// One chain after burn-in and thinning. values[d][p]: declared unit.
struct Chain {
  std::vector<std::vector<double>> values;
  std::vector<double> log_prior;  // on the declared scale, Jacobian left out
  std::vector<double> log_likelihood;
  std::vector<double> log_density;  // what the sampler saw: log prior on R^P + log likelihood ("lp__")
  std::vector<double> acceptance;   // acceptance probability of the step that led here ("accept_stat__")
};

struct Draws {
  std::vector<std::string> names;  // parameters, then parameter-derived quantities
  std::vector<std::string> units;
  std::vector<Chain> chains;
  int parameter_count = 0;  // the first names are sampled parameters, the rest derived

  std::size_t total() const {
    std::size_t n = 0;
    for (Chain const& chain : chains) n += chain.values.size();
    return n;
  }
  /// What `map` and `ml` give: a single point, which has no spread.
  bool is_optimum() const { return total() == 1; }
  /// Of one name, chain after chain.
  std::vector<double> column(std::size_t name) const;

  struct Best {
    std::vector<double> const* values = nullptr;  // all columns; null: there is no draw
    double log_density = -std::numeric_limits<double>::infinity();
  };
  /// The first of highest log density.
  Best best() const;
};

/// Up to `count` draws spread evenly over all chains, never random: parameters only, as columns [parameter_count x <= count].
LaneArray spread(Draws const& draws, int count);
/// The same of exactly `count`, some of them repeated where there are fewer draws: what stands for a share of a mixture.
LaneArray spread_with_repeats(Draws const& draws, int count);

}  // namespace sysid
