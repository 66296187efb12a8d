// Chains that jump between models against evidences in closed form; the ratio of a jump, what a tally says, findings, and the same
// bytes after interruptions.
#include "inference/jump/reversible_jump.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "inference/jump/findings.hpp"
#include "inference/jump/moves.hpp"
#include "inference/jump/plan.hpp"
#include "inference/jump/tally.hpp"
#include "inference/targets.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"
#include "replications.hpp"

using namespace sysid;
using testing::Bench;
using testing::Prior;
using testing::TestTarget;

namespace {

Settings jump_settings(std::initializer_list<std::pair<char const*, std::int64_t>> values) {
  Settings settings(jump::settings());
  for (auto const& [name, value] : values) settings.set(name, value);
  return settings;
}

bool has(Findings const& findings, FindingCode code) {
  return std::any_of(findings.begin(), findings.end(), [&](Finding const& each) { return each.code == code; });
}

/// Polynomials of degree 1 to 4 without constant, normal priors of sd 2, 40 samples of known noise; truth is of degree 2.
struct Polynomials {
  static constexpr int rows = 40;
  static constexpr double sd = 0.5, prior_sd = 2;
  Eigen::VectorXd x{rows}, y{rows};
  std::vector<TestTarget> targets;

  explicit Polynomials(std::uint64_t record) {
    Stream stream({record, Purpose::test, 0, 0});
    for (int i = 0; i < rows; ++i) {
      x(i) = -1 + 2.0 * i / (rows - 1);
      y(i) = 0.8 * x(i) - 0.6 * x(i) * x(i) + sd * stream.normal();
    }
    for (int degree = 1; degree <= 4; ++degree) {
      std::vector<std::string> names;
      std::vector<Prior> priors;
      for (int k = 1; k <= degree; ++k) names.push_back("b" + std::to_string(k)), priors.push_back({Prior::normal, 0, prior_sd});
      double const constant = -0.5 * rows * std::log(2 * std::numbers::pi * sd * sd);
      targets.emplace_back(names, priors, rows, constant,
                           [x = x, y = y, degree](std::vector<double> const& b, std::vector<double>& r) {
                             for (int i = 0; i < rows; ++i) {
                               double sum = 0;
                               for (int k = degree; k >= 1; --k) sum = (sum + b[static_cast<std::size_t>(k - 1)]) * x(i);
                               r[static_cast<std::size_t>(i)] = (y(i) - sum) / sd;
                             }
                           });
    }
  }

  /// y is normal with covariance sd^2 I + prior_sd^2 X X'.
  double log_evidence(int degree) const {
    Eigen::MatrixXd covariance = sd * sd * Eigen::MatrixXd::Identity(rows, rows);
    for (int k = 1; k <= degree; ++k) {
      Eigen::VectorXd const column = x.array().pow(k).matrix();
      covariance += prior_sd * prior_sd * column * column.transpose();
    }
    Eigen::MatrixXd const root = *cholesky(covariance);
    double const square = y.dot(Eigen::VectorXd(solve_cholesky(root, y)));
    return -0.5 * square - root.diagonal().array().log().sum() - 0.5 * rows * std::log(2 * std::numbers::pi);
  }

  std::vector<LikelihoodCandidate> candidates() const {
    std::vector<LikelihoodCandidate> all;
    for (std::size_t k = 0; k < targets.size(); ++k)
      all.push_back({"degree " + std::to_string(k + 1), 0.25, &targets[k], 0, {}, {}});
    return all;
  }
  std::vector<double> log_evidences() const { return {log_evidence(1), log_evidence(2), log_evidence(3), log_evidence(4)}; }
};

std::vector<double> probabilities(std::vector<double> const& log_evidence) {
  double const highest = *std::max_element(log_evidence.begin(), log_evidence.end());
  std::vector<double> p;
  double sum = 0;
  for (double const each : log_evidence) p.push_back(std::exp(each - highest)), sum += p.back();
  for (double& each : p) each /= sum;
  return p;
}

SelectionResult run(std::vector<LikelihoodCandidate> const& candidates, Settings const& settings, std::uint64_t seed) {
  Bench bench(seed);
  return jump::run(candidates, settings, bench.context);
}

/// A parameter over decades, whose coordinate has a Jacobian; `forgets`: it is left out.
class Scaled : public TestTarget {
 public:
  explicit Scaled(bool forgets)
      : TestTarget({"s"}, {{Prior::log_uniform, 0.1, 10}}, 1, 0,
                   [](std::vector<double> const& s, std::vector<double>& r) { r[0] = (s[0] - 4) / 0.7; }),
        forgets_(forgets) {}
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian) const override {
    TestTarget::log_prior(theta, out, jacobian && !forgets_);
  }

