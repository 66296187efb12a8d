// Learns during burn-in around what, and how often, independence moves are tried.
#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "inference/chain/adaptation.hpp"
#include "inference/chain/independence.hpp"
#include "result/mode.hpp"

namespace sysid::metropolis {

/// Begins with the normal distributions at the modes. Burn-in is cut into windows, each a third of what lies before it. At the end
/// of one a mixture with the means and covariances that the chains had before it replaces the one in use if it gives the states
/// *of* the window, which it has not seen, a higher mean log density. How many independence moves follow each move of the random
/// walk is decided by the share of them that is accepted, and by how long a chain may stay in one place: at x it takes w(x) / E w
/// independence moves to leave, w = p / q, E over q (Mengersen and Tweedie 1996).
class IndependenceLearning {
 public:
  /// Random walks alone.
  IndependenceLearning() = default;
  /// component_of_chain [W]: the mode that each chain starts in.
  IndependenceLearning(std::vector<Mode> const& modes, std::vector<int> component_of_chain);

  bool active() const { return !current_.empty(); }
  Independence const& mixture() const { return current_; }
  /// Independence moves of the next cycle of burn-in: now and then one even where they are not accepted, since they may be later.
  int moves_in_burn_in() const;
  /// The same after burn-in; 0 where they are not worth their simulations.
  int moves() const;

  /// [W]: the chains that stand nearer to another mode than to their own.
  std::vector<char> away(State const& state) const;
  /// After every iteration of burn-in.
  void learn(State const& state, Info const& info);
  /// Between cycles: ends the window when it is long enough. Candidates that are drawn already must have been decided on.
  void end_cycle(std::span<Adaptation const> groups);

  /// Share of accepted independence moves in the last window; 0 before its end.
  double acceptance() const { return acceptance_; }

  nlohmann::json store() const;
  static IndependenceLearning restore(nlohmann::json const& stored, int dimension);

 private:
  /// What the states of a window say of a mixture.
  struct Fit {
    double log_density = 0;                   // sum of log q over the states
    double log_highest = 0, log_inverse = 0;  // of the weights w: log max w, log sum 1/w
    void add(double log_posterior, double log_q, bool first);
  };
  struct Window {
    std::uint64_t iterations = 0, states = 0, moves = 0;
    Fit current, candidate;
    double acceptance = 0;  // sum over moves
  };
  int worth() const;

  std::vector<int> component_of_chain_;
  std::vector<double> weights_;
  Independence current_, candidate_;
  Window window_;
  std::uint64_t iterations_ = 0, cycles_ = 0, windows_ = 0;
  double acceptance_ = 0, longest_stay_ = 1;  // of the last window
};

}  // namespace sysid::metropolis
