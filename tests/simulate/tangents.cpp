// Derivatives of programs by tangents against closed forms, and against extrapolated differences in long double.
#include "program/tangents.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "relative.hpp"
#include "simulate/experiments.hpp"
#include "simulate/random_sources.hpp"
#include "simulate/simulator.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace tangent_tests {
namespace {

using testing::random_sources::input_at, testing::random_sources::measured_at, testing::random_sources::record,
    testing::random_sources::sample_step, testing::random_sources::samples, testing::random_sources::random_source;

/// Outputs of a source: its sums, then its records of all samples.
std::vector<double> simulated(SimulationSource const& source, std::vector<double> const& parameters) {
  auto const program = std::make_shared<SimulationProgram const>(compile(source));
  SolverSettings solver;
  solver.method = source.integrator;
  Simulator const simulator(program, Schedule(*program, record(), solver));
  LaneArray column(static_cast<int>(parameters.size()), 1), sums(program->sum_count(), 1),
      records(samples * program->registers.records, 1);
  for (std::size_t p = 0; p < parameters.size(); ++p) column(static_cast<int>(p), 0) = parameters[p];
  std::vector<Outcome> outcome(1);
  simulator.sums(column, sums, outcome);
  std::vector<double> values(sums.view().data(), sums.view().data() + sums.rows());
  simulator.records(column, 0, samples, records, outcome);
  values.insert(values.end(), records.view().data(), records.view().data() + records.rows());
  return values;
}

// --- the same in long double, written out ---

using Real = long double;

Real computed(Node const& node, Real a, Real b, Real c) {
  switch (node.operation) {
    case Operation::negate:
      return -a;
    case Operation::add:
      return a + b;
    case Operation::subtract:
      return a - b;
    case Operation::multiply:
      return a * b;
    case Operation::divide:
      return a / b;
    case Operation::power:
      return std::pow(a, b);
    case Operation::fused:
      return a * b + c;
    case Operation::square_root:
      return std::sqrt(a);
    case Operation::absolute:
      return std::fabs(a);
    case Operation::sign:
      return a > 0 ? 1 : a < 0 ? -1 : a;
    case Operation::minimum:
      return std::isnan(b) || a > b ? b : a;
    case Operation::maximum:
      return std::isnan(b) || a < b ? b : a;
    case Operation::floor:
      return std::floor(a);
    case Operation::less:
      return a < b;
    case Operation::less_equal:
      return a <= b;
    case Operation::equal:
      return a == b;
    case Operation::conjunction:
      return a != 0 && b != 0;
    case Operation::disjunction:
      return a != 0 || b != 0;
    case Operation::negation:
      return a == 0;
    case Operation::select:
      return a != 0 ? b : c;
    default:
      return std::log(a);  // the one call
  }
}

Real evaluated(Graph const& graph, NodeId root, std::vector<Real>& values, std::vector<bool>& known, auto const& leaf_value) {
  for (NodeId const id : graph.reachable({&root, 1})) {
    if (known[id]) continue;
    known[id] = true;
    Node const& node = graph[id];
    int const operands = operand_count(node);
    if (node.operation == Operation::constant)
      values[id] = node.value;
    else if (node.operation == Operation::leaf)
      values[id] = leaf_value(node);
    else
      values[id] = computed(node, values[node.a], operands > 1 ? values[node.b] : 0, operands > 2 ? values[node.c] : 0);
  }
  return values[root];
}

class Plain {
 public:
  explicit Plain(SimulationSource const& source) : source_(source) {}

