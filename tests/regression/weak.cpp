// The weak form on signals whose integrals are known, and its covariance against the dense one.
#include "regression/weak/weak.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <limits>

#include "linear_algebra/decompositions.hpp"
#include "regression/problems.hpp"
#include "regression/weak/pieces.hpp"
#include "regression/weak/test_function.hpp"

using namespace sysid;
using namespace sysid::regression;

namespace {

constexpr int half = 20, power = 8;
constexpr double step = 0.01;

Settings settings_with(int stride) {
  Settings settings(weak::settings());
  settings.set("half_width", std::int64_t{half});
  settings.set("step", std::int64_t{stride});
  return settings;
}

Experiment sampled(int rows, double (*y)(double), double (*x)(double) = nullptr, InputRule rule = InputRule::linear) {
  Experiment experiment;
  experiment.name = "made";
  std::vector<double> input;
  experiment.measured.emplace_back();
  for (int i = 0; i < rows; ++i) {
    double const t = step * (i - rows / 2);
    experiment.time.push_back(t);
    experiment.measured.front().push_back(y(t));
    input.push_back(x ? x(t) : 0);
  }
  experiment.inputs = {InputSignal(rule, experiment.time, input)};
  experiment.scored.assign(static_cast<std::size_t>(rows), 1);
  return experiment;
}

/// integral phi f around `centre`, on a grid fine enough to be taken for exact.
template <class Function>
double integral(double centre, Function f) {
  TestFunction const phi(power);
  int const n = 200000;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    double const s = -1 + (2.0 * i + 1) / n;
    sum += phi.derivative(0, s) * f(centre + s * half * step) * 2.0 / n;
  }
  return sum;
}

struct Fixture {
  Dictionary d;
  sysid::Term y, v, a, x, t;

  Fixture()
      : y(leaf(d, Symbol::Kind::state, 0, 0)),
        v(leaf(d, Symbol::Kind::state, 0, 1)),
        a(leaf(d, Symbol::Kind::state, 0, 2)),
        x(leaf(d, Symbol::Kind::input, 0, 0)),
        t(leaf(d, Symbol::Kind::time, 0, 0)) {
    d.states = {"y"};
    d.channels = {{.name = "y", .state = 0, .noise_sd = 0.1}};
  }
};

}  // namespace

TEST_CASE("derivatives move onto the test function, and integrals are those of calculus") {
  Fixture f;
  f.d.equations.push_back({.name = "y",
                           .known = f.a.id,
                           .terms = {{"y'", f.v.id},
                                     {"y*y'", (f.y * f.v).id},
                                     {"abs(y)*y'", (abs(f.y) * f.v).id},
                                     {"y^3", (f.y * f.y * f.y).id},
                                     {"t*y", (f.t * f.y).id},
                                     {"2*y' - y/4", (2.0 * f.v - f.y / 4.0).id}}});
  Experiment const experiment = sampled(201, [](double t) { return t * t - 0.3 * t * t * t - 0.2; });
  std::vector<Experiment> const experiments = {experiment};
  auto const projection = weak::project(f.d, experiments, settings_with(40));
  REQUIRE_FALSE(any_fatal(projection->concerns(0)));
  CHECK(projection->concerns(0).empty());  // nothing needed a smoothed derivative
  Columns const& columns = projection->columns(0);
  REQUIRE(columns.known.size() == 5);
  for (int k = 0; k < 5; ++k) {
    double const centre = experiment.time[static_cast<std::size_t>(half + 40 * k)];
    auto const y = [](double t) { return t * t - 0.3 * t * t * t - 0.2; };
    auto const v = [](double t) { return 2 * t - 0.9 * t * t; };
    double const expected[] = {integral(centre, v),
                               integral(centre, [&](double t) { return y(t) * v(t); }),
                               integral(centre, [&](double t) { return std::abs(y(t)) * v(t); }),
                               integral(centre, [&](double t) { return y(t) * y(t) * y(t); }),
                               integral(centre, [&](double t) { return t * y(t); }),
                               integral(centre, [&](double t) { return 2 * v(t) - y(t) / 4; })};
    CHECK(columns.known(k) == doctest::Approx(integral(centre, [](double t) { return 2 - 1.8 * t; })).epsilon(1e-6));
    // Euler and Maclaurin: phi'' has six zero derivatives at the ends, so the trapezoidal rule errs by h^8 B_8/8! (phi'' y)^(7), a
    // few 1e-8 of 0.5 here, and less for fewer derivatives. abs has a kink, whose potential y|y|/2 bends at it: h^3.
    for (int j = 0; j < 6; ++j) CHECK(columns.terms(k, j) == doctest::Approx(expected[j]).epsilon(j == 2 ? 1e-4 : 1e-7).scale(0.1));
  }
}

