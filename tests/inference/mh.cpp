// Metropolis-Hastings against posteriors known in closed form; resuming, reproducing, and refusing to pass off a standing chain.
#include "inference/chain/mh.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "diagnostics/convergence.hpp"
#include "diagnostics/verdict.hpp"
#include "inference/interruptions.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"
#include "search/global/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

Settings chosen(std::int64_t samples, std::int64_t burn_in, std::int64_t thin = 1, std::int64_t chains = 4) {
  Settings settings(mh::settings());
  settings.set("samples", samples);
  settings.set("burn_in", burn_in);
  settings.set("thin", thin);
  settings.set("chains", chains);
  return settings;
}

/// Three chains, thinned, that learn for a third of their iterations.
Settings short_chains(std::string const& proposal) {
  Settings settings = chosen(1200, 400, 5, 3);
  settings.set("proposal", proposal);
  return settings;
}

FitResult fit(Target const& target, Settings const& settings, std::uint64_t seed = 1) {
  Bench bench(seed);
  return mh::run(target, settings, bench.context);
}

/// y = a + b t + e, e ~ N(0, 0.1^2) known, normal priors: the posterior is Gaussian.          Bishop 2006, eq. 3.50, 3.51
struct Line {
  Eigen::VectorXd mean, sd;
  TestTarget target;
};

Line line() {
  constexpr int n = 40;
  constexpr double sigma = 0.1;
  Eigen::MatrixXd design(n, 2);
  Eigen::VectorXd y(n);
  Stream noise({11, Purpose::noise, 0, 0});
  for (int i = 0; i < n; ++i) {
    design(i, 0) = 1;
    design(i, 1) = 0.1 * i;
    y(i) = 2 - 0.5 * design(i, 1) + sigma * noise.normal();
  }
  Eigen::Vector2d const prior_mean(0, 1), prior_sd(5, 2);
  Eigen::MatrixXd precision = design.transpose() * design / (sigma * sigma);
  Eigen::VectorXd right = design.transpose() * y / (sigma * sigma);
  for (int p = 0; p < 2; ++p) {
    precision(p, p) += 1 / (prior_sd(p) * prior_sd(p));
    right(p) += prior_mean(p) / (prior_sd(p) * prior_sd(p));
  }
  auto const residuals = [=](std::vector<double> const& w, std::vector<double>& rows) {
    for (int i = 0; i < n; ++i) rows[static_cast<std::size_t>(i)] = (y(i) - w[0] - w[1] * design(i, 1)) / sigma;
  };
  return {solve_symmetric(precision, right), inverse(precision).diagonal().cwiseSqrt(),
          TestTarget({"a", "b"}, {{Prior::normal, 0, 5}, {Prior::normal, 1, 2}}, n, 0, residuals)};
}

void check_moments(FitResult const& result, Eigen::VectorXd const& mean, Eigen::VectorXd const& sd) {
  auto const summaries = summarise(result);
  REQUIRE(summaries.size() == static_cast<std::size_t>(mean.size()));
  for (std::size_t p = 0; p < summaries.size(); ++p) {
    Summary const& s = summaries[p];
    auto const i = static_cast<Eigen::Index>(p);
    CAPTURE(s.name);
    CHECK(s.ess_bulk >= 2000);
    CHECK(s.rhat < 1.01);
    CHECK(std::fabs(s.mean - mean(i)) < 3 * s.mcse_mean);
    CHECK(s.sd == relative(sd(i), 0.05));
  }
  CHECK(verdict_of(result.findings).pass);
}

std::vector<std::string> codes(FitResult const& result) {
  std::vector<std::string> all;
  for (Finding const& f : result.findings) all.emplace_back(word(f.code));
  return all;
}

bool found(FitResult const& result, std::string const& code) {
  auto const all = codes(result);
  return std::find(all.begin(), all.end(), code) != all.end();
}

}  // namespace

TEST_CASE("a line fitted to data has the posterior of Gaussian linear regression") {
  Line const known = line();
  FitResult const result = fit(known.target, chosen(12000, 2000));
  check_moments(result, known.mean, known.sd);
  CHECK(result.draws.chains.size() == 4);
  CHECK(result.draws.chains[0].values.size() == 10000);
  for (double const rate : result.acceptance_rate) CHECK(rate > 0.15);
}

