// Autoregressive moves: they leave the posterior as it is, whatever they go about, and yield more than walks in many dimensions.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "inference/backend/checkpoint.hpp"
#include "inference/chain/independence_learning.hpp"
#include "inference/chain/local_learning.hpp"
#include "inference/chain/metropolis.hpp"
#include "inference/chain/mh.hpp"
#include "inference/interruptions.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::testing;
using namespace sysid::metropolis;

namespace {

constexpr int chains = 40000;

/// Only autoregressive moves; the walk is named but never made.
struct Moves {
  Proposal walk;
  std::vector<Proposal const*> walks;
  LocalMoves local;
  Moves(Independence const& mixture, double step, int dimension)
      : walk(spherical(dimension, 1)), walks(chains, &walk), local{walks, &mixture, step, 1, 0} {}
};

/// 0.6 N(-2, 0.5^2) + 0.4 N(1.5, 1).
double lopsided(double x) {
  auto const part = [&](double share, double mean, double sd) {
    return share / sd * std::exp(-(x - mean) * (x - mean) / (2 * sd * sd)) / std::sqrt(2 * std::numbers::pi);
  };
  return std::log(part(0.6, -2, 0.5) + part(0.4, 1.5, 1) + 1e-300);
}

double draw_lopsided(Stream& stream) { return stream.uniform() < 0.6 ? -2 + 0.5 * stream.normal() : 1.5 + stream.normal(); }

Independence in_line(double weight, double left, double left_variance, double right, double right_variance) {
  auto const one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
  auto const square = [](double x) { return Eigen::MatrixXd::Constant(1, 1, x); };
  return Independence({{weight, one(left), square(left_variance)}, {1 - weight, one(right), square(right_variance)}});
}

/// Chains that begin at draws of the posterior: they are so distributed after moves too, and of a reversible one as many go from
/// one of ten intervals to another as back. Several reversible moves in turn leave the posterior as it is, but are not reversible.
void check_balance(ConstLanes before, ConstLanes after, double lower, double upper, bool reversible = true) {
  constexpr int bins = 10;
  auto const bin = [&](double x) { return std::clamp(static_cast<int>(bins * (x - lower) / (upper - lower)), 0, bins - 1); };
  double flow[bins][bins] = {}, change = 0, pairs = 0, balance = 0;
  for (int w = 0; w < before.width(); ++w) ++flow[bin(before(0, w))][bin(after(0, w))];
  for (int i = 0; i < bins; ++i) {
    double out = 0, in = 0;
    for (int j = 0; j < bins; ++j) {
      if (j == i) continue;
      out += flow[i][j];
      in += flow[j][i];
      double const both = flow[i][j] + flow[j][i];
      if (j > i || both < 10) continue;
      balance += (flow[i][j] - flow[j][i]) * (flow[i][j] - flow[j][i]) / both;
      ++pairs;
    }
    if (out + in > 0) change += (out - in) * (out - in) / (out + in);
  }
  REQUIRE(pairs >= 5);
  if (reversible) CHECK(balance < pairs + 4 * std::sqrt(2 * pairs));
  CHECK(change < bins + 4 * std::sqrt(2.0 * bins));
}

}  // namespace

