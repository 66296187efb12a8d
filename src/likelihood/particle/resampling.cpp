// Orders are found by counting, in time proportional to the particles: comparisons would cost more than the simulation.
#include "likelihood/particle/resampling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace sysid {
namespace {

constexpr int place_bits = 16;
constexpr std::size_t most_axes = 8;
constexpr int enough_for_a_box = 256;  // particles

/// One pass of a sort by counting, by 8 bits of the keys.
void sort_by(std::span<std::uint16_t const> keys, int shift, std::span<int const> from, std::span<int> to) {
  std::array<int, 257> begin{};
  for (std::uint16_t const key : keys) ++begin[static_cast<std::size_t>((key >> shift) & 255) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (int const particle : from) {
    int& place = begin[static_cast<std::size_t>((keys[static_cast<std::size_t>(particle)] >> shift) & 255)];
    to[static_cast<std::size_t>(place++)] = particle;
  }
}

using Word = std::uint16_t;
constexpr std::size_t at_once = 64;  // points

/// Skilling's transposition of points that lie side by side: undo the excess work, then Gray code.
void transpose(Word* const* x, int axes, int bits) {
  auto const word = [](unsigned value) { return static_cast<Word>(value); };
  for (unsigned q = 1U << (bits - 1); q > 1; q >>= 1) {
    Word const bit = word(q), mask = word(q - 1);
    for (int a = 0; a < axes; ++a)
      for (std::size_t i = 0; i < at_once; ++i) {
        Word const set = word(0U - static_cast<unsigned>((x[a][i] & bit) != 0));
        Word const swapped = word((x[0][i] ^ x[a][i]) & mask & ~set);
        x[0][i] = word(x[0][i] ^ swapped ^ (set & mask));
        x[a][i] = word(x[a][i] ^ (a == 0 ? 0U : swapped));
      }
  }
  for (int a = 1; a < axes; ++a)
    for (std::size_t i = 0; i < at_once; ++i) x[a][i] = word(x[a][i] ^ x[a - 1][i]);
  std::array<Word, at_once> flip{};
  for (unsigned q = 1U << (bits - 1); q > 1; q >>= 1)
    for (std::size_t i = 0; i < at_once; ++i) flip[i] = word(flip[i] ^ ((x[axes - 1][i] & q) != 0 ? q - 1 : 0));
  for (int a = 0; a < axes; ++a)
    for (std::size_t i = 0; i < at_once; ++i) x[a][i] = word(x[a][i] ^ flip[i]);
}

}  // namespace

void hilbert_places(std::span<std::uint16_t> points, int axes, int bits, std::span<std::uint16_t> places) {
  std::size_t const count = places.size();
  std::array<std::array<Word, at_once>, most_axes> here;
  std::array<Word*, most_axes> x{};
  for (std::size_t a = 0; a < most_axes; ++a) x[a] = here[a].data();
  for (std::size_t from = 0; from < count; from += at_once) {
    std::size_t const size = std::min(at_once, count - from);
    for (int a = 0; a < axes; ++a) {
      here[static_cast<std::size_t>(a)].fill(0);
      std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(a) * count + from), size, x[a]);
    }
    transpose(x.data(), axes, bits);
    std::array<Word, at_once> place{};
    for (int bit = bits; bit-- > 0;)
      for (int a = 0; a < axes; ++a)
        for (std::size_t i = 0; i < at_once; ++i) place[i] = static_cast<Word>((place[i] << 1) | ((x[a][i] >> bit) & 1));
    std::copy_n(place.begin(), size, places.begin() + static_cast<std::ptrdiff_t>(from));
  }
}

ParticleOrder::ParticleOrder(int count)
    : places_(static_cast<std::size_t>(count)), order_(places_.size()), sorted_(places_.size()) {}

void ParticleOrder::find_axes(ConstLanes states) {
  axes_.clear();
  int const stride = std::max(1, states.width() / enough_for_a_box);
  for (int s = 0; s < states.rows() && axes_.size() < most_axes; ++s) {
    double sum = 0, count = 0, squares = 0;
    for (int w = 0; w < states.width(); w += stride)
      if (std::isfinite(states(s, w))) sum += states(s, w), ++count;
    double const mean = sum / count;
    for (int w = 0; w < states.width(); w += stride)
      if (std::isfinite(states(s, w))) squares += (states(s, w) - mean) * (states(s, w) - mean);
    double const sd = std::sqrt(squares / count);
    if (sd > 0 && std::isfinite(1 / sd)) axes_.push_back({s, mean - 4 * sd, 1 / (8 * sd)});
  }
}

std::span<int const> ParticleOrder::operator()(ConstLanes states) {
  find_axes(states);
  std::iota(order_.begin(), order_.end(), 0);
  if (axes_.empty()) return order_;
  std::size_t const count = places_.size();
  int const bits = place_bits / static_cast<int>(axes_.size());
  double const cells = static_cast<double>(1U << bits), end = cells - 1;
  points_.resize(axes_.size() * count);
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    double const* const row = states.row(axes_[a].state).data();
    double const low = axes_[a].low, scale = axes_[a].scale * cells;
    for (std::size_t w = 0; w < count; ++w) {
      double const at = (row[w] - low) * scale;
      points_[a * count + w] =
          static_cast<std::uint16_t>(static_cast<int>(at > 0 ? std::min(at, end) : 0));  // also where it is NaN
    }
  }
  if (axes_.size() == 1)
    std::copy(points_.begin(), points_.end(), places_.begin());
  else
    hilbert_places(points_, static_cast<int>(axes_.size()), bits, places_);
  sort_by(places_, 0, order_, sorted_);
  sort_by(places_, 8, sorted_, order_);
  return order_;
}

void systematic_ancestors(std::span<double const> weights, std::span<int const> order, double uniform, std::span<int> ancestors) {
  double total = 0;
  for (int const particle : order) total += weights[static_cast<std::size_t>(particle)];
  double const share = total / static_cast<double>(ancestors.size());
  std::size_t next = 0;
  double below = 0;
  int last = order.front();  // that has a weight
  for (int const particle : order) {
    double const weight = weights[static_cast<std::size_t>(particle)];
    if (!(weight > 0)) continue;
    below += weight;
    last = particle;
    while (next < ancestors.size() && (uniform + static_cast<double>(next)) * share < below) ancestors[next++] = particle;
  }
  std::fill(ancestors.begin() + static_cast<std::ptrdiff_t>(next), ancestors.end(), last);  // rounding has left the end open
}

}  // namespace sysid