TEST_CASE("a correlated Gaussian with scales spanning a factor 100 is sampled in all directions") {
  // Correlation 0.9 between neighbours, sds 1, 10^-0.5, ..., 10^-2.
  constexpr int dimension = 5;
  Eigen::MatrixXd covariance(dimension, dimension);
  Eigen::VectorXd mean(dimension), sd(dimension);
  for (int i = 0; i < dimension; ++i) {
    sd(i) = std::pow(10.0, -0.5 * i);
    mean(i) = 0.3 * i;
  }
  for (int i = 0; i < dimension; ++i)
    for (int j = 0; j < dimension; ++j) covariance(i, j) = sd(i) * sd(j) * std::pow(0.9, std::abs(i - j));
  // A prior of sd 1e4 is flat on this scale: it moves the widest sd by 5e-9.
  std::vector<Prior> const priors(dimension, Prior{Prior::normal, 0, 1e4});
  Eigen::MatrixXd const whiten = inverse(*cholesky(covariance));
  TestTarget const target({"a", "b", "c", "d", "e"}, priors, dimension, 0,
                          [=](std::vector<double> const& w, std::vector<double>& rows) {
                            Eigen::Map<Eigen::VectorXd>(rows.data(), dimension) =
                                whiten * (Eigen::Map<Eigen::VectorXd const>(w.data(), dimension) - mean);
                          });
  check_moments(fit(target, chosen(25000, 5000)), mean, sd);
}

TEST_CASE("a posterior cut off by its prior is sampled up to the bound") {
  // N(0, 1) seen through a uniform prior on (0, 10): a half normal, mean sqrt(2/pi), sd sqrt(1 - 2/pi).
  TestTarget const target({"x"}, {{Prior::uniform, 0, 10}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = w[0]; });
  FitResult const result = fit(target, chosen(15000, 3000));
  double const pi = std::numbers::pi;
  check_moments(result, Eigen::VectorXd::Constant(1, std::sqrt(2 / pi)), Eigen::VectorXd::Constant(1, std::sqrt(1 - 2 / pi)));
  for (Chain const& chain : result.draws.chains)
    for (auto const& draw : chain.values) REQUIRE(draw[0] > 0);
}

TEST_CASE("regions where the model cannot be solved are left out, counted, and do no harm") {
  // The solver fails for x > 1: what is left of N(0, 1) has mean -phi(1)/Phi(1) and variance 1 - phi/Phi - (phi/Phi)^2.
  TestTarget const target({"x"}, {{Prior::normal, 0, 100}}, 1, 0, [](std::vector<double> const& w, std::vector<double>& rows) {
    rows[0] = w[0] > 1 ? std::numeric_limits<double>::quiet_NaN() : w[0];
  });
  Bench bench;
  FitResult const result = mh::run(target, chosen(15000, 3000), bench.context);
  double const phi = std::exp(-0.5) / std::sqrt(2 * std::numbers::pi), below = 0.5 * std::erfc(-1 / std::sqrt(2.0));
  double const ratio = phi / below;
  check_moments(result, Eigen::VectorXd::Constant(1, -ratio), Eigen::VectorXd::Constant(1, std::sqrt(1 - ratio - ratio * ratio)));
  REQUIRE(bench.ledger.failures().size() == 1);
  CHECK(bench.ledger.failures()[0].where == "the test's residual");
  CHECK(bench.ledger.failed() > 1000);
}

namespace {

/// share N(-5, 0.5^2) + (1 - share) N(5, 0.5^2): twenty sds apart.
TestTarget two_modes(double share) {
  auto const density = [=](double x) {
    auto const part = [&](double centre) { return std::exp(-2 * (x - centre) * (x - centre)); };
    return std::log(share * part(-5) + (1 - share) * part(5) + 1e-300);
  };
  return TestTarget({"x"}, {{Prior::normal, 0, 20}}, 1, 700,
                    [=](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = as_residual(density(w[0]), 700); });
}

}  // namespace

