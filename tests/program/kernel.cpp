// Kernels as functions: inputs, constants and shared results as outputs; leaves that are not inputs are refused.
#include "program/kernel.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/text/diagnostic.hpp"

using namespace sysid;

TEST_CASE("outputs may be inputs, constants and one value several times") {
  Graph g;
  NodeId const x = g.leaf(LeafKind::parameter, 0), y = g.leaf(LeafKind::parameter, 1);
  NodeId const sum = g.add(x, y);
  std::vector<NodeId> const leaves{x, y}, outputs{y, g.constant(7), sum, sum, g.negate(sum)};
  Kernel const kernel = compile_kernel(g, leaves, outputs);
  LaneArray in(2, 3), out(5, 3);
  for (int w = 0; w < 3; ++w) in(0, w) = w, in(1, w) = 10 * w;
  run(kernel, in, out);
  for (int w = 0; w < 3; ++w) {
    CHECK(out(0, w) == 10 * w);
    CHECK(out(1, w) == 7);
    CHECK(out(2, w) == 11 * w);
    CHECK(out(3, w) == 11 * w);
    CHECK(out(4, w) == -11 * w);
  }
}

TEST_CASE("a kernel without inputs still fills every lane") {
  Graph g;
  std::vector<NodeId> const outputs{g.constant(2.5)};
  Kernel const kernel = compile_kernel(g, {}, outputs);
  LaneArray out(1, 9);
  run(kernel, ConstLanes{}, out);
  for (int w = 0; w < 9; ++w) CHECK(out(0, w) == 2.5);
}

TEST_CASE("integer powers are products and call no function") {
  Graph g;
  NodeId const x = g.leaf(LeafKind::parameter, 0);
  std::vector<NodeId> const leaves{x};
  std::vector<NodeId> const outputs{g.power(x, g.constant(5)), g.power(x, g.constant(-3)), g.power(x, g.constant(0.5)),
                                    g.power(x, g.constant(2.3))};
  Kernel const kernel = compile_kernel(g, leaves, outputs);
  int calls = 0;
  for (Instruction const& i : kernel.code) calls += i.opcode == Opcode::call_binary;
  CHECK(calls == 1);
  for (double const value : {0.3, 1.7, 12.0}) {
    std::vector<double> out(4);
    run_scalar(kernel, std::vector<double>{value}, out);
    // Five products round at most four times, a reciprocal once more.
    CHECK(std::abs(out[0] / elementary::pow(value, 5) - 1) < 5 * 0x1p-53 * 2);
    CHECK(std::abs(out[1] * elementary::pow(value, 3) - 1) < 5 * 0x1p-53 * 2);
    CHECK(out[2] == std::sqrt(value));
    CHECK(out[3] == elementary::pow(value, 2.3));
  }
}

TEST_CASE("a leaf that is not an input is a fault of ours") {
  Graph g;
  std::vector<NodeId> const outputs{g.leaf(LeafKind::state, 0)};
  CHECK_THROWS_AS(compile_kernel(g, {}, outputs), InternalError);
}

TEST_CASE("the dump of a kernel names its inputs") {
  Graph g;
  NodeId const x = g.leaf(LeafKind::parameter, 0), y = g.leaf(LeafKind::parameter, 1);
  std::vector<NodeId> const leaves{x, y}, outputs{g.multiply(g.add(x, y), x)};
  std::string const text = dump(compile_kernel(g, leaves, outputs), [](int row) { return row == 0 ? "mass" : "stiffness"; });
  CHECK(text ==
        "  _ = add mass stiffness\n"
        "  %0 = multiply _ mass\n"
        "  out0 = %0\n");
}
