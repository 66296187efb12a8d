// Emission: values updated in place, exchanged, copied; the accumulator and few registers.
#include "program/emit.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "program/interpreter/executor.hpp"

using namespace sysid;

namespace {

/// Leaves are states in registers 0, 1, ...; constants are uniforms in the order they are met.
struct EmitBench {
  Graph graph;
  std::vector<double> constants;

  NodeId state(int i) { return graph.leaf(LeafKind::state, i); }

  Emitted emit(std::vector<Goal> const& goals, std::uint32_t states) {
    Locate const locate = [this](NodeId id) -> std::optional<Operand> {
      if (graph[id].operation == Operation::leaf) return Operand{OperandPlace::lane, static_cast<std::uint32_t>(graph[id].index)};
      if (graph[id].operation != Operation::constant) return std::nullopt;
      constants.push_back(graph[id].value);
      return Operand{OperandPlace::uniform, static_cast<std::uint32_t>(constants.size() - 1)};
    };
    return sysid::emit(graph, goals, locate, states);
  }

  std::vector<double> run(Emitted const& emitted, std::vector<double> states) const {
    states.resize(states.size() + static_cast<std::size_t>(emitted.temporaries));
    run_scalar(emitted.code, constants.data(), states.data());
    return states;
  }
};

}  // namespace

TEST_CASE("states exchanged in one step do not overwrite each other") {
  EmitBench bench;
  Emitted const emitted = bench.emit({{bench.state(1), 0}, {bench.state(2), 1}, {bench.state(0), 2}}, 3);
  std::vector<double> const after = bench.run(emitted, {10, 20, 30});
  CHECK(after[0] == 20);
  CHECK(after[1] == 30);
  CHECK(after[2] == 10);
}

TEST_CASE("new states are computed from the old ones, in whatever order they are updated") {
  EmitBench bench;
  Graph& g = bench.graph;
  NodeId const x = bench.state(0), y = bench.state(1);
  Emitted const emitted = bench.emit({{g.add(x, y), 0}, {g.multiply(x, y), 1}}, 2);
  std::vector<double> const after = bench.run(emitted, {3, 5});
  CHECK(after[0] == 8);
  CHECK(after[1] == 15);
}

TEST_CASE("one value may go to several targets, one of them a register it is computed from") {
  EmitBench bench;
  Graph& g = bench.graph;
  NodeId const sum = g.add(bench.state(0), bench.state(1));
  Emitted const emitted = bench.emit({{sum, 0}, {sum, 1}, {bench.state(0), 2}}, 3);
  std::vector<double> const after = bench.run(emitted, {3, 5, 0});
  CHECK(after[0] == 8);
  CHECK(after[1] == 8);
  CHECK(after[2] == 3);
}

TEST_CASE("a chain of single uses lives in the accumulator and touches no temporary") {
  EmitBench bench;
  Graph& g = bench.graph;
  NodeId value = bench.state(0);
  for (int i = 0; i < 20; ++i) value = g.multiply(g.add(value, g.constant(i + 0.5)), bench.state(1));
  Emitted const emitted = bench.emit({{value, 0}}, 2);
  CHECK(emitted.temporaries == 0);
  for (std::size_t i = 0; i + 1 < emitted.code.size(); ++i) CHECK_FALSE(emitted.code[i].store);
}

TEST_CASE("a balanced tree of 64 values needs as many registers as its depth") {
  EmitBench bench;
  Graph& g = bench.graph;
  std::vector<NodeId> level;
  for (int i = 0; i < 64; ++i) level.push_back(g.multiply(bench.state(i), bench.state(63 - i + (i < 32 ? 0 : 64))));
  while (level.size() > 1) {
    std::vector<NodeId> next;
    for (std::size_t i = 0; i < level.size(); i += 2) next.push_back(g.add(level[i], level[i + 1]));
    level = next;
  }
  Emitted const emitted = bench.emit({{level.front(), std::nullopt}}, 200);
  CHECK(emitted.temporaries <= 7);
}

TEST_CASE("operands no executor reads as uniforms are moved to registers") {
  EmitBench bench;
  Graph& g = bench.graph;
  NodeId const x = bench.state(0);
  NodeId const power = g.power(x, g.constant(1.5));
  Emitted const emitted = bench.emit({{g.add(power, g.power(g.constant(2), x)), 1}}, 2);
  CHECK_NOTHROW(link(emitted.code, 2));
  std::vector<double> const after = bench.run(emitted, {4, 0});
  CHECK(after[1] == 24);
}
