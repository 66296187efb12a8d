// Which coordinates are asked whether the likelihood contains them, and what is said of those that it does not.
#include "diagnostics/identifiability/influence_check.hpp"

#include <doctest/doctest.h>

#include <functional>

#include "check/checking.hpp"

using namespace sysid;

namespace {

/// The likelihood of a model that a test writes down, of declared values.
class WrittenLikelihood : public Target {
 public:
  WrittenLikelihood(ParameterSpace const& space, std::function<double(std::vector<double> const&)> value)
      : space_(space), value_(std::move(value)) {}

  int dimension() const override { return space_.dimension(); }
  std::span<ParameterInfo const> parameters() const override { return space_.infos(); }
  void sample_prior(StreamKey key, Lanes theta) const override { space_.sample_prior(key, theta); }
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian) const override { space_.log_prior(theta, out, jacobian); }
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger&) const override {
    LaneArray declared(dimension(), theta.width());
    space_.constrain(theta, declared);
    for (int w = 0; w < theta.width(); ++w) {
      std::vector<double> values;
      for (int p = 0; p < dimension(); ++p) values.push_back(declared(p, w));
      out[static_cast<std::size_t>(w)] = value_(values);
    }
    lanes += theta.width();
  }
  int residual_count() const override { return 0; }
  void residuals(ConstLanes, Lanes, Ledger&) const override {}
  void constrain(ConstLanes theta, Lanes declared) const override { space_.constrain(theta, declared); }
  void unconstrain(ConstLanes declared, Lanes theta) const override { space_.unconstrain(declared, theta); }

  mutable int lanes = 0;

 private:
  ParameterSpace const& space_;
  std::function<double(std::vector<double> const&)> value_;
};

Draws draws_of(ParameterSpace const& space, int count) {
  Draws draws;
  draws.parameter_count = space.dimension();
  draws.chains.resize(1);
  for (int d = 0; d < count; ++d) draws.chains[0].values.emplace_back(static_cast<std::size_t>(space.dimension()), 0.1 + 0.001 * d);
  return draws;
}

std::vector<std::string> said(Findings const& findings) {
  std::vector<std::string> names;
  for (Finding const& each : findings) names.push_back(each.names.front());
  return names;
}

}  // namespace

TEST_CASE("an element of a vector that has no influence in one experiment is named") {
  ParameterSpace const space(
      test::model_of("input u\nparameter a ~ normal(0, sd = 1)\nparameter c(2) per experiment ~ normal(0, sd "
                     "= 1)\nobserve d ~ normal(a*u + c[1]*u + c[2]*u^2, sd = 1)"),
      {{"bench", {}}, {"road", {}}});
  REQUIRE(space.infos()[4].name == "c[2,road]");
  WrittenLikelihood const target(space,
                                 [](std::vector<double> const& x) { return -(x[0] * x[0] + x[1] * x[1] + x[2] + x[3] * x[3]); });
  CHECK(said(check_influence(space, target, draws_of(space, 30))) == std::vector<std::string>{"c[2,road]"});
  CHECK(check_influence(space, target, draws_of(space, 23)).empty());
}

TEST_CASE("nothing is simulated where no parameter is asked of") {
  ParameterSpace const space(test::model_of("input u\nparameter a ~ normal(0, sd = 1)\nparameter k ~ normal(a, sd = 1)\n"
                                            "parameter spread ~ half_normal(1)\nparameter z ~ normal(k, sd = spread)\n"
                                            "derive e = z\nobserve d ~ normal(u, sd = 1)"),
                             {{"", {}}});
  WrittenLikelihood const target(space, [](std::vector<double> const&) { return 0; });
  CHECK(check_influence(space, target, draws_of(space, 30)).empty());
  CHECK(target.lanes == 0);
}