 private:
  bool forgets_;
};

/// Its evidence by quadrature over s.
double scaled_log_evidence() {
  double sum = 0;
  constexpr double h = 1e-4;
  for (double s = 0.1 + h / 2; s < 10; s += h) sum += h * std::exp(-0.5 * (s - 4) * (s - 4) / 0.49) / (s * std::log(100.0));
  return std::log(sum);
}

/// Its log Bayes factor against a line whose evidence is known, off the true one, in standard errors.
double off_by(bool forgets) {
  Scaled const scaled(forgets);
  TestTarget const line({"b"}, {{Prior::normal, 0, 1}}, 1, 0,
                        [](std::vector<double> const& b, std::vector<double>& r) { r[0] = b[0] - 1; });
  // N(1 | b, 1) without its constant, b ~ N(0, 1):  sqrt(1/2) exp(-1/4)
  double const of_line = -0.5 * std::log(2.0) - 0.25;
  SelectionResult const result = run({{"scaled", 0.3, &scaled, 0, {}, {}}, {"line", 0.7, &line, 0, {}, {}}},
                                     jump_settings({{"samples", 4000}, {"burn_in", 800}, {"pilot", 800}}), 3);
  REQUIRE_FALSE(result.failure);
  JumpRecord::OfModel const &a = result.jumps->models[0], &b = result.jumps->models[1];
  double const factor = a.log_bayes_factor - b.log_bayes_factor;
  return (factor - (scaled_log_evidence() - of_line)) / std::hypot(a.factor_error, b.factor_error);
}

}  // namespace

TEST_CASE("the chance of a jump is the ratio of densities over proposals, constants kept") {
  TestTarget const one({"a"}, {{Prior::normal, 0, 1}}, 1, 2.5,
                       [](std::vector<double> const&, std::vector<double>& r) { r[0] = 0; });
  TestTarget const two({"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 3}}, 1, 1.5,
                       [](std::vector<double> const&, std::vector<double>& r) { r[0] = 0; });
  std::vector<LikelihoodCandidate> const candidates = {{"one", 0.4, &one, 0, {}, {}}, {"two", 0.6, &two, 0.25, {}, {}}};
  // Proposals that are the posteriors: normal, of the priors' widths.
  auto const normal = [](std::vector<double> const& sd) {
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(std::ssize(sd), std::ssize(sd));
    for (std::size_t i = 0; i < sd.size(); ++i) covariance(static_cast<int>(i), static_cast<int>(i)) = sd[i] * sd[i];
    return marginal::Mixture({{Component(Eigen::VectorXd::Zero(std::ssize(sd)), covariance), 1, 0}});
  };
  std::vector<jump::Model> const models = {{&candidates[0], normal({1}), 0.3, 1}, {&candidates[1], normal({1, 3}), 0.4, 1}};
  jump::Place from{0, {0.7}, 0, 0}, to{1, {-0.4, 2.2}, 0, 0};
  std::vector<jump::Place*> const both = {&from, &to};
  Ledger ledger;
  jump::evaluate(models, both, ledger);
  // Priors and proposals cancel: what is left are model priors, likelihoods, units and biases.
  double const w_from = std::log(0.4) + 2.5 - 0.3, w_to = std::log(0.6) + 1.5 + 0.25 - 0.4;
  CHECK(jump::log_weight(models, from) == doctest::Approx(w_from).epsilon(1e-12));
  CHECK(jump::log_weight(models, to) == doctest::Approx(w_to).epsilon(1e-12));
  CHECK(jump::jump_acceptance(models, from, to) == doctest::Approx(std::exp(w_to - w_from)).epsilon(1e-12));
  CHECK(jump::jump_acceptance(models, to, from) == 1);
}

TEST_CASE("mean chances give the distribution that jumps leave unchanged, and their scatter its error") {
  jump::Tally tally(3, 2, 4);
  // Chances of a chain whose shares are 0.2, 0.3 and 0.5: pi_k a_kj = pi_j a_jk.
  double const share[] = {0.2, 0.3, 0.5};
  for (int chain = 0; chain < 2; ++chain)
    for (int part = 0; part < 4; ++part)
      for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
          for (int i = 0; i < 5; ++i) tally.add(chain, part, k, j, std::min(1.0, share[j] / share[k]));
  std::vector<double> const logs = jump::log_shares(tally);
  for (int k = 0; k < 3; ++k) CHECK(logs[static_cast<std::size_t>(k)] == doctest::Approx(std::log(share[k])).epsilon(1e-12));
  jump::Estimate const even = jump::estimate(tally, {0, 0, 0}, {0.2, 0.3, 0.5});
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(even.probability[k] == relative(share[k], 1e-12));
    CHECK(even.factor[k] == doctest::Approx(0).epsilon(1e-12));  // the priors are the shares
    CHECK(even.error[k] < 1e-12);
  }
  // A model that jumps never leave for again has no share.
  jump::Tally lost(2, 1, 2);
  lost.add(0, 0, 0, 1, 0);
  lost.add(0, 1, 0, 0, 1);
  CHECK(jump::log_shares(lost)[1] == -infinity);
  // Where no jump goes both ways, what is known is where the chain is.
  jump::Tally stuck(2, 1, 2);
  stuck.add(0, 0, 1, 0, 0);
  stuck.add(0, 1, 1, 1, 1);
  CHECK(jump::log_shares(stuck)[0] == -infinity);
  CHECK(jump::log_shares(stuck)[1] == 0);
}

