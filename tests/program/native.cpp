// Machine code against the scalar oracle, bit for bit: random programs and every operation on every kind of number, all vectors and
// widths.
#include <doctest/doctest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/numeric/instruction_set.hpp"
#include "core/numeric/lanes.hpp"
#include "native/machine_code.hpp"
#include "native/module.hpp"
#include "program/interpreter/executor.hpp"
#include "program/kernel.hpp"
#include "program/random_expressions.hpp"
#include "program/upper_halves.hpp"

using namespace sysid;

namespace {

bool same_number(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (a != a && b != b);
}

/// Of all sets: where a processor has no 512-bit vectors, the compiler makes two of one.
std::vector<Executor> all_native_executors() {
  std::vector<Executor> all;
  for (InstructionSet const set : {narrowest_instruction_set, InstructionSet::avx512})
    for (Executor const& each : native_executors(set))
      if (each.set == set) all.push_back(each);
  return all;
}

/// Numbers that operations treat in ways of their own, and others.
double awkward(Stream& stream) {
  double const all[] = {0.0,
                        -0.0,
                        1.0,
                        -1.0,
                        std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity(),
                        std::nan(""),
                        -std::nan(""),
                        5e-324,
                        -1e-310,
                        std::numeric_limits<double>::max(),
                        -std::numeric_limits<double>::max()};
  std::uint64_t const which = stream.below(24);
  return which < 12 ? all[which] : 3 * stream.normal();
}

/// The code as a loop over one sample, after which all its registers can be read.
native::Loop loop_of(Code const& code, std::vector<double> const& constants, int registers, Executor executor) {
  native::Loop loop;
  loop.kind = native::LoopKind::observe;
  loop.wide = executor.set == InstructionSet::avx512;
  loop.vector_lanes = executor.width == 1 ? 1 : loop.wide ? 8 : 4;
  loop.vectors = executor.width / loop.vector_lanes;
  loop.stride = executor.stride();
  loop.constants = constants;
  loop.samples = {{code, 0}};
  loop.kept = registers;
  return loop;
}

void run_native(native::Function function, double* registers) {
  double const row = 0;
  double const* const rows = &row;
  std::uint8_t const flag = 1;
  std::uint8_t const* const summed = &flag;
  native::Call call;
  call.registers = registers;
  call.rows = &rows;
  call.summed = &summed;
  call.to = 1;
  function(&call);
  CHECK(testing::upper_halves_are_clear());
}

std::unique_ptr<native::Machine> compiled(native::Loop const& loop) {
  native::Module const* const compiler = native::module();
  REQUIRE(compiler != nullptr);
  std::string why;
  auto machine = compiler->compile(loop, why);
  REQUIRE_MESSAGE(machine != nullptr, why);
  return machine;
}

/// Where the registers of the machine code and of the oracle differ, on `inputs` rows of awkward numbers; -1: nowhere.
int first_difference(native::Machine const& machine, Code const& code, std::vector<double> const& constants, int inputs,
                     int registers, Executor executor, std::uint64_t seed) {
  LaneArray file(registers, executor.stride()), expected(registers, executor.width);
  for (int w = 0; w < executor.width; ++w) {
    Stream stream({.seed = seed, .purpose = Purpose::test, .index = static_cast<std::uint64_t>(w), .step = 0});
    std::vector<double> scalar(static_cast<std::size_t>(registers));
    for (int r = 0; r < inputs; ++r) scalar[static_cast<std::size_t>(r)] = file(r, w) = awkward(stream);
    run_scalar(code, constants.data(), scalar.data());
    for (int r = 0; r < registers; ++r) expected(r, w) = scalar[static_cast<std::size_t>(r)];
  }
  run_native(machine.function(), file.view().data());
  for (int r = 0; r < registers; ++r)
    for (int w = 0; w < executor.width; ++w)
      if (!same_number(file(r, w), expected(r, w))) return r;
  return -1;
}

}  // namespace

