// What samples and blocks of samples contribute to predictive scores, from their log densities under posterior draws.
#pragma once
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "criteria/leave_out.hpp"
#include "result/criteria.hpp"

namespace sysid {

/// Of one sample.
struct SampleScore {
  double log_density = 0;  // log of its mean density under the draws, which have seen it
  double p_waic = 0;       // variance of its log density                            Watanabe 2010; Gelman, Hwang and Vehtari 2014
  double elpd_loo = 0;     // log of its density under the draws as though they had not seen it
  double pareto_k = 0;

  double elpd_waic() const { return log_density - p_waic; }
};

/// log_density: finite, of each draw, chain after chain. influence: of all draws on the sum of elpd_loo.
SampleScore score_sample(std::span<double const> log_density, int chains, DrawInfluence& influence);

/// Of the samples of a block, which were left out together.
struct BlockScore {
  double pareto_k = 0;
  std::vector<double> elpd;  // [samples]
};

/// Of samples that the weighted draws have not seen; log_density: [samples x draws], -infinity where a draw predicts nothing.
BlockScore score_block(LeftOut const& weights, ConstLanes log_density, DrawInfluence& influence);

/// log_density: [samples x draws]. Scored whatever k is.
BlockScore leave_block_out(ConstLanes log_density, int chains, DrawInfluence& influence);

/// Leaves out the end of a record, more and more of it: each block is predicted from the samples before it alone.
///
/// For samples that are independent given the parameters and what came before, the posterior without the last of them has the
/// weights 1 / likelihood of these.                                                          Buerkner, Gabry and Vehtari 2020,
/// backward
class FutureOut {
 public:
  FutureOut(int draws, int chains) : chains_(chains), log_likelihood_(static_cast<std::size_t>(draws), 0) {}
  /// The block before those of before.
  void leave(ConstLanes log_density);
  /// Scores the block that was left out last. Without scores where k is above `most_k`: earlier blocks would be worse.
  BlockScore score(ConstLanes log_density, double most_k, DrawInfluence& influence) const;
  /// Whether what was left out tells nothing of the parameters: its weights do not differ.
  bool tells_nothing() const;

 private:
  int chains_;
  std::vector<double> log_likelihood_;  // of what has been left out, under each draw
};

/// The sum with its standard error, of the values that are not NaN; an infinite sum has none (NaN).
LogScore sum_of(std::span<double const> values);

/// Where a record of so many scored rows is cut into blocks: the first of each, and the end. At most `blocks`, none empty.
std::vector<int> block_ends(int rows, int blocks);

}  // namespace sysid
