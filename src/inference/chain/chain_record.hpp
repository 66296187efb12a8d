// The record of W chains, iteration by iteration, in the sampler's coordinates; and its conversion to draws.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "inference/backend/backend.hpp"
#include "inference/chain/metropolis.hpp"

namespace sysid {

class ChainRecord {
 public:
  ChainRecord() = default;
  ChainRecord(int dimension, int chains);

  void count_burn_in(metropolis::Info const& info);
  /// One iteration of one chain in burn-in.
  void count_burn_in(int chain, metropolis::Move const& move);
  /// One iteration of one chain after burn-in; `keep`: its state is recorded, not only counted.
  void add(int chain, metropolis::State const& state, metropolis::Move const& move, bool keep);
  /// The same of a state [P] on its own, which is recorded.
  void add(int chain, std::span<double const> theta, double log_prior, double log_likelihood, metropolis::Move const& move);

  /// Share of accepted moves per chain: after burn-in once there is any, else during it.
  std::vector<double> acceptance_rate() const;
  double mean_acceptance() const;
  /// States visited per chain after burn-in: accepted moves and the one it came with.
  std::vector<std::uint64_t> distinct_states() const;

  /// Every `thin`-th record becomes a draw of result.draws; with `unthinned` all of them go to result.unthinned. Chains that are at
  /// different iterations (an interrupted run) are cut to the shortest.
  void write(Target const& target, std::uint64_t thin, bool unthinned, FitResult& result) const;

  nlohmann::json store() const;
  static ChainRecord restore(nlohmann::json const& stored, int dimension, int chains);

 private:
  struct Trace {
    std::uint64_t burnt = 0, accepted_burning = 0, sampled = 0, accepted = 0;  // iterations
    std::vector<double> theta;                                                 // P numbers per record
    std::vector<double> log_prior, log_likelihood, acceptance;                 // one per record
  };
  void write_chain(Target const& target, Trace const& trace, std::size_t records, std::uint64_t thin, bool unthinned,
                   std::size_t chain, FitResult& result) const;

  int dimension_ = 0;
  std::vector<Trace> traces_;
};

}  // namespace sysid
