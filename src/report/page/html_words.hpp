// What the numbers of a report mean, in sentences that name them.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "result/report.hpp"

namespace sysid {

/// The verdict's first line in words: of a discovery without its equations, which a page has as formulas.
std::string verdict_words(Report const& report);

/// What the verdict allows: to use the numbers, to look first, or neither. Empty where there is none.
std::string verdict_meaning(Report const& report);

/// What the values of a kind of score say here, of the worst of the lines; empty where nothing is to be said.
std::string score_words(Report const& report, std::vector<FitLine> const& lines, ScoreName const& score);

/// A diagnostic of the chains, what it says here, and whether it is as it should be.
struct ChainWords {
  std::string name, words;
  bool good;
};
/// Of chains alone: an optimum has none.
std::vector<ChainWords> chain_words(Report const& report);

/// How many simulations failed and what that means for the result; empty where nothing was simulated.
std::string ledger_words(Report const& report);

/// What the modes that were found say, and no more than a search can. There is a mode.
std::string mode_words(Report const& report);

/// What the posterior has learnt beyond the prior: the parameters that are hardly narrower than their priors.
std::string learning_words(Report const& report);

}  // namespace sysid
