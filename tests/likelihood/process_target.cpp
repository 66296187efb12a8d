// The Target of a model with Gaussian processes against the textbook's regression in extended precision, its gradient against
// differences, and what it integrates out.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "gaussian_process/textbook.hpp"
#include "likelihood/process/process_target.hpp"
#include "load/load.hpp"
#include "relative.hpp"

using namespace sysid;
namespace gp = gaussian_process;

namespace {

Model process_model(std::string const& text) {
  Source source("case.sysid", text);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return file->models.front();
}

struct ProcessCase {
  Experiment experiment;
  std::shared_ptr<ProcessModel const> model;
  std::shared_ptr<ParameterSpace const> space;
  std::unique_ptr<ProcessTarget> target;

  ProcessCase(std::string const& text, int rows, int inputs, int threads = 1) {
    Stream stream(StreamKey{.seed = 3});
    for (int i = 0; i < rows; ++i) experiment.time.push_back(0.1 * i);
    for (int k = 0; k < inputs; ++k) {
      std::vector<double> samples;
      for (int i = 0; i < rows; ++i) samples.push_back(stream.normal());
      experiment.inputs.emplace_back(InputRule::linear, experiment.time, samples);
    }
    experiment.measured.emplace_back();
    for (int i = 0; i < rows; ++i) experiment.measured[0].push_back(1e-3 * (2 + stream.normal()));  // SI: metres
    experiment.measured[0][5] = std::nan("");
    experiment.scored.assign(static_cast<std::size_t>(rows), 1);
    experiment.scored[0] = 0;
    model = std::make_shared<ProcessModel const>(process_model(text), false, "rk4");
    space = std::make_shared<ParameterSpace const>(model->reduced(), std::vector<ExperimentMember>{{"case", {}}});
    TargetOptions options;
    options.execution.threads = threads;
    target = std::make_unique<ProcessTarget>(model, space, std::vector<Experiment>{experiment}, options);
  }
  std::vector<int> rows() const {
    std::vector<int> kept;
    for (int i = 1; i < static_cast<int>(experiment.time.size()); ++i)
      if (i != 5) kept.push_back(i);
    return kept;
  }
  double input(int which, int row) const { return experiment.inputs[static_cast<std::size_t>(which)].sample(row); }
};

std::string const two_kernels = R"(
model line {
  input u [K], v
  parameter level [mm] ~ normal(1, sd = 20)
  parameter slope [mm/K] ~ normal(0.5, sd = 3)
  parameter offset [mm] ~ uniform(-1, 1)
  parameter s [mm] ~ half_normal(sd = 2)
  parameter lu [K] ~ log_normal(median = 1, sd = 0.5)
  parameter lv ~ log_normal(median = 1, sd = 0.5)
  parameter w ~ half_normal(sd = 1)
  parameter sigma [mm] ~ log_uniform(0.05, 5)
  function rest(a, b) ~ gp(squared_exponential(amplitude = s, length = (lu, lv)) + matern32(b, amplitude = w*s, length = 2)*
                           constant(amplitude = 1))
  observe y [mm] ~ normal(level + slope*u + offset*v^2 + rest(u, v), sd = sigma)
}
)";

}  // namespace

TEST_CASE("the likelihood of a model with a Gaussian process is the textbook's, in the declared unit") {
  ProcessCase const c(two_kernels, 25, 2);
  CHECK(c.model->marginalised() == std::vector<std::string>{"level", "slope"});
  REQUIRE(c.target->dimension() == 6);  // offset, s, lu, lv, w, sigma
  LaneArray declared(6, 1), theta(6, 1);
  double const values[] = {0.4, 1.3, 0.8, 1.7, 0.6, 0.3};
  for (int p = 0; p < 6; ++p) declared(p, 0) = values[p];
  c.target->unconstrain(declared, theta);
  double found = 0;
  Ledger ledger;
  c.target->log_likelihood(theta, {&found, 1}, ledger);

  // By hand, in millimetres throughout.
  std::vector<int> const rows = c.rows();
  auto const n = static_cast<Eigen::Index>(rows.size());
  gp::Observations o{Eigen::MatrixXd(n, 2), Eigen::VectorXd(n), Eigen::MatrixXd(n, 2), Eigen::Vector2d(1, 0.5),
                     Eigen::Vector2d(20, 3)};
  for (Eigen::Index i = 0; i < n; ++i) {
    int const row = rows[static_cast<std::size_t>(i)];
    double const u = c.input(0, row), v = c.input(1, row);
    o.inputs.row(i) << u, v;
    o.columns.row(i) << 1, u;
    o.values[i] = 1e3 * c.experiment.measured[0][static_cast<std::size_t>(row)] - 0.4 * v * v;
  }
  gp::Covariance const covariance =
      gp::Covariance(*gp::find_kernel("squared_exponential"), {0, 1}) +
      gp::Covariance(*gp::find_kernel("matern32"), {1}) * gp::Covariance(*gp::find_kernel("constant"), {0, 1});
  std::vector<double> const parameters = {1.3, 0.8, 1.7, 0.6 * 1.3, 2, 1, 0.3};
  CHECK(found == doctest::Approx(gp::textbook::log_marginal_likelihood(covariance, o, parameters)).epsilon(1e-11));
}

