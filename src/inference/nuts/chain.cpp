// Iterations of one chain, and what it learns from them.
#include "inference/nuts/chain.hpp"

#include <algorithm>
#include <utility>

#include "inference/backend/checkpoint.hpp"

namespace sysid::nuts {
namespace {

constexpr std::uint64_t first_window = 25, shortest_burn_in = 20, longest_way_in = 75, longest_settling = 50;
constexpr std::size_t most_places = 100;  // of trajectories that diverged, per chain

}  // namespace

BurnIn plan_burn_in(std::uint64_t length) {
  BurnIn burn_in{length, std::min(longest_way_in, 15 * length / 100), {}};
  if (length < shortest_burn_in) return burn_in;
  std::uint64_t const last = length - std::min(longest_settling, length / 10);
  std::uint64_t size = first_window;
  for (std::uint64_t at = burn_in.first; at < last; size *= 2) {
    at += size;
    if (at + 2 * size > last) at = last;  // the next window would be cut short
    burn_in.ends.push_back(at);
  }
  return burn_in;
}

Chain::Chain(StreamKey key, Point start, Metric metric, double acceptance, int most_doublings)
    : key_(key),
      most_doublings_(most_doublings),
      at_(std::move(start)),
      metric_(std::move(metric)),
      step_(metric_.dimension, acceptance) {
  begin();
}

void Chain::begin() { trajectory_ = Trajectory(key_.with_step(iterations_), at_, metric_, step_.step(), most_doublings_); }

bool Chain::take(Point at, BurnIn const& burn_in) {
  trajectory_.take(std::move(at), metric_);
  if (!trajectory_.done()) return false;
  last_ = trajectory_.info();
  at_ = trajectory_.draw();
  ++iterations_;
  if (iterations_ <= burn_in.length)
    learn(burn_in);
  else
    count();
  begin();
  return true;
}

void Chain::learn(BurnIn const& burn_in) {
  step_.learn(last_.acceptance);
  bool const in_window = !burn_in.ends.empty() && iterations_ > burn_in.first && iterations_ <= burn_in.ends.back();
  if (in_window) window_.add(metric_, at_.theta, last_.moved);
  if (std::binary_search(burn_in.ends.begin(), burn_in.ends.end(), iterations_)) {
    metric_ = window_.estimate(metric_);
    window_.clear();
    step_.restart();
  }
  if (iterations_ == burn_in.length) step_.freeze();
}

void Chain::count() {
  ++tally_.trajectories;
  tally_.cut += last_.cut ? 1 : 0;
  if (!last_.diverged) return;
  ++tally_.diverged;
  tally_.unsolved += last_.unsolved ? 1 : 0;
  if (tally_.places.size() < most_places * last_.place.size())
    tally_.places.insert(tally_.places.end(), last_.place.begin(), last_.place.end());
}

void Chain::resume(StreamKey key, int dimension) {
  auto const n = static_cast<std::size_t>(dimension);
  key_ = key;
  if (at_.theta.size() != n || at_.gradient.size() != n || metric_.dimension != dimension ||
      metric_.factor.size() != (metric_.dense ? n * n : n) || tally_.places.size() % n != 0 || !window_.fits(metric_))
    throw checkpoint::Mismatch("its chains differ in number or dimension");
  trajectory_.resume(key.with_step(iterations_), dimension);
}

}  // namespace sysid::nuts
