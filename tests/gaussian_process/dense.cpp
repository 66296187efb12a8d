// Regression by the whole covariance matrix: against the textbook in extended precision, closed forms, and another program's
// figures.
#include "gaussian_process/dense.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include <limits>
#include <numbers>

#include "core/numeric/not_finite.hpp"
#include "gaussian_process/leave_one_out.hpp"
#include "gaussian_process/made.hpp"
#include "gaussian_process/textbook.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::gaussian_process;

namespace {

/// 40 observations of two inputs with a mean of three columns: level, line, and a second input's square.
Observations with_mean(std::vector<double> const& sds) {
  Observations o;
  o.inputs = made_inputs(40, 2, 6);
  o.values = made_values(o.inputs, 0.1).array() + 3;
  o.columns.resize(40, 3);
  o.columns << Eigen::VectorXd::Ones(40), o.inputs.col(0), o.inputs.col(1).array().square().matrix();
  o.prior_mean = Eigen::Vector3d(0.4, 0, -0.2);
  o.prior_sd = Eigen::Map<Eigen::VectorXd const>(sds.data(), 3);
  return o;
}

Places places_of(Observations const& o) {
  Places result;
  result.inputs = made_inputs(7, 2, 9, 3);
  if (o.columns.cols() == 3) {
    result.columns.resize(7, 3);
    result.columns << Eigen::VectorXd::Ones(7), result.inputs.col(0), result.inputs.col(1).array().square().matrix();
  }
  return result;
}

/// The record of 11 points for which figures of scikit-learn 1.2.1 (Debian 12) stand below.
Observations eleven() {
  Observations o;
  o.inputs = Eigen::VectorXd::LinSpaced(11, -10, 10);
  o.values.resize(11);
  o.values << 4.75906, 1.59423, 2.99548, 5.27501, 1.66472, 2.24347, 2.8914, 4.08681, 4.60588, 0.802364, 3.92136;
  return o;
}

}  // namespace

TEST_CASE("likelihood, gradient and posterior equal the textbook's in extended precision") {
  for (bool const mean : {false, true}) {
    CAPTURE(mean);
    Observations o = with_mean({2, 0.5, 1.5});
    if (!mean) o.columns.resize(40, 0), o.prior_mean.resize(0), o.prior_sd.resize(0);
    for (Covariance const& covariance :
         {kernel("squared_exponential", {0, 1}), kernel("matern52", {0}) * kernel("matern12", {1}) + kernel("linear", {0, 1}),
          kernel("periodic", {1}) + kernel("matern32", {0, 1}) + kernel("constant", {})}) {
      std::vector<double> parameters = made_parameters(covariance.parameter_count());
      parameters.push_back(0.15);
      Marginal const found = dense_marginal(covariance, o, parameters, true);
      REQUIRE(found.outcome == Outcome::fine);
      CHECK(found.jitter == 0);
      CHECK(found.log_likelihood == doctest::Approx(textbook::log_marginal_likelihood(covariance, o, parameters)).epsilon(1e-11));
      CHECK(dense_marginal(covariance, o, parameters, false).log_likelihood == found.log_likelihood);

      Eigen::VectorXd const expected =
          differences([&](Numbers p) { return textbook::log_marginal_likelihood(covariance, o, p); }, parameters, 1e-4);
      CHECK((found.gradient - expected).norm() < 1e-8 * expected.norm());
      for (Eigen::Index i : {0, 17, 39}) {
        Observations moved = o;
        moved.values[i] += 1e-3;
        double const up = textbook::log_marginal_likelihood(covariance, moved, parameters);
        moved.values[i] -= 2e-3;
        double const down = textbook::log_marginal_likelihood(covariance, moved, parameters);
        CHECK(found.values_gradient[i] == relative((up - down) / 2e-3, 1e-8));
      }

      Places const places = places_of(o);
      DensePosterior const posterior(covariance, o, parameters);
      textbook::Posterior const book = textbook::posterior(covariance, o, parameters, places);
      Prediction const prediction = posterior.predict(places);
      Eigen::MatrixXd const joint = posterior.covariance(places);
      for (std::size_t i = 0; i < 7; ++i) {
        auto const row = static_cast<Eigen::Index>(i);
        CHECK(prediction.mean[row] == relative(static_cast<double>(book.mean[i][0]), 1e-10));
        CHECK(prediction.variance[row] == relative(static_cast<double>(book.covariance[i][i]), 1e-10));
        for (std::size_t j = 0; j < 7; ++j)
          CHECK(std::fabs(joint(row, static_cast<Eigen::Index>(j)) - static_cast<double>(book.covariance[i][j])) < 1e-10);
      }
      CHECK(posterior.log_likelihood() == found.log_likelihood);
    }
  }
}

