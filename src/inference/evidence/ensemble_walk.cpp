// Differential-evolution moves between two halves of walkers.
#include "inference/evidence/ensemble_walk.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid::marginal {
namespace {

/// Walkers [first, first + count) move along differences of those in [other, other + others).
struct Halves {
  int first, count, other, others;
};

class Walk {
 public:
  Walk(Objective const& objective, LaneArray walkers, std::vector<double> log_density, StreamKey key, double power)
      : objective_(objective), walkers_(std::move(walkers)), log_density_(std::move(log_density)), key_(key), power_(power) {}

  LaneArray const& walkers() const { return walkers_; }

  void step(std::uint64_t number, Ledger& ledger, std::function<bool()> const& stop) {
    int const half = walkers_.width() / 2, rest = walkers_.width() - half;
    move({0, half, half, rest}, number, ledger, stop);
    move({half, rest, 0, half}, number, ledger, stop);
  }

 private:
  void move(Halves const& of, std::uint64_t number, Ledger& ledger, std::function<bool()> const& stop) {
    double const best = 2.38 / std::sqrt(2.0 * walkers_.rows());
    LaneArray proposed(walkers_.rows(), of.count);
    std::vector<double> chance;
    for (int w = 0; w < of.count; ++w) {
      Stream stream(key_.at(static_cast<std::uint64_t>(of.first + w), key_.step + number));
      auto const others = static_cast<std::uint64_t>(of.others);
      int const a = of.other + static_cast<int>(stream.below(others));
      int b = of.other + static_cast<int>(stream.below(others - 1));
      if (b >= a) ++b;
      double const size = stream.uniform() < 0.1 ? 1 : best;
      for (int i = 0; i < proposed.rows(); ++i)
        proposed(i, w) = walkers_(i, of.first + w) + size * (walkers_(i, a) - walkers_(i, b));
      chance.push_back(elementary::log(stream.uniform()));
    }
    std::vector<double> const density = log_density_in_blocks(objective_, proposed, ledger, stop);
    for (int w = 0; w < of.count; ++w) {
      auto const at = static_cast<std::size_t>(of.first + w), k = static_cast<std::size_t>(w);
      bool const lost = !std::isfinite(log_density_[at]);
      if (!std::isfinite(density[k]) || !(lost || chance[k] < power_ * (density[k] - log_density_[at]))) continue;
      log_density_[at] = density[k];
      for (int i = 0; i < proposed.rows(); ++i) walkers_(i, of.first + w) = proposed(i, w);
    }
  }

  Objective const& objective_;
  LaneArray walkers_;
  std::vector<double> log_density_;
  StreamKey key_;
  double power_;
};

}  // namespace

LaneArray walk(Objective const& objective, LaneArray walkers, int steps, StreamKey key, Ledger& ledger,
               std::function<bool()> const& stop, double power) {
  constexpr int quarters = 4;
  int const width = walkers.width();
  LaneArray states(walkers.rows(), (quarters - 1) * width);
  std::vector<double> log_density = log_density_in_blocks(objective, walkers, ledger, stop);
  Walk moved(objective, std::move(walkers), std::move(log_density), key, power);
  int number = 0;
  for (int quarter = 0; quarter < quarters; ++quarter) {
    for (int const end = steps * (quarter + 1) / quarters; number < end && !stop(); ++number)
      moved.step(static_cast<std::uint64_t>(number), ledger, stop);
    if (quarter == 0) continue;
    for (int i = 0; i < states.rows(); ++i)
      std::ranges::copy(moved.walkers().row(i), states.row(i).begin() + (quarter - 1) * width);
  }
  return states;
}

}  // namespace sysid::marginal
