// Programs as text: one line per instruction, the user's names for what the user named, %n for temporaries, $n for hoisted values.
#include <fmt/format.h>

#include <functional>
#include <iterator>

#include "program/embedded.hpp"
#include "program/simulation_program.hpp"

namespace sysid {
namespace {

using NameRegister = std::function<std::string(std::uint32_t)>;
using NameUniform = std::function<std::string(std::uint32_t)>;

std::string operand(Operand const& operand, NameRegister const& name_register, NameUniform const& name_uniform) {
  switch (operand.place) {
    case OperandPlace::lane:
      return name_register(operand.index);
    case OperandPlace::uniform:
      return name_uniform(operand.index);
    case OperandPlace::accumulator:
      return "_";
    case OperandPlace::none:
      break;
  }
  return {};
}

void write(std::string& text, Code const& code, NameRegister const& name_register, NameUniform const& name_uniform) {
  for (Instruction const& i : code) {
    std::string line = fmt::format("  {} = {}", i.store ? name_register(i.target) : "_",
                                   i.function != nullptr ? i.function->name : capability(i.opcode).name);
    for (Operand const& each : {i.a, i.b, i.c})
      if (each.place != OperandPlace::none) line += " " + operand(each, name_register, name_uniform);
    text += line + "\n";
  }
}

std::string const& at(std::vector<std::string> const& names, int index) { return names.at(static_cast<std::size_t>(index)); }

class Dump {
 public:
  Dump(SimulationProgram const& program, ProgramNames const& names) : program_(program), names_(names) {}

  std::string text() {
    RegisterLayout const& layout = program_.registers;
    text_ = fmt::format(
        "# {}; registers: {} parameters, {} hoisted, {} states, {} accumulators, {} records, {} sums, {} temporaries\n"
        "# a step and its observations touch {} of them; _ is the accumulator\n",
        program_.source.map && !program_.source.stepped ? "map from sample to sample" : "integrator " + program_.source.integrator,
        layout.parameters, layout.hoisted, layout.states, layout.accumulators, layout.records, layout.sums, layout.temporaries,
        program_.hot_registers);
    section("prologue: once per parameter vector", program_.prologue, "");
    section("start: initial states", program_.start, "");
    if (!program_.source.memories.empty()) section("carry: what each sample leaves to remember", program_.carry, "sample");
    section("step", program_.step, "step");
    for (std::size_t c = 0; c < program_.observe.size(); ++c)
      section(fmt::format("observe {}: each scored sample", at(names_.channels, static_cast<int>(c))), program_.observe[c],
              "sample");
    section("record: each sample", program_.record, "sample");
    if (!program_.record_after.code.empty()) section("record: each sample, after its channels", program_.record_after, "sample");
    if (!program_.source.adjoint_by.empty()) reverse(program_.reverse);
    section("epilogue: once per solve", program_.epilogue, "");
    return std::move(text_);
  }

 private:
  void reverse(ReverseSections const& sections) {
    section("back over a step", sections.step, "step");
    for (std::size_t c = 0; c < sections.observe.size(); ++c)
      section(fmt::format("back over {}: each scored sample", at(names_.channels, static_cast<int>(c))), sections.observe[c],
              "sample");
    section("back over the start", sections.start, "");
  }

  void section(std::string const& title, Section const& section, std::string const& per) {
    text_ += "\n" + title + "\n";
    Kernel const& table = section.uniforms.kernel;
    if (table.outputs > 0) {
      text_ += fmt::format("  per {}, once per data set:\n", per);
      auto const leaf = [&](int row) { return leaf_name(section.uniforms.leaves[static_cast<std::size_t>(row)]); };
      auto const name_register = [&](std::uint32_t r) {
        return static_cast<int>(r) < table.inputs ? leaf(static_cast<int>(r))
                                                  : fmt::format("%{}", r - static_cast<std::uint32_t>(table.inputs));
      };
      auto const name_constant = [&](std::uint32_t u) { return fmt::format("{}", table.constants[u]); };
      std::string lines;
      write(lines, table.code, name_register, name_constant);
      for (int k = 0; k < table.outputs; ++k)
        lines += fmt::format("  @{} = {}\n", k, operand(table.results[static_cast<std::size_t>(k)], name_register, name_constant));
      std::size_t begin = 0;
      for (std::size_t end = lines.find('\n'); end != std::string::npos; begin = end + 1, end = lines.find('\n', begin))
        text_ += "  " + lines.substr(begin, end + 1 - begin);
    }
    auto const name_uniform = [&](std::uint32_t u) {
      if (u < program_.constants.size()) return fmt::format("{}", program_.constants[u]);
      int const k = static_cast<int>(u - program_.constants.size());
      if (&section != &program_.epilogue) return fmt::format("@{}", k);
      int const channels = static_cast<int>(program_.source.channels.size());
      return k < channels ? fmt::format("count({})", at(names_.channels, k)) : fmt::format("data_sum{}", k - channels);
    };
    write(
        text_, section.code, [this](std::uint32_t r) { return register_name(static_cast<int>(r)); }, name_uniform);
  }

