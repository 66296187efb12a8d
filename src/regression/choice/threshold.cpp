// Backward elimination, cut where the contribution passes the share.
#include "regression/choice/threshold.hpp"

#include <cmath>

#include "regression/choice/triangle.hpp"

namespace sysid::regression::threshold {
namespace {

constexpr SettingRow rows[] = {
    {"share", SettingKind::real, "0.02", 0, 1, "",
     "smallest contribution of a kept term, as a fraction of the explained root mean square"},
};

/// Supports offered as candidates beside the chosen one.
constexpr int neighbours = 2;

}  // namespace

std::span<SettingRow const> settings() { return rows; }

Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const&) {
  Triangle const triangle = reduce(problem);
  double const share = settings.real("share");
  std::vector<Elimination> const path = eliminate(triangle, problem.always);
  std::size_t chosen = 0;
  while (path[chosen].lost >= 0 && path[chosen].contribution < share) ++chosen;

  Choice choice;
  choice.iterations = static_cast<int>(chosen);
  choice.terms.resize(static_cast<std::size_t>(problem.terms.cols()));
  for (std::size_t round = 0; round < chosen; ++round) {  // an exchange may bring a term back: its last loss counts
    TermChoice& term = choice.terms[static_cast<std::size_t>(path[round].lost)];
    term.measure = path[round].contribution;
    term.dropped_in = static_cast<int>(round) + 1;
  }
  auto const offer = [&](std::size_t index) {
    Support support = support_of(triangle, path[index].terms);
    support.log_evidence = default_log_evidence(triangle, problem.always, path[index].terms);
    support.probability = index == chosen ? 1 : 0;
    return support;
  };
  choice.chosen = offer(chosen);
  choice.noise_sd = choice.chosen.noise_sd;
  SubsetFit const subset = fit(triangle, choice.chosen.terms);
  for (std::size_t k = 0; k < choice.chosen.terms.size(); ++k) {
    auto const i = static_cast<Eigen::Index>(k);
    TermChoice& term = choice.terms[static_cast<std::size_t>(choice.chosen.terms[k])];
    term.kept = true;
    term.dropped_in = 0;
    term.measure =
        triangle.total > 0 ? std::sqrt(subset.coefficient(i) * subset.coefficient(i) / subset.inverse(i, i) / triangle.total) : 0;
    term.mean = choice.chosen.coefficient(i);
    term.sd = std::sqrt(choice.chosen.covariance(i, i));
  }
  choice.supports.push_back(choice.chosen);
  for (int distance = 1; distance <= neighbours; ++distance) {
    auto const away = static_cast<std::size_t>(distance);
    if (chosen >= away) choice.supports.push_back(offer(chosen - away));
    if (chosen + away < path.size()) choice.supports.push_back(offer(chosen + away));
  }
  return choice;
}

}  // namespace sysid::regression::threshold
