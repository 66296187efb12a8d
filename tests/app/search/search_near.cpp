// `search = near(FIT)`: the same optimum from where an earlier fit ended, with a changed prior, a term more, or a unit changed.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "app/search/search_near.hpp"
#include "inference/targets.hpp"

using namespace sysid;

namespace {

std::string const near_text = R"(
model linear {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  parameter sigma [m] ~ log_uniform(1e-7, 1e-2)
  1 [kg]*y'' + c*y' + k*y = x
  observe displacement ~ normal(y, sd = sigma)
}
model cubic {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/mm] ~ log_uniform(1, 100)
  parameter k3 [N/m^3] ~ log_uniform(1e7, 1e11)
  parameter sigma [m] ~ log_uniform(1e-7, 1e-2)
  1 [kg]*y'' + c*y' + k*y + k3*y^3 = x
  observe displacement ~ normal(y, sd = sigma)
}
data bench { file "made.csv"; time t [s]; input x = x [N] hold zero_order; measure displacement = displacement [m] }
)";

std::string made_record() {
  static std::string const record =
      CaseRun(near_text +
                  "made = simulate cubic with values(c = 20, k = 10, k3 = 5e9), input x = gaussian(sd = 10), "
                  "noise = 1 [percent], samples = 400, rate = 500 [Hz], seed = 1\n",
              {{"made.csv", ""}})
          .file("made/made.csv");
  return record;
}

bool found(nlohmann::json const& summary, std::string const& code) {
  for (auto const& finding : summary.at("findings"))
    if (finding.at("code") == code) return true;
  return false;
}

}  // namespace

TEST_CASE("a search near an earlier fit ends where a search everywhere ends, with a fraction of the simulations, and says so") {
  CaseRun const run(near_text +
                        "first = fit linear to bench with map, seed = 1\n"
                        "everywhere = fit cubic to bench with map, seed = 1\n"
                        "near = fit cubic to bench with map, search = near(first), seed = 1\n"
                        "again = fit cubic to bench with map, search = near(near), seed = 2\n",
                    {{"made.csv", made_record()}});
  auto const everywhere = run.summary("everywhere");
  CHECK_FALSE(found(everywhere, "searched_near"));
  for (char const* task : {"near", "again"}) {
    auto const near = run.summary(task);
    CAPTURE(task);
    CHECK(found(near, "searched_near"));
    for (auto const& [name, parameter] : everywhere.at("parameters").items()) {
      double const sd = parameter.at("sd");
      CHECK(near.at("parameters").at(name).at("mean").get<double>() ==
            doctest::Approx(parameter.at("mean").get<double>()).scale(sd).epsilon(1e-3));
    }
  }
  CHECK(run.summary("again").at("ledger").at("solves").get<int>() < everywhere.at("ledger").at("solves").get<int>() / 3);
}

TEST_CASE("what reproduces a fit that searched near another holds that one, too") {
  CaseRun const run(near_text +
                        "first = fit linear to bench with map, seed = 1\n"
                        "unused = fit linear to bench with ml, seed = 1\n"
                        "near = fit cubic to bench with map, search = near(first), seed = 1\n",
                    {{"made.csv", made_record()}});
  std::string const resolved = run.file("near/resolved.sysid");
  CHECK(resolved.find("first = fit linear") != std::string::npos);
  CHECK(resolved.find("unused = ") == std::string::npos);
  CHECK(resolved.find("search = near(first)") != std::string::npos);
}

TEST_CASE("a search begins near a fit that stands above it") {
  auto const refusal = [](std::string const& task) {
    try {
      CaseRun(near_text + task, {{"made.csv", made_record()}});
    } catch (UserError const& error) {
      return error.diagnostic().code;
    }
    return std::string();
  };
  CHECK(refusal("near = fit linear to bench with map, search = near(near), seed = 1\n") != "");
  CHECK(refusal("near = fit linear to bench with map, search = near(other), seed = 1\n") == "E6001");
  CHECK(refusal("near = fit linear to bench with map, search = other, seed = 1\n") == "E6004");
  CHECK(refusal("near = fit linear to bench with map, search = near(b)\nb = fit linear to bench with map\n") == "E6012");
}

