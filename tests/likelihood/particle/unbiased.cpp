// Estimates of the likelihood by particles have the likelihood as their mean: against the dense joint normal of short linear
// records, and against quadrature where the noise is not normal.
#include <Eigen/Core>

#include <numbers>

#include "likelihood/particle/cases.hpp"
#include "linear_algebra/decompositions.hpp"
#include "replications.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// A full run finds a mean that is off by a part of 0.03 of the sd of an estimate, which is below the likelihood; an ordinary one
/// twice as much.
int estimates() { return replications(2500, 10000); }

double dense_normal(Eigen::VectorXd const& y, Eigen::VectorXd const& mean, Eigen::MatrixXd const& covariance) {
  Eigen::VectorXd const r = y - mean;
  return -0.5 * (static_cast<double>(y.size()) * std::log(2 * std::numbers::pi) + log_absolute_determinant(covariance) +
                 r.dot(inverse(covariance) * r));
}

/// A linear system with random states, as all its samples together: x' = A x + b + L w from a normal start.
struct Linear {
  Eigen::MatrixXd drift;      // A
  Eigen::VectorXd push;       // b
  Eigen::MatrixXd diffusion;  // L q L', of white noise
  Eigen::VectorXd start;
  Eigen::MatrixXd start_covariance;
};

Eigen::MatrixXd exponential(Eigen::MatrixXd const& matrix) {
  int squarings = 0;
  Eigen::MatrixXd scaled = matrix;
  while (scaled.norm() > 0.1) scaled /= 2, ++squarings;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()), term = sum;
  for (int k = 1; k < 14; ++k) {
    term = term * scaled / k;
    sum += term;
  }
  for (; squarings > 0; --squarings) sum = sum * sum;
  return sum;
}

/// Mean and covariance of the states at all times, one after another (Van Loan 1978).
struct Joint {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};
Joint joint(Linear const& system, std::vector<double> const& time) {
  Eigen::Index const n = system.start.size(), count = static_cast<Eigen::Index>(time.size());
  Joint result{Eigen::VectorXd::Zero(n * count), Eigen::MatrixXd::Zero(n * count, n * count)};
  result.mean.head(n) = system.start;
  result.covariance.topLeftCorner(n, n) = system.start_covariance;
  for (Eigen::Index i = 0; i + 1 < count; ++i) {
    double const h = time[static_cast<std::size_t>(i + 1)] - time[static_cast<std::size_t>(i)];
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    wide.topLeftCorner(n, n) = -system.drift * h;
    wide.topRightCorner(n, n) = system.diffusion * h;
    wide.bottomRightCorner(n, n) = system.drift.transpose() * h;
    Eigen::MatrixXd const e = exponential(wide), step = e.bottomRightCorner(n, n).transpose();
    Eigen::MatrixXd affine = Eigen::MatrixXd::Zero(n + 1, n + 1);
    affine.topLeftCorner(n, n) = system.drift * h;
    affine.topRightCorner(n, 1) = system.push * h;
    result.mean.segment(n * (i + 1), n) = step * result.mean.segment(n * i, n) + exponential(affine).topRightCorner(n, 1);
    Eigen::MatrixXd const row = step * result.covariance.block(n * i, 0, n, n * (i + 1));
    result.covariance.block(n * (i + 1), 0, n, n * (i + 1)) = row;
    result.covariance.block(0, n * (i + 1), n * (i + 1), n) = row.transpose();
    result.covariance.block(n * (i + 1), n * (i + 1), n, n) =
        step * result.covariance.block(n * i, n * i, n, n) * step.transpose() + step * e.topRightCorner(n, n);
  }
  return result;
}

