// One Metropolis step: proposals of the stated shape, detailed balance, failures rejected, lanes independent.
#include "inference/chain/metropolis.hpp"

#include <doctest/doctest.h>

#include "inference/chain/adaptation.hpp"
#include "inference/targets.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::testing;
using namespace sysid::metropolis;

namespace {

TestTarget gaussian(int dimension) {
  std::vector<std::string> names(static_cast<std::size_t>(dimension), "x");
  return TestTarget(names, std::vector<Prior>(static_cast<std::size_t>(dimension), {Prior::normal, 0, 1e3}), dimension, 0,
                    [](std::vector<double> const& w, std::vector<double>& rows) { rows = w; });
}

}  // namespace

TEST_CASE("a flat density accepts every move, so states spread as the proposal says") {
  // One step from 0 on a flat density: theta = s L z, covariance s^2 L L'.
  TestTarget const flat({"a", "b"}, {{Prior::normal, 0, 1e9}, {Prior::normal, 0, 1e9}}, 1, 0,
                        [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = 0; });
  constexpr int chains = 20000;
  Proposal const proposal{2, {2, 0, 1, 0.5}, 0.1};
  std::vector<Proposal const*> const proposals(chains, &proposal);
  Ledger ledger;
  State state = init(flat, LaneArray(2, chains), ledger);
  Info const info = step(flat, {proposals}, {1, Purpose::proposal, 0, 0}, state, ledger);
  double aa = 0, ab = 0, bb = 0, accepted = 0;
  for (int w = 0; w < chains; ++w) {
    aa += state.theta(0, w) * state.theta(0, w) / chains;
    ab += state.theta(0, w) * state.theta(1, w) / chains;
    bb += state.theta(1, w) * state.theta(1, w) / chains;
    accepted += info[static_cast<std::size_t>(w)].accepted;
  }
  CHECK(accepted == chains);
  CHECK(aa == relative(0.04, 0.04));  // standard error 1 %
  CHECK(ab == relative(0.02, 0.05));
  CHECK(bb == relative(0.0125, 0.04));
}

TEST_CASE("one step leaves the target's distribution as it is") {
  // 40,000 chains drawn from N(0, 1) still have its moments after a step; mean square has standard error sqrt(2/40000) = 0.7 %.
  TestTarget const target = gaussian(1);
  constexpr int chains = 40000;
  LaneArray start(1, chains);
  for (int w = 0; w < chains; ++w) start(0, w) = Stream({2, Purpose::test, static_cast<std::uint64_t>(w), 0}).normal();
  Ledger ledger;
  State state = init(target, std::move(start), ledger);
  Proposal const proposal = spherical(1, 4);
  std::vector<Proposal const*> const proposals(chains, &proposal);
  double acceptance = 0;
  for (std::uint64_t i = 0; i < 3; ++i) {
    Info const info = step(target, {proposals}, {3, Purpose::proposal, 0, i}, state, ledger);
    for (Move const& move : info) acceptance += move.acceptance_probability / (3.0 * chains);
  }
  double square = 0, fourth = 0;
  for (double const x : state.theta.row(0)) {
    square += x * x / chains;
    fourth += x * x * x * x / chains;
  }
  CHECK(square == doctest::Approx(1).epsilon(0.025));
  CHECK(fourth == doctest::Approx(3).epsilon(0.06));
  // Acceptance of N(0, s^2) moves on N(0, 1): 2/pi atan(2/s), Gelman, Roberts and Gilks 1996; s = 2.
  CHECK(acceptance == doctest::Approx(0.5).epsilon(0.01));
}

TEST_CASE("small moves come in their share and size") {
  TestTarget const flat({"a"}, {{Prior::normal, 0, 1e9}}, 1, 0,
                        [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = 0; });
  constexpr int chains = 20000;
  Proposal const proposal{1, {1}, 1, 0.1, 0.2};
  std::vector<Proposal const*> const proposals(chains, &proposal);
  Ledger ledger;
  State state = init(flat, LaneArray(1, chains), ledger);
  Info const info = step(flat, {proposals}, {1, Purpose::proposal, 0, 0}, state, ledger);
  double small = 0, square = 0;
  for (int w = 0; w < chains; ++w) {
    if (info[static_cast<std::size_t>(w)].tunes_scale) continue;
    ++small;
    square += state.theta(0, w) * state.theta(0, w);
  }
  CHECK(small / chains == relative(0.1, 0.08));
  CHECK(square / small == relative(0.04, 0.12));
}

