// The worked examples of docs/extending.md, compiled and held to closed forms: what the page shows is this text.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "function/primitive.hpp"
#include "inference/backend/backend.hpp"
#include "inference/targets.hpp"
#include "relative.hpp"
#include "solver/stages.hpp"

namespace sysid {
namespace importance {

constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "100000", 1, 1e8, "", "draws from the prior"},
    {"draws", SettingKind::integer, "1000", 1, 1e7, "", "posterior draws, chosen by weight"},
};

/// Importance sampling from the prior: weights w_i = p(y | theta_i).          Bishop 2006, sec. 11.1.4
FitResult run(Target const& target, Settings const& settings, RunContext& context) {
  FitResult result;
  result.settings = settings;
  int const samples = static_cast<int>(settings.integer("samples")), block = 512;
  LaneArray theta(target.dimension(), samples);
  target.sample_prior({context.seed, Purpose::prior, 0, 0}, theta);
  std::vector<double> weight(static_cast<std::size_t>(samples));
  context.progress.begin("weighting", static_cast<std::uint64_t>(samples));
  for (int first = 0; first < samples; first += block) {
    if (context.stop_requested()) {
      result.interrupted = true;
      return result;
    }
    int const width = std::min(block, samples - first);
    auto const out = std::span(weight).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(width));
    target.log_likelihood(theta.view().columns(first, width), out, context.ledger);
    context.progress.advance(static_cast<std::uint64_t>(first + width), "");
  }
  context.progress.end();

  double const best = *std::max_element(weight.begin(), weight.end());
  if (!std::isfinite(best)) {
    result.failure = Finding(FindingCode::no_finite_start, Severity::error, {},
                             "the likelihood is finite at no draw from the prior", "narrow the prior");
    return result;
  }
  double sum = 0, square = 0;
  for (double& w : weight) {
    w = elementary::exp(w - best);
    sum += w;
    square += w * w;
  }
  double const effective = sum * sum / square;
  if (effective < 400)
    result.findings.push_back({FindingCode::few_effective_particles,
                               Severity::warning,
                               {},
                               fmt::format("the weighted draws are worth {:.0f} independent ones", effective),
                               "use mh"});

  for (ParameterInfo const& parameter : target.parameters()) {
    result.draws.names.push_back(parameter.name);
    result.draws.units.push_back(parameter.unit);
  }
  result.draws.parameter_count = target.dimension();
  LaneArray declared(target.dimension(), samples);
  target.constrain(theta, declared);
  std::vector<double> log_prior(weight.size()), log_density(weight.size());
  target.log_prior(theta, log_prior, false);
  target.log_prior(theta, log_density);
  Chain& chain = result.draws.chains.emplace_back();
  // Systematic resampling: equally spaced places on the line of weights, begun at random.
  auto const count = settings.integer("draws");
  double const start = Stream({context.seed, Purpose::selection, 0, 0}).uniform();
  double passed = 0;
  std::int64_t next = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    double const log_likelihood = best + elementary::log(weight[i]);
    for (passed += weight[i]; next < count && (static_cast<double>(next) + start) / static_cast<double>(count) * sum < passed;
         ++next) {
      std::vector<double> values;
      for (int p = 0; p < declared.rows(); ++p) values.push_back(declared(p, static_cast<int>(i)));
      chain.values.push_back(std::move(values));
      chain.log_prior.push_back(log_prior[i]);
      chain.log_likelihood.push_back(log_likelihood);
      chain.log_density.push_back(log_density[i] + log_likelihood);
      chain.acceptance.push_back(1);
    }
  }
  return result;
}

}  // namespace importance

/// The midpoint method (Runge 1895), order 2: k1 = f(y, t), k2 = f(y + h/2 k1, t + h/2), y + h k2.
std::vector<NodeId> midpoint_step(Stages const& stages) {
  Graph& graph = stages.graph;
  NodeId const half = graph.multiply(graph.constant(0.5), stages.h);
  std::vector<NodeId> const k1 = stages.evaluate(stages.states, Stage::begin);
  std::vector<NodeId> const k2 = stages.evaluate(stages.advance(k1, half), Stage::middle);
  return stages.advance(k2, stages.h);
}

/// log(1 + e^x), a smooth max(x, 0), without overflow for large x.
NodeId softplus(Graph& graph, std::span<NodeId const> a) {
  Term const x(graph, a[0]);
  return (max(x, Term(graph, 0.0)) + log1p(exp(-abs(x)))).id;
}

}  // namespace sysid

using namespace sysid;

TEST_CASE("the example back end finds a conjugate posterior") {
  // theta ~ N(0, 1), one sample 1.2 with sd 0.5: precision 1 + 4, mean 4 * 1.2 / 5.
  double const constant = -std::log(0.5) - 0.5 * std::log(2 * std::numbers::pi);
  sysid::testing::TestTarget const target(
      {"theta"}, {{sysid::testing::Prior::normal, 0, 1}}, 1, constant,
      [](std::vector<double> const& declared, std::vector<double>& rows) { rows[0] = (1.2 - declared[0]) / 0.5; });
  SilentProgress progress;
  Ledger ledger;
  RunContext context{7, progress, ledger};
  FitResult const result = importance::run(target, Settings(importance::rows), context);
  REQUIRE(result.draws.total() == 1000);
  double mean = 0, square = 0;
  for (auto const& draw : result.draws.chains[0].values) mean += draw[0] / 1000;
  for (auto const& draw : result.draws.chains[0].values) square += (draw[0] - mean) * (draw[0] - mean) / 1000;
  // Systematic resampling of 100 000 weighted draws: the error of the mean is below that of 1000 independent ones,
  // 0.447/sqrt(1000).
  CHECK(std::fabs(mean - 0.96) < 4 * 0.0141);
  CHECK(std::sqrt(square) == doctest::Approx(std::sqrt(0.2)).epsilon(4 / std::sqrt(2000)));
  CHECK(result.findings.empty());
  CHECK(ledger.solves() == 100000);
}

TEST_CASE("the example integrator is of second order") {
  // y' = -y: one step is y (1 - h + h^2/2).
  Graph graph;
  NodeId const y = graph.leaf(LeafKind::state, 0), h = graph.leaf(LeafKind::step_size);
  std::vector<NodeId> const derivative = {graph.negate(y)};
  std::vector<StageVisit> visited;
  std::vector<NodeId> const next = midpoint_step({graph, derivative, {y}, h, visited});
  double const value = graph.evaluate(next[0], [&](NodeId leaf) { return leaf == y ? 2.0 : 0.25; });
  CHECK(value == doctest::Approx(2 * (1 - 0.25 + 0.25 * 0.25 / 2)).epsilon(1e-15));
}

TEST_CASE("the example function neither overflows nor loses its tail") {
  Graph graph;
  NodeId const x = graph.leaf(LeafKind::state, 0);
  NodeId const node = softplus(graph, std::span(&x, 1));
  auto const at = [&](double value) { return graph.evaluate(node, [&](NodeId) { return value; }); };
  CHECK(at(0) == doctest::Approx(std::log(2)).epsilon(1e-15));
  CHECK(at(1000) == 1000);
  CHECK(at(-40) == relative(std::exp(-40), 1e-15));
}
