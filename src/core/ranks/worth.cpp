// A running mean, as it is the mean of exchanges that a run pays for; a single slow one cannot move it far.
#include "core/ranks/worth.hpp"

#include <algorithm>

namespace sysid::ranks {
namespace {

/// [s] until a processor is free, where ranks take turns: part of a time slice.
constexpr double turn_of_another = 1e-3;

constexpr double weight_of_one = 0.125, largest_step = 8, between_looks = 50;

}  // namespace

Worth::Worth(double least, double rate, bool crowded)
    : least_(least), exchange_(crowded ? std::max(least, turn_of_another) : least), rate_(rate) {}

bool Worth::worth(double seconds, double bytes) {
  double const sent = bytes / rate_;
  if (seconds > 2 * (exchange_ + sent)) return true;
  if (seconds <= 2 * (least_ + sent)) return false;
  refused_ += seconds;
  if (refused_ < between_looks * exchange_) return false;
  refused_ = 0;
  return true;
}

void Worth::learn(double seconds, double bytes) {
  double const bounded = std::clamp(seconds - bytes / rate_, least_, largest_step * std::max(exchange_, least_));
  exchange_ += weight_of_one * (bounded - exchange_);
}

}  // namespace sysid::ranks
