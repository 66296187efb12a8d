// Single populations of tempered SMC against closed forms, where they have to travel far.
// SYSID_REPLICATIONS=50 asks for as many records of each kind and prints what was found; an ordinary run makes few, and
// finds errors that are a third of what they should be.
#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

#include "inference/evidence/known.hpp"
#include "inference/evidence/smc.hpp"
#include "replications.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

void check_populations(std::string const& name, std::function<Known(std::uint64_t)> const& kind, int few) {
  int const count = replications(few, 20);
  double square = 0, sum = 0, worst = 0, off = 0, error = 0, simulations = 0;
  for (int r = 1; r <= count; ++r) {
    auto const record = static_cast<std::uint64_t>(r);
    Known const known = kind(record);
    Ledger ledger;
    marginal::SmcEstimate const found = marginal::smc(known.target, 1000, {}, 1'000'000, record, ledger, {});
    CHECK(found.finished);
    double const z = (found.log_evidence - known.log_evidence) / found.error;
    square += z * z, sum += z, worst = std::max(worst, std::fabs(z)), off += found.log_evidence - known.log_evidence;
    error += found.error, simulations += static_cast<double>(found.simulations);
  }
  double const n = count;
  if (std::getenv("SYSID_REPLICATIONS") != nullptr)
    MESSAGE(name << ": " << count << " populations, mean z " << sum / n << ", rms z " << std::sqrt(square / n) << ", worst z "
                 << worst << ", mean deviation " << off / n << ", mean error " << error / n << ", mean simulations "
                 << simulations / n);
  CHECK(worst < 3 + 0.3 * std::log(n));
  CHECK(std::sqrt(square / n) < 1.2 + 1.5 / std::sqrt(n));
}

}  // namespace

TEST_CASE("a population reaches a narrow posterior from wide priors where the noise is estimated") {
  check_populations(
      "wide regression, 240 rows", [](std::uint64_t r) { return wide_regression(240, r); }, 2);
}

TEST_CASE("populations in few and in twenty dimensions") {
  check_populations(
      "wide regression, 20 rows", [](std::uint64_t r) { return wide_regression(20, r); }, 1);
  check_populations("two modes", &two_modes, 1);
  check_populations("ridge", &ridge, 1);
  check_populations("funnel", &funnel, 1);
  check_populations("oscillator", &linear_oscillator, 1);
  check_populations(
      "normals, 5", [](std::uint64_t r) { return mixture_of_normals(5, r); }, 1);
}