TEST_CASE("the gradient is that of the likelihood, also where inputs of the process move with a parameter") {
  std::string const lagged = R"(
model narx {
  time discrete 0.1 [s]
  input u
  parameter c [mm] ~ normal(0, sd = 5)
  parameter s [mm] ~ half_normal(sd = 2)
  parameter lu ~ log_normal(median = 1, sd = 0.5)
  parameter lr [mm] ~ log_normal(median = 1, sd = 0.5)
  parameter sigma [mm] ~ log_uniform(0.05, 5)
  function f(a, r) ~ gp(squared_exponential(amplitude = s, length = (lu, lr)))
  observe y [mm] ~ normal(c*u + f(lags(u, 0..1), lags(residual(y), 1..2)), sd = sigma)
}
)";
  std::string const moving = R"(
model slow {
  input u
  state x [-]
  initial x = x0
  parameter x0 [-] ~ normal(1, sd = 1)
  parameter a [1/s] ~ log_normal(median = 2, sd = 0.5)
  parameter s [-] ~ half_normal(sd = 2)
  parameter lx [-] ~ log_normal(median = 1, sd = 0.5)
  parameter sigma [-] ~ log_uniform(0.05, 5)
  function f(now, force) ~ gp(squared_exponential(amplitude = s, length = (lx, 1)), zero_at = (0, 0), flat_at = (0.01, 0))
  x' = -a*x + 1 [1/s]*u
  observe y [-] ~ normal(x + f(x, u), sd = sigma)
}
)";
  for (std::string const& text : {two_kernels, lagged, moving}) {
    ProcessCase c(text, 25, text == two_kernels ? 2 : 1);
    if (text == lagged) {  // a missing sample is an input that is missing
      c.experiment.measured[0][5] = 1e-3;
      for (std::size_t i = 0; i < 4; ++i) c.experiment.scored[i] = 0;
      c.target = std::make_unique<ProcessTarget>(c.model, c.space, std::vector<Experiment>{c.experiment}, TargetOptions{});
      CHECK(c.model->marginalised().empty());
    }
    int const dimension = c.target->dimension();
    LaneArray theta(dimension, 1);
    Stream stream(StreamKey{.seed = 8});
    for (int p = 0; p < dimension; ++p) theta(p, 0) = 0.2 * stream.normal();
    LaneArray gradient(dimension, 1);
    Ledger ledger;
    double value = 0;
    c.target->log_likelihood(theta, {&value, 1}, ledger);
    double with_gradient = 0;
    c.target->log_likelihood_gradient(theta, {&with_gradient, 1}, gradient, ledger);
    CHECK(with_gradient == doctest::Approx(value).epsilon(1e-12));
    REQUIRE(std::isfinite(value));
    for (int p = 0; p < dimension; ++p) {
      // Richardson's extrapolation of central differences.
      auto const at = [&](double step) {
        LaneArray moved = theta;
        moved(p, 0) += step;
        double f = 0;
        c.target->log_likelihood(moved, {&f, 1}, ledger);
        return f;
      };
      auto const central = [&](double h) { return (at(h) - at(-h)) / (2 * h); };
      double const exact = (4 * central(5e-4) - central(1e-3)) / 3;
      CAPTURE(p);
      CHECK(gradient(p, 0) == doctest::Approx(exact).epsilon(1e-6).scale(1));
    }
  }
}

TEST_CASE("the gradient does not depend on the unit of a coordinate without bounds") {
  // The same prior and the same mean, with the stiffness in pascals and as a number near 2.
  auto const gradient_of = [](std::string const& prior, std::string const& scale) {
    ProcessCase const c(fmt::format(R"(
model bent {{
  input u
  parameter stiffness {}
  parameter s [mm] ~ half_normal(sd = 2)
  parameter lu ~ log_normal(median = 1, sd = 0.5)
  parameter sigma [mm] ~ log_uniform(0.05, 5)
  function f(a) ~ gp(squared_exponential(amplitude = s, length = lu))
  observe y [mm] ~ normal(3 [mm]*exp(-stiffness/{}) + f(u), sd = sigma)
}}
)",
                                    prior, scale),
                        25, 1);
    REQUIRE(c.target->dimension() == 4);
    LaneArray theta(4, 1), gradient(4, 1);
    theta(0, 0) = c.model->model().parameters[0].to_si(prior.starts_with("[Pa]") ? 212e9 : 2.12);
    theta(1, 0) = 0.1, theta(2, 0) = -0.2, theta(3, 0) = 0.3;
    double value = 0;
    Ledger ledger;
    c.target->log_likelihood_gradient(theta, {&value, 1}, gradient, ledger);
    REQUIRE(std::isfinite(value));
    return std::vector<double>{gradient(0, 0), gradient(1, 0), gradient(2, 0), gradient(3, 0)};
  };
  std::vector<double> const number = gradient_of("~ normal(2.1, sd = 0.05)", "1");
  std::vector<double> const pascals = gradient_of("[Pa] ~ normal(210e9, sd = 5e9)", "100 [GPa]");
  CHECK(std::abs(number[0]) > 1e-6);
  CHECK(pascals[0] * 1e11 == relative(number[0], 1e-5));
  for (std::size_t p = 1; p < 4; ++p) CHECK(pascals[p] == doctest::Approx(number[p]).epsilon(1e-6).scale(1));
}