/// Of the scored samples that are there; channel c sees outputs.row(c) of the states, with noise of sd[c].
double joint_density(Joint const& states, Experiment const& experiment, Eigen::MatrixXd const& outputs,
                     std::vector<double> const& sd) {
  Eigen::Index const n = outputs.cols();
  std::vector<double> values, noise;
  std::vector<Eigen::VectorXd> rows;
  for (std::size_t c = 0; c < experiment.measured.size(); ++c)
    for (std::size_t i = 0; i < experiment.time.size(); ++i) {
      if (!experiment.is_scored(c, i)) continue;
      values.push_back(experiment.measured[c][i]);
      noise.push_back(sd[c] * sd[c]);
      Eigen::VectorXd row = Eigen::VectorXd::Zero(states.mean.size());
      row.segment(n * static_cast<Eigen::Index>(i), n) = outputs.row(static_cast<Eigen::Index>(c)).transpose();
      rows.push_back(row);
    }
  auto const count = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixXd sees(count, states.mean.size());
  Eigen::VectorXd y(count), variance(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    sees.row(k) = rows[static_cast<std::size_t>(k)].transpose();
    y[k] = values[static_cast<std::size_t>(k)];
    variance[k] = noise[static_cast<std::size_t>(k)];
  }
  Eigen::MatrixXd covariance = sees * states.covariance * sees.transpose();
  covariance += variance.asDiagonal();
  return dense_normal(y, sees * states.mean, covariance);
}

Model windy_oscillator() {
  Model model = parsed_model(R"(
model oscillator {
  input x
  input w
  state y
  initial y = 0.3, y' = 0
  parameter k ~ log_uniform(1, 100)
  parameter q ~ log_uniform(0.1, 10)
  parameter s0 ~ log_uniform(0.01, 10)
  constant c = 0.8
  y'' + c*y' + k*y = x + w
  observe position ~ normal(y, sd = 0.15)
  observe velocity ~ normal(y', sd = 0.6)
}
)");
  disturb(model, "q");
  random_start(model, 0, "s0");
  return model;
}

/// Unequal steps, samples that are missing or not scored, one that neither channel has.
Experiment unequal_record() {
  Experiment made;
  made.name = "record";
  made.time = {0, 0.1, 0.25, 0.3, 0.5, 0.55, 0.7, 0.85, 0.9, 1.05};
  made.inputs.emplace_back(InputRule::zero_order, made.time, std::vector<double>(made.time.size(), 2.0));
  made.scored = {1, 1, 1, 0, 1, 1, 1, 1, 1, 1};
  double const gone = std::nan("");
  made.measured = {{0.5, 0.4, 0.35, 9, -0.1, gone, 0.1, 0.3, gone, 0.2}, {gone, -0.5, gone, 9, -1, gone, 1.2, gone, 0.3, -0.4}};
  return made;
}

}  // namespace

TEST_CASE("particles: the mean of the estimates is the joint normal density of an oscillator in wind") {
  Model const model = windy_oscillator();
  Experiment const experiment = unequal_record();
  double const k = 20, q = 1.1, s0 = 0.3;
  Linear system{Eigen::MatrixXd{{0, 1}, {-k, -0.8}}, Eigen::VectorXd{{0, 2.0}}, Eigen::MatrixXd{{0, 0}, {0, q * q}},
                Eigen::VectorXd{{0.3, 0.0}}, Eigen::MatrixXd{{s0 * s0, 0}, {0, 0}}};
  double const sure = joint_density(joint(system, experiment.time), experiment, Eigen::MatrixXd::Identity(2, 2), {0.15, 0.6});
  SolverSettings solver;
  solver.substeps = 4;
  auto const target = particle_target(model, {experiment}, 64, solver);
  Bias const found = bias(*target, {k, q, s0}, sure, estimates(), 11);
  MESSAGE("z " << found.z << ", sd of an estimate " << found.relative_sd << " of the likelihood");
  CHECK(std::fabs(found.z) < 3);
  CHECK(found.relative_sd < 1);
}

