// A portmanteau test with as many lags as the rows allow, the inputs, and whether gaps leave anything to be seen.
#include "regression/error_concerns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sysid::regression {
namespace {

constexpr Eigen::Index most_lags = 20;
/// Rows that follow one another, below which a moving average of the noise is hardly seen, nor that it is missing.
constexpr Eigen::Index shortest_runs = 10;
/// The same where there is one: the errors before each run are known from samples before it, which its likelihood takes for
/// independent of them. So each gap counts against a moving average that is long enough, and a lag too many comes in its place:
/// with runs of 14 rows in 16 of 20 records, with runs of 35 in at most 1 of 10 (tests/statistical/narmax.cpp).
constexpr Eigen::Index short_of_average = 25;

}  // namespace

Portmanteau portmanteau(Eigen::VectorXd const& errors, Eigen::Index lags) {
  Portmanteau found;
  Eigen::Index const rows = errors.size();
  double const squares = errors.squaredNorm();
  for (Eigen::Index lag = 1; lag <= lags; ++lag) {
    double const r = errors.head(rows - lag).dot(errors.tail(rows - lag)) / squares;
    found.correlations += r;
    found.statistic += static_cast<double>(rows) * static_cast<double>(rows + 2) * r * r / static_cast<double>(rows - lag);
  }
  return found;
}

Concerns error_concerns(NoiseOfEquation const& noise, int equation, Eigen::VectorXd const& errors, int runs, bool any_term,
                        bool coloured) {
  Concerns concerns;
  if (errors.size() == 0) return concerns;
  if (errors.size() < shortest_runs * runs) {
    Concern concern{.kind = Concern::Kind::short_runs, .value = static_cast<double>(errors.size()) / runs};
    concern.clause = fmt::format(
        "missing samples leave only {:.1f} consecutive rows on average: a correlation of the noise can hardly be detected",
        concern.value);
    concerns.push_back(std::move(concern));
  } else if (coloured && errors.size() < short_of_average * runs) {
    Concern concern{.kind = Concern::Kind::short_runs, .value = static_cast<double>(errors.size()) / runs};
    concern.clause = fmt::format(
        "missing samples leave only {:.1f} consecutive rows on average: the estimated moving average of the noise may be too "
        "short, with an unnecessary lagged term in its place",
        concern.value);
    concerns.push_back(std::move(concern));
  }
  Eigen::Index const rows = errors.size(), most = std::min(most_lags, rows / 4);
  double const seen = portmanteau(errors, most).statistic;
  // Once in a million: Wilson and Hilferty 1931.
  double const part = 2 / (9.0 * static_cast<double>(std::max<Eigen::Index>(most, 1))), root = 1 - part + 4.753 * std::sqrt(part);
  double const limit = static_cast<double>(most) * root * root * root;
  if (most >= 3 && seen > limit) {
    Concern concern{.kind = Concern::Kind::not_white, .value = seen};
    concern.clause =
        fmt::format("the residual is not white: its chi-squared over {} lags is {:.0f}; for white noise it would be below {:.0f}",
                    most, seen, limit);
    concerns.push_back(std::move(concern));
  }
  if (auto const trace = noise.input_in(equation, errors)) {
    Concern concern{.kind = Concern::Kind::input_left, .input = trace->input, .value = trace->correlation};
    concern.clause =
        fmt::format("the residual is correlated with {} (correlation {:.2f})",
                    fmt::format("{} {}", trace->square ? "the square of this input" : "this input",
                                trace->lag == 0 ? "in the same row"
                                                : fmt::format("{} {} before", trace->lag, trace->lag == 1 ? "row" : "rows")),
                    trace->correlation);
    concerns.push_back(std::move(concern));
  }
  if (!any_term) {
    Concern concern{.kind = Concern::Kind::explains_nothing};
    concern.clause = "no term of the dictionary explains the target";
    concerns.push_back(std::move(concern));
  }
  return concerns;
}

}  // namespace sysid::regression
