// Kernels: no heavy algebra, they are not hot; what matters is that their values are those of the expressions.
#include "program/kernel.hpp"

#include <algorithm>
#include <unordered_map>

#include "core/text/diagnostic.hpp"
#include "program/algebra.hpp"
#include "program/emit.hpp"
#include "program/interpreter/executor.hpp"

namespace sysid {
namespace {

/// Runs one block of at most executor.width lanes; what the block has more is a copy of its last lane.
void run_block(Kernel const& kernel, Executor executor, double* file, ConstLanes inputs, Lanes out) {
  double* const rows = file + uniform_space(static_cast<int>(kernel.constants.size()));
  int const lanes = inputs.rows() > 0 ? inputs.width() : out.width();
  for (int r = 0; r < kernel.inputs; ++r) {
    double* const row = rows + r * executor.stride();
    for (int w = 0; w < executor.width; ++w) row[w] = inputs(r, std::min(w, lanes - 1));
  }
  run(*kernel.linked, executor, file);
  for (int r = 0; r < kernel.outputs; ++r) {
    Operand const result = kernel.results[static_cast<std::size_t>(r)];
    for (int w = 0; w < lanes; ++w)
      out(r, w) = result.place == OperandPlace::uniform ? kernel.constants[result.index]
                                                        : rows[static_cast<int>(result.index) * executor.stride() + w];
  }
}

}  // namespace

Kernel compile_kernel(Graph const& graph, std::span<NodeId const> input_leaves, std::span<NodeId const> outputs) {
  Graph work = graph;
  std::vector<NodeId> const roots = expand_powers(work, outputs);

  Kernel kernel;
  kernel.inputs = static_cast<int>(input_leaves.size());
  kernel.outputs = static_cast<int>(outputs.size());
  std::unordered_map<NodeId, std::uint32_t> rows;
  for (std::size_t i = 0; i < input_leaves.size(); ++i) rows.emplace(input_leaves[i], static_cast<std::uint32_t>(i));
  Locate const locate = [&](NodeId id) -> std::optional<Operand> {
    if (auto const found = rows.find(id); found != rows.end()) return Operand{OperandPlace::lane, found->second};
    if (std::optional<double> const value = work.constant_value(id)) {
      kernel.constants.push_back(*value);
      return Operand{OperandPlace::uniform, static_cast<std::uint32_t>(kernel.constants.size() - 1)};
    }
    if (work[id].operation == Operation::leaf) throw InternalError("a kernel reads a leaf that is not among its inputs");
    return std::nullopt;
  };
  std::vector<Goal> goals;
  for (NodeId const root : roots) goals.push_back({root, std::nullopt});
  Emitted emitted = emit(work, goals, locate, static_cast<std::uint32_t>(kernel.inputs));
  kernel.registers = kernel.inputs + emitted.temporaries;
  kernel.code = std::move(emitted.code);
  kernel.results = std::move(emitted.results);
  kernel.linked = link(kernel.code, static_cast<int>(kernel.constants.size()));
  return kernel;
}

void run(Kernel const& kernel, ConstLanes inputs, Lanes out) {
  int const width = out.width();
  if (width == 0 || kernel.outputs == 0) return;
  Executor const executor = choose_executor(width);
  int const uniforms = uniform_space(static_cast<int>(kernel.constants.size()));
  LaneArray memory(1, uniforms + kernel.registers * executor.stride());
  double* const file = memory.view().data();
  std::copy(kernel.constants.begin(), kernel.constants.end(), file);
  for (int first = 0; first < width; first += executor.width) {
    int const count = std::min(executor.width, width - first);
    run_block(kernel, executor, file, kernel.inputs > 0 ? inputs.columns(first, count) : inputs, out.columns(first, count));
  }
}

void run_scalar(Kernel const& kernel, std::span<double const> inputs, std::span<double> out) {
  std::vector<double> registers(static_cast<std::size_t>(kernel.registers));
  std::copy(inputs.begin(), inputs.end(), registers.begin());
  run_scalar(kernel.code, kernel.constants.data(), registers.data());
  for (std::size_t r = 0; r < out.size(); ++r) {
    Operand const result = kernel.results[r];
    out[r] = result.place == OperandPlace::uniform ? kernel.constants[result.index] : registers[result.index];
  }
}

}  // namespace sysid