TEST_CASE("jumps between polynomials agree with evidences in closed form within three standard errors, and so do their proposals") {
  Polynomials const problem(11);
  std::vector<double> const logs = problem.log_evidences(), exact = probabilities(logs);
  auto const candidates = problem.candidates();
  SelectionResult const result = run(candidates, jump_settings({{"samples", 5000}, {"burn_in", 1000}, {"pilot", 1000}}), 5);
  REQUIRE_FALSE(result.failure);
  REQUIRE(result.jumps);
  auto const lead = static_cast<std::size_t>(std::max_element(exact.begin(), exact.end()) - exact.begin());
  for (std::size_t m = 0; m < 4; ++m) {
    CAPTURE(m);
    JumpRecord::OfModel const& model = result.jumps->models[m];
    CHECK(std::fabs(result.models[m].probability - exact[m]) < 3 * model.error);
    CHECK(model.error < 0.01);
    CHECK(std::fabs(model.log_evidence - logs[m]) < 3 * model.evidence_error);
    if (m == lead) continue;
    CHECK(std::fabs(model.log_bayes_factor - (logs[m] - logs[lead])) < 3 * model.factor_error);
    CHECK(model.accepted_in > 0.5);
  }
  CHECK(result.findings.empty());
  // Draws of a model are those of its posterior: of degree 1 the mean is known.
  double const precision = problem.x.squaredNorm() / 0.25 + 0.25, mean = problem.x.dot(problem.y) / 0.25 / precision;
  WeightedSummary const& slope = result.models[0].summaries[0];
  auto const n = static_cast<double>(result.models[0].weight.size());
  CHECK(std::fabs(slope.mean - mean) < 4 / std::sqrt(precision * n / 3));  // a third of the draws are new
  CHECK(slope.sd == relative(1 / std::sqrt(precision), 0.1));
}

TEST_CASE("standard errors are as large as the scatter over seeds") {
  Polynomials const problem(12);
  std::vector<double> const logs = problem.log_evidences(), exact = probabilities(logs);
  auto const candidates = problem.candidates();
  double squares = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SelectionResult const result =
        run(candidates, jump_settings({{"samples", 1500}, {"burn_in", 300}, {"pilot", 400}, {"chains", 4}}), seed);
    for (std::size_t m = 0; m < 4; ++m) {
      double const z = (result.models[m].probability - exact[m]) / result.jumps->models[m].error;
      squares += z * z;
      ++count;
    }
  }
  double const rms = std::sqrt(squares / count);
  MESSAGE("rms of errors over standard errors: " << rms);
  CHECK(rms > 0.7);
  CHECK(rms < 1.4);
}

TEST_CASE("a Jacobian that is left out is seen") {
  CHECK(std::fabs(off_by(false)) < 3);
  CHECK(std::fabs(off_by(true)) > 10);
}

TEST_CASE("a model without parameters is a point that chains go to and come back from") {
  TestTarget const point({}, {}, 1, -1, [](std::vector<double> const&, std::vector<double>& r) { r[0] = 0; });
  TestTarget const line({"b"}, {{Prior::normal, 0, 1}}, 1, 0,
                        [](std::vector<double> const& b, std::vector<double>& r) { r[0] = b[0] - 1; });
  SelectionResult const result = run({{"point", 0.5, &point, 0, {}, {}}, {"line", 0.5, &line, 0, {}, {}}},
                                     jump_settings({{"samples", 3000}, {"burn_in", 500}, {"pilot", 400}}), 2);
  REQUIRE_FALSE(result.failure);
  double const factor = -1 - (-0.5 * std::log(2.0) - 0.25), exact = 1 / (1 + std::exp(-factor));
  CHECK(std::fabs(result.models[0].probability - exact) < 3 * result.jumps->models[0].error);
}

