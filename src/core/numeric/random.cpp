// Philox 4x64 with ten rounds (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3"), as Random123 ships it.
#include "core/numeric/random.hpp"

#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <Random123/philox.h>
#pragma GCC diagnostic pop

namespace sysid {

namespace {

using Philox = r123::Philox4x64;

inline Philox::ctr_type block_of(StreamKey const& key, std::uint64_t block) {
  return Philox()(Philox::ctr_type{{key.index, key.step, block, 0}},
                  Philox::key_type{{key.seed, static_cast<std::uint64_t>(key.purpose)}});
}

/// The middles of 2^52 equal cells: never 0, never 1, symmetric about 1/2.
inline double uniform_of(std::uint64_t word) { return (static_cast<double>(static_cast<std::int64_t>(word >> 12)) + 0.5) * 0x1p-52; }

}  // namespace

std::uint64_t Stream::bits() {
  if (used_ == 4) {
    Philox::ctr_type const words = block_of(key_, block_++);
    for (std::size_t i = 0; i < 4; ++i) words_[i] = words[i];
    used_ = 0;
  }
  return words_[static_cast<std::size_t>(used_++)];
}

double Stream::uniform() { return uniform_of(bits()); }

void Stream::uniforms(std::span<double> out) {
  std::size_t i = 0;
  while (i < out.size() && used_ < 4) out[i++] = uniform();
  // Whole blocks do not wait for one another.
  for (; i + 4 <= out.size(); i += 4) {
    Philox::ctr_type const words = block_of(key_, block_++);
    for (std::size_t k = 0; k < 4; ++k) out[i + k] = uniform_of(words[k]);
  }
  while (i < out.size()) out[i++] = uniform();
}

double Stream::normal() {
  if (has_normal_) {
    has_normal_ = false;
    return normal_;
  }
  double const radius = std::sqrt(-2 * elementary::log(uniform()));
  double const angle = 2 * std::numbers::pi * uniform();
  normal_ = radius * elementary::sin(angle);
  has_normal_ = true;
  return radius * elementary::cos(angle);
}

std::uint64_t Stream::below(std::uint64_t n) {
  // Words below 2^64 mod n would make the first residues likelier; they are drawn again.
  std::uint64_t const reject = (0 - n) % n;
  std::uint64_t word = bits();
  while (word < reject) word = bits();
  return word % n;
}

}  // namespace sysid