TEST_CASE("machine code of every operation equals the oracle for zeros, infinities, NaNs and subnormals") {
  Function const logarithm = log_function;
  constexpr Function power{"pow", 2, nullptr, nullptr, &elementary::pow, &elementary::pow_lanes, nullptr};
  for (Executor const& executor : all_native_executors()) {
    Code code;
    std::vector<double> const constants = {-0.0, 2.5, std::nan("")};
    for (int o = 0; o <= static_cast<int>(Opcode::call_binary); ++o) {
      auto const opcode = static_cast<Opcode>(o);
      int const operands = capability(opcode).operands;
      auto const lane = [](std::uint32_t index) { return Operand{OperandPlace::lane, index}; };
      Instruction instruction{.opcode = opcode, .store = true, .target = static_cast<std::uint32_t>(3 + o), .a = lane(0)};
      if (operands > 1) instruction.b = lane(1);
      if (operands > 2) instruction.c = lane(2);
      if (opcode == Opcode::call_unary) instruction.function = &logarithm;
      if (opcode == Opcode::call_binary) instruction.function = &power;
      code.push_back(instruction);
    }
    // What comparisons leave is used by choices and by logic, by way of the accumulator too.
    auto next = static_cast<std::uint32_t>(3 + code.size());
    std::uint32_t const less = 3 + static_cast<std::uint32_t>(Opcode::less),
                        logic = 3 + static_cast<std::uint32_t>(Opcode::conjunction);
    for (Opcode const opcode : {Opcode::select, Opcode::conjunction, Opcode::disjunction, Opcode::negation, Opcode::less})
      for (std::uint32_t const of : {less, logic})
        code.push_back({.opcode = opcode,
                        .store = true,
                        .target = next++,
                        .a = {OperandPlace::lane, of},
                        .b = {OperandPlace::lane, 1},
                        .c = {OperandPlace::uniform, next % 3}});
    // Functions over lanes are called in registers where there is such a form, else through memory. AVX-512 has more registers for
    // narrow vectors too.
    for (int const way : {0, 1, 2}) {
      bool const in_registers = way > 0;
      native::Loop loop = loop_of(code, constants, static_cast<int>(next), executor);
      if (way == 2) loop.wide = true;
      if (in_registers) loop.vector_form = &elementary::vector_form;
      if (in_registers && loop.wide && supported_instruction_set() != InstructionSet::avx512) continue;
      auto const machine = compiled(loop);
      for (std::uint64_t seed = 0; seed < 400; ++seed) {
        CAPTURE(executor.width);
        CAPTURE(seed);
        CHECK(first_difference(*machine, code, constants, 3, static_cast<int>(next), executor, seed) == -1);
      }
    }
  }
}

TEST_CASE("machine code of random programs equals the oracle bit for bit") {
  for (std::uint64_t index = 0; index < 25; ++index) {
    Stream stream({.seed = 21, .purpose = Purpose::test, .index = index, .step = 0});
    Graph graph;
    std::vector<NodeId> leaves;
    for (int i = 0; i < 5; ++i) leaves.push_back(graph.leaf(LeafKind::unknown, i));
    std::vector<NodeId> const outputs = testing::random_expressions(graph, leaves, 10 + static_cast<int>(stream.below(120)),
                                                                    1 + static_cast<int>(stream.below(8)), stream);
    Kernel const kernel = compile_kernel(graph, leaves, outputs);
    CAPTURE(index);
    for (Executor const& executor : all_native_executors()) {
      CAPTURE(executor.width);
      auto const machine = compiled(loop_of(kernel.code, kernel.constants, kernel.registers, executor));
      for (std::uint64_t seed = 0; seed < 5; ++seed)
        CHECK(first_difference(*machine, kernel.code, kernel.constants, kernel.inputs, kernel.registers, executor, seed) == -1);
    }
  }
}

TEST_CASE("where memory may not become executable, there is no machine code and a reason") {
  REQUIRE(native::module() != nullptr);
  int channel[2];
  REQUIRE(pipe(channel) == 0);
  pid_t const child = fork();
  if (child == 0) {
    // mprotect(..., PROT_EXEC) is refused from here on.
    sock_filter filter[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_mprotect, 0, 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args[2])),
        BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, PROT_EXEC, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    sock_fprog const program{sizeof filter / sizeof *filter, filter};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) _exit(3);
    Code const code = {{.opcode = Opcode::negate, .target = 1, .a = {OperandPlace::lane, 0}}};
    std::string why;
    auto const machine = native::module()->compile(loop_of(code, {}, 2, all_native_executors().front()), why);
    [[maybe_unused]] auto const written = write(channel[1], why.data(), why.size());
    _exit(machine == nullptr ? 0 : 1);
  }
  close(channel[1]);
  char text[400] = {};
  [[maybe_unused]] auto const got = read(channel[0], text, sizeof text - 1);
  close(channel[0]);
  int status = 0;
  waitpid(child, &status, 0);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK_MESSAGE(std::string(text).find("ermission denied") != std::string::npos, text);
}

TEST_CASE("a loop waits for machine code until it has been interpreted for as long as compiling it takes") {
  native::MachineCode code;
  native::LoopName const narrow{.width = 4}, wide{.width = 16};
  double const compilation = 0.013;
  CHECK_FALSE(code.pays(narrow, 0.012, compilation));
  CHECK_FALSE(code.pays(wide, 0.009, compilation));
  // Loading the compiler takes 50 ms of all loops together, of which no more than one has to be compiled.
  CHECK(code.pays(narrow, 0.05, compilation));
  CHECK(code.pays(narrow, 0, compilation));
  CHECK_FALSE(code.pays(wide, 0.001, compilation));
}

TEST_CASE("of much interpretation that is known to come, a part is enough for machine code") {
  native::LoopName const narrow{.width = 4}, wide{.width = 16};
  double const compilation = 0.012;
  native::MachineCode little;
  little.expect(0.04);  // with what there has been, less than the compiler is loaded for
  CHECK_FALSE(little.pays(narrow, 0.006, compilation));
  native::MachineCode much;
  much.expect(0.2);
  CHECK_FALSE(much.pays(narrow, 0.002, compilation));
  CHECK_FALSE(much.pays(wide, 0.002, compilation));
  CHECK(much.pays(wide, 0.002, compilation));
  native::MachineCode over;  // what was expected has come
  over.expect(0.2);
  CHECK(over.pays(wide, 0.19, compilation));
  CHECK_FALSE(over.pays(narrow, 0.004, compilation));
}