TEST_CASE("the gradient equals the textbook's trace to 1e-10") {
  // 1/2 (alpha^T dK alpha - trace(K^-1 dK)), squared exponential of one input, the inverse in extended precision.
  Observations o;
  o.inputs = made_inputs(25, 1, 6);
  o.values = made_values(o.inputs, 0.1);
  Covariance const covariance = kernel("squared_exponential");
  std::vector<double> const parameters = {1.3, 0.9, 0.2};
  using textbook::Matrix, textbook::Real;
  Real unused = 0;
  Matrix const inverted = textbook::inverse(textbook::covariance_of(covariance, o, parameters), unused);
  Matrix const alpha = textbook::product(inverted, textbook::centred(o));
  Real expected[3] = {0, 0, 0};
  for (std::size_t i = 0; i < 25; ++i)
    for (std::size_t j = 0; j < 25; ++j) {
      Real const u =
          (Real(o.inputs(static_cast<Eigen::Index>(i), 0)) - o.inputs(static_cast<Eigen::Index>(j), 0)) / Real(parameters[1]);
      Real const k = Real(parameters[0]) * parameters[0] * std::exp(-u * u / 2);
      Real const weight = 0.5L * (alpha[i][0] * alpha[j][0] - inverted[i][j]);
      expected[0] += weight * 2 * k;
      expected[1] += weight * k * u * u;
      if (i == j) expected[2] += weight * 2 * Real(parameters[2]) * parameters[2];
    }
  Marginal const found = dense_marginal(covariance, o, parameters, true);
  for (int j = 0; j < 3; ++j) CHECK(found.gradient[j] == doctest::Approx(static_cast<double>(expected[j])).epsilon(1e-10));
}

TEST_CASE("flat coefficients are the limit of wide priors") {
  Observations const flat = with_mean({infinity, 0.5, infinity}), wide = with_mean({1e5, 0.5, 1e5});
  Covariance const covariance = kernel("matern32", {0, 1});
  std::vector<double> const parameters = {0.9, 1.1, 1.4, 0.2};
  Marginal const one = dense_marginal(covariance, flat, parameters, true),
                 other = dense_marginal(covariance, wide, parameters, true);
  REQUIRE(one.outcome == Outcome::fine);
  // The normal density at its middle, 1/(sqrt(2 pi) sd), is 1 in the flat one.
  double const constant = 2 * std::log(std::sqrt(2 * std::numbers::pi) * 1e5);
  CHECK(one.log_likelihood == doctest::Approx(other.log_likelihood + constant).epsilon(1e-8));
  CHECK((one.gradient - other.gradient).norm() < 1e-6);
  CHECK((one.values_gradient - other.values_gradient).norm() < 1e-6);
}

