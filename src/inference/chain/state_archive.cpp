// Keeping, thinning and picking states.
#include "inference/chain/state_archive.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "inference/backend/checkpoint.hpp"

namespace sysid::metropolis {
namespace {

constexpr std::size_t most_archived = 8192;

}  // namespace

void StateArchive::add(ConstLanes theta, int chain, std::uint64_t iteration) {
  if (iteration % interval_ != 0) return;
  for (int p = 0; p < theta.rows(); ++p) states_.push_back(theta(p, chain));
  iterations_.push_back(iteration);
}

void StateArchive::thin() {
  if (size() < most_archived) return;
  interval_ *= 2;
  std::size_t kept = 0;
  // Whole iterations go: every second state would be those of every second chain.
  for (std::size_t n = 0; n < iterations_.size(); ++n) {
    if (iterations_[n] % interval_ != 0) continue;
    std::copy_n(states_.begin() + static_cast<std::ptrdiff_t>(n * dimension_), dimension_,
                states_.begin() + static_cast<std::ptrdiff_t>(kept * dimension_));
    iterations_[kept++] = iterations_[n];
  }
  states_.resize(kept * dimension_);
  iterations_.resize(kept);
}

LaneArray StateArchive::picked(std::size_t first, std::size_t most) const {
  std::vector<std::size_t> starts;  // of the iterations
  for (std::size_t n = first; n < size(); ++n)
    if (n == 0 || iterations_[n] != iterations_[n - 1]) starts.push_back(n);
  std::vector<std::size_t> places;
  if (!starts.empty()) {
    std::size_t const all = size() - starts.front(), of_each = (all + starts.size() - 1) / starts.size();
    std::size_t const count = std::clamp<std::size_t>(most / of_each, 1, starts.size());
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t const start = starts[i * starts.size() / count];
      for (std::size_t n = start; n < size() && iterations_[n] == iterations_[start] && places.size() < most; ++n)
        places.push_back(n);
    }
  }
  LaneArray states(static_cast<int>(dimension_), static_cast<int>(places.size()));
  for (int n = 0; n < states.width(); ++n)
    for (int p = 0; p < states.rows(); ++p)
      states(p, n) = states_[places[static_cast<std::size_t>(n)] * dimension_ + static_cast<std::size_t>(p)];
  return states;
}

nlohmann::json StateArchive::store() const {
  return {{"states", checkpoint::encode(std::span<double const>(states_))}, {"iterations", iterations_}, {"interval", interval_}};
}

StateArchive StateArchive::restore(nlohmann::json const& stored, int dimension) {
  StateArchive all(dimension);
  all.iterations_ = stored.at("iterations").get<std::vector<std::uint64_t>>();
  all.states_ = checkpoint::decode(stored.at("states"), all.iterations_.size() * all.dimension_);
  all.interval_ = std::max<std::uint64_t>(1, stored.at("interval").get<std::uint64_t>());
  return all;
}

}  // namespace sysid::metropolis