TEST_CASE("a candidate that cannot be simulated takes no part and is named; where none can, the run says so") {
  TestTarget const broken({"b"}, {{Prior::normal, 0, 1}}, 1, 0,
                          [](std::vector<double> const&, std::vector<double>& r) { r[0] = std::nan(""); });
  TestTarget const line({"b"}, {{Prior::normal, 0, 1}}, 1, 0,
                        [](std::vector<double> const& b, std::vector<double>& r) { r[0] = b[0] - 1; });
  Settings const settings = jump_settings({{"samples", 1000}, {"burn_in", 200}, {"pilot", 400}});
  SelectionResult const result = run({{"broken", 0.5, &broken, 0, {}, {}}, {"line", 0.5, &line, 0, {}, {}}}, settings, 2);
  REQUIRE_FALSE(result.failure);
  CHECK(result.models[1].probability == 1);
  CHECK(result.models[0].probability == 0);
  REQUIRE(has(result.findings, FindingCode::model_not_visited));
  CHECK(result.findings.front().names == std::vector<std::string>{"broken"});
  CHECK(run({{"broken", 1, &broken, 0, {}, {}}}, settings, 2).failure);
}

TEST_CASE("findings: each fires where it must and is silent where it must not") {
  SelectionResult result;
  result.models.resize(3);
  result.jumps.emplace();
  result.jumps->models.resize(3);
  for (std::size_t m = 0; m < 3; ++m) {
    result.models[m].name = std::string(1, static_cast<char>('a' + m));
    result.models[m].probability = m == 0 ? 0.6 : 0.2;
    JumpRecord::OfModel& of = result.jumps->models[m];
    of.error = of.factor_error = of.evidence_error = 0.01;
    of.log_bayes_factor = of.log_evidence = m == 0 ? 0 : std::log(1.0 / 3);
    of.accepted_in = of.accepted_out = 0.5;
    of.spread = 1;
    of.worth = 0.5;
  }
  std::vector<std::string> const none(3);
  CHECK(jump::check_jumps(result, none).empty());
  auto const found = [&](auto const& change) {
    SelectionResult other = result;
    change(other.jumps->models[1]);
    return jump::check_jumps(other, none);
  };
  CHECK(has(found([](JumpRecord::OfModel& of) { of.log_bayes_factor = -infinity; }), FindingCode::model_not_visited));
  CHECK(has(found([](JumpRecord::OfModel& of) { of.accepted_out = 0.01; }), FindingCode::jumps_rarely_accepted));
  CHECK(has(found([](JumpRecord::OfModel& of) { of.worth = 0.003; }), FindingCode::posterior_not_covered));
  CHECK(has(found([](JumpRecord::OfModel& of) { of.spread = 9, of.error = 0.03; }), FindingCode::visits_disagree));
  CHECK(has(found([](JumpRecord::OfModel& of) { of.log_evidence += 1; }), FindingCode::visits_disagree));
  CHECK(has(found([](JumpRecord::OfModel& of) { of.error = 0.2; }), FindingCode::probabilities_imprecise));
  CHECK(has(jump::check_jumps(result, {"", "", "no reason"}), FindingCode::model_not_visited));
  // One model alone has no jumps, and so none that are rejected.
  SelectionResult alone = result;
  alone.models.resize(1);
  alone.jumps->models.resize(1);
  alone.jumps->models[0].accepted_in = alone.jumps->models[0].accepted_out = 0;
  CHECK(jump::check_jumps(alone, {""}).empty());
}