TEST_CASE("a move to a place that cannot be solved is rejected and marked") {
  TestTarget const target({"x"}, {{Prior::normal, 0, 1}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = w[0] == 0 ? 0 : infinity; });
  Ledger ledger;
  State state = init(target, LaneArray(1, 3), ledger);
  Proposal const proposal = spherical(1, 1);
  Info const info = step(target, {std::vector<Proposal const*>(3, &proposal)}, {1, Purpose::proposal, 0, 0}, state, ledger);
  for (int w = 0; w < 3; ++w) {
    CHECK(state.theta(0, w) == 0);
    CHECK(info[static_cast<std::size_t>(w)].failed);
    CHECK_FALSE(info[static_cast<std::size_t>(w)].accepted);
    CHECK(info[static_cast<std::size_t>(w)].acceptance_probability == 0);
  }
  CHECK(ledger.failed() == 3);
}

TEST_CASE("many chains in one batch take the steps that each takes alone") {
  TestTarget const target = gaussian(3);
  Proposal const proposal = spherical(3, 0.5);
  Ledger ledger;
  State together = init(target, LaneArray(3, 5), ledger);
  for (std::uint64_t i = 0; i < 20; ++i)
    step(target, {std::vector<Proposal const*>(5, &proposal)}, {1, Purpose::proposal, 0, i}, together, ledger);
  for (int w = 0; w < 5; ++w) {
    State alone = init(target, LaneArray(3, 1), ledger);
    for (std::uint64_t i = 0; i < 20; ++i)
      step(target, {std::vector<Proposal const*>(1, &proposal)}, {1, Purpose::proposal, static_cast<std::uint64_t>(w), i}, alone,
           ledger);
    for (int p = 0; p < 3; ++p) CHECK(alone.theta(p, 0) == together.theta(p, w));
    CHECK(alone.log_likelihood[0] == together.log_likelihood[static_cast<std::size_t>(w)]);
  }
}

TEST_CASE("chains that run ahead in idle lanes take the same path as step by step") {
  TestTarget const target = gaussian(2);
  Proposal const wide = spherical(2, 9), narrow = spherical(2, 0.01);
  std::vector<Proposal const*> const proposals = {&wide, &narrow, &wide};
  Ledger ledger;
  using Path = std::vector<std::vector<double>>;
  constexpr std::uint64_t iterations = 200;
  auto const run = [&](int ahead) {
    State state = init(target, LaneArray(2, 3), ledger);
    std::vector<std::uint64_t> next(3, 0);
    Path path(3);
    auto const visit = [&](int chain, Move const& move) {
      auto const w = static_cast<std::size_t>(chain);
      path[w].insert(path[w].end(),
                     {state.theta(0, chain), state.theta(1, chain), state.log_likelihood[w], move.acceptance_probability});
    };
    int batches = 0;
    for (; next != std::vector<std::uint64_t>(3, iterations); ++batches)
      advance(target, {proposals}, {1, Purpose::proposal, 0, 0}, ahead, iterations, next, state, ledger, visit);
    return std::pair(path, batches);
  };
  auto const [one, batches_of_one] = run(1);
  CHECK(batches_of_one == iterations);
  CHECK(one[0].size() == 4 * iterations);
  for (int const ahead : {2, 5, 8}) {
    auto const [path, batches] = run(ahead);
    CHECK(path == one);
    CHECK(batches <= batches_of_one);
  }
  // The wide proposal is mostly refused: with it alone, eight at a time need far fewer batches.
  State alone = init(target, LaneArray(2, 1), ledger);
  std::vector<std::uint64_t> next(1, 0);
  int batches = 0;
  for (; next[0] < iterations; ++batches)
    advance(target, {std::vector<Proposal const*>{&wide}}, {1, Purpose::proposal, 0, 0}, 8, iterations, next, alone, ledger,
            [](int, Move const&) {});
  CHECK(batches < 80);
  CHECK(alone.theta(0, 0) == one[0][4 * iterations - 4]);
}

