// The no-U-turn sampler against posteriors known in closed form; resuming, reproducing, and what it reports of its trajectories.
#include "inference/nuts/nuts.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "diagnostics/verdict.hpp"
#include "inference/chain/mh.hpp"
#include "inference/interruptions.hpp"
#include "inference/nuts/trajectory_checks.hpp"
#include "linear_algebra/decompositions.hpp"
#include "replications.hpp"

namespace sysid::nuts {
namespace {

using namespace sysid::testing;

Settings chosen(std::int64_t samples, std::int64_t burn_in, std::int64_t chains = 4) {
  Settings settings(nuts::settings());
  settings.set("samples", samples);
  settings.set("burn_in", burn_in);
  settings.set("chains", chains);
  return settings;
}

FitResult fit(Target const& target, Settings const& settings, std::uint64_t seed = 1) {
  Bench bench(seed);
  return nuts::run(target, settings, bench.context);
}

bool has(FitResult const& result, FindingCode code) {
  return std::any_of(result.findings.begin(), result.findings.end(), [&](Finding const& each) { return each.code == code; });
}

/// Mean and sd within four Monte Carlo standard errors, by the effective sizes that the run states.
void check_summary(FitResult const& result, std::size_t p, double mean, double sd) {
  Summary const s = summarise(result)[p];
  CAPTURE(s.name);
  CHECK(s.rhat < 1.01);
  CHECK(s.ess_bulk >= 400);
  CHECK(std::fabs(s.mean - mean) < 4 * s.mcse_mean);
  CHECK(std::fabs(s.sd - sd) < 4 * sd / std::sqrt(2 * s.ess_bulk));
}

/// Correlated normals whose sds span a factor of 100, under wide priors; data rows L^-1 (x - m) of covariance L L^T.
struct Gaussian {
  Eigen::VectorXd mean, sd;
  TestTarget target;
};
Gaussian gaussian() {
  Eigen::Matrix3d covariance;
  covariance << 1, 0.9 * 0.1, -0.5 * 0.01, 0.9 * 0.1, 0.01, -0.6 * 0.001, -0.5 * 0.01, -0.6 * 0.001, 0.0001;
  Eigen::Vector3d const mean(1, -0.2, 0.03);
  Eigen::Matrix3d const whitening = inverse(*cholesky(covariance));
  Eigen::Matrix3d precision = inverse(covariance);
  Eigen::Vector3d right = precision * mean;
  precision.diagonal().array() += 1.0 / 100;
  Eigen::VectorXd const posterior_mean = solve_symmetric(precision, right);
  return {posterior_mean, inverse(precision).diagonal().cwiseSqrt(),
          TestTarget({"a", "b", "c"}, {{Prior::normal, 0, 10}, {Prior::normal, 0, 10}, {Prior::normal, 0, 10}}, 3, 0,
                     [=](std::vector<double> const& w, std::vector<double>& rows) {
                       Eigen::Vector3d const r = whitening * (Eigen::Vector3d(w[0], w[1], w[2]) - mean);
                       for (int i = 0; i < 3; ++i) rows[static_cast<std::size_t>(i)] = r(i);
                     })};
}

/// The same target with a gradient that is wrong in size and direction.
class WrongGradient : public TestTarget {
 public:
  using TestTarget::TestTarget;
  explicit WrongGradient(TestTarget target) : TestTarget(std::move(target)) {}
  void log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const override {
    TestTarget::log_likelihood_gradient(theta, out, gradient, ledger);
    for (int p = 0; p < theta.rows(); ++p)
      for (int w = 0; w < theta.width(); ++w) gradient(p, w) = 0.8 * gradient(p, w) + 0.2 * std::sin(theta(0, w));
  }
};

/// Neal 2003: v ~ N(0, 3^2), x_i | v ~ N(0, exp(v)).
TestTarget funnel() {
  constexpr double wide = 40;
  std::vector<Prior> priors{{Prior::normal, 0, 3}};
  std::vector<std::string> names{"v"};
  for (int i = 0; i < 4; ++i) {
    priors.push_back({Prior::normal, 0, wide});
    names.push_back("x" + std::to_string(i));
  }
  return TestTarget(names, priors, 1, 200, [](std::vector<double> const& w, std::vector<double>& rows) {
    double log_density = 0;
    for (std::size_t i = 1; i < w.size(); ++i)
      log_density += -w[0] / 2 - w[i] * w[i] / 2 * (std::exp(-w[0]) - 1 / (wide * wide)) + std::log(wide);
    rows[0] = as_residual(std::min(log_density, 199.0), 200);
  });
}

}  // namespace

TEST_CASE("a correlated Gaussian is sampled with nearly independent draws, with either metric") {
  Gaussian const known = gaussian();
  for (char const* metric : {"dense", "diagonal"}) {
    CAPTURE(metric);
    Settings settings = chosen(2500, 500);
    settings.set("metric", std::string(metric));
    FitResult const result = fit(known.target, settings);
    for (std::size_t p = 0; p < 3; ++p)
      check_summary(result, p, known.mean(static_cast<Eigen::Index>(p)), known.sd(static_cast<Eigen::Index>(p)));
    CHECK(verdict_of(result.findings).pass);
    CHECK(summarise(result)[0].ess_bulk > (std::string(metric) == "dense" ? 4000 : 1500));
    CHECK_FALSE(has(result, FindingCode::trajectories_diverge));
    CHECK_FALSE(has(result, FindingCode::trajectories_cut));
  }
}

TEST_CASE("the start at draws of the prior leads to the same posterior") {
  Gaussian const known = gaussian();
  Settings settings = chosen(2500, 1000);
  settings.set("start", std::string("prior"));
  FitResult const result = fit(known.target, settings);
  for (std::size_t p = 0; p < 3; ++p)
    check_summary(result, p, known.mean(static_cast<Eigen::Index>(p)), known.sd(static_cast<Eigen::Index>(p)));
  CHECK(result.modes.empty());
}

TEST_CASE("bounded parameters are sampled to their bounds") {
  // No data: the posterior is the prior, uniform and log-uniform.
  TestTarget const target({"u", "l"}, {{Prior::uniform, -1, 3}, {Prior::log_uniform, 0.01, 100}}, 1, 0,
                          [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = 0; });
  FitResult const result = fit(target, chosen(4000, 1000));
  check_summary(result, 0, 1, 4 / std::sqrt(12.0));
  double const log_range = std::log(1e4), mean = (100 - 0.01) / log_range;
  check_summary(result, 1, mean, std::sqrt((1e4 - 1e-4) / 2 / log_range - mean * mean));
}

TEST_CASE("a wrong gradient costs acceptance, and leaves the posterior as it is") {
  Gaussian const known = gaussian();
  WrongGradient const target{TestTarget(known.target)};
  FitResult const result = fit(target, chosen(4000, 1000));
  for (std::size_t p = 0; p < 3; ++p)
    check_summary(result, p, known.mean(static_cast<Eigen::Index>(p)), known.sd(static_cast<Eigen::Index>(p)));
}

TEST_CASE("Duffing's posterior is that of mh") {
  TestTarget const target = duffing(1);
  FitResult const result = fit(target, chosen(600, 300));
  CHECK(verdict_of(result.findings).pass);
  Bench bench(2);
  Settings walks(mh::settings());
  walks.set("samples", std::int64_t{full_size() ? 6000 : 3000});
  walks.set("burn_in", std::int64_t{full_size() ? 2000 : 1000});
  FitResult const reference = mh::run(target, walks, bench.context);
  std::vector<Summary> const drawn = summarise(result), known = summarise(reference);
  for (std::size_t p = 0; p < 5; ++p) {
    CAPTURE(drawn[p].name);
    CHECK(drawn[p].ess_bulk > 600);
    CHECK(std::fabs(drawn[p].mean - known[p].mean) < 4 * std::hypot(drawn[p].mcse_mean, known[p].mcse_mean));
    CHECK(std::fabs(drawn[p].sd - known[p].sd) < 4 * known[p].sd * std::sqrt(0.5 / drawn[p].ess_bulk + 0.5 / known[p].ess_bulk));
  }
}

TEST_CASE("chains do not depend on how many there are, and the same seed gives the same bytes") {
  Gaussian const known = gaussian();
  FitResult const four = fit(known.target, chosen(200, 100, 4)), again = fit(known.target, chosen(200, 100, 4));
  CHECK(same_draws(four, again));
  FitResult const two = fit(known.target, chosen(200, 100, 2));
  for (std::size_t c = 0; c < 2; ++c) CHECK(four.draws.chains[c].values == two.draws.chains[c].values);
  CHECK(four.draws.chains[0].values != four.draws.chains[1].values);
}

TEST_CASE("a run stopped anywhere and resumed gives the bytes of one that never stopped") {
  TestTarget const target = funnel();  // with trajectories that diverge
  for (char const* start : {"global", "prior"}) {
    CAPTURE(start);
    Settings settings = chosen(50, 25, 3);
    settings.set("depth", std::int64_t{6});
    settings.set("start", std::string(start));
    Unbroken const whole = unbroken(nuts::run, target, settings);
    int const end = whole.questions;
    check_stops(nuts::run, target, settings, whole, {3, end - 300, end - 213, end - 120, end - 57, end - 1});
  }
}

TEST_CASE("a run whose batch is given up goes on from before it, to the same bytes") {
  Settings settings = chosen(60, 30, 3);
  settings.set("start", std::string("prior"));
  check_given_up(nuts::run, gaussian().target, settings, {150, 30, 0});
}

TEST_CASE("checkpoints of another run, and damaged ones, are refused") {
  Settings const settings = chosen(60, 30, 2);
  nlohmann::json saved;
  int asked = 0;
  Bench first;
  first.context.interrupted = [&] { return ++asked > 40; };
  first.context.checkpoint = [&](nlohmann::json const& state) { saved = state; };
  TestTarget const target = gaussian().target;
  Settings from_prior = settings;
  from_prior.set("start", std::string("prior"));
  REQUIRE(nuts::run(target, from_prior, first.context).interrupted);
  auto const refused = [&](nlohmann::json const& state, Settings const& with) {
    Bench bench;
    bench.context.resume = std::make_shared<nlohmann::json const>(state);
    FitResult const result = nuts::run(target, with, bench.context);
    return result.failure && result.failure->code == FindingCode::checkpoint_mismatch;
  };
  CHECK_FALSE(refused(saved, from_prior));
  CHECK(refused(saved, settings));
  nlohmann::json fewer = saved;
  fewer["trajectories"].erase(0);
  CHECK(refused(fewer, from_prior));
  nlohmann::json text = saved;
  text["trajectories"][0] = "0 0 0";
  CHECK(refused(text, from_prior));
}

TEST_CASE("trajectories that diverge are counted, and located in the neck of a funnel") {
  FitResult const result = fit(funnel(), chosen(800, 300));
  auto const found = std::find_if(result.findings.begin(), result.findings.end(),
                                  [](Finding const& each) { return each.code == FindingCode::trajectories_diverge; });
  REQUIRE(found != result.findings.end());
  CHECK(found->names == std::vector<std::string>{"v"});
  CHECK(found->message.find("trajectories diverged") != std::string::npos);
  CHECK(found->help.find("acceptance = 0.95") != std::string::npos);
}

TEST_CASE("what is said of trajectories follows their counts") {
  TestTarget const target = gaussian().target;
  Draws draws;
  draws.names = {"a", "b", "c"};
  draws.units = {"m", "", ""};
  draws.chains.resize(1);
  for (int i = 0; i < 100; ++i) draws.chains[0].values.push_back({0.01 * i, 0.5, 0.5});
  auto const findings = [&](nuts::Tally const& tally, double acceptance = 0.8) {
    return nuts::check_trajectories({target, draws, {tally}, acceptance, 10});
  };
  CHECK(findings({1000, 0, 0, 0, {}}).empty());
  CHECK(findings({1000, 0, 0, 9, {}}).empty());
  Findings const few = findings({1000, 5, 1, 0, {0.9, 0.5, 0.5, 0.95, 0.5, 0.5, 0.9, 0.5, 0.5}});
  REQUIRE(few.size() == 1);
  CHECK(few[0].severity == Severity::warning);
  CHECK(few[0].names == std::vector<std::string>{"a"});
  CHECK(few[0].message ==
        "5 of 1000 trajectories diverged (1 where the model cannot be solved), so a part of the posterior may be missing from the "
        "draws: half of them where `a` lies between 0.9 and 0.925 m (posterior median 0.495 m)");
  CHECK(findings({1000, 10, 0, 0, {0.9, 0.5, 0.5}})[0].severity == Severity::error);
  CHECK(findings({1000, 10, 1, 0, {0.9, 0.5, 0.5}})[0].severity == Severity::warning);
  CHECK(findings({1000, 1, 0, 0, {0.9, 0.5, 0.5}}, 0.97)[0].help.find("acceptance = 0.99") != std::string::npos);
  CHECK(findings({1000, 1, 0, 0, {0.9, 0.5, 0.5}}, 0.99)[0].help.find("acceptance") == std::string::npos);
  Findings const cut = findings({1000, 0, 0, 10, {}});
  REQUIRE(cut.size() == 1);
  CHECK(cut[0].code == FindingCode::trajectories_cut);
  CHECK(cut[0].message.find("1 % of the trajectories") != std::string::npos);
  CHECK(cut[0].message.find("1023 steps") != std::string::npos);
}

TEST_CASE("trajectories that may double only once are reported as cut") {
  Settings settings = chosen(300, 100);
  settings.set("depth", std::int64_t{1});
  settings.set("acceptance", 0.99);
  CHECK(has(fit(gaussian().target, settings), FindingCode::trajectories_cut));
}

TEST_CASE("two separate modes, one chain in each: the chains disagree, and say so") {
  TestTarget const target({"x"}, {{Prior::uniform, -10, 10}}, 1, 5000, [](std::vector<double> const& w, std::vector<double>& rows) {
    double const a = -50 * (w[0] - 5) * (w[0] - 5), b = -50 * (w[0] + 5) * (w[0] + 5), high = std::max(a, b);
    rows[0] = as_residual(high + std::log(std::exp(a - high) + std::exp(b - high)), 5000);
  });
  FitResult const result = fit(target, chosen(600, 200));
  CHECK(result.modes.size() == 2);
  CHECK(has(result, FindingCode::chains_disagree));
}

TEST_CASE("settings that do not go together are refused") {
  CHECK(nuts::refuse(chosen(100, 100)).find("burn_in (100) must be smaller") != std::string::npos);
  Settings thinned = chosen(100, 50);
  thinned.set("thin", std::int64_t{51});
  CHECK(nuts::refuse(thinned).find("no draw would be kept") != std::string::npos);
  CHECK(nuts::refuse(chosen(900'000'000, 0)).find("use fewer samples") != std::string::npos);
  CHECK(nuts::refuse(Settings(nuts::settings())).empty());
}

}  // namespace sysid::nuts