TEST_CASE("a random walk does not cross from mode to mode, and says so") {
  Settings settings = chosen(4000, 1000);
  settings.set("proposal", std::string("walk"));
  FitResult const result = fit(two_modes(0.7), settings);
  REQUIRE(result.modes.size() >= 2);
  CHECK(result.modes[0].declared[0] == doctest::Approx(-5).epsilon(0.01));
  CHECK(result.modes[1].declared[0] == doctest::Approx(5).epsilon(0.01));
  // The prior is the same at both; Laplace is exact for separate Gaussians but for the prior's curvature, equal at both.
  CHECK(result.modes[1].share == doctest::Approx(0.3).epsilon(1e-3));
  CHECK(found(result, "second_mode"));
  CHECK(found(result, "chains_disagree"));
  CHECK_FALSE(verdict_of(result.findings).pass);
  int left = 0;
  for (Chain const& chain : result.draws.chains) left += chain.values.back()[0] < 0;
  CHECK(left == 3);
}

TEST_CASE("independence moves cross from mode to mode, and the draws have the modes' shares") {
  for (double const share : {0.5, 0.7, 0.97}) {
    CAPTURE(share);
    FitResult const result = fit(two_modes(share), chosen(6000, 1000));
    CHECK_FALSE(found(result, "chains_disagree"));
    CHECK_FALSE(found(result, "chains_not_converged"));
    Summary const summary = summarise(result)[0];
    CHECK(summary.ess_bulk > 5000);
    // Mean 5 - 10 share, with the prior's pull of (0.5 / 20)^2 of 5 at each.
    CHECK(std::fabs(summary.mean - (5 - 10 * share) * (1 - 0.025 * 0.025)) < 4 * summary.mcse_mean);
    for (Chain const& chain : result.draws.chains) {
      double left = 0;
      for (auto const& draw : chain.values) left += draw[0] < 0;
      CHECK(left / static_cast<double>(chain.values.size()) == doctest::Approx(share).epsilon(0.08));
    }
  }
}

TEST_CASE("a posterior that no normal distribution resembles falls back to the random walk") {
  // Rosenbrock's valley: x ~ N(0, 1), y | x ~ N(4 x^2, 0.5^2).
  TestTarget const target({"x", "y"}, {{Prior::normal, 0, 100}, {Prior::normal, 0, 1000}}, 2, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            rows[0] = w[0];
                            rows[1] = (w[1] - 4 * w[0] * w[0]) / 0.5;
                          });
  FitResult const both = fit(target, chosen(40000, 10000));
  Settings walking = chosen(40000, 10000);
  walking.set("proposal", std::string("walk"));
  FitResult const walk = fit(target, walking);
  CHECK(summarise(both)[0].ess_bulk > 0.5 * summarise(walk)[0].ess_bulk);
  Summary const x = summarise(both)[0];
  CHECK(std::fabs(x.mean) < 4 * x.mcse_mean);
}

TEST_CASE("the tutorial's spherical proposal of absurd size is caught standing still") {
  Line const known = line();
  Settings settings = chosen(3000, 1000);
  settings.set("proposal", std::string("spherical"));
  settings.set("variance", 1e4);
  FitResult const result = fit(known.target, settings);
  REQUIRE(found(result, "chain_did_not_move"));
  Verdict const verdict = verdict_of(result.findings);
  CHECK(verdict.exit_code == 1);
  std::string const list = findings_list(result.findings, Surface::command_line);
  CHECK(list.find("of the proposed moves were accepted") != std::string::npos);
  CHECK(list.find("proposal = adaptive") != std::string::npos);
}

TEST_CASE("a spherical proposal that fits gives the right posterior") {
  Line const known = line();
  Settings settings = chosen(30000, 2000);
  settings.set("proposal", std::string("spherical"));
  settings.set("variance", 4e-4);
  check_moments(fit(known.target, settings), known.mean, known.sd);
}

