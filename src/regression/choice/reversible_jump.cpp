// The chains, and how often they were where.
#include "regression/choice/reversible_jump.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"
#include "regression/choice/triangle.hpp"
#include "regression/choice/weighed_supports.hpp"

namespace sysid::regression::reversible_jump {
namespace {

constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "4000", 1, 1e8, "",
     "iterations of each chain, burn-in included; each tries as many moves as there are terms"},
    {"burn_in", SettingKind::integer, "500", 0, 1e8, "", "first iterations, discarded"},
    {"chains", SettingKind::integer, "4", 1, 1000, "", "number of independent chains"},
    {"prior", SettingKind::word, "beta_prime", 0, 0, "beta_prime unit_information zellner",
     "prior of the coefficients, as of `spike_slab`"},
    {"g", SettingKind::real, "0", 0, 1e300, "",
     "for unit_information and zellner: prior variance divided by that of the estimate; 0: the number of rows"},
    {"sizes", SettingKind::word, "beta_binomial", 0, 0, "beta_binomial uniform",
     "prior of the number of terms, as of `spike_slab`"},
    {"keep", SettingKind::real, "0.5", 0, 1, "", "inclusion probability above which a term is kept"},
    {"supports", SettingKind::integer, "10", 1, 10000, "", "number of sets of terms that are reported, best first"},
};

/// Parts of all chains together whose scatter gives the errors.
constexpr std::int64_t wanted_parts = 48;
constexpr double exchanges = 0.3;  // of the moves
/// Chains disagree about a term where their variance is so many times what their parts leave, and the probability is not known.
constexpr double disagreement = 6, tolerable = 0.02;

double gamma_draw(double shape, Stream& stream) {  // Marsaglia and Tsang 2000; shape >= 1/4
  double const more = shape < 1 ? 1 : 0, d = shape + more - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    double const x = stream.normal(), v = (1 + c * x) * (1 + c * x) * (1 + c * x);
    double const level = stream.uniform();
    if (v <= 0 || !(elementary::log(level) < 0.5 * x * x + d - d * v + d * elementary::log(v))) continue;
    if (more == 0) return d * v;
    return d * v * elementary::exp(elementary::log(stream.uniform()) / shape);
  }
}

/// What is known of a set of terms once.
struct Known {
  Weighed weighed;
  double size = 0, squares = 0;  // squares that it leaves
};

/// A set with the noise variance and g.
struct State {
  Bits support;
  double variance = 1, g = 1;
};

class Chains {
 public:
  Chains(Triangle const& triangle, Scale const& scale)
      : scale_(scale), triangle_(triangle), base_(residual_squares(triangle, scale.always)), count_(scale.selectable.size()) {}

  Known const& known(Bits const& support) {
    auto place = known_.find(support);
    if (place != known_.end()) return place->second;
    // What exact data leave is rounding, as in `log_bayes_factor`.
    double const squares = std::max(residual_squares(triangle_, scale_.terms(support)), 1e-30 * base_);
    auto const size = static_cast<double>(std::count(support.begin(), support.end(), true));
    return known_.emplace(support, Known{scale_.weigh(support, squares), size, squares}).first->second;
  }

  /// log of p(y, set | noise variance, g) and of what g and the set have as prior, coefficients integrated out; up to a constant.
  double log_density(State const& state, Bits const& support) {
    Known const& of = known(support);
    double const n = scale_.rows(), shrink = state.g / (1 + state.g), explained = base_ - of.squares;
    double const left = scale_.prior() == CoefficientPrior::unit_information ? of.squares : base_ - shrink * explained;
    double value = scale_.log_prior(of.size) - 0.5 * of.size * elementary::log1p(state.g) - left / (2 * state.variance);
    if (scale_.prior() == CoefficientPrior::beta_prime) {
      // p(g | set) = g^b (1 + g)^(-a - b - 2) / B(a + 1, b + 1), a = -3/4, b = (n - p)/2 - a - 2    Maruyama and George 2011,
      // eq. 2.9
      double const b = (n - of.size) / 2 - 1.25;
      value += b * elementary::log(state.g) - (b + 1.25) * elementary::log1p(state.g) - elementary::lgamma(b + 1) +
               elementary::lgamma(b + 1.25);
    }
    return value;
  }