TEST_CASE("inputs are integrated on their own polynomials under every rule") {
  for (InputRule const rule : {InputRule::zero_order, InputRule::linear, InputRule::cubic}) {
    Fixture f;
    f.d.equations.push_back({.name = "y", .known = f.x.id, .terms = {{"x^2", (f.x * f.x).id}, {"x*y", (f.x * f.y).id}}});
    Experiment const experiment = sampled(
        101, [](double t) { return 1 + t; }, [](double t) { return std::sin(40 * t) + (t > 0.05 ? 1 : 0); }, rule);
    std::vector<Experiment> const experiments = {experiment};
    auto const projection = weak::project(f.d, experiments, settings_with(20));
    Columns const& columns = projection->columns(0);
    InputSignal const& signal = experiment.inputs.front();
    auto const x = [&](double t) {
      double const place = (t - experiment.time.front()) / step;
      int const interval = std::min(99, std::max(0, static_cast<int>(place)));
      return signal.value(interval, place - interval);
    };
    for (int k = 0; k < columns.known.size(); ++k) {
      double const centre = experiment.time[static_cast<std::size_t>(half + 20 * k)];
      // 200 000 midpoints across jumps of size 1: 1e-5 at worst.
      CHECK(columns.known(k) == doctest::Approx(integral(centre, x)).epsilon(2e-5).scale(1));
      CHECK(columns.terms(k, 0) == doctest::Approx(integral(centre, [&](double t) { return x(t) * x(t); })).epsilon(2e-5).scale(1));
      // x*y is read at samples, the mean of both sides of a jump: h^2/12 (x y)'' phi.
      CHECK(columns.terms(k, 1) ==
            doctest::Approx(integral(centre, [&](double t) { return x(t) * (1 + t); })).epsilon(0.02).scale(1));
    }
  }
}

TEST_CASE("terms are taken apart by what may move") {
  Fixture f;
  auto const pieces = [&](sysid::Term term) { return *weak_pieces(f.d, term.id); };
  using Kind = Piece::Kind;
  auto moved = pieces(-3.0 * f.a);
  REQUIRE(moved.size() == 1);
  CHECK(moved[0].kind == Kind::moved);
  CHECK(moved[0].moves == 2);
  CHECK(moved[0].factor == -3);
  auto sum = pieces((f.y * f.y + 1.0) * f.v - f.x / 2.0);
  REQUIRE(sum.size() == 2);
  CHECK(sum[0].kind == Kind::potential);
  CHECK(sum[1].kind == Kind::inputs);
  CHECK(sum[1].factor == -0.5);
  for (sysid::Term const term :
       {sign(f.v), abs(f.v) * f.v, f.x * f.v, f.y * f.a, f.y * sign(f.v), select(less(f.v, 0.0), f.y, f.x)}) {
    auto const smoothed = pieces(term);
    REQUIRE(smoothed.size() == 1);
    CHECK(smoothed[0].kind == Kind::samples);
    CHECK(smoothed[0].smoothed);
  }
  CHECK_FALSE(pieces(f.y * f.x)[0].smoothed);
  Fixture velocity;  // a velocity alone is measured
  velocity.d.channels = {{.name = "v", .state = 0, .order = 1}};
  CHECK_FALSE(weak_pieces(velocity.d, velocity.y.id).has_value());
  CHECK((*weak_pieces(velocity.d, velocity.a.id))[0].moves == 1);
}

