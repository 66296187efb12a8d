// The archive of differential-evolution moves.
#include "inference/chain/difference_moves.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid::metropolis {
namespace {

constexpr double whole_share = 0.1, jitter = 1e-3;
/// Iterations from one entry into the archive to the next: neighbours in a chain are nearly the same state.
constexpr std::uint64_t entry_interval = 5;

}  // namespace

DifferenceMoves::DifferenceMoves(ConstLanes first) : archive_(first.rows(), first.width()) {
  for (int p = 0; p < first.rows(); ++p)
    for (int w = 0; w < first.width(); ++w) archive_(p, w) = first(p, w);
  log_scale_ = elementary::log(2.38 / std::sqrt(2.0 * first.rows()));  // ter Braak 2006
  scale_ = elementary::exp(log_scale_);
  measure_widths();
}

void DifferenceMoves::measure_widths() {
  widths_.assign(static_cast<std::size_t>(archive_.rows()), 0.0);
  for (int p = 0; p < archive_.rows(); ++p) {
    double mean = 0, square = 0;
    for (double const x : archive_.row(p)) mean += x / archive_.width();
    for (double const x : archive_.row(p)) square += (x - mean) * (x - mean) / archive_.width();
    widths_[static_cast<std::size_t>(p)] = std::sqrt(square);
  }
}

bool DifferenceMoves::propose(StreamKey key, ConstLanes from, int chain, Lanes to, int lane) const {
  Stream stream(key);
  bool const whole = stream.uniform() < whole_share;
  auto const members = static_cast<std::uint64_t>(archive_.width());
  auto const a = static_cast<int>(stream.below(members));
  auto b = static_cast<int>(stream.below(members - 1));
  if (b >= a) ++b;
  for (int p = 0; p < archive_.rows(); ++p)
    to(p, lane) = from(p, chain) + (whole ? 1 : scale_) * (archive_(p, a) - archive_(p, b)) +
                  jitter * widths_[static_cast<std::size_t>(p)] * stream.normal();
  return whole;
}

void DifferenceMoves::learn(State const& state, Info const& info, int first, int count) {
  ++iteration_;
  double acceptance = 0;
  int moves = 0;
  for (int w = first; w < first + count; ++w) {
    Move const& move = info[static_cast<std::size_t>(w)];
    if (move.failed || !move.tunes_scale) continue;
    acceptance += move.acceptance_probability;
    ++moves;
  }
  if (moves > 0) {
    log_scale_ += learning_gain(best_acceptance, iteration_) * (acceptance / moves - best_acceptance);
    scale_ = elementary::exp(log_scale_);
  }
  if (iteration_ % entry_interval != 0) return;
  for (int w = first; w < first + count; ++w) {
    for (int p = 0; p < archive_.rows(); ++p) archive_(p, next_) = state.theta(p, w);
    next_ = (next_ + 1) % archive_.width();
  }
  measure_widths();
}

nlohmann::json DifferenceMoves::store() const {
  return {{"members", archive_.width()},
          {"archive", checkpoint::encode(archive_)},
          {"scales", checkpoint::encode(std::vector<double>{log_scale_, scale_})},
          {"counts", {iteration_, static_cast<std::uint64_t>(next_)}}};
}

DifferenceMoves DifferenceMoves::restore(nlohmann::json const& stored, int dimension) {
  DifferenceMoves all;
  all.archive_ = checkpoint::decode(stored.at("archive"), dimension, stored.at("members").get<int>());
  std::vector<double> const scales = checkpoint::decode(stored.at("scales"), 2);
  auto const counts = stored.at("counts").get<std::vector<std::uint64_t>>();
  if (all.archive_.width() < 2 || counts.size() != 2 || counts[1] >= static_cast<std::uint64_t>(all.archive_.width()))
    throw checkpoint::Mismatch("its archive differs in form");
  all.log_scale_ = scales.at(0);
  all.scale_ = scales.at(1);
  all.iteration_ = counts[0];
  all.next_ = static_cast<int>(counts[1]);
  all.measure_widths();
  return all;
}

}  // namespace sysid::metropolis