TEST_CASE("particles: the mean of the estimates is the joint normal density of an Ornstein-Uhlenbeck force") {
  Model model = parsed_model(R"(
model relaxation {
  input e
  state y, w
  initial y = 1, w = 0
  parameter s ~ log_uniform(0.1, 10)
  parameter size ~ log_uniform(0.1, 10)
  constant lifetime = 0.4
  y' = -2*y + w
  w' = -w/lifetime + e
  observe position ~ normal(y, sd = 0.1)
}
)");
  disturb(model, "size");
  random_start(model, 1, "s");
  model.disturbances[0].state = 1;
  Experiment experiment;
  experiment.name = "record";
  for (int i = 0; i < 12; ++i) experiment.time.push_back(0.05 * i);
  experiment.measured = {{1.1, 0.8, 0.85, 0.9, 0.7, 0.8, 0.65, 0.5, 0.6, 0.35, 0.5, 0.3}};
  experiment.scored.assign(12, 1);
  double const s = 1.5, size = s * std::sqrt(2 / 0.4);
  Linear system{Eigen::MatrixXd{{-2, 1}, {0, -1 / 0.4}}, Eigen::VectorXd::Zero(2), Eigen::MatrixXd{{0, 0}, {0, size * size}},
                Eigen::VectorXd{{1.0, 0.0}}, Eigen::MatrixXd{{0, 0}, {0, s * s}}};
  double const sure = joint_density(joint(system, experiment.time), experiment, Eigen::MatrixXd{{1, 0}}, {0.1});
  Bias const found = bias(*particle_target(model, {experiment}, 64), {s, size}, sure, estimates(), 12);
  MESSAGE("z " << found.z << ", sd of an estimate " << found.relative_sd << " of the likelihood");
  CHECK(std::fabs(found.z) < 3);
  CHECK(found.relative_sd < 1);
}

TEST_CASE("particles: white noise is drawn anew in each step of the solver, which a fast force needs") {
  Model model = parsed_model(R"(
model gust {
  input e
  state w
  initial w = 0
  parameter s ~ log_uniform(0.1, 10)
  parameter size ~ log_uniform(0.1, 10)
  constant lifetime = 0.05
  w' = -w/lifetime + e
  observe force ~ normal(w, sd = 0.3)
}
)");
  disturb(model, "size");
  random_start(model, 0, "s");
  Experiment experiment;
  experiment.name = "record";
  experiment.measured = {{2.5, -2.8, 2.2, 1.6, -3.2, 0.4, -1.9, 2.6, -2.3, 0.9}};  // far out, where the variance counts most
  for (std::size_t i = 0; i < experiment.measured[0].size(); ++i) experiment.time.push_back(0.2 * static_cast<double>(i));
  experiment.scored.assign(experiment.time.size(), 1);
  double const s = 1.5, size = s * std::sqrt(2 / 0.05);
  Linear system{Eigen::MatrixXd{{-1 / 0.05}}, Eigen::VectorXd::Zero(1), Eigen::MatrixXd{{size * size}}, Eigen::VectorXd{{0.0}},
                Eigen::MatrixXd{{s * s}}};
  double const sure = joint_density(joint(system, experiment.time), experiment, Eigen::MatrixXd{{1}}, {0.3});
  // The force dies off within a quarter of a sampling interval. One line for the whole interval has 0.9 of its variance: the
  // likelihood of this record would be half of what it is.
  SolverSettings solver;
  solver.substeps = 8;
  Bias const found = bias(*particle_target(model, {experiment}, 256, solver), {s, size}, sure, estimates(), 15);
  MESSAGE("z " << found.z << ", sd of an estimate " << found.relative_sd << " of the likelihood");
  CHECK(std::fabs(found.z) < 3);
  CHECK(found.relative_sd < 1);
}

