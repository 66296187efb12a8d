// Sorts a system's expressions into sections by binding time and emits each.
#include "program/simulation_program.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <tuple>

#include "core/text/diagnostic.hpp"
#include "program/adjoint.hpp"
#include "program/algebra.hpp"
#include "program/embedded.hpp"
#include "program/emit.hpp"
#include "program/registers.hpp"
#include "program/settled.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

// OperandPlace holders for values that only the program has: leaves of kind `unknown`.
constexpr int accumulator_leaf = 1 << 20;       // + accumulator
constexpr int epilogue_uniform_leaf = 1 << 21;  // + position in the epilogue's row

/// A channel's sum as  sum_i factor_i * term_i : terms are accumulators, data sums, or the number of samples.
struct SumTerm {
  NodeId factor;
  NodeId term;  // a place holder
};

class Compilation {
 public:
  explicit Compilation(SimulationSource source) { program_.source = std::move(source); }

  SimulationProgram compile() {
    SimulationSource const& source = program_.source;
    program_.graph = source.graph;
    program_.registers.parameters = source.parameters;
    program_.registers.states = source.states();
    SolverRow const* const solver = find_solver(source.integrator);
    if (solver != nullptr && solver->embedded != nullptr)
      program_.equations = compile_equation_kernels(source);  // where a failed solve is looked into
    if (source.map || (solver != nullptr && solver->in_program)) {
      if (!source.constraints.empty()) throw InternalError("an explicit method for a model with algebraic states");
      expand_step(solver);
      graph_ = program_.graph;
      compile_step();
      if (!source.adjoint_by.empty()) find_adjoint();
    } else if (solver != nullptr) {
      if (!source.constraints.empty() && !solver->implicit)
        throw InternalError("a solver for explicit equations for a model with algebraic states");
      program_.equations = compile_equation_kernels(source);
      graph_ = program_.graph;
      program_.step = section({});
    } else {
      throw InternalError("there is no integrator `" + source.integrator + "`");
    }
    compile_carry();
    for (std::size_t c = 0; c < source.channels.size(); ++c) compile_observation(static_cast<int>(c));
    compile_records();
    compile_epilogue();
    if (!program_.source.adjoint_by.empty()) compile_reverse();
    if (!adjoint_.values.empty()) compile_reverse_values();
    compile_start();
    compile_prologue();
    widest_row_ = std::max(widest_row_, static_cast<int>(source.channels.size()) + data_sums_);
    number_registers(program_, widest_row_);
    return std::move(program_);
  }

 private:
  void expand_step(SolverRow const* solver) {
    if (program_.source.map) {
      program_.next = program_.source.derivative;
      return;
    }
    if (solver->embedded != nullptr) {
      Attempt const values = attempt(program_.graph, solver->embedded(), program_.source.derivative);
      program_.next = values.states;
      control_ = values.control;
      program_.registers.control = static_cast<int>(control_.size());
      return;
    }
    Graph& graph = program_.graph;
    std::vector<NodeId> states;
    for (int i = 0; i < program_.source.states(); ++i) states.push_back(graph.leaf(LeafKind::state, i));
    NodeId const h = graph.leaf(LeafKind::step_size);
    Stages const stages{graph, program_.source.derivative, std::move(states), h, program_.visited};
    program_.next = solver->step(stages);
  }

  void compile_step() {
    std::vector<NodeId> roots = program_.next;
    roots.insert(roots.end(), control_.begin(), control_.end());
    Algebra algebra(graph_, roots);
    std::vector<Goal> goals;
    for (std::size_t i = 0; i < program_.next.size(); ++i) {
      if (is_state(program_.next[i], i)) continue;  // what is remembered stays as it is
      goals.push_back({algebra.rewrite(program_.next[i]), state_bank + static_cast<std::uint32_t>(i)});
    }
    for (std::size_t i = 0; i < control_.size(); ++i)
      goals.push_back({algebra.rewrite(control_[i]), control_bank + static_cast<std::uint32_t>(i)});
    program_.step = section(goals, program_.source.corrects() ? Order::eager : Order::goal_by_goal);
  }

  void find_adjoint() {
    if (!has_adjoint(program_.source)) throw InternalError("an adjoint of a program that has none");
    adjoint_ = adjoint_of(program_.source, graph_, program_.next);
    program_.registers.adjoints = static_cast<int>(adjoint_.step.size());
    program_.registers.slopes = static_cast<int>(adjoint_.slopes.size());
  }