TEST_CASE("a chain's path depends on its own number only, not on the chains beside it") {
  Line const known = line();
  Settings settings = chosen(200, 50, 1, 2);
  settings.set("proposal", std::string("spherical"));
  settings.set("variance", 4e-4);
  settings.set("start", std::string("prior"));
  FitResult const two = fit(known.target, settings);
  settings.set("chains", std::int64_t{7});
  FitResult const seven = fit(known.target, settings);
  for (std::size_t c = 0; c < 2; ++c) CHECK(two.draws.chains[c].values == seven.draws.chains[c].values);
  CHECK(two.draws.chains[0].values != two.draws.chains[1].values);
}

TEST_CASE("one seed gives the same bytes twice, another seed others") {
  Line const known = line();
  FitResult const first = fit(known.target, chosen(400, 100), 5), again = fit(known.target, chosen(400, 100), 5);
  CHECK(same_draws(first, again));
  CHECK_FALSE(same_draws(first, fit(known.target, chosen(400, 100), 6)));
}

TEST_CASE("a run stopped anywhere and resumed gives the bytes of one that never stopped") {
  Line const known = line();
  for (char const* proposal : {"walk", "adaptive"}) {
    CAPTURE(proposal);
    Settings const settings = short_chains(proposal);
    // One question is asked before every batch: those of the search, of burn-in, and of sampling, which has fewer than iterations.
    Unbroken const whole = unbroken(mh::run, known.target, settings);
    int const questions = whole.questions;
    int searching = 0;
    Bench search_alone(9);
    search_alone.context.interrupted = [&] { return ++searching < 0; };
    Settings shortest = settings;
    shortest.set("samples", std::int64_t{5});
    shortest.set("burn_in", std::int64_t{0});
    mh::run(known.target, shortest, search_alone.context);
    REQUIRE(searching > 3);
    REQUIRE(questions > searching + 60);
    int const batches = questions - searching;
    // In the search, at the first iteration, in burn-in, around its end, in sampling, before the last batch.
    check_stops(mh::run, known.target, settings, whole,
                {3, searching, searching + batches / 8, searching + batches / 3, searching + batches * 2 / 5,
                 searching + batches / 2, searching + batches * 3 / 4, questions - 1});
  }
}

TEST_CASE("a run whose batch is given up goes on from before it, to the same bytes") {
  Line const known = line();
  for (char const* proposal : {"walk", "adaptive"}) {
    CAPTURE(proposal);
    Settings const settings = short_chains(proposal);
    GivenUp const never(known.target, -1), searched(known.target, -1);
    Bench whole(interrupted_seed), search_alone(interrupted_seed);
    mh::run(never, settings, whole.context);
    SearchResult const modes = search(searched, ObjectiveKind::posterior, search_alone.context);
    // In burn-in and in sampling; before them lie the search and the batch of the starts.
    int const count = never.batches - searched.batches - 2;
    check_given_up(mh::run, known.target, settings, {count - 2, count - count / 4, count - count / 2, count - count * 3 / 4, 1});
  }
}

TEST_CASE("every checkpoint on the way leads to the same end") {
  Line const known = line();
  Settings const settings = chosen(500, 250, 1, 3);
  Bench bench(9);
  std::vector<nlohmann::json> saved;
  bench.context.checkpoint_interval = 0;
  bench.context.checkpoint = [&](nlohmann::json const& state) { saved.push_back(state); };
  FitResult const unbroken = mh::run(known.target, settings, bench.context);
  REQUIRE(saved.size() > 50);
  for (nlohmann::json const& state : saved) {
    Bench again(9);
    again.context.resume = std::make_shared<nlohmann::json const>(state);
    CHECK(same_draws(unbroken, mh::run(known.target, settings, again.context)));
  }
}

TEST_CASE("a checkpoint of another run is refused with its reason") {
  Line const known = line();
  nlohmann::json saved;
  Bench first(9);
  first.context.interrupted = [&] { return saved.contains("next"); };
  first.context.checkpoint_interval = 0;
  first.context.checkpoint = [&](nlohmann::json const& state) { saved = state; };
  mh::run(known.target, chosen(600, 200), first.context);
  REQUIRE(saved.contains("next"));
  Bench other_seed(10);
  other_seed.context.resume = std::make_shared<nlohmann::json const>(saved);
  FitResult const refused = mh::run(known.target, chosen(600, 200), other_seed.context);
  REQUIRE(refused.failure);
  CHECK(refused.failure->message.find("seed") != std::string::npos);
  Bench other_settings(9);
  other_settings.context.resume = std::make_shared<nlohmann::json const>(saved);
  REQUIRE(mh::run(known.target, chosen(700, 200), other_settings.context).failure);
  saved["theta"] = "?";
  Bench damaged(9);
  damaged.context.resume = std::make_shared<nlohmann::json const>(saved);
  CHECK(mh::run(known.target, chosen(600, 200), damaged.context).failure->code == FindingCode::checkpoint_mismatch);
}