namespace {

std::string autoregression(std::string const& noise) {
  return R"(
model drift {
  time discrete
  input w
  state x
  initial x = 0.5
  parameter a ~ uniform(-1, 1)
  parameter q ~ log_uniform(0.01, 10)
  parameter s0 ~ log_uniform(0.01, 10)
  x = a*lag(x, 1) + w
  observe y ~ )" +
         noise + "\n}\n";
}

Experiment drift_record() {
  Experiment made;
  made.name = "record";
  made.measured = {{0.7, 0.9, 0.2, 0.1, -0.4, 1.8, 0.6, 0.9, 1.2, 0.4}};
  for (std::size_t i = 0; i < made.measured[0].size(); ++i) made.time.push_back(static_cast<double>(i));
  made.measured[0][3] = std::nan("");
  made.scored.assign(made.time.size(), 1);
  return made;
}

/// p(y) of the autoregression by the trapezoidal rule over the states, one sample after another.
template <class Density>
double by_quadrature(Experiment const& experiment, double a, double q, double s0, Density const& density) {
  int const n = 2001;
  double const low = -8, h = 16.0 / (n - 1);
  auto const normal = [](double x, double sd) {
    return std::exp(-0.5 * x * x / (sd * sd)) / (sd * std::sqrt(2 * std::numbers::pi));
  };
  std::vector<double> p(static_cast<std::size_t>(n)), next(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = normal(low + h * static_cast<double>(i) - 0.5 * a, std::hypot(a * s0, q));
  for (std::size_t t = 0; t < experiment.time.size(); ++t) {
    double const y = experiment.measured[0][t];
    for (std::size_t i = 0; i < p.size() && !std::isnan(y); ++i) p[i] *= density(y - (low + h * static_cast<double>(i)));
    if (t + 1 == experiment.time.size()) break;
    for (std::size_t j = 0; j < p.size(); ++j) {
      next[j] = 0;
      for (std::size_t i = 0; i < p.size(); ++i)
        next[j] += h * p[i] * normal(low + h * static_cast<double>(j) - a * (low + h * static_cast<double>(i)), q);
    }
    std::swap(p, next);
  }
  double total = 0;
  for (double const each : p) total += h * each;
  return std::log(total);
}

}  // namespace

TEST_CASE("particles: the mean of the estimates is the likelihood by quadrature, for normal and for Student's t noise") {
  Experiment const experiment = drift_record();
  double const a = 0.7, q = 0.6, s0 = 0.4;
  SUBCASE("normal") {
    Model model = parsed_model(autoregression("normal(x, sd = 0.5)"));
    disturb(model, "q");
    random_start(model, 0, "s0");
    double const sure = by_quadrature(
        experiment, a, q, s0, [](double r) { return std::exp(-0.5 * r * r / 0.25) / (0.5 * std::sqrt(2 * std::numbers::pi)); });
    // The joint normal once more, as it stands in every textbook: both ways of the test agree.
    Eigen::Index const n = static_cast<Eigen::Index>(experiment.time.size());
    Joint states{Eigen::VectorXd(n), Eigen::MatrixXd(n, n)};
    for (Eigen::Index i = 0; i < n; ++i) {
      states.mean[i] = 0.5 * std::pow(a, i + 1);
      for (Eigen::Index j = 0; j < n; ++j) {
        states.covariance(i, j) = std::pow(a, i + j + 2) * s0 * s0;
        for (Eigen::Index k = 0; k <= std::min(i, j); ++k) states.covariance(i, j) += std::pow(a, i + j - 2 * k) * q * q;
      }
    }
    CHECK(joint_density(states, experiment, Eigen::MatrixXd::Identity(1, 1), {0.5}) == doctest::Approx(sure).epsilon(1e-9));
    Bias const found = bias(*particle_target(model, {experiment}, 48), {a, q, s0}, sure, estimates(), 13);
    MESSAGE("z " << found.z << ", sd of an estimate " << found.relative_sd << " of the likelihood");
    CHECK(std::fabs(found.z) < 3);
  }
  SUBCASE("Student's t") {
    Model model = parsed_model(autoregression("student_t(x, 3, scale = 0.3)"));
    disturb(model, "q");
    random_start(model, 0, "s0");
    double const sure = by_quadrature(experiment, a, q, s0, [](double r) {
      return std::tgamma(2.0) / (std::tgamma(1.5) * std::sqrt(3 * std::numbers::pi) * 0.3) * std::pow(1 + r * r / (3 * 0.09), -2);
    });
    Bias const found = bias(*particle_target(model, {experiment}, 48), {a, q, s0}, sure, estimates(), 14);
    MESSAGE("z " << found.z << ", sd of an estimate " << found.relative_sd << " of the likelihood");
    CHECK(std::fabs(found.z) < 3);
  }
}