  void compile_reverse() {
    ReverseSections& reverse = program_.reverse;
    std::vector<NodeId> roots = adjoint_.slopes;
    roots.insert(roots.end(), adjoint_.step.begin(), adjoint_.step.end());
    Algebra algebra(graph_, roots);
    std::vector<Goal> goals;
    add_goals(adjoint_.slopes, slope_leaf, slope_bank, algebra, goals);
    add_goals(adjoint_.step, adjoint_leaf, adjoint_bank, algebra, goals);
    reverse.step = section(goals, Order::eager);
    for (std::vector<NodeId> const& observe : adjoint_.observe) {
      Algebra of_channel(graph_, observe);
      goals.clear();
      add_goals(observe, adjoint_leaf, adjoint_bank, of_channel, goals);
      reverse.observe.push_back(section(goals));
    }
    Algebra of_start(graph_, adjoint_.start);
    goals.clear();
    add_goals(adjoint_.start, slope_leaf, slope_bank, of_start, goals);
    reverse.start = section(goals);
  }

  /// Of a record whose steps differ in length, the values of each go their way alone.
  void compile_reverse_values() {
    std::vector<NodeId> sums;
    for (std::size_t i = 0; i < adjoint_.values.size(); ++i)
      sums.push_back(graph_.add(graph_.leaf(LeafKind::unknown, slope_leaf + static_cast<int>(i)), adjoint_.values[i]));
    Algebra algebra(graph_, sums);
    std::vector<Goal> goals;
    add_goals(sums, slope_leaf, slope_bank, algebra, goals);
    program_.reverse.values = section(goals);
  }

