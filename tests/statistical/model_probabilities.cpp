// Model probabilities by weights against an exact answer, for every combination of kernel, thresholds, model kernel and
// coordinates.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "inference/abc/abc_smc.hpp"
#include "inference/selection_toys.hpp"
#include "replications.hpp"

using namespace sysid;

namespace {

constexpr double exact = 10.0 / 11, last_threshold = 0.05;
// With either, errors of the weights of twice what is claimed are found.
std::int64_t const particles = full_size() ? 3000 : 1500;

struct Estimate {
  double log_odds = 0, error = 0;  // of the first model by weights, and its standard error
  double share = 0;                // of particles
};

/// A model's summed weights are those of independent proposals, so their relative variance is that of n weighted draws, 1/ess of
/// the model; what the populations before have done takes part in the proposals' density alone, which the weights divide by.
Estimate estimate(Settings const& settings, std::uint64_t seed) {
  SilentProgress silent;
  Ledger ledger;
  RunContext context{seed, silent, ledger, {}, {}, 60, {}, {}, {}};
  SelectionResult const result = abc::run(testing::two_widths(), settings, context);
  REQUIRE_FALSE(result.failure);
  REQUIRE(result.threshold == last_threshold);
  Estimate estimate;
  double variance = 0;
  for (SelectedModel const& model : result.models) {
    REQUIRE(model.died_in == 0);
    for (double const w : model.weight) variance += w * w;  // they sum to 1 within the model
  }
  estimate.log_odds = std::log(result.models[0].probability / result.models[1].probability);
  estimate.error = std::sqrt(variance);
  estimate.share = result.models[0].share;
  return estimate;
}

}  // namespace

TEST_CASE("weights are exact for every kernel, threshold rule, model kernel and coordinates, and shares of particles for none") {
  double const target = std::log(exact / (1 - exact));
  double squares = 0, sum = 0;
  int count = 0;
  for (std::string const kernel : {"gaussian", "component_gaussian", "uniform", "nearest_neighbours"})
    for (bool const by_quantile : {false, true})
      for (std::string const model_kernel : {"prior", "previous"})
        for (std::string const coordinates : {"natural", "declared", "unconstrained"}) {
          CAPTURE(kernel);
          CAPTURE(by_quantile);
          CAPTURE(model_kernel);
          CAPTURE(coordinates);
          Settings settings = testing::abc_settings(
              {{"particles", particles}, {"kernel", kernel}, {"model_kernel", model_kernel}, {"coordinates", coordinates}});
          if (by_quantile) {
            settings.set("quantile", 0.3);
            settings.set("target", last_threshold);
            settings.set("relative_change", 0.0);  // at the target and not just before it
          } else {
            settings.set("schedule", std::vector<double>{1, 0.4, 0.15, last_threshold});
          }
          Estimate const one = estimate(settings, 100 + static_cast<std::uint64_t>(count));
          double const z = (one.log_odds - target) / one.error;
          CHECK(std::fabs(z) < 4);
          CHECK(one.error < 0.1);  // an answer that tells 10/11 from 1/2, whose log odds are 2.3 apart
          // The share is a binomial of its own, far from the probability.
          CHECK(one.share < exact - 6 * std::sqrt(exact * (1 - exact) / static_cast<double>(particles)));
          squares += z * z;
          sum += z;
          ++count;
        }
  // Errors as large as claimed, no larger and no smaller: chi-square of 48, and their mean, within 4 standard errors.
  CHECK(count == 48);
  CHECK(std::fabs(squares - count) < 4 * std::sqrt(2.0 * count));
  CHECK(std::fabs(sum) < 4 * std::sqrt(static_cast<double>(count)));
}
