// Which concerns are fatal, and those that inputs and hyper-parameters alone can raise.
#include "gaussian_process/concern.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace sysid::gaussian_process {

bool fatal(Concern::Kind kind) { return kind <= Concern::Kind::not_finite; }

int repeated_inputs(Eigen::MatrixXd const& inputs, std::vector<int> const& columns) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(inputs.rows()));
  std::iota(order.begin(), order.end(), 0);
  auto const before = [&](Eigen::Index a, Eigen::Index b) {
    for (int const c : columns)
      if (inputs(a, c) != inputs(b, c)) return inputs(a, c) < inputs(b, c);
    return false;
  };
  std::sort(order.begin(), order.end(), before);
  int repeated = 0;
  for (std::size_t n = 1; n < order.size(); ++n)
    if (!before(order[n - 1], order[n])) ++repeated;
  return repeated;
}

Concerns duplicates_without_noise(Eigen::MatrixXd const& inputs, std::vector<int> const& columns) {
  int const repeated = repeated_inputs(inputs, columns);
  if (repeated == 0) return {};
  return {{.kind = Concern::Kind::duplicate_inputs,
           .value = static_cast<double>(repeated),
           .clause =
               fmt::format("{} of {} observations repeat the inputs of another, and there is no noise", repeated, inputs.rows())}};
}

Concerns places_outside(Eigen::MatrixXd const& inputs, Eigen::MatrixXd const& places, std::vector<int> const& columns) {
  constexpr double tolerated = 0.1;
  Concerns concerns;
  if (inputs.rows() == 0 || places.rows() == 0) return concerns;
  for (int const column : columns) {
    double const low = inputs.col(column).minCoeff(), high = inputs.col(column).maxCoeff(), width = high - low;
    double const beyond = std::max(places.col(column).maxCoeff() - high, low - places.col(column).minCoeff());
    if (!(beyond > tolerated * width)) continue;
    Eigen::Index const count =
        (places.col(column).array() > high + tolerated * width || places.col(column).array() < low - tolerated * width).count();
    std::string const far = width > 0 ? fmt::format("by up to {:.3g} times their range", beyond / width) : "which are all the same";
    concerns.push_back({.kind = Concern::Kind::far_outside,
                        .column = column,
                        .value = beyond / width,
                        .clause = fmt::format("{} of {} places lie outside the observations in input {}, {}", count, places.rows(),
                                              column + 1, far)});
  }
  return concerns;
}

}  // namespace sysid::gaussian_process