  std::string register_name(int r) const {
    RegisterLayout const& layout = program_.registers;
    if (r >= layout.first_temporary()) return fmt::format("%{}", r - layout.first_temporary());
    if (r >= layout.first_sum()) return fmt::format("sum{}", r - layout.first_sum());
    if (r >= layout.first_record()) return fmt::format("record{}", r - layout.first_record());
    if (r >= layout.first_slope()) return fmt::format("slope{}", r - layout.first_slope());
    if (r >= layout.first_adjoint()) return fmt::format("adjoint({})", at(names_.states, r - layout.first_adjoint()));
    if (r >= layout.first_accumulator()) return fmt::format("total{}", r - layout.first_accumulator());
    if (r >= layout.first_control()) return control_name(r - layout.first_control());
    if (r >= layout.first_state()) return at(names_.states, r - layout.first_state());
    if (r >= layout.first_hoisted()) return fmt::format("${}", r - layout.first_hoisted());
    return at(names_.parameters, r);
  }

  std::string control_name(int index) const {
    switch (static_cast<Control>(index)) {
      case Control::position:
        return "position";
      case Control::step:
        return "step";
      case Control::aim:
        return "aim";
      case Control::hunts:
        return "hunts";
      default:
        break;
    }
    int const rest = index - static_cast<int>(Control::rest), states = static_cast<int>(names_.states.size());
    return rest < states ? fmt::format("reached({})", at(names_.states, rest)) : fmt::format("side{}", rest - states);
  }

  std::string leaf_name(UniformLeaf const& leaf) const {
    std::string const name = present_name(leaf);
    return leaf.lag == 0 ? name : fmt::format("lag({}, {})", name, leaf.lag);
  }

  std::string present_name(UniformLeaf const& leaf) const {
    std::string const stage = leaf.stage == Stage::begin ? "" : leaf.stage == Stage::middle ? "@middle" : "@end";
    switch (leaf.kind) {
      case LeafKind::input:
        return at(names_.inputs, leaf.index) + stage;
      case LeafKind::input_rate:
        return at(names_.inputs, leaf.index) + "'" + stage;
      case LeafKind::time:
        return "time" + stage;
      case LeafKind::measured:
        return fmt::format("measured({})", at(names_.channels, leaf.index));
      case LeafKind::coefficient:
        return fmt::format("{}.{}", at(names_.inputs, leaf.index / (largest_input_degree + 1)),
                           leaf.index % (largest_input_degree + 1));
      case LeafKind::interval: {
        constexpr std::string_view names[] = {"begin", "length", "relative", "absolute"};
        return std::string(names[leaf.index]);
      }
      default:
        return "h";
    }
  }

  SimulationProgram const& program_;
  ProgramNames const& names_;
  std::string text_;
};

}  // namespace

std::string dump(SimulationProgram const& program, ProgramNames const& names) { return Dump(program, names).text(); }

std::string dump(Kernel const& kernel, std::function<std::string(int)> const& name_of) {
  auto const name_register = [&](std::uint32_t r) {
    return static_cast<int>(r) < kernel.inputs ? name_of(static_cast<int>(r))
                                               : fmt::format("%{}", static_cast<int>(r) - kernel.inputs);
  };
  auto const name_constant = [&](std::uint32_t u) { return fmt::format("{}", kernel.constants[u]); };
  std::string text;
  write(text, kernel.code, name_register, name_constant);
  for (std::size_t k = 0; k < kernel.results.size(); ++k)
    text += fmt::format("  out{} = {}\n", k, operand(kernel.results[k], name_register, name_constant));
  return text;
}

}  // namespace sysid
