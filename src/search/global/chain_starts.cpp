// Around modes by their covariance, or from the prior.
#include "search/global/chain_starts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "linear_algebra/decompositions.hpp"
#include "search/laplace.hpp"
#include "search/mode_findings.hpp"
#include "search/starts.hpp"

namespace sysid {
namespace {

// Steps of Purpose::start: the streams of this file never meet those of the search.
constexpr std::uint64_t prior_start_step = 1'000, dispersal_step = 1'000'000;

/// Redraws the columns of `starts` until the density is finite at each; `redraw(chain, attempt)` gives the next try. Returns the
/// chains that never got one.
template <class Redraw>
std::vector<int> make_finite(Target const& target, LaneArray& starts, int attempts, Ledger& ledger, Redraw const& redraw) {
  std::vector<int> open(static_cast<std::size_t>(starts.width()));
  std::iota(open.begin(), open.end(), 0);
  for (int attempt = 0; attempt < attempts && !open.empty(); ++attempt) {
    std::vector<Eigen::VectorXd> points;
    for (int const chain : open) points.push_back(redraw(chain, attempt));
    LaneArray const theta = to_lanes(points);
    std::vector<double> prior(open.size()), likelihood(open.size());
    target.log_prior(theta, prior);
    target.log_likelihood(theta, likelihood, ledger);
    std::vector<int> still;
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (int p = 0; p < starts.rows(); ++p) starts(p, open[i]) = theta(p, static_cast<int>(i));
      if (!std::isfinite(prior[i] + likelihood[i])) still.push_back(open[i]);
    }
    open = std::move(still);
  }
  return open;
}

}  // namespace

std::vector<int> spread_over_modes(std::vector<Mode> const& modes, int chains) {
  std::vector<int> count(modes.size(), 0);
  int left = chains;
  for (std::size_t m = 0; m < modes.size() && left > 0; ++m) {
    if (m > 0 && modes[m].share <= notable_share) continue;
    ++count[m];
    --left;
  }
  for (; left > 0; --left) {
    std::size_t most_wanting = 0;
    auto const want = [&](std::size_t m) { return modes[m].share * chains - count[m]; };
    for (std::size_t m = 1; m < modes.size(); ++m)
      if (want(m) > want(most_wanting)) most_wanting = m;
    ++count[most_wanting];
  }
  std::vector<int> mode_of_chain;
  for (std::size_t m = 0; m < modes.size(); ++m)
    mode_of_chain.insert(mode_of_chain.end(), static_cast<std::size_t>(count[m]), static_cast<int>(m));
  return mode_of_chain;
}

LaneArray overdispersed_starts(Target const& target, std::vector<Mode> const& modes, std::vector<int> const& mode_of_chain,
                               RunContext& context) {
  constexpr double inflation = 3;
  LaneArray starts(target.dimension(), static_cast<int>(mode_of_chain.size()));
  auto const mode_of = [&](int chain) -> Mode const& {
    return modes[static_cast<std::size_t>(mode_of_chain[static_cast<std::size_t>(chain)])];
  };
  auto const redraw = [&](int chain, int attempt) -> Eigen::VectorXd {
    Mode const& mode = mode_of(chain);
    Stream stream(
        {context.seed, Purpose::start, static_cast<std::uint64_t>(chain), dispersal_step + static_cast<std::uint64_t>(attempt)});
    Eigen::VectorXd z(target.dimension());
    for (double& v : z) v = stream.normal();
    Eigen::VectorXd const move = cholesky_or_diagonal(covariance_of(mode)) * z;
    return theta_of(mode) + inflation * move;
  };
  for (int const chain : make_finite(target, starts, 100, context.ledger, redraw))
    for (int p = 0; p < starts.rows(); ++p) starts(p, chain) = mode_of(chain).theta[static_cast<std::size_t>(p)];
  return starts;
}

std::optional<LaneArray> prior_starts(Target const& target, int chains, RunContext& context) {
  LaneArray starts(target.dimension(), chains);
  auto const redraw = [&](int chain, int attempt) {
    StreamKey const key{context.seed, Purpose::start, static_cast<std::uint64_t>(chain),
                        prior_start_step + static_cast<std::uint64_t>(attempt)};
    return column(draw_prior(target, key, 1), 0);
  };
  std::vector<int> const without = make_finite(target, starts, 1000, context.ledger, redraw);
  if (static_cast<int>(without.size()) == chains) return std::nullopt;
  // The others begin where those begin that have found a place.
  for (int const chain : without) {
    int lender = chain;
    do lender = (lender + 1) % chains;
    while (std::find(without.begin(), without.end(), lender) != without.end());
    for (int p = 0; p < starts.rows(); ++p) starts(p, chain) = starts(p, lender);
  }
  return starts;
}

}  // namespace sysid