  std::vector<Real> outputs(std::vector<Real> const& parameters) const {
    std::size_t const n = source_.derivative.size();
    std::vector<Real> state = all(source_.initial, {}, parameters, 0, 0);
    std::vector<Real> sums, records;
    for (int i = 0; i < samples; ++i) {
      std::vector<Real> summed;
      for (ChannelSource const& channel : source_.channels) {
        std::vector<Real> const of = all(channel.sums, state, parameters, i, 0);
        summed.insert(summed.end(), of.begin(), of.end());
      }
      sums.resize(summed.size());
      for (std::size_t s = 0; s < summed.size(); ++s) sums[s] += summed[s];
      std::vector<Real> const of = all(source_.records, state, parameters, i, 0);
      records.insert(records.end(), of.begin(), of.end());
      if (i + 1 == samples) break;
      if (source_.map) {
        state = all(source_.derivative, state, parameters, i, 0);
        continue;
      }
      Real const h = times_[static_cast<std::size_t>(i) + 1] - times_[static_cast<std::size_t>(i)];
      auto const at = [&](std::vector<Real> const& slope, Real by) {
        std::vector<Real> moved = state;
        for (std::size_t k = 0; k < n; ++k) moved[k] += by * slope[k];
        return moved;
      };
      auto const f = [&](std::vector<Real> const& x, Real part) { return all(source_.derivative, x, parameters, i, part); };
      std::vector<Real> const k1 = f(state, 0), k2 = f(at(k1, h / 2), 0.5L), k3 = f(at(k2, h / 2), 0.5L), k4 = f(at(k3, h), 1);
      if (source_.integrator == "rk4")
        for (std::size_t k = 0; k < n; ++k) state[k] += h / 6 * (k1[k] + 2 * (k2[k] + k3[k]) + k4[k]);
      else
        for (std::size_t k = 0; k < n; ++k) state[k] += h * k1[k];  // euler
    }
    sums.insert(sums.end(), records.begin(), records.end());
    return sums;
  }

 private:
  /// Values of expressions at a part of the step after sample i.
  std::vector<Real> all(std::vector<NodeId> const& roots, std::vector<Real> const& state, std::vector<Real> const& parameters,
                        int i, Real part) const {
    auto const s = static_cast<std::size_t>(i), next = std::min<std::size_t>(s + 1, samples - 1);
    auto const between = [&](std::vector<double> const& v) { return v[s] + part * (static_cast<Real>(v[next]) - v[s]); };
    std::vector<Real> values(source_.graph.size());
    std::vector<bool> known(source_.graph.size());
    auto const leaf = [&](Node const& node) -> Real {
      auto const k = static_cast<std::size_t>(node.index);
      switch (node.leaf_kind) {
        case LeafKind::state:
          return state[k];
        case LeafKind::parameter:
          return parameters[k];
        case LeafKind::input:
          return between(inputs_);
        case LeafKind::time:
          return between(times_);
        default:
          return measured_[s];
      }
    };
    std::vector<Real> result;
    for (NodeId const root : roots) result.push_back(evaluated(source_.graph, root, values, known, leaf));
    return result;
  }

  static std::vector<double> sampled(double (*of)(double)) {
    std::vector<double> values;
    for (double const t : testing::uniform_times(samples, sample_step)) values.push_back(of(t));
    return values;
  }

  SimulationSource const& source_;
  std::vector<double> times_ = testing::uniform_times(samples, sample_step), inputs_ = sampled(&input_at),
                      measured_ = sampled(&measured_at);
};

/// The derivative of every output by a parameter, extrapolated twice; nothing where three steps do not agree: at a kink.
std::vector<std::optional<Real>> differences(Plain const& plain, std::vector<double> const& parameters, std::size_t p) {
  std::vector<std::vector<Real>> slopes;
  for (Real const h : {1e-3L, 5e-4L, 2.5e-4L}) {
    std::vector<Real> ahead(parameters.begin(), parameters.end()), behind = ahead;
    ahead[p] += h;
    behind[p] -= h;
    std::vector<Real> const a = plain.outputs(ahead), b = plain.outputs(behind);
    slopes.emplace_back();
    for (std::size_t i = 0; i < a.size(); ++i) slopes.back().push_back((a[i] - b[i]) / (ahead[p] - behind[p]));
  }
  std::vector<std::optional<Real>> result;
  for (std::size_t i = 0; i < slopes[0].size(); ++i) {
    Real const first = (4 * slopes[1][i] - slopes[0][i]) / 3, second = (4 * slopes[2][i] - slopes[1][i]) / 3;
    Real const best = (16 * second - first) / 15;
    bool const agree = std::fabs(best - second) <= 1e-12L * std::max<Real>(std::fabs(best), 1e-3L);
    result.push_back(std::isfinite(best) && agree ? std::optional(best) : std::nullopt);
  }
  return result;
}

/// Sums over the samples of products of the residual (0) and its derivatives (1, 2, ...), as `with_squares` has them; nothing where
/// one is not known. size: sums of their magnitudes.
struct Squares {
  std::vector<std::optional<Real>> values;
  std::vector<Real> sizes;
};

Squares squares_of(std::vector<std::vector<std::optional<Real>>> const& columns) {
  Squares squares;
  auto const add = [&](std::size_t k, std::size_t l) {
    std::optional<Real> sum = 0;
    Real size = 0;
    for (std::size_t i = 0; i < samples; ++i) {
      if (!columns[k][i] || !columns[l][i]) sum.reset();
      if (!sum) break;
      *sum += *columns[k][i] * *columns[l][i];
      size += std::fabs(*columns[k][i] * *columns[l][i]);
    }
    squares.values.push_back(sum);
    squares.sizes.push_back(size);
  };
  for (std::size_t k = 1; k < columns.size(); ++k) add(0, k);
  for (std::size_t k = 1; k < columns.size(); ++k)
    for (std::size_t l = 1; l <= k; ++l) add(k, l);
  return squares;
}

}  // namespace

