// The standard normal numbers behind a likelihood of particles, in the order in which a filter takes them: fresh from a stream, or
// kept, so that an estimate can be repeated or moved a little.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "core/numeric/random.hpp"

namespace sysid {

class ParticleNormals {
 public:
  virtual ~ParticleNormals() = default;
  /// The next ones; until the next call.
  virtual std::span<double const> take(std::size_t count) = 0;
};

/// The same for the same calls, whoever makes them.
class StreamNormals : public ParticleNormals {
 public:
  explicit StreamNormals(StreamKey key) : stream_(key) {}
  std::span<double const> take(std::size_t count) override;

 private:
  Stream stream_;
  std::vector<double> numbers_;
};

class StoredNormals : public ParticleNormals {
 public:
  explicit StoredNormals(std::span<double const> numbers) : rest_(numbers) {}
  std::span<double const> take(std::size_t count) override;

 private:
  std::span<double const> rest_;
};

/// rho u + sqrt(1 - rho^2) e with e from the stream: standard normal again, correlated with u by rho.     Deligiannidis, Doucet,
/// Pitt 2018, eq. 10
void move_normals(std::span<double> numbers, double correlation, StreamKey key);

}  // namespace sysid
