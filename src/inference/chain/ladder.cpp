// Powers of the likelihood, and their adaptation.
#include "inference/chain/ladder.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid::tempering {
namespace {

/// Powers are b = s^6, with s equally spaced at first and interpolated linearly.
constexpr double exponent = 6;

}  // namespace

Ladder::Ladder(int rungs) : sums_(static_cast<std::size_t>(rungs) - 1), counts_(sums_) {
  for (int k = 0; k < rungs; ++k) powers_.push_back(elementary::pow(1 - static_cast<double>(k) / (rungs - 1), exponent));
  powers_.back() = 0;
}

double Ladder::probability(int rung, double log_likelihood, double log_likelihood_above) const {
  double const log_ratio = (power(rung) - power(rung + 1)) * (log_likelihood_above - log_likelihood);
  if (std::isnan(log_ratio)) return 0;
  return log_ratio >= 0 ? 1 : elementary::exp(log_ratio);
}

void Ladder::count(int rung, double probability) {
  sums_[static_cast<std::size_t>(rung)] += probability;
  counts_[static_cast<std::size_t>(rung)] += 1;
}

double Ladder::rejection(std::size_t rung) const { return counts_[rung] > 0 ? 1 - sums_[rung] / counts_[rung] : 0; }

void Ladder::equalise() {
  std::vector<double> reached{0};  // sum of rejection rates up to each rung; the little that is added keeps it growing
  for (std::size_t k = 0; k + 1 < powers_.size(); ++k) reached.push_back(reached.back() + rejection(k) + 1e-3);
  std::vector<double> const before = powers_;
  std::size_t at = 0;
  for (std::size_t k = 1; k + 1 < powers_.size(); ++k) {
    double const wanted = reached.back() * static_cast<double>(k) / static_cast<double>(powers_.size() - 1);
    while (reached[at + 1] < wanted) ++at;
    double const share = (wanted - reached[at]) / (reached[at + 1] - reached[at]);
    auto const root = [](double power) { return elementary::pow(power, 1 / exponent); };
    powers_[k] = elementary::pow(root(before[at]) + share * (root(before[at + 1]) - root(before[at])), exponent);
  }
  forget_counts();
}

void Ladder::forget_counts() {
  sums_.assign(sums_.size(), 0.0);
  counts_.assign(counts_.size(), 0.0);
}

double Ladder::least_acceptance() const {
  double least = 1;
  for (std::size_t k = 0; k < counts_.size(); ++k) least = std::min(least, 1 - rejection(k));
  return least;
}

double Ladder::barrier() const {
  double sum = 0;
  for (std::size_t k = 0; k < counts_.size(); ++k) sum += rejection(k);
  return sum;
}

nlohmann::json Ladder::store() const {
  auto const block = [](std::vector<double> const& v) { return checkpoint::encode(std::span<double const>(v)); };
  return {{"powers", block(powers_)}, {"sums", block(sums_)}, {"counts", block(counts_)}};
}

Ladder Ladder::restore(nlohmann::json const& stored, int rungs) {
  auto const count = static_cast<std::size_t>(rungs);
  Ladder ladder;
  ladder.powers_ = checkpoint::decode(stored.at("powers"), count);
  ladder.sums_ = checkpoint::decode(stored.at("sums"), count - 1);
  ladder.counts_ = checkpoint::decode(stored.at("counts"), count - 1);
  return ladder;
}

}  // namespace sysid::tempering