TEST_CASE("adaptation learns covariance and scale, and a failed move does not steer it") {
  TestTarget const target({"a", "b"}, {{Prior::normal, 0, 1e3}, {Prior::normal, 0, 1e3}}, 2, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            rows = {w[0] / 10, w[1] * 10};
                          });
  Ledger ledger;
  State state = init(target, LaneArray(2, 4), ledger);
  Adaptation adaptation({0, 1, 2, 3}, Eigen::MatrixXd::Identity(2, 2));
  double late = 0;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    Info const info =
        step(target, {std::vector<Proposal const*>(4, &adaptation.proposal())}, {1, Purpose::proposal, 0, i}, state, ledger);
    for (std::size_t w = 0; w < 4 && i >= 3000; ++w)
      late += info[w].tunes_scale ? info[w].acceptance_probability / (0.9 * 2000 * 4) : 0;
    adaptation.learn(state, info, std::vector<char>(4));
  }
  auto const& factor = adaptation.proposal().factor;
  CHECK(factor[0] == doctest::Approx(10).epsilon(0.15));
  CHECK(std::hypot(factor[2], factor[3]) == relative(0.1, 0.15));
  CHECK(late == relative(0.234, 0.1));

  double const scale = adaptation.proposal().scale;
  Info const failed(4, Move{.failed = true});
  for (int i = 0; i < 10; ++i) adaptation.learn(state, failed, std::vector<char>(4));
  CHECK(adaptation.proposal().scale == scale);
  // Independence moves tell nothing of the random walk's scale, and chains at another mode nothing of the width of this one.
  for (int i = 0; i < 10; ++i)
    adaptation.learn(state, Info(4, Move{.acceptance_probability = 1, .kind = MoveKind::independent}), std::vector<char>(4));
  CHECK(adaptation.proposal().scale == scale);
  Eigen::MatrixXd const covariance = adaptation.covariance();
  for (int w = 0; w < 4; ++w) state.theta(0, w) = 1e6;
  adaptation.learn(state, failed, std::vector<char>(4, 1));
  CHECK(adaptation.covariance() == covariance);
}

TEST_CASE("a cycle takes its moves in turn, each from where the one before ended") {
  // Of a density that the mixture equals almost, all independence moves but a few are accepted, and the last is where the chain is.
  TestTarget const target({"a", "b"}, {{Prior::normal, 0, 1e3}, {Prior::normal, 0, 1e3}}, 2, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            rows = {w[0] - 1, w[1] * 10};
                          });
  Independence const mixture({{1, Eigen::Vector2d(1, 0), Eigen::Vector2d(1, 0.01).asDiagonal()}});
  Proposal const walk = spherical(2, 1e-4);
  std::vector<Proposal const*> const proposals(3, &walk);
  Ledger ledger;
  State state = init(target, LaneArray(2, 3), ledger);
  std::vector<int> order;
  int accepted = 0, independent = 0;
  double mean = 0, square = 0;
  std::uint64_t at = 0;
  constexpr std::uint64_t end = 9999;  // no multiple of the cycle: the last one is cut
  while (at < end)
    at += static_cast<std::uint64_t>(
        cycle(target, {proposals}, mixture, 3, {1, Purpose::proposal, 0, at}, end, state, ledger, [&](int chain, Move const& move) {
          order.push_back(chain);
          independent += move.kind == MoveKind::independent;
          accepted += move.kind == MoveKind::independent && move.accepted;
          mean += state.theta(0, chain) / (3.0 * end);
          square += 100 * state.theta(1, chain) * state.theta(1, chain) / (3.0 * end);
        }));
  CHECK(at == end);
  REQUIRE(order.size() == 3 * end);
  for (std::size_t i = 0; i < order.size(); ++i) REQUIRE(order[i] == static_cast<int>(i % 3));
  CHECK(independent == 3 * (end - end / 4 - 1));
  CHECK(accepted > 0.75 * independent);
  CHECK(std::fabs(mean - 1) < 0.04);
  CHECK(square == doctest::Approx(1).epsilon(0.05));
}

TEST_CASE("what acceptances move a scale by is 1 at first and settles") {
  CHECK(learning_gain(0.5, 1) == 1);
  CHECK(learning_gain(0.5, 100) == doctest::Approx(4 * std::pow(100.0, -0.6)));
  CHECK(learning_gain(best_acceptance, 1'000'000) < 0.002);
}