TEST_CASE("tangents of random programs, and the squares of residuals, are those of differences in long double") {
  int programs = 0, infinite_between = 0, compared = 0, squares_compared = 0, left_out = 0;
  std::vector<int> const by = {0, 1, 2};
  constexpr std::size_t sums = 4;
  for (std::uint64_t index = 0; programs < 500; ++index) {
    CAPTURE(index);
    Stream stream({.seed = 21, .purpose = Purpose::test, .index = index, .step = 0});
    SimulationSource const source = random_source(stream);
    REQUIRE(has_tangents(source));
    std::vector<double> const parameters = {0.4 + stream.uniform(), 1.1 + stream.uniform(), -0.3 - stream.uniform()};
    std::vector<double> const found = simulated(with_squares(source, by), parameters), values = simulated(source, parameters);
    Plain const plain(source);
    std::vector<Real> const expected = plain.outputs({parameters.begin(), parameters.end()});
    REQUIRE(expected.size() == sums + samples);
    // On the same branches: else rounding decides at a jump.
    auto const same = [&](std::size_t i) {
      return std::fabs(values[i] - static_cast<double>(expected[i])) <= 1e-12 * std::max(1.0, std::fabs(values[i]));
    };
    std::vector<std::vector<std::optional<Real>>> slopes;
    for (std::size_t k = 0; k < by.size(); ++k) slopes.push_back(differences(plain, parameters, k));
    if (!std::isfinite(found.front())) {  // a value or a derivative that is not finite makes a lane fail
      auto const unknown = [](auto const& each) {
        return std::any_of(each.begin(), each.end(), [](auto const& slope) { return !slope; });
      };
      // Of outputs that are finite, some have an infinity on their way, such as a/(b/0).
      if (std::none_of(slopes.begin(), slopes.end(), unknown)) ++infinite_between;
      continue;
    }
    ++programs;
    std::vector<std::vector<std::optional<Real>>> columns(1);
    for (std::size_t i = sums; i < expected.size(); ++i)
      columns[0].push_back(same(i) && std::isfinite(expected[i]) ? std::optional(expected[i]) : std::nullopt);
    for (std::size_t k = 0; k < by.size(); ++k) {
      columns.emplace_back(slopes[k].begin() + sums, slopes[k].end());
      double largest = 0;
      for (std::size_t s = 0; s < sums; ++s)
        if (slopes[k][s]) largest = std::max(largest, std::fabs(static_cast<double>(*slopes[k][s])));
      for (std::size_t s = 0; s < sums; ++s) {
        if (!slopes[k][s] || !same(s)) {
          ++left_out;
          continue;
        }
        ++compared;
        CHECK(std::fabs(found[(k + 1) * sums + s] - static_cast<double>(*slopes[k][s])) <=
              1e-10 * std::max({largest, std::fabs(values[s]), 1e-6}));
      }
    }
    Squares const squares = squares_of(columns);
    REQUIRE(found.size() == sums * (1 + by.size()) + squares.values.size());
    for (std::size_t i = 0; i < squares.values.size(); ++i) {
      if (!squares.values[i]) continue;
      ++squares_compared;
      double const error = std::fabs(found[sums * (1 + by.size()) + i] - static_cast<double>(*squares.values[i]));
      CHECK(error <= 1e-10 * std::max(static_cast<double>(squares.sizes[i]), 1e-6));
    }
  }
  MESSAGE(compared << " derivatives and " << squares_compared << " squares compared, " << left_out << " at kinks or not finite");
  CHECK(infinite_between <= 5);
  CHECK(compared > 4 * left_out);
  CHECK(squares_compared > 3000);
}