TEST_CASE("constant and linear kernels are Bayesian linear regression, and so are columns with priors") {
  Observations kernels;
  kernels.inputs = made_inputs(60, 2, 4);
  kernels.values =
      1.5 + 2 * kernels.inputs.col(0).array() - kernels.inputs.col(1).array() + 0.3 * made_values(kernels.inputs, 1).array();
  double const level = 2, slope0 = 1.7, slope1 = 0.6, noise = 0.4;
  std::vector<double> const parameters = {level, slope0, slope1, noise};
  Covariance const covariance = kernel("constant", {}) + kernel("linear", {0, 1});

  // Closed form: precision A = X^T X/noise^2 + S^-2, coefficients A^-1 X^T y/noise^2 (Bishop 2006, eq. 3.50, 3.51).
  Eigen::MatrixXd x(60, 3);
  x << Eigen::VectorXd::Ones(60), kernels.inputs;
  Eigen::Matrix3d precision = x.transpose() * x / (noise * noise);
  precision.diagonal() += Eigen::Vector3d(1 / (level * level), 1 / (slope0 * slope0), 1 / (slope1 * slope1));
  Eigen::Matrix3d const spread = inverse(precision);
  Eigen::Vector3d const coefficients = spread * x.transpose() * kernels.values / (noise * noise);

  Places places{made_inputs(5, 2, 10, 9), {}};
  Prediction const found = DensePosterior(covariance, kernels, parameters).predict(places);
  Eigen::MatrixXd rows(5, 3);
  rows << Eigen::VectorXd::Ones(5), places.inputs;
  CHECK((found.mean - rows * coefficients).norm() < 1e-10);
  CHECK((found.variance - (rows * spread * rows.transpose()).diagonal()).norm() < 1e-10);

  // The same as a mean beside a process too small to matter.
  Observations columns = kernels;
  columns.columns = x;
  columns.prior_mean = Eigen::Vector3d::Zero();
  columns.prior_sd = Eigen::Vector3d(level, slope0, slope1);
  std::vector<double> const small = {1e-9, noise};
  DensePosterior const posterior(kernel("constant", {}), columns, small);
  CHECK((posterior.coefficients().mean - coefficients).norm() < 1e-10);
  CHECK((posterior.coefficients().covariance - spread).norm() < 1e-12);
  CHECK(posterior.log_likelihood() ==
        doctest::Approx(dense_marginal(covariance, kernels, parameters, false).log_likelihood).epsilon(1e-10));
}

TEST_CASE("figures of scikit-learn 1.2.1 are reproduced") {
  struct Recorded {
    Covariance covariance;
    std::vector<double> parameters;
    double log_likelihood;
    std::vector<std::pair<int, double>> gradient;  // of the logarithms of amplitude^2, length, ..., noise variance
    double mean[3], observation_variance[3], covariance01;
  };
  Recorded const records[] = {
      {kernel("squared_exponential"),
       {3, 2.5, 0.7},
       -28.338883636766724,
       {{0, 2.3063897421186406}, {1, -10.039261258665714}, {2, 2.1716614749200427}},
       {2.970588853327185, 2.046347940602325, 2.2920205772180915},
       {0.8519654657734179, 0.8344152066907462, 8.446290318684861},
       -0.0048890390750059185},
      {kernel("matern32"),
       {3, 2.5, 0.7},
       -26.335396016020198,
       {{0, 0.3351286737834911}, {1, 0.9845215754148602}, {2, 0.03947816789431446}},
       {3.123540032374062, 2.336849964128159, 1.0270100471969397},
       {1.6526983916496798, 1.3121156920867598, 8.978865934506317},
       -1.9985998501309554e-06},
      {kernel("matern52") * kernel("periodic"),
       {3, 2.5, 1, 1.2, 7, 0.7},
       -27.293725120113173,
       {{0, -0.23918087756251077},
        {1, 2.26487291028732},
        {3, 2.250481741164226},
        {4, 0.29412510229223543},
        {5, -0.08975278631885057}},
       {3.1348089285458167, 2.3314008055302584, 0.22364149185622925},
       {3.1891661846575055, 2.0603511309921174, 9.437835581301858},
       0.012922174096249156},
  };
  Observations const o = eleven();
  Places places;
  places.inputs = Eigen::Vector3d(-9, 0.5, 14);
  for (Recorded const& recorded : records) {
    Marginal const found = dense_marginal(recorded.covariance, o, recorded.parameters, true);
    CHECK(found.log_likelihood == doctest::Approx(recorded.log_likelihood).epsilon(1e-12));
    for (auto const& [j, expected] : recorded.gradient) {
      bool const squared = j == 0 || j == static_cast<int>(recorded.parameters.size()) - 1;
      CHECK(found.gradient[j] * (squared ? 0.5 : 1.0) == relative(expected, 1e-10));
    }
    DensePosterior const posterior(recorded.covariance, o, recorded.parameters);
    Prediction const prediction = posterior.predict(places);
    for (int i = 0; i < 3; ++i) {
      CHECK(prediction.mean[i] == relative(recorded.mean[i], 1e-11));
      CHECK(prediction.variance[i] + 0.49 == doctest::Approx(recorded.observation_variance[i]).epsilon(1e-11));
    }
    CHECK(std::fabs(posterior.covariance(places)(0, 1) - recorded.covariance01) < 1e-12);
  }
}