TEST_CASE("a gradient books the solves of its neighbours, and those of them that fail") {
  ProcessCase const c(R"(
model edge {
  input u
  state x [-]
  initial x = 1
  parameter a [-] ~ normal(0, sd = 1)
  parameter s [-] ~ half_normal(sd = 2)
  parameter sigma [-] ~ log_uniform(0.05, 5)
  function f(now) ~ gp(squared_exponential(amplitude = s, length = 1))
  x' = -sqrt(a)*x*1 [1/s]
  observe y [-] ~ normal(x + f(u), sd = sigma)
}
)",
                      25, 1);
  REQUIRE(c.target->dimension() == 3);
  LaneArray theta(3, 1), gradient(3, 1);
  theta(0, 0) = 1;
  double value = 0;
  Ledger inside;
  c.target->log_likelihood_gradient(theta, {&value, 1}, gradient, inside);
  CHECK(std::isfinite(value));
  CHECK(inside.solves() == 7);
  CHECK(inside.failed() == 0);
  theta(0, 0) = 1e-7;  // nearer to the edge than a step is long
  Ledger at_edge;
  c.target->log_likelihood_gradient(theta, {&value, 1}, gradient, at_edge);
  CHECK(std::isfinite(value));
  CHECK(at_edge.solves() == 7);
  CHECK(at_edge.failed() == 1);
  // From the other side: the step is about 1e-5 of the prior's width.
  LaneArray beyond = theta;
  beyond(0, 0) += 1e-5;
  double there = 0;
  Ledger one;
  c.target->log_likelihood(beyond, {&there, 1}, one);
  CHECK(gradient(0, 0) == doctest::Approx((there - value) / 1e-5).epsilon(0.2));
  theta(0, 0) = -1;
  Ledger outside;
  c.target->log_likelihood_gradient(theta, {&value, 1}, gradient, outside);
  CHECK(value == -infinity);
  CHECK(outside.solves() == 7);
  CHECK(outside.failed() == 7);
}

TEST_CASE("a lane is the same bytes whatever the batch and the threads") {
  ProcessCase const one(two_kernels, 25, 2, 1), two(two_kernels, 25, 2, 2);
  LaneArray theta(6, 7);
  one.target->sample_prior({5, Purpose::prior, 0, 0}, theta);
  std::vector<double> all(7), threaded(7);
  Ledger ledger;
  one.target->log_likelihood(theta, all, ledger);
  two.target->log_likelihood(theta, threaded, ledger);
  CHECK(all == threaded);
  for (int w = 0; w < 7; ++w) {
    LaneArray column(6, 1);
    for (int p = 0; p < 6; ++p) column(p, 0) = theta(p, w);
    double alone = 0;
    one.target->log_likelihood(column, {&alone, 1}, ledger);
    CHECK(alone == all[static_cast<std::size_t>(w)]);
  }
}

TEST_CASE("only coefficients that nothing else reads are integrated out") {
  auto const integrated = [](std::string const& lines, std::string const& centre) {
    std::string const text =
        "model line {\n  input u\n  parameter a ~ normal(0, sd = 2)\n  parameter b ~ normal(0, sd = 2)\n  parameter l ~ "
        "log_normal(median = 1, sd = 1)\n  parameter sigma ~ log_uniform(0.1, 1)\n" +
        lines + "  function f(x) ~ gp(matern52(amplitude = 1, length = l))\n  observe y ~ normal(" + centre +
        " + f(u), sd = sigma)\n}\n";
    return ProcessModel(process_model(text), false, "rk4").marginalised();
  };
  using Names = std::vector<std::string>;
  CHECK(integrated("", "a + b*u") == Names{"a", "b"});
  CHECK(integrated("", "a*b*u") == Names{"a"});          // bilinear: one of them
  CHECK(integrated("", "exp(a*u) + b") == Names{"b"});   // not linear
  CHECK(integrated("", "a*u + sign(b)") == Names{"a"});  // of derivative 0, and not constant
  CHECK(integrated("", "a*u + (if b < 0 then u else 0)") == Names{"a"});
  CHECK(integrated("  parameter c ~ normal(b, sd = 1)\n", "a + b*u + c") == Names{"a"});  // read by a prior; c's is not constant
  CHECK(integrated("  parameter c ~ uniform(-1, 1)\n", "a + c*u + b") == Names{"a", "b"});
  CHECK(integrated("  parameter c ~ normal(0, sd = 1, lower = 0)\n", "a + c*u + b*u^2") == Names{"a", "b"});
}