TEST_CASE("a posterior that proposals do not cover gets a longer pilot, and where that is not enough an error") {
  // The product of three parameters is known alone: curved sheets in all directions. ln Z by quadrature over the logarithms.
  auto const product = [](std::vector<double> const& b, std::vector<double>& r) { r[0] = (b[0] * b[1] * b[2] - 2) / 0.02; };
  TestTarget const sheets({"a", "b", "c"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}, {Prior::normal, 0, 1}}, 1, 0, product);
  TestTarget const line({"b"}, {{Prior::normal, 0, 1}}, 1, -3,
                        [](std::vector<double> const& b, std::vector<double>& r) { r[0] = b[0] - 1; });
  constexpr double h = 0.02;
  double density = 0;  // of the product at 2; it hardly changes over the width of the likelihood
  for (double u = -8; u < 3; u += h)
    for (double v = -8; v < 3; v += h) {
      double const a = std::exp(u), b = std::exp(v), c = 2 / (a * b);
      density += 4 * h * h * std::exp(-0.5 * (a * a + b * b + c * c)) / std::pow(2 * std::numbers::pi, 1.5);
    }
  double const factor = std::log(density * 0.02 * std::sqrt(2 * std::numbers::pi)) - (-3 - 0.5 * std::log(2.0) - 0.25);
  for (std::uint64_t const seed : seeds(2, 4)) {
    CAPTURE(seed);
    SelectionResult const result = run({{"sheets", 0.5, &sheets, 0, {}, {}}, {"line", 0.5, &line, 0, {}, {}}},
                                       jump_settings({{"samples", 4000}, {"burn_in", 800}, {"pilot", 800}}), seed);
    REQUIRE_FALSE(result.failure);
    JumpRecord::OfModel const &a = result.jumps->models[0], &b = result.jumps->models[1];
    double const off = std::fabs(a.log_bayes_factor - b.log_bayes_factor - factor) / std::hypot(a.factor_error, b.factor_error);
    bool const doubted =
        has(result.findings, FindingCode::posterior_not_covered) || has(result.findings, FindingCode::visits_disagree);
    CHECK((off < 4 || doubted));
  }
}

TEST_CASE("few samples give a warning instead of a number that looks sure") {
  Polynomials const problem(11);
  auto const candidates = problem.candidates();
  SelectionResult const result =
      run(candidates, jump_settings({{"samples", 24}, {"burn_in", 8}, {"pilot", 100}, {"chains", 2}, {"thin", 1}}), 5);
  REQUIRE_FALSE(result.failure);
  CHECK((has(result.findings, FindingCode::probabilities_imprecise) || has(result.findings, FindingCode::model_not_visited)));
}

TEST_CASE("a run that is stopped anywhere and goes on ends in the same bytes") {
  Polynomials const problem(11);
  auto const candidates = problem.candidates();
  Settings const settings = jump_settings({{"samples", 400}, {"burn_in", 100}, {"pilot", 200}, {"chains", 3}, {"thin", 2}});
  auto const text = [](SelectionResult const& result) {
    std::string all;
    for (std::size_t m = 0; m < result.models.size(); ++m) {
      JumpRecord::OfModel const& of = result.jumps->models[m];
      all += nlohmann::json({result.models[m].probability, of.error, of.log_bayes_factor, of.log_evidence, of.visits, of.bias,
                             of.accepted_in, of.accepted_within, of.simulations})
                 .dump();
      for (int w = 0; w < result.models[m].theta.width(); ++w)
        for (int p = 0; p < result.models[m].theta.rows(); ++p) all += nlohmann::json(result.models[m].theta(p, w)).dump();
    }
    return all;
  };
  int questions = 0;
  Bench whole(4);
  whole.context.interrupted = [&] { return ++questions < 0; };
  SelectionResult const unbroken = jump::run(candidates, settings, whole.context);
  REQUIRE_FALSE(unbroken.failure);
  for (int part = 1; part < 12; ++part) {
    CAPTURE(part);
    int const stop = questions * part / 12 + 1;
    nlohmann::json state;
    int asked = 0;
    Bench first(4);
    first.context.interrupted = [&] { return ++asked >= stop; };
    first.context.checkpoint = [&](nlohmann::json const& stored) { state = stored; };
    SelectionResult const broken = jump::run(candidates, settings, first.context);
    CHECK(broken.interrupted);
    REQUIRE_FALSE(state.is_null());
    Bench second(4);
    second.context.resume = std::make_shared<nlohmann::json const>(nlohmann::json::from_cbor(nlohmann::json::to_cbor(state)));
    SelectionResult const resumed = jump::run(candidates, settings, second.context);
    REQUIRE_FALSE(resumed.failure);
    CHECK(text(resumed) == text(unbroken));
    CHECK(second.ledger.solves() == whole.ledger.solves());
  }
  // Of other settings it is refused.
  Bench other(4);
  other.context.resume = std::make_shared<nlohmann::json const>(nlohmann::json{{"identity", "of another"}});
  SelectionResult const refused = jump::run(candidates, settings, other.context);
  REQUIRE(refused.failure);
  CHECK(refused.failure->code == FindingCode::checkpoint_mismatch);
}