TEST_CASE("an autoregressive move about the normal distribution that is the posterior is accepted, and has the stated shape") {
  TestTarget const target({"a", "b"}, {{Prior::normal, 0, 1e8}, {Prior::normal, 0, 1e8}}, 2, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            rows = {w[0] - 1, (w[1] - 0.5 * (w[0] - 1)) / 0.1};
                          });
  Eigen::Matrix2d covariance;
  covariance << 1, 0.5, 0.5, 0.26;
  Independence const mixture({{1, Eigen::Vector2d(1, 0), covariance}});
  Moves const moves(mixture, 0.6, 2);
  LaneArray start(2, chains);
  for (int w = 0; w < chains; ++w) {
    start(0, w) = 3;
    start(1, w) = 1;
  }
  Ledger ledger;
  State state = init(target, std::move(start), ledger);
  Info const info = step(target, moves.local, {1, Purpose::proposal, 0, 0}, state, ledger);
  double mean = 0, square = 0, jump = 0;
  for (int w = 0; w < chains; ++w) {
    Move const& move = info[static_cast<std::size_t>(w)];
    REQUIRE(move.kind == MoveKind::autoregressive);
    REQUIRE(move.acceptance_probability == doctest::Approx(1).epsilon(1e-9));
    double const a = state.theta(0, w) - 1, b = (state.theta(1, w) - 0.5 * a) / 0.1;
    mean += a / chains;
    square += b * b / chains;
    jump += move.squared_jump / chains;
    REQUIRE(move.squared_jump == relative((a - 2) * (a - 2) + b * b, 1e-6));
  }
  // From z = (2, 0): z' = 0.8 z + 0.6 n.
  CHECK(mean == doctest::Approx(1.6).epsilon(0.01));
  CHECK(square == doctest::Approx(0.36).epsilon(0.03));
  CHECK(jump == doctest::Approx(0.16 + 2 * 0.36).epsilon(0.03));
}

TEST_CASE("autoregressive moves about a mixture that is not the posterior leave it as it is, and go to and fro equally often") {
  TestTarget const target({"x"}, {{Prior::normal, 0, 1e4}}, 1, 700, [](std::vector<double> const& w, std::vector<double>& rows) {
    rows[0] = as_residual(lopsided(w[0]), 700);
  });
  Independence const mixture = in_line(0.3, -1.5, 0.5, 1, 0.8);
  for (double const step : {0.3, 0.8, 1.0}) {
    CAPTURE(step);
    Moves const moves(mixture, step, 1);
    LaneArray start(1, chains);
    for (int w = 0; w < chains; ++w) {
      Stream stream({5, Purpose::test, static_cast<std::uint64_t>(w), 0});
      start(0, w) = draw_lopsided(stream);
    }
    Ledger ledger;
    State state = init(target, start, ledger);
    metropolis::step(target, moves.local, {2, Purpose::proposal, 0, 0}, state, ledger);
    check_balance(start, state.theta, -3.5, 3.5);
  }
}

TEST_CASE("moves about a normal distribution over declared values leave the posterior of a weakly determined logarithm as it is") {
  // x ~ log_uniform(0.1, 10), measured as 0.8 with sd 0.5: p(x) ~ N(x; 0.8, 0.5^2) / x.
  TestTarget const target({"x"}, {{Prior::log_uniform, 0.1, 10}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] - 0.8) / 0.5; });
  constexpr int cells = 20000;
  std::vector<double> cumulative(cells + 1, 0.0);
  auto const place = [](double cell) { return 0.1 * std::exp(std::log(100.0) * cell / cells); };  // even in log x
  for (int i = 0; i < cells; ++i) {
    double const r = (place(i + 0.5) - 0.8) / 0.5;
    cumulative[static_cast<std::size_t>(i) + 1] = cumulative[static_cast<std::size_t>(i)] + std::exp(-r * r / 2);
  }
  LaneArray exact(1, chains), start(1, chains), after(1, chains);
  for (int w = 0; w < chains; ++w) {
    Stream stream({6, Purpose::test, static_cast<std::uint64_t>(w), 0});
    double const share = stream.uniform() * cumulative.back();
    auto const above = std::upper_bound(cumulative.begin(), cumulative.end(), share) - cumulative.begin();
    exact(0, w) = place(static_cast<double>(above) - stream.uniform());
  }
  target.unconstrain(exact, start);
  Independence const mixture({{1, Eigen::VectorXd::Constant(1, 0.7), Eigen::MatrixXd::Constant(1, 1, 0.3)}}, true);
  for (double const step : {0.5, 1.0}) {
    CAPTURE(step);
    Moves const moves(mixture, step, 1);
    Ledger ledger;
    State state = init(target, start, ledger);
    Info const info = metropolis::step(target, moves.local, {2, Purpose::proposal, 0, 0}, state, ledger);
    CHECK(ledger.failed() == 0);
    for (Move const& move : info) REQUIRE_FALSE(move.failed);
    target.constrain(state.theta, after);
    check_balance(exact, after, 0, 3);
    // A cycle of one such move and two independent ones.
    cycle(target, moves.local, mixture, 2, {3, Purpose::proposal, 0, 0}, 3, state, ledger, [](int, Move const&) {});
    target.constrain(state.theta, after);
    check_balance(exact, after, 0, 3, false);
  }
  // An independence move alone: the walk before it stands still.
  Proposal const still = spherical(1, 0);
  std::vector<Proposal const*> const walks(chains, &still);
  Ledger ledger;
  State state = init(target, start, ledger);
  cycle(target, {walks}, mixture, 1, {4, Purpose::proposal, 0, 0}, 2, state, ledger, [](int, Move const&) {});
  target.constrain(state.theta, after);
  check_balance(exact, after, 0, 3);
}

