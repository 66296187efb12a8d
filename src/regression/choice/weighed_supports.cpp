// Priors of supports, and what a list of weighed supports says of terms.
#include "regression/choice/weighed_supports.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid::regression {
namespace {

/// Supports beyond this many, by falling probability, no longer enter averages of coefficients.
constexpr std::size_t averaged = 2000;

}  // namespace

Scale::Scale(LinearProblem const& problem, Triangle const& triangle, Settings const& settings) : triangle_(triangle) {
  for (int j = 0; j < static_cast<int>(problem.always.size()); ++j)
    (problem.always[static_cast<std::size_t>(j)] != 0 ? always : selectable).push_back(j);
  n_ = triangle.rows - static_cast<double>(always.size());
  g_ = settings.real("g") > 0 ? settings.real("g") : n_;
  std::string const& prior = settings.word("prior");
  prior_ = prior == "beta_prime"         ? CoefficientPrior::beta_prime
           : prior == "unit_information" ? CoefficientPrior::unit_information
                                         : CoefficientPrior::zellner;
  beta_binomial_ = settings.word("sizes") == "beta_binomial";
  base_ = residual_squares(triangle, always);
}

std::vector<int> Scale::terms(Bits const& support) const {
  std::vector<int> terms = always;
  for (std::size_t i = 0; i < support.size(); ++i)
    if (support[i]) terms.push_back(selectable[i]);
  std::sort(terms.begin(), terms.end());
  return terms;
}

Weighed Scale::weigh(Bits support, double squares) const {
  auto const size = static_cast<double>(std::count(support.begin(), support.end(), true));
  double const evidence = log_bayes_factor(prior_, n_, size, squares, base_, g_);
  return {std::move(support), evidence, evidence + log_prior(size)};
}

Weighed Scale::weigh(Bits support) const {
  double const squares = residual_squares(triangle_, terms(support));
  return weigh(std::move(support), squares);
}

double Scale::log_prior(double size) const {
  if (!beta_binomial_) return 0;
  auto const all = static_cast<double>(selectable.size());
  // 1 / (number of sizes) / (number of supports of this size), the first factor left out
  return elementary::lgamma(size + 1) + elementary::lgamma(all - size + 1) - elementary::lgamma(all + 1);
}

void summarise(LinearProblem const& problem, Triangle const& triangle, Scale const& scale, std::vector<Weighed> weighed,
               Settings const& settings, Choice& choice) {
  auto const count = static_cast<int>(problem.terms.cols());
  choice.joint = Eigen::MatrixXd::Zero(count, count);
  choice.terms.resize(static_cast<std::size_t>(count));
  Eigen::VectorXd first = Eigen::VectorXd::Zero(count), second = first;  // moments of the coefficients
  double averaged_mass = 0;
  auto const offer = [&](std::size_t index) {
    Support support = support_of(triangle, scale.terms(weighed[index].support));
    support.log_evidence = weighed[index].log_evidence;
    support.probability = weighed[index].probability;
    support.probability_error = weighed[index].error;
    return support;
  };
  for (std::size_t s = 0; s < weighed.size() && weighed[s].probability > 0; ++s) {
    std::vector<int> const terms = scale.terms(weighed[s].support);
    for (int const a : terms)
      for (int const b : terms) choice.joint(a, b) += weighed[s].probability;
    if (s >= averaged) continue;
    Support const support = offer(s);
    averaged_mass += weighed[s].probability;
    for (std::size_t k = 0; k < terms.size(); ++k) {
      auto const i = static_cast<Eigen::Index>(k);
      first(terms[k]) += weighed[s].probability * support.coefficient(i);
      second(terms[k]) += weighed[s].probability * (support.covariance(i, i) + support.coefficient(i) * support.coefficient(i));
    }
    if (static_cast<std::int64_t>(s) < settings.integer("supports")) choice.supports.push_back(support);
  }
  std::vector<int> kept;
  for (int j = 0; j < count; ++j) {
    TermChoice& term = choice.terms[static_cast<std::size_t>(j)];
    term.measure = choice.joint(j, j);
    term.kept = problem.always[static_cast<std::size_t>(j)] != 0 || term.measure > settings.real("keep");
    if (term.kept) kept.push_back(j);
    term.mean = first(j) / averaged_mass;
    term.sd = std::sqrt(std::max(0.0, second(j) / averaged_mass - term.mean * term.mean));
  }
  auto const same = [&](Support const& support) { return support.terms == kept; };
  auto const place = std::find_if(choice.supports.begin(), choice.supports.end(), same);
  if (place != choice.supports.end()) {
    choice.chosen = *place;
  } else {
    std::size_t index = 0;
    while (index < weighed.size() && scale.terms(weighed[index].support) != kept) ++index;
    if (index == weighed.size()) {  // the median model is no support that a chain has met
      Bits support(scale.selectable.size());
      for (std::size_t i = 0; i < support.size(); ++i)
        support[i] = std::binary_search(kept.begin(), kept.end(), scale.selectable[i]);
      weighed.push_back(scale.weigh(std::move(support)));
      weighed.back().probability =
          weighed.front().probability * elementary::exp(weighed.back().log_weight - weighed.front().log_weight);
    }
    choice.chosen = offer(index);
    choice.supports.push_back(choice.chosen);
  }
  choice.noise_sd = choice.chosen.noise_sd;
}

}  // namespace sysid::regression