TEST_CASE("the tangent of a decay is the derivative of the powers that the method computes") {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const rate = g.leaf(LeafKind::parameter, 0), x = g.leaf(LeafKind::state, 0);
  source.parameters = 2;
  source.inputs = 1;
  source.initial = {g.leaf(LeafKind::parameter, 1)};
  source.derivative = {g.negate(g.multiply(rate, x))};
  source.channels = {{{x}}};
  source.records = {x};
  double const a = 1.7, b = 0.8, z = -a * sample_step;
  std::vector<double> const found = simulated(with_squares(source, std::vector<int>{0, 1}), {a, b});
  double const growth = 1 + z + z * z / 2 + z * z * z / 6 + z * z * z * z / 24, slope = 1 + z + z * z / 2 + z * z * z / 6;
  std::vector<double> expected(8);  // x, by rate, by start; x times those; their products
  for (int i = 0; i < samples; ++i) {
    double const power = std::pow(growth, i), before = i > 0 ? i * std::pow(growth, i - 1) : 0;
    double const value = b * power, by_rate = -b * before * slope * sample_step, by_start = power;
    double const terms[] = {
        value, by_rate, by_start, value * by_rate, value * by_start, by_rate * by_rate, by_start * by_rate, by_start * by_start};
    for (std::size_t t = 0; t < expected.size(); ++t) expected[t] += terms[t];
  }
  REQUIRE(found.size() == expected.size());
  for (std::size_t t = 0; t < expected.size(); ++t) CHECK(found[t] == relative(expected[t], 1e-13));
}

TEST_CASE("a parameter that moves no state takes no states, and one at a power of 0 has a slope") {
  SimulationSource duffing = systems::duffing();
  duffing.records.resize(1);
  // m, c, k, k3 move both states, the precision none.
  CHECK(with_squares(duffing, std::vector<int>{0, 1, 2, 3, 4}).states() == 2 + 4 * 2);
  CHECK(with_squares(duffing, std::vector<int>{4}).states() == 2);
  // |z|^(n - 1) z begins at z = 0, with 1 < n < 2.
  SimulationSource hysteresis = systems::bouc_wen(0);
  hysteresis.records.resize(1);
  std::vector<int> const all = {0, 1, 2, 3, 4, 5};
  std::vector<double> const found = simulated(with_squares(hysteresis, all), {1.2, 0.7, 3, 0.9, 0.4, 1.4});
  CHECK(std::all_of(found.begin(), found.end(), [](double v) { return std::isfinite(v); }));
}

TEST_CASE("what is remembered from sample to sample has tangents") {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const a = g.leaf(LeafKind::parameter, 0), x = g.leaf(LeafKind::state, 0), before = g.leaf(LeafKind::state, 1);
  source.parameters = 1;
  source.inputs = 1;
  source.memories = {g.multiply(a, x)};
  source.initial = {g.constant(1), a};
  source.derivative = {g.negate(g.multiply(a, x)), g.constant(0)};
  source.channels = {{{before, x, g.multiply(before, x)}}};
  source.records = {before};
  std::vector<double> const found = simulated(with_squares(source, std::vector<int>{0}), {0.6}),
                            ahead = simulated(source, {0.6 + 1e-6}), behind = simulated(source, {0.6 - 1e-6});
  for (std::size_t s = 0; s < 3; ++s) CHECK(found[3 + s] == doctest::Approx((ahead[s] - behind[s]) / 2e-6).epsilon(1e-8));
}

TEST_CASE("there are no tangents of methods that choose their steps, nor of constraints") {
  SimulationSource source = systems::duffing();
  source.integrator = "dopri5";
  CHECK(!has_tangents(source));
  source.integrator = "cvode";
  CHECK(!has_tangents(source));
  source.integrator = "heun";
  CHECK(has_tangents(source));
}

}  // namespace tangent_tests