TEST_CASE("local moves learn an acceptance of 0.4, and the kind that yields less is made rarely") {
  LocalLearning learning;
  auto const moved = [](bool autoregressive, double acceptance, double jump) {
    Move move;
    move.kind = autoregressive ? MoveKind::autoregressive : MoveKind::walk;
    move.acceptance_probability = acceptance;
    move.squared_jump = jump;
    return move;
  };
  // Acceptance falls with the step: exp(-2 b) is 0.4 at b = 0.458.
  for (int i = 0; i < 4000; ++i) learning.learn(Info(4, moved(true, std::exp(-2 * learning.step()), 1)));
  CHECK(learning.step() == doctest::Approx(0.458).epsilon(0.01));
  double const step = learning.step();
  learning.learn(Info(4, Move{.failed = true, .kind = MoveKind::autoregressive}));
  CHECK(learning.step() == step);
  learning.end_window(true);
  CHECK(learning.share() == 0.5);  // no walk was made
  learning.end_window(true);
  CHECK(learning.share() == 0.5);  // none was made
  learning.end_window(false);
  CHECK(learning.share() == 0);
  learning.learn({moved(true, 0.5, 1), moved(true, 0.5, 1), moved(false, 0.25, 3)});
  LocalLearning again = LocalLearning::restore(learning.store());
  for (LocalLearning* each : {&learning, &again}) {
    each->end_window(true);
    CHECK(each->share() == relative(0.1, 1e-12));
    CHECK(each->step() == learning.step());
  }
  // All are accepted: the step is that of independent draws.
  for (int i = 0; i < 4000; ++i) learning.learn(Info(4, moved(true, 1, 1)));
  CHECK(learning.step() == 1);
}

TEST_CASE("a place that the mixture hardly reaches takes no independence moves away from chains that accept a quarter of them") {
  TestTarget const target({"x"}, {{Prior::normal, 0, 1}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = w[0]; });
  Mode mode;
  mode.theta = {0};
  mode.covariance = {1};
  auto const moves = [&](double acceptance, double longest_stay) {
    nlohmann::json stored = IndependenceLearning(target, {mode}, {0, 0}).store();
    std::vector<double> sums = checkpoint::decode(stored.at("sums"));
    sums[1] = acceptance;
    sums[2] = longest_stay;
    stored["sums"] = checkpoint::encode(std::span<double const>(sums));
    stored["counts"].back() = 1;  // windows
    return IndependenceLearning::restore(stored, 1, 2).moves();
  };
  CHECK(moves(0.6, 1) == 15);
  CHECK(moves(0.6, 10) == 3);
  CHECK(moves(0.6, 1e6) == 1);
  CHECK(moves(0.25, 1e6) == 1);
  CHECK(moves(0.24, 1e6) == 0);
  CHECK(moves(0.24, 10) == 3);
  CHECK(moves(0.09, 1) == 0);
}

