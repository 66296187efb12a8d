#include "result/criteria.hpp"

#include <algorithm>
#include <numbers>

#include "core/numeric/elementary.hpp"

namespace sysid {

double ScoreAtMode::bic() const { return -2 * log_likelihood + parameters * elementary::log(samples); }

double largest_k(int draws) { return std::min(largest_k_of_many, 1 - std::numbers::ln10 / elementary::log(std::max(draws, 10))); }

bool all_reached(std::vector<LeftOutBlocks> const& blocks, int draws) {
  return std::ranges::all_of(blocks, [&](LeftOutBlocks const& each) {
    return std::ranges::all_of(each.pareto_k, [&](double k) { return k <= largest_k(draws); });
  });
}

}  // namespace sysid
