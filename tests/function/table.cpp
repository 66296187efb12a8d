// Generic checks over all functions of the language: a new row is tested at birth.
#include "function/table.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "function/primitive.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

/// Points inside every function's domain and away from kinks: 0 < x < 1, different in each argument.
constexpr double points[][3] = {{0.31, 0.52, 0.83}, {0.77, 0.22, 0.49}, {0.05, 0.64, 0.93}};

struct Call {
  Graph graph;
  std::vector<NodeId> arguments;
  NodeId value = 0;

  explicit Call(FunctionRow const& row) {
    for (int i = 0; i < std::min(3, row.maximum_arguments); ++i) arguments.push_back(graph.leaf(LeafKind::parameter, i));
    value = row.build(graph, arguments);
  }
  double evaluate(NodeId node, std::vector<double> const& x) const {
    return graph.evaluate(node, [&](NodeId id) { return x[static_cast<std::size_t>(graph[id].index)]; });
  }
};

void check_lanes(Function const& function) {
  CAPTURE(function.name);
  Stream stream(StreamKey{.seed = 11});
  // Widths around every vector length, so that each remainder path is met.
  for (int width = 1; width <= 35; ++width) {
    auto const size = static_cast<std::size_t>(width);
    std::vector<double> x(size), y(size), out(size);
    for (std::size_t i = 0; i < size; ++i) {
      x[i] = 40 * (stream.uniform() - 0.3);
      y[i] = 40 * (stream.uniform() - 0.3);
    }
    if (function.arity == 1)
      function.unary_lanes(x.data(), out.data(), width);
    else
      function.binary_lanes(x.data(), y.data(), out.data(), width);
    bool equal = true;
    for (std::size_t i = 0; i < size; ++i) {
      double const scalar = function.arity == 1 ? function.unary(x[i]) : function.binary(x[i], y[i]);
      equal = equal && (std::bit_cast<std::uint64_t>(scalar) == std::bit_cast<std::uint64_t>(out[i]) ||
                        (scalar != scalar && out[i] != out[i]));
    }
    CHECK(equal);
  }
}

}  // namespace

TEST_CASE("every function's derivative matches a central difference") {
  // Fourth order: error h^4 f^(5)/30 + eps |f|/h, about 1e-11 for the values and slopes here; the steepest fifth derivative, of
  // log10 and lgamma at x = 0.05, is 24/x^5 = 8e7, which leaves h^4 * 3e6 = 3e-8 of a slope of 20.
  constexpr double h = 3e-4;
  for (FunctionRow const& row : functions()) {
    Call call(row);
    for (std::size_t which = 0; which < call.arguments.size(); ++which) {
      NodeId const derivative = call.graph.differentiate(call.value, call.arguments[which]);
      for (auto const& point : points) {
        std::vector<double> const x(point, point + call.arguments.size());
        auto const moved = [&](double by) {
          std::vector<double> other = x;
          other[which] += by;
          return call.evaluate(call.value, other);
        };
        double const difference = (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h);
        CAPTURE(row.name);
        CAPTURE(which);
        CAPTURE(x[0]);
        CHECK(call.evaluate(derivative, x) == relative(difference, 1e-7));
      }
    }
  }
}

TEST_CASE("every primitive gives the same bits over lanes and one at a time") {
  std::set<Function const*> primitives = {&digamma_function, &gamma_p_function, &gamma_q_function, &student_t_cdf_function};
  for (FunctionRow const& row : functions()) {
    Call const call(row);
    for (NodeId const id : call.graph.reachable({&call.value, 1}))
      if (call.graph[id].operation == Operation::call) primitives.insert(call.graph[id].function);
  }
  CHECK(primitives.size() > 15);
  for (Function const* function : primitives) check_lanes(*function);
}

TEST_CASE("every function is found by its name and by no other") {
  std::set<std::string_view> names;
  for (FunctionRow const& row : functions()) {
    CHECK(find_function(row.name) == &row);
    CHECK(names.insert(row.name).second);
    CHECK_FALSE(row.summary.empty());
    CHECK(row.minimum_arguments <= row.maximum_arguments);
  }
  CHECK(find_function("sine") == nullptr);
}

TEST_CASE("functions built from operations have the values of their definitions") {
  auto const value = [](std::string_view name, std::vector<double> const& x) {
    Graph graph;
    std::vector<NodeId> arguments;
    for (double const each : x) arguments.push_back(graph.constant(each));
    return *graph.constant_value(find_function(name)->build(graph, arguments));
  };
  CHECK(value("hypot", {3, 4}) == 5);
  CHECK(value("step", {-0.1}) == 0);
  CHECK(value("step", {0}) == 1);
  CHECK(value("step", {2}) == 1);
  CHECK(value("clamp", {5, -1, 1}) == 1);
  CHECK(value("clamp", {-5, -1, 1}) == -1);
  CHECK(value("clamp", {0.5, -1, 1}) == 0.5);
  CHECK(value("min", {3, 1, 2, 5}) == 1);
  CHECK(value("max", {3, 1, 7, 5}) == 7);
  CHECK(value("floor", {-1.5}) == -2);
  CHECK(value("sign", {-1.5}) == -1);
  CHECK(value("sqrt", {2}) == std::sqrt(2.0));
  CHECK(value("normal_cdf", {0}) == 0.5);
  // R: options(digits = 17); pnorm(c(-8, 1.5))
  CHECK(value("normal_cdf", {-8}) == relative(6.2209605742717849e-16, 1e-14));
  CHECK(value("normal_cdf", {1.5}) == doctest::Approx(0.93319279873114191).epsilon(1e-15));
}
