// Compilation of systems: what runs how often, and the text that shows it.
#include "program/simulation_program.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/text/diagnostic.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace {

int count(Code const& code, Opcode opcode) {
  return static_cast<int>(std::count_if(code.begin(), code.end(), [&](Instruction const& i) { return i.opcode == opcode; }));
}

ProgramNames const duffing_names{{"m", "c", "k", "k3", "beta"}, {"x"}, {"y", "y'"}, {"displacement"}};

}  // namespace

TEST_CASE("work that depends on parameters alone leaves the step") {
  SimulationProgram const program = compile(systems::duffing());
  CHECK(count(program.step.code, Opcode::divide) == 0);
  CHECK(count(program.step.code, Opcode::call_unary) == 0);
  CHECK(count(program.prologue.code, Opcode::divide) == 2);  // 1/m, and beta/(2 pi) for the density's constant
  CHECK(count(program.prologue.code, Opcode::call_unary) == 1);
}

TEST_CASE("a normal density accumulates nothing but squares, shared with the sum of squares") {
  SimulationProgram const program = compile(systems::duffing());
  CHECK(program.registers.accumulators == 1);
  REQUIRE(program.observe.size() == 1);
  CHECK(program.observe[0].code.size() == 2);  // the residual; its square added
}

TEST_CASE("a step of Duffing's equation takes at most 37 instructions and 14 rows of registers") {
  // Four evaluations of five operations, three times two to advance, twice four to put together: 34; one to copy a state, and
  // reserve.
  SimulationProgram const program = compile(systems::duffing());
  CHECK(program.step.code.size() <= 37);
  CHECK(program.hot_registers <= 14);
}

TEST_CASE("integer exponents call no power, a free exponent one power per evaluation") {
  CHECK(count(compile(systems::bouc_wen(2)).step.code, Opcode::call_binary) == 0);
  CHECK(count(compile(systems::bouc_wen(4)).step.code, Opcode::call_binary) == 0);
  CHECK(count(compile(systems::bouc_wen(0)).step.code, Opcode::call_binary) == 4);
  CHECK(compile(systems::bouc_wen(2)).step.code.size() <= 56);
}

TEST_CASE("terms of data alone are summed once per data set") {
  SimulationSource source = systems::duffing();
  Graph& g = source.graph;
  NodeId const measured = g.leaf(LeafKind::measured, 0);
  // (measured - y) beta + measured^2: products of data and parameters need no accumulator either.
  source.channels[0].sums = {g.add(g.multiply(g.subtract(measured, g.leaf(LeafKind::state, 0)), g.leaf(LeafKind::parameter, 4)),
                                   g.power(measured, g.constant(2)))};
  SimulationProgram const program = compile(std::move(source));
  CHECK(program.registers.accumulators == 1);
  CHECK(program.observe[0].code.size() == 1);  // total + y
  CHECK(program.data_sums[0].kernel.outputs == 2);
}

TEST_CASE("a sum over a channel that reads no state needs no accumulator") {
  SimulationSource source = systems::duffing();
  source.channels[0].sums = {source.graph.leaf(LeafKind::parameter, 2)};
  SimulationProgram const program = compile(std::move(source));
  CHECK(program.registers.accumulators == 0);
  CHECK(program.observe[0].code.empty());
}

TEST_CASE("an unknown integrator is a fault of ours") {
  SimulationSource source = systems::duffing();
  source.integrator = "magic";
  CHECK_THROWS_AS(compile(std::move(source)), InternalError);
}

TEST_CASE("the dump shows sections, tables and the user's names") {
  std::string const text = dump(compile(systems::duffing()), duffing_names);
  for (char const* part :
       {"integrator rk4; registers: 5 parameters, 3 hoisted, 2 states, 1 accumulators, 2 records, 2 sums,",
        "\nprologue: once per parameter vector\n", "  $0 = divide 1 m\n", "\nstart: initial states\n",
        "\nstep\n  per step, once per data set:\n", "= x@middle\n", "= divide h 6\n",
        "\nobserve displacement: each scored sample\n",
        "    @0 = measured(displacement)\n  _ = subtract @0 y\n  total0 = fused _ _ total0\n", "\nrecord: each sample\n",
        "  record1 = move y'\n", "\nepilogue: once per solve\n", "count(displacement)"}) {
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
  }
}
