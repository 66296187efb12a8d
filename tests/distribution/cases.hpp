// One or more admissible uses of every distribution, for the tests that run over the table.
#pragma once
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/numeric/not_finite.hpp"
#include "distribution/distribution.hpp"

namespace sysid::test {

/// Canonical arguments; bounds infinite where there is no truncation.
struct Case {
  std::string name;
  std::vector<double> arguments;
  double lower = -infinity, upper = infinity;

  DistributionRow const& row() const { return *find_distribution(name); }
  Distribution in(Graph& graph) const {
    Distribution use;
    use.row = &row();
    for (double const argument : arguments) use.arguments.push_back(graph.constant(argument));
    if (std::isfinite(lower)) use.lower = graph.constant(lower);
    if (std::isfinite(upper)) use.upper = graph.constant(upper);
    return use;
  }
};

inline std::vector<Case> const& whole_cases() {
  static std::vector<Case> const cases = {
      {"uniform", {-2, 5}},
      {"uniform", {1e-3, 2e-3}},
      {"log_uniform", {1e3, 1e5}},
      {"log_uniform", {0.2, 0.7}},
      {"normal", {0.3, 0.5}},
      {"normal", {-40, 3}},
      {"log_normal", {2, 0.25}},
      {"log_normal", {0.1, 1.5}},
      {"half_normal", {1.7}},
      {"student_t", {1, 4, 0.6}},
      {"student_t", {-2, 7.5, 3}},
      {"student_t", {0, 150, 1}},
      {"half_cauchy", {2.5}},
      {"exponential", {0.4}},
      {"gamma", {0.6, 2}},
      {"gamma", {7.5, 0.3}},
      {"inverse_gamma", {3, 2}},
      {"inverse_gamma", {0.8, 1}},
      {"beta", {2, 3}},
      {"beta", {0.5, 1.5}},
      {"beta", {40, 25}},
  };
  return cases;
}

/// Of the distributions of counts.
inline std::vector<Case> const& count_cases() {
  static std::vector<Case> const cases = {
      {"poisson", {0.3}},
      {"poisson", {4}},
      {"poisson", {10}},
      {"poisson", {250}},
      {"negative_binomial", {0.5, 0.7}},
      {"negative_binomial", {6, 3}},
      {"negative_binomial", {40, 25}},
      {"negative_binomial", {80, 1.5}},
  };
  return cases;
}

/// Bounds on either side, on both, in either tail, and beyond the natural support.
inline std::vector<Case> const& truncated_cases() {
  static std::vector<Case> const cases = {
      {"uniform", {-2, 5}, 0, 9},
      {"log_uniform", {1e3, 1e5}, 2e3, infinity},
      {"log_uniform", {1, 100}, 0.1, 20},
      {"normal", {0, 1}, 0.5, infinity},
      {"normal", {0, 1}, -infinity, -3},
      {"normal", {0, 1}, 6, 7},
      {"normal", {0, 1}, -12, -11},
      {"normal", {3, 0.5}, 2, 4},
      {"log_normal", {2, 0.5}, 4, 5},
      {"half_normal", {1}, -1, 0.3},
      {"half_normal", {1}, 5, infinity},
      {"student_t", {1, 4, 0.5}, 2, infinity},
      {"student_t", {0, 3, 1}, -8, -6},
      {"student_t", {0, 5, 1}, 30, 40},
      {"half_cauchy", {1}, 50, 80},
      {"exponential", {2}, 1, 3},
      {"exponential", {1}, 30, infinity},
      {"gamma", {3, 0.5}, 0.1, 0.3},
      {"gamma", {3, 0.5}, 15, infinity},
      {"inverse_gamma", {3, 2}, 0.2, 0.4},
      {"inverse_gamma", {3, 2}, 20, infinity},
      {"beta", {2, 5}, 0.1, 0.4},
      {"beta", {2, 5}, 0.9, 0.95},
  };
  return cases;
}

inline std::vector<Case> all_cases() {
  std::vector<Case> cases = whole_cases();
  cases.insert(cases.end(), truncated_cases().begin(), truncated_cases().end());
  return cases;
}

/// For messages.
inline std::string describe(Case const& use) {
  std::string text = use.name + "(";
  for (double const argument : use.arguments) text += std::to_string(argument) + " ";
  return text + "| " + std::to_string(use.lower) + ", " + std::to_string(use.upper) + ")";
}

}  // namespace sysid::test