TEST_CASE("jitter is used only where it is needed, reported, and limited") {
  Observations o;
  o.inputs = made_inputs(30, 1, 1);
  o.values = made_values(o.inputs, 0);
  Covariance const smooth = kernel("squared_exponential");
  std::vector<double> const exact = {1, 2, 0};
  Marginal const found = dense_marginal(smooth, o, exact, true);
  REQUIRE(found.outcome == Outcome::fine);
  CHECK(found.jitter >= 1e-12);
  CHECK(found.jitter < 1e-6);
  Marginal const refused = dense_marginal(smooth, o, exact, true, {.first = 0, .growth = 10, .most = 0});
  CHECK(refused.outcome == Outcome::not_positive_definite);
  CHECK(refused.log_likelihood == -infinity);
  CHECK(DensePosterior(smooth, o, exact, {.first = 0, .growth = 10, .most = 0}).outcome() == Outcome::not_positive_definite);
}

TEST_CASE("observations that need jitter are predicted from the others, as they are fitted") {
  Observations o;
  o.inputs = made_inputs(30, 1, 1);
  o.values = o.inputs.col(0).array().sin();
  Covariance const smooth = kernel("squared_exponential");
  std::vector<double> const exact = {1, 2, 0};
  REQUIRE(dense_marginal(smooth, o, exact, false).jitter > 0);
  Prediction const left_out = leave_one_out(smooth, o, exact);
  REQUIRE(left_out.mean.size() == 30);
  CHECK(left_out.mean.allFinite());
  CHECK(left_out.variance.minCoeff() > 0);
  // From the inner ones of 30 exact observations a smooth function is known well.
  CHECK((left_out.mean - o.values).cwiseAbs().minCoeff() < 1e-3);
}

TEST_CASE("a gradient with jitter is that of the likelihood with jitter") {
  Observations o;
  o.inputs = made_inputs(8, 1, 1);
  o.values = made_values(o.inputs, 0);
  Covariance const smooth = kernel("squared_exponential");
  // A first jitter large enough to see in differences, on a matrix that needs one.
  o.inputs.row(3) = o.inputs.row(2);
  o.inputs.row(5) = o.inputs.row(4);
  Jitter const coarse{.first = 1e-4, .growth = 10, .most = 1};
  std::vector<double> const exact = {1, 0.5, 1e-12};
  Marginal const found = dense_marginal(smooth, o, exact, true, coarse);
  REQUIRE(found.outcome == Outcome::fine);
  REQUIRE(found.jitter == relative(1e-4, 1e-12));
  Eigen::VectorXd const expected =
      differences([&](Numbers p) { return dense_marginal(smooth, o, p, false, coarse).log_likelihood; }, exact);
  CHECK((found.gradient - expected).norm() < 1e-7 * expected.norm());
}