TEST_CASE("a prior without any solvable point is a failure with its classes, not a crash") {
  TestTarget const target({"x"}, {{Prior::uniform, 0, 1}}, 1, 0,
                          [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = infinity; });
  FitResult const result = fit(target, chosen(100, 10));
  REQUIRE(result.failure);
  CHECK(result.failure->code == FindingCode::no_finite_start);
  CHECK(result.failure->message.find("the test's residual") != std::string::npos);
  Settings settings = chosen(100, 10);
  settings.set("start", std::string("prior"));
  CHECK(fit(target, settings).failure->code == FindingCode::no_finite_start);
}

TEST_CASE("settings that leave no draws are refused") {
  CHECK(mh::refuse(chosen(1000, 100)).empty());
  CHECK_FALSE(mh::refuse(chosen(1000, 1000)).empty());
  CHECK_FALSE(mh::refuse(chosen(1000, 900, 101)).empty());
  CHECK(mh::refuse(chosen(1000, 900, 100)).empty());
}

TEST_CASE("thinned draws are every n-th of the chain, whose diagnostics use all of it") {
  Line const known = line();
  FitResult const all = fit(known.target, chosen(600, 200, 1)), thinned = fit(known.target, chosen(600, 200, 10));
  REQUIRE(thinned.draws.chains[0].values.size() == 40);
  for (std::size_t i = 0; i < 40; ++i) CHECK(thinned.draws.chains[1].values[i] == all.draws.chains[1].values[10 * i + 9]);
  CHECK(thinned.unthinned == all.unthinned);
  CHECK(summarise(thinned)[0].ess_bulk == summarise(all)[0].ess_bulk);
}

TEST_CASE("the logged densities are those of the declared parameters and of the sampler") {
  TestTarget const target({"x"}, {{Prior::uniform, 0, 10}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = w[0] - 4; });
  Chain const chain = fit(target, chosen(300, 100)).draws.chains[0];
  for (std::size_t i = 0; i < chain.values.size(); ++i) {
    double const x = chain.values[i][0];
    CHECK(chain.log_prior[i] == doctest::Approx(-std::log(10.0)).epsilon(1e-12));
    CHECK(chain.log_likelihood[i] == relative(-0.5 * (x - 4) * (x - 4), 1e-12));
    // d x / d u = x (10 - x) / 10 for x = 10 / (1 + e^-u)
    double const jacobian = std::log(x * (10 - x) / 10);
    CHECK(chain.log_density[i] == doctest::Approx(chain.log_prior[i] + chain.log_likelihood[i] + jacobian).epsilon(1e-9));
  }
}

TEST_CASE("Duffing's oscillator is identified from prior draws alone, as the tutorial's Sec. 8.4 should have it") {
  TestTarget const target = duffing(1);
  FitResult const result = fit(target, chosen(8000, 3000, 10));
  auto const summaries = summarise(result);
  double const truth[] = {1, 20, 1e4, 5e9};
  for (std::size_t p = 0; p < 4; ++p) CHECK(std::fabs(summaries[p].mean - truth[p]) < 3.5 * summaries[p].sd);
  // Relative sds over 200 records lie in 0.053-0.089, 0.059-0.11, 0.068-0.13 and 0.22-0.66 % (5 to 95 %); sd of beta sqrt(2/500).
  CHECK(summaries[0].sd < 0.0015);
  CHECK(summaries[2].sd < 20);
  CHECK(summaries[4].sd / summaries[4].mean == relative(std::sqrt(2.0 / 500), 0.1));
  CHECK(verdict_of(result.findings).pass);
}