  /// Noise and g given the set, coefficients integrated out.
  void refresh(State& state, Stream& stream) {
    Known const& of = known(state.support);
    double const n = scale_.rows(), explained = base_ - of.squares;
    if (scale_.prior() == CoefficientPrior::beta_prime) {
      // g q / (1 + g q) is beta distributed, q the part of the squares that the set leaves.
      double const x = gamma_draw((n - of.size) / 2 - 0.25, stream), y = gamma_draw(of.size / 2 + 0.25, stream);
      state.g = std::clamp(x / y * base_ / of.squares, 1e-12, 1e250);
    }
    double const shrink = state.g / (1 + state.g);
    double const left = scale_.prior() == CoefficientPrior::unit_information ? of.squares : base_ - shrink * explained;
    state.variance = std::max(0.5 * left, 1e-300) / gamma_draw(n / 2, stream);
  }

  /// As many moves as there are terms.
  void sweep(State& state, Stream& stream) {
    double density = log_density(state, state.support);
    for (std::size_t i = 0; i < count_; ++i) {
      Bits other = state.support;
      std::size_t const a = stream.below(count_), b = stream.below(count_);
      double const kind = stream.uniform(), level = elementary::log(stream.uniform());
      if (kind < exchanges) {
        if (other[a] == other[b]) continue;  // both in or both out
        other[a] = !other[a];
        other[b] = !other[b];
      } else {
        other[a] = !other[a];
      }
      double const there = log_density(state, other);
      if (!(level < there - density)) continue;
      state.support = std::move(other);
      density = there;
    }
  }

  State start(Bits support, Stream& stream) {
    State state{std::move(support), 1, scale_.prior() == CoefficientPrior::beta_prime ? scale_.rows() : scale_.g()};
    refresh(state, stream);
    return state;
  }

 private:
  Scale const& scale_;
  Triangle const& triangle_;
  double base_;  // squares that the always terms leave
  std::size_t count_;
  std::map<Bits, Known> known_;
};

/// Visits of something in each part of the chains, chain after chain.
using Visits = std::vector<double>;

struct Count {
  std::map<Bits, Visits> visits;
  Visits length;          // iterations of each part, at least 1
  std::size_t parts = 1;  // of a chain
};

Count run(Chains& chains, std::size_t selectable, Settings const& settings, SelectorContext const& context) {
  auto const samples = settings.integer("samples"), burn_in = settings.integer("burn_in"), kept = samples - burn_in;
  auto const of = settings.integer("chains"),
             parts = std::clamp<std::int64_t>(wanted_parts / of, std::min<std::int64_t>(4, kept), kept);
  Count count;
  count.parts = static_cast<std::size_t>(parts);
  count.length.assign(static_cast<std::size_t>(of * parts), 0.0);
  for (std::int64_t c = 0; c < of; ++c) {
    StreamKey const key{context.seed, Purpose::jump, (context.equation << 32) + static_cast<std::uint64_t>(c), 0};
    Stream first(key.with_step(~std::uint64_t{0}));
    Bits support(selectable, false);  // the first chain begins without any term, others with about half of them
    for (std::size_t i = 0; i < selectable; ++i) support[i] = c > 0 && first.uniform() < 0.5;
    State state = chains.start(std::move(support), first);
    for (std::int64_t i = 0; i < samples; ++i) {
      if (context.interrupted && context.interrupted()) break;
      Stream stream(key.with_step(static_cast<std::uint64_t>(i)));
      chains.sweep(state, stream);
      chains.refresh(state, stream);
      if (i < burn_in) continue;
      auto const part = static_cast<std::size_t>(c * parts + (i - burn_in) * parts / kept);
      Visits& here = count.visits[state.support];
      here.resize(count.length.size(), 0.0);
      ++here[part];
      ++count.length[part];
    }
  }
  for (double& each : count.length) each = std::max(each, 1.0);
  return count;
}