TEST_CASE("columns that say the same with flat priors are refused, with priors they are not") {
  Observations o = with_mean({infinity, infinity, infinity});
  o.columns.col(2) = 2 * o.columns.col(1) - o.columns.col(0);
  std::vector<double> const parameters = {1, 1, 1, 0.1};
  CHECK(dense_marginal(kernel("matern12", {0, 1}), o, parameters, true).outcome == Outcome::dependent_columns);
  o.prior_sd[2] = 1;
  CHECK(dense_marginal(kernel("matern12", {0, 1}), o, parameters, true).outcome == Outcome::fine);
}

TEST_CASE("samples have the posterior's mean and covariance, and depend on their own stream alone") {
  Observations const o = with_mean({2, 0.5, 1.5});
  std::vector<double> const parameters = {0.9, 1.1, 1.4, 0.2};
  DensePosterior const posterior(kernel("matern32", {0, 1}), o, parameters);
  Places const places = places_of(o);
  int const count = 4000;
  StreamKey const key{.seed = 3, .purpose = Purpose::test};
  DensePosterior::Samples const samples = posterior.sample(places, count, key);
  REQUIRE(samples.functions.cols() == count);
  CHECK(samples.jitter == 0);
  Prediction const expected = posterior.predict(places);
  Eigen::MatrixXd const covariance = posterior.covariance(places);
  Eigen::VectorXd const mean = samples.functions.rowwise().mean();
  Eigen::MatrixXd const centred = samples.functions.colwise() - mean;
  Eigen::MatrixXd const spread = centred * centred.transpose() / (count - 1);
  for (int i = 0; i < 7; ++i) {
    CHECK(std::fabs(mean[i] - expected.mean[i]) < 4.5 * std::sqrt(expected.variance[i] / count));
    for (int j = 0; j < 7; ++j) {
      double const sd = std::sqrt((covariance(i, i) * covariance(j, j) + covariance(i, j) * covariance(i, j)) / count);
      CHECK(std::fabs(spread(i, j) - covariance(i, j)) < 4.5 * sd);
    }
  }
  CHECK((posterior.sample(places, 3, key).functions.array() == samples.functions.leftCols(3).array()).all());
}

TEST_CASE("places are predicted in blocks, and none at all") {
  Observations const o = with_mean({2, infinity, 1.5});
  std::vector<double> const parameters = {0.9, 1.1, 1.4, 0.2};
  DensePosterior const posterior(kernel("matern32", {0, 1}), o, parameters);
  Places places;
  places.inputs = made_inputs(1030, 2, 9, 4);
  places.columns.resize(1030, 3);
  places.columns << Eigen::VectorXd::Ones(1030), places.inputs.col(0), places.inputs.col(1).array().square().matrix();
  Prediction const all = posterior.predict(places);
  for (Eigen::Index i : {0, 511, 512, 1029}) {
    Prediction const one = posterior.predict({places.inputs.row(i), places.columns.row(i)});
    CHECK(one.mean[0] == doctest::Approx(all.mean[i]).epsilon(1e-12));
    CHECK(one.variance[0] == relative(all.variance[i], 1e-10));
  }
  CHECK(posterior.predict({Eigen::MatrixXd(0, 2), Eigen::MatrixXd(0, 3)}).mean.size() == 0);
}

TEST_CASE("likelihood, gradient and predictions are the same bytes twice") {
  Observations o;
  o.inputs = made_inputs(300, 2, 9);
  o.values = made_values(o.inputs, 0.1);
  std::vector<double> const parameters = {0.9, 1.1, 1.4, 0.2};
  Covariance const covariance = kernel("squared_exponential", {0, 1});
  Marginal const first = dense_marginal(covariance, o, parameters, true), second = dense_marginal(covariance, o, parameters, true);
  CHECK(first.log_likelihood == second.log_likelihood);
  CHECK((first.gradient.array() == second.gradient.array()).all());
  CHECK((first.values_gradient.array() == second.values_gradient.array()).all());
  Places const places{made_inputs(50, 2, 9, 2), {}};
  CHECK((DensePosterior(covariance, o, parameters).predict(places).variance.array() ==
         DensePosterior(covariance, o, parameters).predict(places).variance.array())
            .all());
}
