// Counter-based random streams (Philox 4x64 of Random123): a number depends on its key and position alone, never on who drew
// before.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sysid {

/// What a stream is for; streams of different purposes never meet. Append only: the values enter every stored result.
enum class Purpose : std::uint32_t {
  prior = 1,      // draws from the prior
  start = 2,      // global search and starts of chains
  proposal = 3,   // moves of a chain
  accept = 4,     // acceptance of a move
  noise = 5,      // measurement noise of made data
  input = 6,      // generated input records
  selection = 7,  // which posterior draws are used
  redraw = 8,     // parameters redrawn at each step
  test = 9,
  prediction = 10,   // measurement noise of predictions
  population = 11,   // parameters of an experiment that was not fitted, from their prior
  particle = 12,     // proposals of populations of particles
  supports = 13,     // moves between supports of a dictionary
  coefficient = 14,  // coefficients that a likelihood integrated out
  exchange = 15,     // exchanges between replicas of a chain
  calibration = 16,  // records that are made to see whether a fit finds their true values
  evidence = 17,     // draws of which an evidence is estimated
  bootstrap = 18,    // weights of samples in a Bayesian bootstrap
  jump = 19,         // moves between models
  average = 20,      // seeds of the members of an averaged prediction
  disturbance = 21,  // disturbances and random starts of made data
  probe = 22,        // noise that is added to a record to see what noise does
};

/// Names a stream: seed of the run, purpose, index (chain, particle, draw, lane) and step (iteration, sample, population).
struct StreamKey {
  std::uint64_t seed = 0;
  Purpose purpose = Purpose::test;
  std::uint64_t index = 0;
  std::uint64_t step = 0;

  StreamKey at(std::uint64_t new_index, std::uint64_t new_step) const { return {seed, purpose, new_index, new_step}; }
  StreamKey with_index(std::uint64_t new_index) const { return {seed, purpose, new_index, step}; }
  StreamKey with_step(std::uint64_t new_step) const { return {seed, purpose, index, new_step}; }
};

/// The numbers of one key, in order.
class Stream {
 public:
  explicit Stream(StreamKey key) : key_(key) {}

  std::uint64_t bits();
  /// Uniform on the open interval (0, 1), 52 random bits.
  double uniform();
  /// The next of them, several times as quick as one by one.
  void uniforms(std::span<double> out);
  /// Standard normal, by Box and Muller on core/numeric/elementary; two numbers per pair of uniforms.
  double normal();
  /// Uniform on {0, ..., n - 1} without bias; n > 0.
  std::uint64_t below(std::uint64_t n);

 private:
  StreamKey key_;
  std::uint64_t block_ = 0;
  std::array<std::uint64_t, 4> words_{};
  int used_ = 4;
  bool has_normal_ = false;
  double normal_ = 0;
};

}  // namespace sysid
