// What W chains leave behind, iteration by iteration, in the sampler's coordinates; and how it becomes draws.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "inference/backend.hpp"
#include "inference/metropolis.hpp"

namespace sysid {

class ChainRecord {
 public:
  ChainRecord() = default;
  ChainRecord(int dimension, int chains);

  void count_burn_in(metropolis::Info const& info);
  /// One iteration after burn-in; `keep`: its states are recorded, not only counted.
  void add(metropolis::State const& state, metropolis::Info const& info, bool keep);

  /// Share of accepted moves per chain: after burn-in once there is any, else during it.
  std::vector<double> acceptance_rate() const;
  double mean_acceptance() const;
  /// States visited per chain after burn-in: accepted moves and the one it came with.
  std::vector<std::uint64_t> distinct_states() const;

  /// Every `thin`-th record becomes a draw of result.draws; with `unthinned` all of them go to result.unthinned.
  void write(Target const& target, std::uint64_t thin, bool unthinned, FitResult& result) const;

  nlohmann::json store() const;
  static ChainRecord restore(nlohmann::json const& stored, int dimension, int chains);

 private:
  int dimension_ = 0;
  int chains_ = 0;
  std::uint64_t burnt_ = 0, sampled_ = 0;  // iterations
  std::vector<std::uint64_t> accepted_burning_, accepted_;
  // Per record: theta by parameter then chain, and one row of chains each.
  std::vector<double> theta_, log_prior_, log_likelihood_, acceptance_;
};

}  // namespace sysid