  /// Of a bank's registers, those that change: not the leaf that stands for the register itself.
  void add_goals(std::vector<NodeId> const& values, int leaf, std::uint32_t bank, Algebra& algebra, std::vector<Goal>& goals) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] != graph_.leaf(LeafKind::unknown, leaf + static_cast<int>(i)))
        goals.push_back({algebra.rewrite(values[i]), bank + static_cast<std::uint32_t>(i)});
  }

  bool is_state(NodeId id, std::size_t state) const {
    Node const& node = graph_[id];
    return node.operation == Operation::leaf && node.leaf_kind == LeafKind::state && node.index == static_cast<int>(state);
  }

  void compile_carry() {
    std::vector<NodeId> const& memories = program_.source.memories;
    Algebra algebra(graph_, memories);
    auto const first = static_cast<std::uint32_t>(program_.source.derivative.size() - memories.size());
    std::vector<Goal> goals;
    for (std::size_t i = 0; i < memories.size(); ++i)
      goals.push_back({algebra.rewrite(memories[i]), state_bank + first + static_cast<std::uint32_t>(i)});
    program_.carry = section(goals);
  }

  /// Splits the channel's sums and emits what is left to do at each sample.
  void compile_observation(int channel) {
    std::vector<NodeId> const sums = sums_of(channel);
    program_.first_sums.push_back(static_cast<int>(sums_.size()));
    std::vector<NodeId> const& correct = program_.source.channels[static_cast<std::size_t>(channel)].correct;
    std::vector<NodeId> roots = sums;
    roots.insert(roots.end(), correct.begin(), correct.end());
    Observation of{channel, Algebra(graph_, roots), {}, {}, {}};
    for (NodeId const sum : sums) {
      std::vector<SumTerm> terms;
      for (Product const& term : of.algebra.expand(sum)) terms.push_back(split(term, of));
      program_.running_sums.push_back(running(terms));
      sums_.push_back(std::move(terms));
    }
    for (std::size_t i = 0; i < correct.size(); ++i)
      if (!is_state(correct[i], i))
        of.goals.push_back({of.algebra.rewrite(correct[i]), state_bank + static_cast<std::uint32_t>(i)});
    add_records(channel, of.algebra, of.goals);
    program_.observe.push_back(section(of.goals, correct.empty() ? Order::goal_by_goal : Order::eager));
    program_.data_sums.push_back(table(of.data_terms));
  }

  /// Those of the source, and behind them what an adjoint needs of the channel directly.
  std::vector<NodeId> sums_of(int channel) {
    std::vector<NodeId> sums = program_.source.channels[static_cast<std::size_t>(channel)].sums;
    if (adjoint_.direct.empty()) return sums;
    std::vector<NodeId> const& direct = adjoint_.direct[static_cast<std::size_t>(channel)];
    for (std::size_t k = 0; k < direct.size(); ++k) {
      if (graph_.is_constant(direct[k], 0)) continue;
      program_.reverse.direct.push_back({static_cast<int>(sums_.size() + sums.size()), static_cast<int>(k)});
      sums.push_back(direct[k]);
    }
    return sums;
  }

  /// A channel whose sums are being split.
  struct Observation {
    int channel;
    Algebra algebra;
    std::vector<Goal> goals;
    std::vector<NodeId> data_terms;     // that are summed once per data set
    std::map<NodeId, NodeId> place_of;  // term -> its place holder: sums of one channel share accumulators
  };

  /// What parameters give to a term, and a place holder for the sum of the rest.
  SumTerm split(Product term, Observation& of) {
    NodeId const factor = term.negative ? graph_.negate(term.parameter) : term.parameter;
    term.negative = false;
    term.parameter = graph_.constant(1);
    bool const at_step = !term.numerator.empty() || !term.denominator.empty();
    NodeId const value = at_step ? of.algebra.product(term) : term.data;
    auto const [place, fresh] = of.place_of.try_emplace(value, 0);
    if (!fresh) return {factor, place->second};
    if (at_step) {
      int const accumulator = program_.registers.accumulators++;
      place->second = graph_.leaf(LeafKind::unknown, accumulator_leaf + accumulator);
      of.goals.push_back(
          {of.algebra.sum({of.algebra.single(place->second), term}), accumulator_bank + static_cast<std::uint32_t>(accumulator)});
    } else if (graph_.is_constant(value, 1)) {
      place->second = epilogue_uniform(of.channel);
    } else {
      place->second = epilogue_uniform(static_cast<int>(program_.source.channels.size()) + data_sums_++);
      of.data_terms.push_back(value);
    }
    return {factor, place->second};
  }

  /// Of those that are computed at that time.
  void add_records(int time, Algebra& algebra, std::vector<Goal>& goals) {
    SimulationSource const& source = program_.source;
    for (std::size_t i = 0; i < source.records.size(); ++i)
      if ((source.recorded_at.empty() ? before_channels : source.recorded_at[i]) == time)
        goals.push_back({algebra.rewrite(source.records[i]), record_bank + static_cast<std::uint32_t>(i)});
  }

  std::optional<RunningSum> running(std::vector<SumTerm> const& terms) const {
    if (terms.size() != 1) return std::nullopt;
    Node const& place = graph_[terms.front().term];
    auto const factor = graph_.constant_value(terms.front().factor);
    if (!factor || place.leaf_kind != LeafKind::unknown || place.index >= epilogue_uniform_leaf) return std::nullopt;
    return RunningSum{place.index - accumulator_leaf, *factor};
  }

  void compile_records() {
    std::vector<NodeId> const& records = program_.source.records;
    Algebra algebra(graph_, records);
    std::vector<Goal> before, after;
    add_records(before_channels, algebra, before);
    add_records(after_channels, algebra, after);
    program_.registers.records = static_cast<int>(records.size());
    program_.record = section(before);
    program_.record_after = section(after);
  }

  void compile_epilogue() {
    std::vector<Goal> goals;
    for (std::vector<SumTerm> const& terms : sums_) {
      NodeId sum = graph_.constant(0);
      for (SumTerm const& term : terms) {
        sum = graph_.is_constant(term.factor, 1) ? graph_.add(sum, term.term)
              : graph_.is_constant(sum, 0)       ? graph_.multiply(term.factor, term.term)
                                                 : graph_.fused(term.factor, term.term, sum);
      }
      goals.push_back({sum, sum_bank + static_cast<std::uint32_t>(goals.size())});
    }
    program_.registers.sums = static_cast<int>(goals.size());
    program_.epilogue = section(goals);
  }

  void compile_start() {
    std::vector<NodeId> const initial = expand_powers(graph_, program_.source.initial);
    std::vector<Goal> goals;
    for (std::size_t i = 0; i < initial.size(); ++i) goals.push_back({initial[i], state_bank + static_cast<std::uint32_t>(i)});
    hoisting_ = false;
    program_.start = section(goals);
  }

  void compile_prologue() {
    std::vector<NodeId> const values = expand_powers(graph_, hoisted_);
    std::vector<Goal> goals;
    for (std::size_t i = 0; i < values.size(); ++i) goals.push_back({values[i], hoisted_bank + static_cast<std::uint32_t>(i)});
    hoisted_rows_.clear();  // they are what is computed here
    program_.registers.hoisted = static_cast<int>(hoisted_.size());
    program_.prologue = section(goals);
  }

  NodeId epilogue_uniform(int position) { return graph_.leaf(LeafKind::unknown, epilogue_uniform_leaf + position); }

  // --- one section ---

  Section section(std::vector<Goal> const& goals, Order order = Order::goal_by_goal) {
    BindingTimes binding(graph_);
    std::vector<NodeId> row;
    Locate const locate = [&](NodeId id) -> std::optional<Operand> {
      Node const& node = graph_[id];
      if (node.operation == Operation::constant) return Operand{OperandPlace::uniform, constant_bank + constant(node.value)};
      if (node.operation == Operation::leaf) {
        auto const index = static_cast<std::uint32_t>(node.index);
        if (node.leaf_kind == LeafKind::parameter) return Operand{OperandPlace::lane, parameter_bank + index};
        if (node.leaf_kind == LeafKind::state) return Operand{OperandPlace::lane, state_bank + index};
        if (node.leaf_kind == LeafKind::control) return Operand{OperandPlace::lane, control_bank + index};
        if (node.leaf_kind == LeafKind::unknown && node.index >= slope_leaf)
          return Operand{OperandPlace::lane, slope_bank + index - slope_leaf};
        if (node.leaf_kind == LeafKind::unknown && node.index >= adjoint_leaf)
          return Operand{OperandPlace::lane, adjoint_bank + index - adjoint_leaf};
        if (node.leaf_kind == LeafKind::unknown && node.index >= epilogue_uniform_leaf)
          return Operand{OperandPlace::uniform, row_bank + index - epilogue_uniform_leaf};
        if (node.leaf_kind == LeafKind::unknown && node.index >= accumulator_leaf)
          return Operand{OperandPlace::lane, accumulator_bank + index - accumulator_leaf};
      }
      Binding const when = binding(id);
      if (when == Binding::data) {
        row.push_back(id);
        return Operand{OperandPlace::uniform, row_bank + static_cast<std::uint32_t>(row.size() - 1)};
      }
      if (when == Binding::parameter) {
        if (!hoisting_ && node.operation == Operation::leaf) {  // a step that the experiment gives
          row.push_back(id);
          return Operand{OperandPlace::uniform, row_bank + static_cast<std::uint32_t>(row.size() - 1)};
        }
        if (auto const found = hoisted_rows_.find(id); found != hoisted_rows_.end())
          return Operand{OperandPlace::lane, hoisted_bank + found->second};
        if (!hoisting_) return std::nullopt;
        auto const index = static_cast<std::uint32_t>(hoisted_.size());
        hoisted_rows_.emplace(id, index);
        hoisted_.push_back(id);
        return Operand{OperandPlace::lane, hoisted_bank + index};
      }
      return std::nullopt;
    };
    Emitted emitted = emit(graph_, goals, locate, temporary_bank, order);
    program_.registers.temporaries = std::max(program_.registers.temporaries, emitted.temporaries);
    Section result;
    result.code = std::move(emitted.code);
    result.uniforms = table(row);
    return result;
  }

  UniformTable table(std::vector<NodeId> const& values) {
    UniformTable result;
    std::vector<NodeId> leaves;
    for (NodeId const id : graph_.reachable(values)) {
      Node const& node = graph_[id];
      if (node.operation != Operation::leaf) continue;
      leaves.push_back(id);
      result.leaves.push_back({node.leaf_kind, node.index, node.stage, node.lag});
    }
    result.kernel = compile_kernel(graph_, leaves, values);
    widest_row_ = std::max(widest_row_, result.kernel.outputs);
    return result;
  }

  std::uint32_t constant(double value) {
    auto const [found, fresh] =
        constants_.try_emplace(std::bit_cast<std::uint64_t>(value), static_cast<std::uint32_t>(program_.constants.size()));
    if (fresh) program_.constants.push_back(value);
    return found->second;
  }

  SimulationProgram program_;
  Graph graph_;                  // grows by algebra
  std::vector<NodeId> control_;  // step control after an attempt
  std::vector<NodeId> hoisted_;  // values of the prologue
  std::map<NodeId, std::uint32_t> hoisted_rows_;
  bool hoisting_ = true;
  std::map<std::uint64_t, std::uint32_t> constants_;
  std::vector<std::vector<SumTerm>> sums_;  // of all channels
  AdjointExpressions adjoint_;
  int data_sums_ = 0;
  int widest_row_ = 0;
};

}  // namespace

bool SimulationSource::corrects() const {
  return std::ranges::any_of(channels, [](ChannelSource const& channel) { return !channel.correct.empty(); });
}

int SimulationProgram::sum_count() const { return registers.sums; }

int SimulationProgram::sum_row(int channel, int k) const { return first_sums[static_cast<std::size_t>(channel)] + k; }

SimulationProgram compile(SimulationSource source) {
  std::optional<SettledSource> settled = settled_source(source);
  SimulationProgram program = Compilation(std::move(source)).compile();
  if (settled)
    program.settled = std::make_shared<SettledProgram const>(
        SettledProgram{Compilation(std::move(settled->source)).compile(), std::move(settled->moving), std::move(settled->fixed)});
  return program;
}

}  // namespace sysid
