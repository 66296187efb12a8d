// All executors run the same bytecode to the same bytes, whatever the width, the position of a lane and the instruction set.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "core/numeric/instruction_set.hpp"
#include "core/numeric/lanes.hpp"
#include "program/interpreter/executor.hpp"
#include "program/kernel.hpp"
#include "program/random_expressions.hpp"
#include "program/upper_halves.hpp"

using namespace sysid;

namespace {

std::vector<InstructionSet> supported() {
  if (supported_instruction_set() == InstructionSet::avx512) return {InstructionSet::avx2, InstructionSet::avx512};
  return {narrowest_instruction_set};
}

/// Equal bits; NaNs are one value, as their payload depends on the order of operands.
bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (a != a && b != b); }

struct Random {
  Graph graph;
  std::vector<NodeId> leaves, outputs;
};

Random random_function(std::uint64_t index) {
  Stream stream({.seed = 11, .purpose = Purpose::test, .index = index, .step = 0});
  Random random;
  for (int i = 0; i < 5; ++i) random.leaves.push_back(random.graph.leaf(LeafKind::unknown, i));
  random.outputs = testing::random_expressions(random.graph, random.leaves, 10 + static_cast<int>(stream.below(120)),
                                               1 + static_cast<int>(stream.below(8)), stream);
  return random;
}

LaneArray random_inputs(int rows, int width) {
  LaneArray inputs(rows, width);
  Stream stream({.seed = 12, .purpose = Purpose::test, .index = 0, .step = 0});
  for (int w = 0; w < width; ++w)
    for (int r = 0; r < rows; ++r) inputs(r, w) = w % 7 == 3 && r == 0 ? 0.0 : 3 * stream.normal();
  if (width > 5) inputs(1, 5) = HUGE_VAL;
  for (int w = 9; w < width; w += 10) inputs((w / 10) % rows, w) = std::nan("");
  return inputs;
}

}  // namespace

TEST_CASE("kernels of random expressions equal their plain evaluation bit for bit on every executor") {
  int const widest = 131;
  for (std::uint64_t index = 0; index < 60; ++index) {
    CAPTURE(index);
    Random const random = random_function(index);
    Kernel const kernel = compile_kernel(random.graph, random.leaves, random.outputs);
    LaneArray const inputs = random_inputs(5, widest);
    LaneArray expected(kernel.outputs, widest);
    for (int w = 0; w < widest; ++w) {
      std::vector<double> column, scalar(static_cast<std::size_t>(kernel.outputs));
      for (int r = 0; r < 5; ++r) column.push_back(inputs(r, w));
      run_scalar(kernel, column, scalar);
      std::vector<double> const plain = random.graph.evaluate(
          random.outputs, [&](NodeId id) { return column[static_cast<std::size_t>(random.graph[id].index)]; });
      for (int r = 0; r < kernel.outputs; ++r) {
        REQUIRE(same(scalar[static_cast<std::size_t>(r)], plain[static_cast<std::size_t>(r)]));
        expected(r, w) = plain[static_cast<std::size_t>(r)];
      }
    }
    for (InstructionSet const set : supported()) {
      InstructionSet const before = instruction_set();
      force_instruction_set(set);
      for (int const width : {1, 3, 4, 7, 8, 13, 16, 29, 32, 64, 65, 131}) {
        LaneArray out(kernel.outputs, width);
        int const first = widest - width;
        run(kernel, inputs.view().columns(first, width), out);
        bool equal = true;
        for (int w = 0; w < width; ++w)
          for (int r = 0; r < kernel.outputs; ++r) equal = equal && same(out(r, w), expected(r, first + w));
        CAPTURE(width);
        CHECK(equal);
      }
      force_instruction_set(before);
    }
  }
}

TEST_CASE("no executor leaves the upper halves of vectors behind, which slow whatever is compiled without them") {
  Random const random = random_function(3);
  Kernel const kernel = compile_kernel(random.graph, random.leaves, random.outputs);
  InstructionSet const before = instruction_set();
  for (InstructionSet const set : supported()) {
    force_instruction_set(set);
    for (Executor const& executor : executors(set)) {
      CAPTURE(executor.width);
      LaneArray const inputs = random_inputs(5, executor.width);
      LaneArray out(kernel.outputs, executor.width);
      run(kernel, inputs, out);
      CHECK(testing::upper_halves_are_clear());
    }
    force_instruction_set(before);
  }
}

TEST_CASE("a block takes the narrowest executor that holds it, within the width allowed") {
  InstructionSet const before = instruction_set();
  force_instruction_set(narrowest_instruction_set);
  CHECK(choose_executor(1).width == 4);
  CHECK(choose_executor(5).width == 8);
  CHECK(choose_executor(1000).width == (narrowest_instruction_set == InstructionSet::neon ? 16 : 32));
  CHECK(choose_executor(1000, 20).width == 16);
  if (supported_instruction_set() == InstructionSet::avx512) {
    force_instruction_set(InstructionSet::avx512);
    CHECK(choose_executor(4).width == 4);
    CHECK(choose_executor(1000).width == 64);
  }
  force_instruction_set(before);
}
