// Draws of a mixture, and those of a posterior in halves.
#include "inference/evidence/sample.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"

namespace sysid::marginal {

void add_draws(Objective const& objective, Mixture const& mixture, int count, std::uint64_t seed, MixtureSample& sample,
               Ledger& ledger, std::function<bool()> const& stop) {
  LaneArray theta(objective.dimension(), count);
  auto const before = static_cast<std::uint64_t>(sample.size());
  for (int k = 0; k < count; ++k) mixture.draw({seed, Purpose::evidence, before + static_cast<std::uint64_t>(k), 0}, theta, k);
  LaneArray const terms = mixture.log_terms(theta);
  std::vector<double> const log_mixture = mixture.log_density(terms);
  std::vector<double> const log_density = log_density_in_blocks(objective, theta, ledger, stop);
  sample.log_mixture.insert(sample.log_mixture.end(), log_mixture.begin(), log_mixture.end());
  sample.log_density.insert(sample.log_density.end(), log_density.begin(), log_density.end());
  sample.terms.resize(static_cast<std::size_t>(terms.rows()));
  for (int t = 0; t < terms.rows(); ++t) {
    auto& all = sample.terms[static_cast<std::size_t>(t)];
    all.insert(all.end(), terms.row(t).begin(), terms.row(t).end());
  }
}

PosteriorSample half_of(Target const& target, Draws const& draws, bool second, int most) {
  std::size_t length = draws.chains.empty() ? 0 : draws.chains.front().values.size();
  for (Chain const& chain : draws.chains) length = std::min(length, chain.values.size());
  std::size_t const chains = draws.chains.size(), first = second ? length / 2 : 0, end = second ? length : length / 2;
  std::size_t const step = std::max<std::size_t>(1, (end - first) * chains / static_cast<std::size_t>(most));
  std::vector<std::size_t> places;
  for (std::size_t d = first; d < end; d += step) places.push_back(d);

  int const dimension = target.dimension();
  LaneArray declared(dimension, static_cast<int>(places.size() * chains)), theta(declared.rows(), declared.width());
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t c = 0; c < chains; ++c)
      for (int p = 0; p < dimension; ++p)
        declared(p, static_cast<int>(i * chains + c)) = draws.chains[c].values[places[i]][static_cast<std::size_t>(p)];
  target.unconstrain(declared, theta);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < places.size(); ++i) {
    bool finite = true;
    for (std::size_t c = 0; c < chains; ++c) {
      finite = finite && std::isfinite(draws.chains[c].log_density[places[i]]);
      for (int p = 0; p < dimension; ++p) finite = finite && std::isfinite(theta(p, static_cast<int>(i * chains + c)));
    }
    if (finite) kept.push_back(i);
  }
  PosteriorSample sample{LaneArray(dimension, static_cast<int>(kept.size() * chains)), {}, {}, {}};
  for (std::size_t c = 0; c < chains; ++c) {
    sample.of_chain.emplace_back();
    for (std::size_t k = 0; k < kept.size(); ++k) {
      sample.of_chain.back().push_back(draws.chains[c].log_density[places[kept[k]]]);
      std::size_t const to = second ? c * kept.size() + k : k * chains + c;
      for (int p = 0; p < dimension; ++p) sample.theta(p, static_cast<int>(to)) = theta(p, static_cast<int>(kept[k] * chains + c));
    }
  }
  return sample;
}

void look_at(Mixture const& mixture, PosteriorSample& sample) {
  sample.terms = mixture.log_terms(sample.theta);
  sample.log_mixture = mixture.log_density(sample.terms);
}

}  // namespace sysid::marginal
