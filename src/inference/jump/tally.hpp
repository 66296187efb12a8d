// What jumps have said: the chances to be accepted, from each model to each other, in parts of the chains whose scatter gives
// errors.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace sysid::jump {

/// Sums over the jumps of a part of a chain.
struct Part {
  std::vector<double> chance, proposed;  // [M x M] row: from; sums of min(1, ratio), and their number
};

struct Tally {
  int models = 0, parts = 1;
  std::vector<Part> all;  // [chains x parts], chain after chain

  Tally() = default;
  Tally(int models, int chains, int parts);
  void add(int chain, int part, int from, int to, double chance);
};

/// What a tally says of the logarithms of the visits' probabilities.
struct Estimate {
  std::vector<double> log_share;     // [M]; -infinity: never visited, or never left for a model that can be returned from
  std::vector<double> probability;   // [M] after the bias is taken back
  std::vector<double> error;         // [M] standard error of it
  std::vector<double> factor;        // [M] log Bayes factor against the most probable one: prior probabilities taken out
  std::vector<double> factor_error;  // [M]
  std::vector<double> spread;        // [M] variance between chains over that within them
};

/// log of the probability with which a chain is at each model, from how likely jumps between them are accepted: the distribution
/// that does not change under the matrix of mean chances. For two models it is Bartolucci, Scaccia and Mira's (2006, eq. 10)
///
///   pi_1 / pi_2 = mean chance from 2 to 1 / mean chance from 1 to 2
///
/// whose error does not contain that of the number of visits.
std::vector<double> log_shares(Tally const& tally);

/// bias, prior: per model. Standard errors by the jackknife over parts of chains; where chains differ by more than their parts do,
/// over chains.                                                                   Miller 1974
Estimate estimate(Tally const& tally, std::vector<double> const& bias, std::vector<double> const& prior);

/// Variance between chains over that within them, above which chains are said to disagree.
constexpr double disagreement = 4;

nlohmann::json store(Tally const& tally);
/// Throws checkpoint::Mismatch.
Tally restore_tally(nlohmann::json const& stored, int models, int chains, int parts);

}  // namespace sysid::jump
