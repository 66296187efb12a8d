// The step of autoregressive moves, and what each kind of local move is worth.
#include "inference/chain/local_learning.hpp"

#include <algorithm>

#include "core/numeric/elementary.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid::metropolis {
namespace {

/// Of autoregressive moves. In many dimensions 0.234 yields the longest jumps, as for walks, but with it rare moves out of tails
/// that the normal distribution hardly reaches.
constexpr double autoregressive_acceptance = 0.4;
constexpr double half_of_moves = 0.5, tenth_of_moves = 0.1;

}  // namespace

void LocalLearning::learn(Info const& info) {
  double acceptance = 0;
  int moves = 0;
  for (Move const& move : info) {
    bool const is_autoregressive = move.kind == MoveKind::autoregressive;
    if (!is_autoregressive && move.kind != MoveKind::walk) continue;
    Worth& worth = is_autoregressive ? autoregressive_ : walk_;
    worth.jump += move.acceptance_probability * move.squared_jump;
    ++worth.moves;
    if (!is_autoregressive || move.failed || !move.tunes_scale) continue;  // a failed solve says nothing of the posterior's shape
    acceptance += move.acceptance_probability;
    ++moves;
  }
  if (moves == 0) return;
  ++iterations_;
  double const off = acceptance / moves - autoregressive_acceptance;
  log_step_ = std::min(0.0, log_step_ + learning_gain(autoregressive_acceptance, iterations_) * off);
  step_ = elementary::exp(log_step_);
}

void LocalLearning::end_window(bool wanted) {
  bool const worse = autoregressive_.moves > 0 && autoregressive_.mean() < walk_.mean();
  share_ = !wanted ? 0 : worse ? tenth_of_moves : half_of_moves;
  walk_ = autoregressive_ = {};
}

nlohmann::json LocalLearning::store() const {
  return {{"numbers", checkpoint::encode(std::vector<double>{walk_.jump, autoregressive_.jump, log_step_, step_, share_})},
          {"counts", {walk_.moves, autoregressive_.moves, iterations_}}};
}

LocalLearning LocalLearning::restore(nlohmann::json const& stored) {
  std::vector<double> const numbers = checkpoint::decode(stored.at("numbers"), 5);
  auto const counts = stored.at("counts").get<std::vector<std::uint64_t>>();
  if (counts.size() != 3) throw checkpoint::Mismatch("its local moves differ in form");
  LocalLearning all;
  all.walk_ = {numbers[0], counts[0]};
  all.autoregressive_ = {numbers[1], counts[1]};
  all.log_step_ = numbers[2];
  all.step_ = numbers[3];
  all.share_ = numbers[4];
  all.iterations_ = counts[2];
  return all;
}

}  // namespace sysid::metropolis
