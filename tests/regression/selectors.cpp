// Selectors on problems small enough for formulas, and against an independent implementation.
#include "regression/choice/selector.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <map>

#include "core/numeric/random.hpp"
#include "data/table/table.hpp"
#include "linear_algebra/decompositions.hpp"
#include "regression/choice/triangle.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::regression;

namespace {

Choice choose(LinearProblem const& problem, std::string_view selector, std::map<std::string, SettingValue> const& given = {}) {
  SelectorRow const& row = *find_selector(selector);
  Settings settings(row.settings);
  for (auto const& [name, value] : given) settings.set(name, value);
  return row.choose(problem, settings, {});
}

/// Random columns, two of them correlated; noise as given.
LinearProblem problem(std::uint64_t seed, int rows, std::vector<double> const& truth, double noise) {
  Stream stream({seed, Purpose::test, 0, 0});
  LinearProblem result;
  auto const count = static_cast<Eigen::Index>(truth.size());
  result.terms.resize(rows, count);
  result.known = Eigen::VectorXd::Zero(rows);
  for (int i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) result.terms(i, j) = stream.normal();
    if (count > 1) result.terms(i, 1) = 0.8 * result.terms(i, 0) + 0.6 * result.terms(i, 1);
    for (Eigen::Index j = 0; j < count; ++j) result.known(i) += truth[static_cast<std::size_t>(j)] * result.terms(i, j);
    result.known(i) += noise * stream.normal();
  }
  result.always.assign(truth.size(), 0);
  return result;
}

std::vector<int> kept(Choice const& choice) {
  std::vector<int> terms;
  for (std::size_t j = 0; j < choice.terms.size(); ++j)
    if (choice.terms[j].kept) terms.push_back(static_cast<int>(j));
  return terms;
}

}  // namespace

TEST_CASE("least squares on a support is that of the normal equations") {
  LinearProblem const p = problem(1, 50, {2, 0, -1, 0.5}, 0.1);
  Support const support = least_squares(p, {0, 2});
  Eigen::MatrixXd a(50, 2);
  a << p.terms.col(0), p.terms.col(2);
  Eigen::MatrixXd const inverse = sysid::inverse(a.transpose() * a);
  Eigen::VectorXd const w = inverse * a.transpose() * p.known;
  double const variance = (p.known - a * w).squaredNorm() / 48;
  CHECK((support.coefficient - w).norm() < 1e-12);
  CHECK(support.noise_sd == doctest::Approx(std::sqrt(variance)).epsilon(1e-12));
  CHECK((support.covariance - variance * inverse).norm() < 1e-12 * support.covariance.norm() * 100);
}

TEST_CASE("the Bayes factor under the beta prime prior is the integral of Zellner's over g") {
  // pi(g) = g^b (1 + g)^(-a - b - 2) / B(a + 1, b + 1), a = -3/4, b = (n - p)/2 - a - 2 (Maruyama and George 2011).
  for (double const n : {12.0, 40.0})
    for (double const p : {1.0, 3.0})
      for (double const q : {0.9, 0.2, 0.01}) {
        double const a = -0.75, b = (n - p) / 2 - a - 2;
        double const log_beta = std::lgamma(a + 1) + std::lgamma(b + 1) - std::lgamma(a + b + 2);
        double sum = 0;
        double const h = 1e-3;
        for (double u = -60; u < 90; u += h) {  // g = e^u
          double const g = std::exp(u);
          double const log_prior = b * u - (a + b + 2) * std::log1p(g) - log_beta;
          sum += h * std::exp(log_bayes_factor(CoefficientPrior::zellner, n, p, q, 1, g) + log_prior + u);
        }
        CHECK(log_bayes_factor(CoefficientPrior::beta_prime, n, p, q, 1, 0) == doctest::Approx(std::log(sum)).epsilon(1e-6));
      }
  for (CoefficientPrior const prior : {CoefficientPrior::beta_prime, CoefficientPrior::unit_information, CoefficientPrior::zellner})
    CHECK(log_bayes_factor(prior, 20, 0, 1, 1, 20) == doctest::Approx(0).scale(1));
}

