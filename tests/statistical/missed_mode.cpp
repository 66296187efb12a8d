// A mode that a search may miss, and one that it has missed and draws have found.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "app/search/higher_place.hpp"
#include "core/numeric/random.hpp"
#include "core/system/progress.hpp"
#include "fits.hpp"
#include "inference/targets.hpp"

using namespace sysid;

namespace {

/// A decay at 7.3 Hz, 20 samples a second: of the prior of f only a small part leads a local search to it.
std::string decay(std::uint64_t seed) {
  std::string table = "t,x\n";
  Stream stream({seed, Purpose::test, 0, 0});
  for (int i = 0; i < 300; ++i) {
    double const t = 0.05 * i, w = 2 * std::numbers::pi * 7.3;
    table += fmt::format("{:.6g},{:.6g}\n", t, 1.5 * std::exp(-0.03 * t) * std::cos(w * t) + 0.4 * stream.normal());
  }
  return table;
}

std::string const model = R"(
model decay {
  state z [mm]
  parameter z0 [mm] ~ normal(0, sd = 2)
  parameter v [mm] ~ normal(0, sd = 2)
  parameter f [Hz] ~ uniform(0.1, 9.9)
  parameter d [1/s] ~ log_uniform(0.001, 1)
  parameter s [mm] ~ log_uniform(0.01, 10)
  initial z = z0, z' = 2*pi*f*v
  z'' + 2*d*z' + ((2*pi*f)^2 + d^2)*z = 0
  observe x ~ normal(z, sd = s)
}
data rec { file "rec.csv"; time t [s]; measure x = x [mm] }
)";

}  // namespace

TEST_CASE("a decay near Nyquist's frequency, whose mode draws of the prior hardly meet, is found") {
  for (std::uint64_t record = 1; record <= 3; ++record) {
    CAPTURE(record);
    Fitted const fitted = run_file(model + "post = fit decay to rec with map, seed = 1\n", {}, {{"rec.csv", decay(record)}});
    CHECK(std::fabs(fitted.of("post", "f").at("mean").get<double>() - 7.3) < 0.01);
  }
}

namespace {

/// Two hills, of f = x^2: at 1 and -1, the second lower.
class TwoHills : public testing::TestTarget {
 public:
  TwoHills()
      : testing::TestTarget({"x"}, {{testing::Prior::normal, 0, 2}}, 2, 0,
                            [](std::vector<double> const& x, std::vector<double>& rows) {
                              rows[0] = (x[0] * x[0] - 1) / 0.1;
                              rows[1] = x[0] - 1;
                            }) {}
};

FitResult drawn(std::vector<double> const& values, std::vector<double> const& log_density) {
  FitResult result;
  result.draws.names = {"x"};
  result.draws.parameter_count = 1;
  Chain chain;
  for (double const each : values) chain.values.push_back({each});
  chain.log_density = log_density;
  result.draws.chains = {chain};
  return result;
}

}  // namespace

TEST_CASE("draws far above all modes show a mode that was missed, and local searches reach it") {
  TwoHills const target;
  Preparation preparation;
  Mode lower;
  lower.theta = lower.declared = {-1};
  lower.sd = {0.05};
  lower.covariance = {0.0025};
  lower.log_density = -4;
  lower.share = 1;
  preparation.modes = {lower};
  auto const place = [&](FitResult const& result, ObjectiveKind kind, bool hierarchical) {
    return place_above_modes(result, target, kind, preparation.modes, hierarchical);
  };
  FitResult const found = drawn({-1, 1.1, 0.9}, {-4, -0.9, -0.8});
  REQUIRE(place(found, ObjectiveKind::posterior, false) == std::vector<double>{0.9});
  CHECK(place(drawn({-1, -1.1}, {-4, -1.2}), ObjectiveKind::posterior, false).empty());
  CHECK(place(found, ObjectiveKind::posterior, true).empty());  // which has a density without end
  CHECK(place(found, ObjectiveKind::likelihood, false).empty());
  FitResult told = found;
  told.higher_place = {1.2};
  CHECK(place(told, ObjectiveKind::declared_posterior, false) == std::vector<double>{1.2});

  SilentProgress silent;
  Ledger ledger;
  RunContext context{1, silent, ledger};
  REQUIRE(search_from_place({0.9}, target, ObjectiveKind::posterior, preparation, context) == HigherSearch::found);
  CHECK(preparation.searched_again == 1);
  REQUIRE(preparation.modes.size() == 2);
  CHECK(preparation.modes.front().declared.front() == doctest::Approx(1).epsilon(0.01));
  CHECK(preparation.modes.back().declared.front() == doctest::Approx(-1).epsilon(0.01));

  // From a place on a known hill nothing is found, and nothing changes.
  std::vector<Mode> const before = preparation.modes;
  REQUIRE(search_from_place({1.05}, target, ObjectiveKind::posterior, preparation, context) == HigherSearch::nothing);
  CHECK(preparation.modes.size() == before.size());
  CHECK(preparation.modes.front().theta == before.front().theta);
}