TEST_CASE("whitening is the inverse Cholesky factor of the covariance that single samples build up") {
  // Rows are linear in y here, so a record that is 1 at one sample and 0 elsewhere projects to a column of G.
  Fixture f;
  f.d.equations.push_back({.name = "y", .known = f.a.id, .terms = {{"y'", f.v.id}, {"y", f.y.id}}});
  int const rows = 80;
  Experiment experiment = sampled(rows, [](double t) { return std::sin(30 * t); });
  Settings const settings = settings_with(4);
  std::vector<Experiment> const experiments = {experiment};
  auto const projection = weak::project(f.d, experiments, settings);
  Eigen::Vector2d const coefficients(-2, -300);
  auto const residual = [&](Columns const& columns) -> Eigen::VectorXd { return columns.known - columns.terms * coefficients; };
  Eigen::MatrixXd gradient(projection->columns(0).known.size(), rows);
  for (int i = 0; i < rows; ++i) {
    std::vector<Experiment> impulse = {experiment};
    impulse[0].measured[0].assign(rows, 0.0);
    impulse[0].measured[0][static_cast<std::size_t>(i)] = 1;
    gradient.col(i) = residual(weak::project(f.d, impulse, settings)->columns(0));
  }
  Eigen::MatrixXd covariance = 0.01 * gradient * gradient.transpose();  // noise_sd 0.1
  covariance.diagonal().array() += 1e-10 * covariance.diagonal().mean();
  Eigen::MatrixXd const factor = *cholesky(covariance);
  Columns const white = projection->whitened(0, coefficients, 0);
  Eigen::VectorXd const back = factor * residual(white);
  CHECK((back - residual(projection->columns(0))).norm() < 1e-8 * back.norm());
}

TEST_CASE("the sensitivity of smoothed and nonlinear terms is their slope in each sample") {
  Fixture f;
  f.d.channels[0].noise_sd = 1;
  f.d.equations.push_back(
      {.name = "y", .known = f.v.id, .terms = {{"v^2", (f.v * f.v).id}, {"y^3", (f.y * f.y * f.y).id}, {"y*y'", (f.y * f.v).id}}});
  int const rows = 90;
  Experiment const experiment = sampled(rows, [](double t) { return std::sin(5 * t); });
  Settings const settings = settings_with(5);
  std::vector<Experiment> const experiments = {experiment};
  auto const projection = weak::project(f.d, experiments, settings);
  REQUIRE(projection->concerns(0).size() == 1);
  CHECK(projection->concerns(0)[0].kind == Concern::Kind::smoothed);
  CHECK(projection->concerns(0)[0].terms == std::vector<int>{0});
  Eigen::Vector3d const coefficients(0.3, -2, 1.5);
  auto const residual = [&](Columns const& columns) -> Eigen::VectorXd { return columns.known - columns.terms * coefficients; };
  Eigen::MatrixXd gradient(projection->columns(0).known.size(), rows);
  double const h = 1e-5;
  for (int i = 0; i < rows; ++i) {
    std::vector<Experiment> more = {experiment}, less = {experiment};
    more[0].measured[0][static_cast<std::size_t>(i)] += h;
    less[0].measured[0][static_cast<std::size_t>(i)] -= h;
    gradient.col(i) =
        (residual(weak::project(f.d, more, settings)->columns(0)) - residual(weak::project(f.d, less, settings)->columns(0))) /
        (2 * h);
  }
  Eigen::MatrixXd covariance = gradient * gradient.transpose();
  covariance.diagonal().array() += 1e-10 * covariance.diagonal().mean();
  Eigen::MatrixXd const factor = *cholesky(covariance);
  Eigen::VectorXd const back = factor * residual(projection->whitened(0, coefficients, 0));
  CHECK((back - residual(projection->columns(0))).norm() < 1e-5 * back.norm());  // differences are good to 1e-9 / h
}

TEST_CASE("windows that touch a missing sample are left out and counted, rows kept aside are not") {
  Fixture f;
  f.d.equations.push_back({.name = "y", .known = f.v.id, .terms = {{"y", f.y.id}}});
  Experiment experiment = sampled(400, [](double t) { return std::sin(3 * t); });
  std::vector<Experiment> experiments = {experiment};
  auto const whole = weak::project(f.d, experiments, settings_with(1))->columns(0).known.size();
  experiments[0].measured[0][200] = std::numeric_limits<double>::quiet_NaN();
  auto const projection = weak::project(f.d, experiments, settings_with(1));
  CHECK(projection->columns(0).known.size() == whole - (2 * half + 1));
  CHECK(projection->columns(0).known.allFinite());
  REQUIRE(projection->concerns(0).size() == 1);
  CHECK(projection->concerns(0)[0].kind == Concern::Kind::missing);
  experiments[0] = experiment;
  for (std::size_t i = 300; i < 400; ++i) experiments[0].scored[i] = 0;
  auto const part = weak::project(f.d, experiments, settings_with(1));
  CHECK(part->columns(0).known.size() == whole - 100);
  CHECK(part->concerns(0).empty());
}