TEST_CASE("in many dimensions, near normal, autoregressive moves yield more than walks") {
  // Log-gamma of shape 2 in 30 directions: mean digamma(2) - log 2, variance trigamma(2), skewness -0.78.
  constexpr int dimension = 30;
  std::vector<std::string> names(dimension, "x");
  TestTarget const target(names, std::vector<Prior>(dimension, {Prior::normal, 0, 1e3}), dimension, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            for (std::size_t i = 0; i < w.size(); ++i)
                              rows[i] = std::copysign(std::sqrt(4 * std::max(0.0, elementary::exp(w[i]) - 1 - w[i])), w[i]);
                          });
  auto const run = [&](char const* proposal) {
    Settings settings(mh::settings());
    settings.set("samples", std::int64_t{12000});
    settings.set("burn_in", std::int64_t{4000});
    settings.set("proposal", std::string(proposal));
    Bench bench(1);
    return mh::run(target, settings, bench.context);
  };
  auto const least = [](std::vector<Summary> const& summaries) {
    double ess = infinity;
    for (Summary const& each : summaries) ess = std::min(ess, each.ess_bulk);
    return ess;
  };
  auto const adaptive = summarise(run("adaptive")), walk = summarise(run("walk"));
  MESSAGE(least(adaptive) << " and " << least(walk));
  CHECK(least(adaptive) > 2 * least(walk));
  for (Summary const& each : adaptive) {
    CHECK(std::fabs(each.mean - (0.42278434 - std::log(2.0))) < 4 * each.mcse_mean);
    CHECK(each.sd == doctest::Approx(std::sqrt(0.64493407)).epsilon(0.08));
  }
}

TEST_CASE("values that the data determine weakly are sampled as they are, not as their logarithms") {
  // Twelve x ~ log_uniform(0.1, 10), each measured as 0.8 with sd 0.25: p(x) ~ N(x; 0.8, 0.25^2) / x.
  constexpr int dimension = 12;
  std::vector<std::string> names(dimension, "x");
  TestTarget const target(names, std::vector<Prior>(dimension, {Prior::log_uniform, 0.1, 10}), dimension, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            for (std::size_t i = 0; i < w.size(); ++i) rows[i] = (w[i] - 0.8) / 0.25;
                          });
  auto const least = [&](char const* proposal) {
    Settings settings(mh::settings());
    settings.set("samples", std::int64_t{8000});
    settings.set("burn_in", std::int64_t{2000});
    settings.set("proposal", std::string(proposal));
    Bench bench(2);
    double mass = 0, mean = 0, square = 0, ess = infinity;
    for (int i = 0; i < 20000; ++i) {
      double const x = 0.1 + 3 * (i + 0.5) / 20000, density = std::exp(-(x - 0.8) * (x - 0.8) / 0.125) / x;
      mass += density;
      mean += density * x;
      square += density * x * x;
    }
    mean /= mass;
    for (Summary const& each : summarise(mh::run(target, settings, bench.context))) {
      CHECK(std::fabs(each.mean - mean) < 4 * each.mcse_mean);
      // A walk has fewer draws that are independent.
      CHECK(each.sd == relative(std::sqrt(square / mass - mean * mean), proposal == std::string("walk") ? 0.2 : 0.08));
      ess = std::min(ess, each.ess_bulk);
    }
    return ess;
  };
  double const adaptive = least("adaptive"), walk = least("walk");
  MESSAGE(adaptive << " and " << walk);
  CHECK(adaptive > 5 * walk);
}

TEST_CASE("a run with autoregressive moves about declared values goes on from where it was stopped, to the same bytes") {
  constexpr int dimension = 12;
  std::vector<std::string> names(dimension, "x");
  TestTarget const target(names, std::vector<Prior>(dimension, {Prior::log_uniform, 0.1, 10}), dimension, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            for (std::size_t i = 0; i < w.size(); ++i) rows[i] = (w[i] - 0.8) / 0.25;
                          });
  Settings settings(mh::settings());
  settings.set("samples", std::int64_t{2500});
  settings.set("burn_in", std::int64_t{1500});
  Unbroken const whole = unbroken(mh::run, target, settings);
  // That it is such a run: moves of the kind were made, and the mixture in use is one over declared values.
  CHECK(whole.last.at("independence").at("mixtures").at(0).at("declared").get<bool>());
  CHECK(whole.last.at("local").at("counts").at(2).get<std::uint64_t>() > 50);
  int const end = whole.questions;
  check_stops(mh::run, target, settings, whole, {end - 1, end - 60, end - 200, end - 500, end - 900});
}
