// Learns during burn-in around what, and how often, independence moves are tried.
#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "inference/chain/adaptation.hpp"
#include "inference/chain/independence.hpp"
#include "inference/chain/state_archive.hpp"
#include "result/mode.hpp"

namespace sysid::metropolis {

/// Begins with the normal distributions at the modes. Burn-in is cut into windows, each a third of what lies before it. At the end
/// of one a mixture with the means and covariances that the chains had before it replaces the one in use if it gives the states
/// *of* the window, which it has not seen, a higher mean log density. Where less than half of the moves of the window before were
/// accepted, two mixtures over the declared values are candidates as well, one from the modes and one from the states: noise that
/// is added to what is measured makes normal what a response is linear in, which is more often a value than its logarithm. So is,
/// with one mode, a mixture of several components, which are fitted to the states by expectation maximisation: a density that
/// narrows towards one side, or bends, is not like one normal distribution in any coordinates.
///
/// How many independence moves follow each local move is decided by the share of them that is accepted, and by how long a chain
/// may stay in one place: at x it takes w(x) / E w independence moves to leave, w = p / q, E over q (Mengersen and Tweedie 1996).
/// Where a quarter of them is accepted one is made, however long a chain may stay: local moves are half of all then.
class IndependenceLearning {
 public:
  /// Random walks alone.
  IndependenceLearning() = default;
  /// component_of_chain [W]: the mode that each chain starts in.
  IndependenceLearning(Target const& target, std::vector<Mode> const& modes, std::vector<int> component_of_chain);

  bool active() const { return !mixtures_[0].empty(); }
  Independence const& mixture() const { return mixtures_[0]; }
  /// Independence moves of the next cycle of burn-in: now and then one even where they are not accepted, since they may be later.
  int moves_in_burn_in() const;
  /// The same after burn-in; 0 where they are not worth their simulations.
  int moves() const;

  /// [W]: log p/q of the states, q the mixture in use, up to a constant that lasts as long as the mixture.
  std::vector<double> log_weights(Target const& target, State const& state) const;
  /// [W]: the chains that stand nearer to another mode than to their own.
  std::vector<char> away(Target const& target, State const& state) const;
  /// After every iteration of burn-in; away [W] as above.
  void learn(Target const& target, State const& state, Info const& info, std::span<char const> away);
  /// Between cycles: ends the window when it is long enough, and returns whether it did. Candidates that are drawn already must
  /// have been decided on.
  bool end_cycle(Target const& target, std::span<Adaptation const> groups, std::uint64_t seed);

  /// Whether the ridge through the mode is to be followed now: once, with one mode and not too many parameters, where too few
  /// moves were accepted, or chains stayed in one place for long.
  bool wants_ridge() const;
  /// A mixture along it, and the share of independent draws that its draws are worth: if that is more than the share of accepted
  /// moves, it is used from now on and no other is compared with it, since states of chains tell nothing of where they have not
  /// been. Where it is not complete it is not used: chains would hardly leave what it covers. That it would have been worth it has
  /// the consequence of a chain that stays in one place for long.
  void see_ridge(Independence const& mixture, double worth, bool complete);

  /// Whether scouts are to look now for mass that neither the mixture nor the chains have reached: with one mode, where many moves
  /// are refused, and, if the first find nothing, once more some windows later. What is learnt from chains misses a tail so narrow
  /// that none has entered it in burn-in. end: of burn-in, before which at least two more windows have to end.
  bool wants_scouts(std::uint64_t end) const;
  /// At most `most` states that the chains have been in. [P x n]
  LaneArray archived(int most) const { return archives_.front().picked(0, static_cast<std::size_t>(most)); }
  /// How often they have looked.
  std::uint64_t scoutings() const { return scoutings_; }
  /// walked: places of scouts, with the densities there. One that independence moves hardly lead away from has the consequence of a
  /// chain that stays there for long; the one that they lead away from least is returned. Only places count whose density is as
  /// chains know it, at least their mean of the last window less one sd, of the logarithm: what is narrow and has mass has no low
  /// density, while some scouts are still on their way back from a flatter one.
  std::optional<std::size_t> see_scouts(Target const& target, State const& walked);

  /// Whether chains need moves along ridges: where the mixture in use, that along a ridge if there is one, has again and again left
  /// a chain in one place for long.
  bool wants_ridge_moves() const;

  /// Whether a window has ended, and too few of its moves were accepted to do without others.
  bool too_few() const;

  nlohmann::json store() const;
  /// Throws checkpoint::Mismatch for another number of parameters or chains.
  static IndependenceLearning restore(nlohmann::json const& stored, int dimension, int chains);

 private:
  /// What the states of a window say of a mixture.
  struct Fit {
    double log_density = 0;                   // sum of log q over the states
    double log_highest = 0, log_inverse = 0;  // of the weights w: log max w, log sum 1/w
    void add(double log_posterior, double log_q, bool first);
  };
  static constexpr std::size_t mixture_count = 5;
  struct Window {
    std::uint64_t iterations = 0, states = 0, moves = 0;
    std::array<Fit, mixture_count> fits;
    double acceptance = 0;           // sum over moves
    double density = 0, square = 0;  // sums of the log density of the states, and of its square
  };
  void archive(State const& state, std::span<char const> away);
  /// Over the declared values of the last two thirds of an archive; nothing where they are too few.
  std::optional<Independence::Component> declared(Target const& target, std::size_t component) const;
  /// Of several components over theta, fitted to the last two thirds of the archive and to where scouts have been; empty where
  /// these are too few.
  Independence several(std::uint64_t seed) const;
  void propose_mixtures(Target const& target, std::span<Adaptation const> groups, std::uint64_t seed);
  /// Whether a mixture takes part in the comparison.
  bool compared(std::size_t m) const { return !mixtures_[m].empty() && (!mixtures_[m].declared() || sees_declared()); }
  bool sees_declared() const { return too_few() || mixture().declared(); }
  int worth() const;
  /// Whether each of `chains` has its component.
  bool fits(int chains) const;

  std::vector<int> component_of_chain_;
  std::vector<double> weights_;
  /// In use (one along a ridge ends the comparison); candidates over theta, over declared values, over these as the modes are, and
  /// of several components over theta; empty where there are none.
  std::array<Independence, mixture_count> mixtures_;
  std::vector<StateArchive> archives_;  // of the chains of each component, while they were near it
  LaneArray walked_;                    // [P x n] where scouts have come back to
  Window window_;
  std::uint64_t iterations_ = 0, cycles_ = 0, windows_ = 0;
  std::uint64_t scoutings_ = 0, next_scouting_ = 0;  // how many there were, and the window from which on there may be another
  std::uint64_t long_stays_ = 0;                     // windows with a place from which independence moves hardly lead
  double acceptance_ = 0, longest_stay_ = 1;         // of the last window
  double log_mean_weight_ = 0;                       // of the last window, over the mixture
  double usual_density_ = 0;                         // mean less sd of the log density of its states
  bool ridge_seen_ = false, on_ridge_ = false;       // whether the mixture in use is one along a ridge
  bool mass_found_ = false;                          // by scouts
};

}  // namespace sysid::metropolis