struct Mean {
  double value = 0, error = 0;
  bool agreed = true;
};

Mean mean_of(Visits const& visits, Count const& count) {
  Mean mean;
  Visits const& length = count.length;
  std::size_t const parts = count.parts;
  auto const n = static_cast<double>(visits.size()), chains = n / static_cast<double>(parts);
  double counted = 0, all = 0;
  for (std::size_t i = 0; i < visits.size(); ++i) counted += visits[i], all += length[i];
  mean.value = counted / all;
  double squares = 0, between = 0;
  for (std::size_t c = 0; c < visits.size() / parts; ++c) {
    double of_chain = 0;
    for (std::size_t s = 0; s < parts; ++s) of_chain += visits[c * parts + s] / length[c * parts + s] / static_cast<double>(parts);
    for (std::size_t s = 0; s < parts; ++s) {
      double const off = visits[c * parts + s] / length[c * parts + s] - mean.value;
      squares += off * off;
    }
    between += (of_chain - mean.value) * (of_chain - mean.value);
  }
  // What was always so, or never, is known to one iteration at best.
  mean.error = n > 1 ? std::max(std::sqrt(squares / (n * (n - 1))), 1 / all) : 1;
  if (chains < 2) return mean;
  double const of_chains = std::sqrt(between / (chains * (chains - 1)));
  mean.agreed = !(of_chains * of_chains > disagreement * mean.error * mean.error && of_chains > tolerable);
  if (of_chains > 2 * mean.error) mean.error = of_chains;
  return mean;
}

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::string refuse(Settings const& settings) {
  std::int64_t const samples = settings.integer("samples"), burn_in = settings.integer("burn_in");
  if (burn_in >= samples)
    return fmt::format("burn_in ({}) must be smaller than samples ({}), which counts all iterations", burn_in, samples);
  return {};
}

Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context) {
  Triangle const triangle = reduce(problem);
  Scale const scale(problem, triangle, settings);
  Chains chains(triangle, scale);
  Count const count = run(chains, scale.selectable.size(), settings, context);
  Choice choice;
  choice.exact = false;
  choice.iterations = static_cast<int>(std::min<std::int64_t>(settings.integer("samples"), 2'000'000'000));
  std::vector<Weighed> weighed;
  std::vector<Visits> of_term(scale.selectable.size(), Visits(count.length.size(), 0.0));
  for (auto const& [support, here] : count.visits) {
    weighed.push_back(chains.known(support).weighed);
    Mean const mean = mean_of(here, count);
    weighed.back().probability = mean.value;
    weighed.back().error = mean.error;
    for (std::size_t i = 0; i < support.size(); ++i)
      if (support[i])
        for (std::size_t s = 0; s < here.size(); ++s) of_term[i][s] += here[s];
  }
  // Of a run that was interrupted at once nothing is used.
  if (weighed.empty()) weighed.push_back(chains.known(Bits(scale.selectable.size(), false)).weighed);
  std::stable_sort(weighed.begin(), weighed.end(),
                   [](Weighed const& a, Weighed const& b) { return a.probability > b.probability; });
  summarise(problem, triangle, scale, std::move(weighed), settings, choice);
  for (std::size_t i = 0; i < of_term.size(); ++i) {
    Mean const mean = mean_of(of_term[i], count);
    choice.terms[static_cast<std::size_t>(scale.selectable[i])].measure_error = mean.error;
    choice.converged = choice.converged && mean.agreed;
  }
  return choice;
}

}  // namespace sysid::regression::reversible_jump