TEST_CASE("a function that is new begins at zero near an earlier fit") {
  // Functions as the prior draws them push so hard that no motion stays finite. The step is stated: one that suits draws of the
  // prior would be a hundredth of the one that the result needs.
  CaseRun const run(near_text + R"(
model unknown {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  parameter sigma [m] ~ log_uniform(1e-7, 1e-2)
  function f(y) ~ gp(linear(slope = 1e9 [N/m]) + squared_exponential(amplitude = 1 [N], length = 1e-3 [m]), zero_at = 0,
      within = (-4e-3, 4e-3), terms = 8)
  1 [kg]*y'' + c*y' + k*y + f(y) = x
  observe displacement ~ normal(y, sd = sigma)
}
first = fit linear to bench with map, seed = 1
near  = fit unknown to bench with map, search = near(first), substeps = 8, seed = 1
)",
                    {{"made.csv", made_record()}});
  CHECK(run.summary("near").at("fit").at("rmse") < 0.5 * run.summary("first").at("fit").at("rmse").get<double>());
}

namespace {

/// A spread between 2 and 5 and one member, placed relative to it.
class Population : public testing::TestTarget {
 public:
  Population()
      : TestTarget({"tau", "k"}, {{testing::Prior::uniform, 2, 5}, {testing::Prior::normal, 0, 1}}, 1, 0,
                   [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = 0; }) {}
  void constrain(ConstLanes theta, Lanes declared) const override {
    TestTarget::constrain(theta, declared);
    for (int w = 0; w < theta.width(); ++w) declared(1, w) *= declared(0, w);
  }
  void unconstrain(ConstLanes declared, Lanes theta) const override {
    TestTarget::unconstrain(declared, theta);
    // A spread that its prior does not allow leaves its members without a place.
    for (int w = 0; w < theta.width(); ++w)
      theta(1, w) = std::isfinite(theta(0, w)) ? declared(1, w) / declared(0, w) : std::numeric_limits<double>::quiet_NaN();
  }
};

}  // namespace

TEST_CASE("a value that was in the same unit, written otherwise, is where a search near it begins") {
  class InUnit : public testing::TestTarget {
   public:
    explicit InUnit(std::string const& unit)
        : TestTarget({"k"}, {{testing::Prior::uniform, 0, 5}}, 1, 0,
                     [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = 0; }),
          own_{{"k", unit, 0, 5}} {}
    std::span<ParameterInfo const> parameters() const override { return own_; }

   private:
    std::vector<ParameterInfo> own_;
  };
  Draws earlier;
  earlier.names = {"k"};
  earlier.parameter_count = 1;
  earlier.chains = {{{{3.25}}, {0}, {0}, {0}, {}}};
  auto const begins_there = [&](std::string const& then, std::string const& now) {
    earlier.units = {then};
    InUnit const target(now);
    LaneArray const starts = starts_near(target, earlier, 1);
    LaneArray declared(1, starts.width());
    target.constrain(starts, declared);
    return std::fabs(declared(0, 0) - 3.25) < 1e-9;
  };
  CHECK(begins_there("N/m", "N m^-1"));
  CHECK(begins_there("1/mm", "mm^-1"));
  CHECK(begins_there("", ""));
  CHECK_FALSE(begins_there("N/m", "N/mm"));
  CHECK_FALSE(begins_there("Hz", "rad/s"));
  CHECK_FALSE(begins_there("degC", "K"));
  CHECK_FALSE(begins_there("", "N/m"));
}

TEST_CASE("members keep their earlier values where the prior no longer allows the earlier spread") {
  Population const target;
  Draws earlier;
  earlier.names = {"tau", "k"};
  earlier.units = {"", ""};
  earlier.parameter_count = 2;
  earlier.chains.resize(1);
  for (int d = 0; d < 20; ++d) {
    earlier.chains[0].values.push_back({d % 2 == 0 ? 1.0 : 3.0, 7.0 + d});
    earlier.chains[0].log_prior.push_back(0);
    earlier.chains[0].log_likelihood.push_back(0);
    earlier.chains[0].log_density.push_back(0);
  }
  LaneArray const starts = starts_near(target, earlier, 1);
  LaneArray declared(2, starts.width());
  target.constrain(starts, declared);
  int replaced = 0;
  for (int w = 0; w < starts.width(); ++w) {
    CHECK(declared(0, w) > 2);
    CHECK(declared(0, w) < 5);
    if (std::fabs(declared(0, w) - 3) > 1e-9) ++replaced;
    CHECK(declared(1, w) == doctest::Approx(std::round(declared(1, w))));
    CHECK(declared(1, w) >= 6.999);
  }
  CHECK(replaced > 0);
  CHECK(replaced < starts.width());
}
