// Squared jumps per simulation, of states by their weights.
#include "inference/chain/ridge_worth.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid::metropolis {
namespace {

constexpr double most_log_ratio = 6.907755278982137;  // log 1000

}  // namespace

void RidgeWorth::learn(ConstLanes before, std::span<double const> log_weights, ConstLanes after, Info const& info) {
  for (std::size_t w = 0; w < info.size(); ++w) {
    if (!std::isfinite(log_weights[w])) continue;
    Eigen::VectorXd squares(before.rows());
    for (int p = 0; p < before.rows(); ++p) {
      double const jump = after(p, static_cast<int>(w)) - before(p, static_cast<int>(w));
      squares(p) = jump * jump;
    }
    if (!squares.allFinite()) continue;
    bool const first = kinds_[0].moves + kinds_[1].moves == 0;
    if (first || log_weights[w] > log_highest_) {
      double const factor = first ? 0 : elementary::exp(log_highest_ - log_weights[w]);
      for (Kind& kind : kinds_) {
        if (kind.jumps.size() == 0) kind.jumps = Eigen::VectorXd::Zero(squares.size());
        kind.jumps *= factor;
        kind.weight *= factor;
      }
      log_highest_ = log_weights[w];
    }
    Kind& kind = kinds_[info[w].kind == MoveKind::ridge ? 1 : 0];
    double const weight = elementary::exp(log_weights[w] - log_highest_);
    kind.jumps += weight * squares;
    kind.weight += weight;
    ++kind.moves;
  }
}

void RidgeWorth::spend(bool along_ridges, std::uint64_t simulations) { kinds_[along_ridges ? 1 : 0].simulations += simulations; }

void RidgeWorth::end_window() {
  auto const& [others, ridges] = kinds_;
  if (others.weight > 0 && ridges.weight > 0 && others.simulations > 0 && ridges.simulations > 0) {
    auto const per_simulation = [](Kind const& kind, Eigen::Index p) {
      return kind.jumps(p) / kind.weight * static_cast<double>(kind.moves) / static_cast<double>(kind.simulations);
    };
    double largest = 0;
    for (Eigen::Index p = 0; p < others.jumps.size(); ++p)
      if (double const other = per_simulation(others, p), ridge = per_simulation(ridges, p); ridge > 0)
        largest = std::max(largest, other > 0 ? ridge / other : elementary::exp(most_log_ratio));
    log_ratios_ += largest > 0 ? std::clamp(elementary::log(largest), -most_log_ratio, most_log_ratio) : -most_log_ratio;
    ++windows_;
  }
  kinds_ = {};
}

nlohmann::json RidgeWorth::store() const {
  std::vector<double> numbers{log_highest_, log_ratios_};
  std::vector<std::uint64_t> counts{windows_};
  for (Kind const& kind : kinds_) {
    numbers.push_back(kind.weight);
    numbers.insert(numbers.end(), kind.jumps.begin(), kind.jumps.end());
    counts.insert(counts.end(), {kind.moves, kind.simulations});
  }
  return {{"numbers", checkpoint::encode(std::span<double const>(numbers))}, {"counts", counts}};
}

RidgeWorth RidgeWorth::restore(nlohmann::json const& stored, int dimension) {
  std::vector<double> const numbers = checkpoint::decode(stored.at("numbers"));
  auto const counts = stored.at("counts").get<std::vector<std::uint64_t>>();
  auto const parameters = static_cast<std::size_t>(dimension);
  if ((numbers.size() != 4 && numbers.size() != 4 + 2 * parameters) || counts.size() != 5)
    throw checkpoint::Mismatch("what it knows of moves along ridges differs in form");
  RidgeWorth all;
  all.log_highest_ = numbers[0];
  all.log_ratios_ = numbers[1];
  all.windows_ = counts[0];
  std::size_t const each = (numbers.size() - 4) / 2;
  for (std::size_t k = 0; k < 2; ++k) {
    double const* first = numbers.data() + 2 + k * (each + 1);
    all.kinds_[k] = {Eigen::Map<Eigen::VectorXd const>(first + 1, static_cast<Eigen::Index>(each)), *first, counts[1 + 2 * k],
                     counts[2 + 2 * k]};
  }
  return all;
}

}  // namespace sysid::metropolis
