// Walkers of which one has strayed.
#include "inference/evidence/walked_draws.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "inference/evidence/known.hpp"

using namespace sysid;

namespace {

/// A standard normal, and far from it a place with a millionth of its mass, which nobody leaves who is there.
double with_a_far_place(std::vector<double> const& u) {
  constexpr double width = 1, mass = 1e-6;
  double const far = (u[0] - 15) / width, beside = u[1] / width;
  double const main = -0.5 * (u[0] * u[0] + u[1] * u[1]),
               other = -0.5 * (far * far + beside * beside) + std::log(mass / (width * width));
  double const most = std::max(main, other);
  return most + std::log(std::exp(main - most) + std::exp(other - most));
}

marginal::WalkedDraws walked_with(int strayed) {
  testing::TestTarget const target = testing::target_of(2, 40, 20, with_a_far_place);
  Objective const objective = make_objective(target, ObjectiveKind::posterior, 1, 0);
  constexpr int width = 64;
  LaneArray walkers(2, width);
  for (int w = 0; w < width; ++w) {
    Stream stream({3, Purpose::test, static_cast<std::uint64_t>(w), 0});
    walkers(0, w) = w < strayed ? 15 : stream.normal();
    walkers(1, w) = w < strayed ? 0 : stream.normal();
  }
  Ledger ledger;
  return marginal::walked_draws(objective, walkers, 100'000, {1, Purpose::test, 0, 1}, ledger, {});
}

/// Of the draws by their weights.
double sd_of(marginal::WalkedDraws const& draws) {
  double sum = 0, mean = 0, square = 0;
  for (int d = 0; d < draws.theta.width(); ++d) {
    double const weight = std::exp(draws.log_weights[static_cast<std::size_t>(d)]);
    sum += weight, mean += weight * draws.theta(0, d), square += weight * draws.theta(0, d) * draws.theta(0, d);
  }
  return std::sqrt(square / sum - mean * mean / (sum * sum));
}

}  // namespace

TEST_CASE("a walker that has strayed to a place of next to no mass goes back to the others, and the draws are confirmed") {
  for (int const strayed : {0, 1, 2}) {
    CAPTURE(strayed);
    marginal::WalkedDraws const draws = walked_with(strayed);
    CHECK(draws.confirmed);
    CHECK(sd_of(draws) == doctest::Approx(1).epsilon(0.1));
  }
}