TEST_CASE("inclusion probabilities of an orthogonal design are those of the formula") {
  // Two orthogonal columns of 8 rows; what each explains of the squares adds up.
  LinearProblem p;
  p.terms.resize(8, 2);
  p.known.resize(8);
  for (int i = 0; i < 8; ++i) {
    double const first = i < 4 ? 1 : -1, second = i % 2 == 0 ? 1 : -1, rest = i % 4 < 2 ? 1 : -1;
    p.terms.row(i) << 5 * first, 0.01 * second;
    p.known(i) = 1.2 * first + 0.5 * second + 0.7 * rest;
  }
  p.always = {0, 0};
  double const total = 1.44 + 0.25 + 0.49, n = 8;
  auto const weight = [&](double q, int size) { return std::pow(1 + n, -size / 2.0) * std::pow(q, -n / 2); };
  double const none = 1, one = weight((0.25 + 0.49) / total, 1), other = weight((1.44 + 0.49) / total, 1),
               both = weight(0.49 / total, 2);
  Choice const uniform = choose(p, "spike_slab", {{"prior", std::string("unit_information")}, {"sizes", std::string("uniform")}});
  double const sum = none + one + other + both;
  CHECK(uniform.terms[0].measure == doctest::Approx((one + both) / sum).epsilon(1e-10));
  CHECK(uniform.terms[1].measure == doctest::Approx((other + both) / sum).epsilon(1e-10));
  CHECK(uniform.joint(0, 1) == doctest::Approx(both / sum).epsilon(1e-10));
  // Coefficients on a support are projections; averaged, they carry the inclusion probability.
  CHECK(uniform.terms[0].mean == relative(1.2 / 5 * (one + both) / sum, 1e-10));
  CHECK(uniform.terms[1].mean == doctest::Approx(0.5 / 0.01 * (other + both) / sum).epsilon(1e-10));
  // Equal probability of sizes: the two supports of one term share theirs.
  Choice const sizes = choose(p, "spike_slab", {{"prior", std::string("unit_information")}});
  double const of_sizes = none + one / 2 + other / 2 + both;
  CHECK(sizes.terms[0].measure == doctest::Approx((one / 2 + both) / of_sizes).epsilon(1e-10));
  double probability = 0;
  for (Support const& support : sizes.supports) probability += support.probability;
  CHECK(probability == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("chains find what enumeration finds, and the same bytes twice") {
  LinearProblem const p = problem(7, 60, {1, 0, 0.25, 0, 0, 0.2, 0, 0, 0.3}, 1);
  Choice const exact = choose(p, "spike_slab");
  Choice const sampled = choose(p, "spike_slab", {{"enumerate", std::int64_t{0}}});
  CHECK(exact.exact);
  CHECK_FALSE(sampled.exact);
  CHECK(exact.iterations == 512);
  for (std::size_t j = 0; j < 9; ++j) {
    // What no chain weighed is missing: supports whose probability is small beside 1/800 sweeps.
    CHECK(sampled.terms[j].measure == doctest::Approx(exact.terms[j].measure).epsilon(0.02).scale(1));
    CHECK(sampled.terms[j].measure > 0);
  }
  Choice const again = choose(p, "spike_slab", {{"enumerate", std::int64_t{0}}});
  for (std::size_t j = 0; j < 9; ++j) CHECK(sampled.terms[j].measure == again.terms[j].measure);
}

TEST_CASE("a term that is always in stays in, with a flat prior") {
  LinearProblem p = problem(3, 40, {0, 0, 1, 0}, 0.5);
  p.always[3] = 1;
  for (char const* selector : {"spike_slab", "ard", "threshold"}) {
    CAPTURE(selector);
    Choice const choice = choose(p, selector);
    CHECK(choice.terms[3].kept);
    CHECK(choice.terms[2].kept);
  }
  // The Bayes factor of the others is that of what the always one leaves.
  Choice const choice = choose(p, "spike_slab", {{"supports", std::int64_t{8}}});
  Eigen::VectorXd const z = p.terms.col(3).normalized();
  Eigen::VectorXd const b = p.known - z * z.dot(p.known), a = p.terms.col(2) - z * z.dot(p.terms.col(2));
  double const q = 1 - std::pow(a.dot(b), 2) / a.squaredNorm() / b.squaredNorm();
  for (Support const& support : choice.supports)
    if (support.terms == std::vector<int>{2, 3})
      CHECK(support.log_evidence == doctest::Approx(log_bayes_factor(CoefficientPrior::beta_prime, 39, 1, q, 1, 0)).epsilon(1e-9));
}

TEST_CASE("scales of columns change nothing but the coefficients") {
  LinearProblem const p = problem(11, 80, {2, 0, 0.5, 0, -1, 0}, 0.3);
  LinearProblem scaled = p;
  for (int j = 0; j < 6; ++j) scaled.terms.col(j) *= std::pow(2.0, 20 * (j - 3));  // powers of two: exact
  for (char const* selector : {"spike_slab", "ard", "threshold"}) {
    CAPTURE(selector);
    Choice const one = choose(p, selector), other = choose(scaled, selector);
    CHECK(kept(one) == kept(other));
    for (int j = 0; j < 6; ++j) {
      auto const k = static_cast<std::size_t>(j);
      CHECK(one.terms[k].measure == other.terms[k].measure);
      CHECK(one.terms[k].mean == other.terms[k].mean * std::pow(2.0, 20 * (j - 3)));
    }
  }
}

TEST_CASE("ard agrees with scikit-learn on a recorded matrix") {
  Table const matrix = Table::read(SYSID_SOURCE_DIR "/tests/regression/fixtures/ard_matrix.csv");
  Table const result = Table::read(SYSID_SOURCE_DIR "/tests/regression/fixtures/ard_result.csv");
  LinearProblem p;
  p.terms.resize(matrix.rows(), 8);
  for (int j = 0; j < 8; ++j) {
    std::vector<double> const column = matrix.numbers(matrix.columns()[static_cast<std::size_t>(j)]);
    p.terms.col(j) = Eigen::Map<Eigen::VectorXd const>(column.data(), matrix.rows());
  }
  std::vector<double> const known = matrix.numbers("b"), mean = result.numbers("coefficient"), sd = result.numbers("sd");
  p.known = Eigen::Map<Eigen::VectorXd const>(known.data(), matrix.rows());
  p.always.assign(8, 0);
  Choice const choice = choose(p, "ard", {{"tolerance", 1e-9}});
  CHECK(choice.converged);
  for (std::size_t j = 0; j < 8; ++j) {
    CHECK(choice.terms[j].kept == (mean[j] != 0));
    CHECK(std::fabs(choice.terms[j].mean - mean[j]) <= 1e-6 * std::fabs(mean[j]));
    CHECK(std::fabs(choice.terms[j].sd - sd[j]) <= 1e-6 * sd[j]);
  }
}

TEST_CASE("ard that has dropped its last term has converged") {
  LinearProblem const nothing = problem(7, 400, {0, 0, 0}, 1);
  Choice const choice = choose(nothing, "ard", {{"prune", 10}});
  CHECK(kept(choice).empty());
  CHECK(choice.converged);
}

TEST_CASE("threshold drops by contribution, one term a round") {
  // Orthogonal: contributions are those of the terms alone, |w_j| |A_j| / |b|.
  LinearProblem p;
  p.terms = Eigen::MatrixXd::Zero(8, 3);
  p.known.resize(8);
  for (int i = 0; i < 8; ++i) {
    p.terms.row(i) << (i < 4 ? 1.0 : -1.0), (i % 2 == 0 ? 1e-6 : -1e-6), (i % 4 < 2 ? 1e6 : -1e6);
    p.known(i) = p.terms(i, 0) + 0.5e6 * p.terms(i, 1) + 1e-8 * p.terms(i, 2);
  }
  p.always = {0, 0, 0};
  double const total = std::sqrt(1 + 0.25 + 1e-4);
  Choice const choice = choose(p, "threshold");
  CHECK(kept(choice) == std::vector<int>{0, 1});
  CHECK(choice.terms[0].measure == doctest::Approx(1 / total).epsilon(1e-9));
  CHECK(choice.terms[1].measure == doctest::Approx(0.5 / total).epsilon(1e-9));
  CHECK(choice.terms[2].measure == relative(0.01 / total, 1e-9));
  CHECK(choice.terms[2].dropped_in == 1);
  CHECK(kept(choose(p, "threshold", {{"share", 0.6}})) == std::vector<int>{0});
  CHECK(kept(choose(p, "threshold", {{"share", 0.005}})) == std::vector<int>{0, 1, 2});
}

TEST_CASE("exchanges bring back a term that elimination has lost") {
  // a2 is almost a0 + a1 and explains the known side best of any one column, so forward steps and eliminations favour it.
  LinearProblem p = problem(21, 200, {1, 0, 0, 0}, 0);
  Stream stream({22, Purpose::test, 0, 0});
  for (int i = 0; i < 200; ++i) {
    p.terms(i, 2) = p.terms(i, 0) + p.terms(i, 3) + 0.3 * stream.normal();
    p.known(i) = p.terms(i, 0) + p.terms(i, 3);
  }
  std::vector<Elimination> const path = eliminate(reduce(p), p.always);
  REQUIRE(path.size() == 5);
  CHECK(path[2].terms == std::vector<int>{0, 3});
  CHECK(path.back().lost == -1);
}

namespace {

/// Probabilities of all sets of terms, by the evidences of `spike_slab`.
std::map<std::vector<int>, double> enumerated(LinearProblem const& p, std::map<std::string, SettingValue> given) {
  given["supports"] = std::int64_t{10000};
  std::map<std::vector<int>, double> all;
  for (Support const& support : choose(p, "spike_slab", given).supports) all[support.terms] = support.probability;
  return all;
}

Choice jump(LinearProblem const& p, std::uint64_t seed, std::map<std::string, SettingValue> const& given) {
  SelectorRow const& row = *find_selector("reversible_jump");
  Settings settings(row.settings);
  for (auto const& [name, value] : given) settings.set(name, value);
  SelectorContext context;
  context.seed = seed;
  return row.choose(p, settings, context);
}

}  // namespace

TEST_CASE("jumps between sets of terms agree with the enumeration of all sets, under every prior") {
  LinearProblem p = problem(21, 60, {0.4, 0, 0.25, 0, 0.2, 0, 0, 0}, 1);
  p.always[3] = 1;
  for (char const* prior : {"beta_prime", "unit_information", "zellner"})
    for (char const* sizes : {"beta_binomial", "uniform"}) {
      CAPTURE(prior);
      CAPTURE(sizes);
      auto const exact = enumerated(p, {{"prior", prior}, {"sizes", sizes}});
      Choice const all = choose(p, "spike_slab", {{"prior", prior}, {"sizes", sizes}});
      Choice const choice = jump(p, 1, {{"prior", prior}, {"sizes", sizes}, {"samples", std::int64_t{6000}}});
      CHECK(choice.converged);
      CHECK_FALSE(choice.exact);
      for (std::size_t j = 0; j < p.always.size(); ++j) {
        CAPTURE(j);
        if (p.always[j] != 0) {
          CHECK(choice.terms[j].kept);
          continue;
        }
        CHECK(std::fabs(choice.terms[j].measure - all.terms[j].measure) < 3 * choice.terms[j].measure_error + 1e-12);
        CHECK(choice.terms[j].measure_error < 0.02);
      }
      for (std::size_t s = 0; s < 3; ++s) {
        Support const& support = choice.supports[s];
        CHECK(std::fabs(support.probability - exact.at(support.terms)) < 3 * support.probability_error);
      }
    }
}

TEST_CASE("errors of inclusion probabilities are as large as their scatter over seeds") {
  LinearProblem const p = problem(22, 50, {0.4, 0.1, 0.25, 0, 0.2, 0}, 1);
  Choice const exact = choose(p, "spike_slab");
  double squares = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Choice const choice = jump(p, seed, {{"samples", std::int64_t{1500}}, {"burn_in", std::int64_t{300}}});
    for (std::size_t j = 0; j < p.always.size(); ++j) {
      double const z = (choice.terms[j].measure - exact.terms[j].measure) / choice.terms[j].measure_error;
      squares += z * z;
      ++count;
    }
  }
  double const rms = std::sqrt(squares / count);
  MESSAGE("rms of errors over standard errors: " << rms);
  CHECK(rms > 0.7);
  CHECK(rms < 1.4);
}

TEST_CASE("exact data leave the chains one set of terms, and nothing that is not a number") {
  LinearProblem const p = problem(23, 30, {2, 0, -1, 0}, 0);
  Choice const choice = jump(p, 1, {{"samples", std::int64_t{600}}, {"burn_in", std::int64_t{100}}});
  CHECK(kept(choice) == std::vector<int>{0, 2});
  for (TermChoice const& term : choice.terms) CHECK(std::isfinite(term.mean));
}

TEST_CASE("error reduction ratios are what terms add to the share of the squares that is explained") {
  LinearProblem const p = problem(11, 80, {1, 0, 0.4, 0, 0, 0.2}, 0.1);
  Choice const choice = choose(p, "forward");
  CHECK(kept(choice) == std::vector<int>{0, 2, 5});
  double sum = 0;
  for (int const term : kept(choice)) sum += choice.terms[static_cast<std::size_t>(term)].measure;
  Support const support = least_squares(p, kept(choice));
  double const left = support.noise_sd * support.noise_sd * (80 - 3);
  CHECK(sum == doctest::Approx(1 - left / p.known.squaredNorm()).epsilon(1e-10));
  CHECK(kept(choose(p, "forward", {{"least_ratio", 0.05}})) == std::vector<int>{0, 2});
}

TEST_CASE("forward selection drops the term that two others made needless") {
  // The first column is nearly the sum of the second and the third, which the known side is made of.
  Stream stream({5, Purpose::test, 0, 0});
  LinearProblem p;
  p.terms.resize(60, 4);
  p.known.resize(60);
  for (int i = 0; i < 60; ++i) {
    double const a = stream.normal(), b = stream.normal();
    p.terms.row(i) << a + b + 0.3 * stream.normal(), a, b, stream.normal();
    p.known(i) = a + b + 0.01 * stream.normal();
  }
  p.always = {0, 0, 0, 0};
  Choice const choice = choose(p, "forward");
  CHECK(choice.terms[0].measure > 0.8);  // it was taken first
  CHECK(kept(choice) == std::vector<int>{1, 2});
}
