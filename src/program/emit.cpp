// Three passes: which instructions (lowering, negations folded into fused operations), in which order (depth first, the needier
// operand first, so that the last one computed is at hand in the accumulator), and where their results live (linear scan).
#include "program/emit.hpp"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "core/numeric/elementary.hpp"
#include "core/text/diagnostic.hpp"
#include "program/eager_order.hpp"

namespace sysid {
namespace {

constexpr Function pow_function{"pow", 2, nullptr, nullptr, &elementary::pow, &elementary::pow_lanes, nullptr};
constexpr int never = std::numeric_limits<int>::max();

Opcode opcode_of(Operation operation) {
  switch (operation) {
    case Operation::negate:
      return Opcode::negate;
    case Operation::add:
      return Opcode::add;
    case Operation::subtract:
      return Opcode::subtract;
    case Operation::multiply:
      return Opcode::multiply;
    case Operation::divide:
      return Opcode::divide;
    case Operation::power:
      return Opcode::call_binary;
    case Operation::square_root:
      return Opcode::square_root;
    case Operation::absolute:
      return Opcode::absolute;
    case Operation::sign:
      return Opcode::sign;
    case Operation::minimum:
      return Opcode::minimum;
    case Operation::maximum:
      return Opcode::maximum;
    case Operation::floor:
      return Opcode::floor;
    case Operation::less:
      return Opcode::less;
    case Operation::less_equal:
      return Opcode::less_equal;
    case Operation::equal:
      return Opcode::equal;
    case Operation::conjunction:
      return Opcode::conjunction;
    case Operation::disjunction:
      return Opcode::disjunction;
    case Operation::negation:
      return Opcode::negation;
    case Operation::select:
      return Opcode::select;
    default:
      throw InternalError("a leaf of the program has no place");
  }
}

/// One operation before registers are known.
struct Lowered {
  Opcode opcode = Opcode::move;
  Function const* function = nullptr;
  std::vector<NodeId> operands;
  int uses = 0;       // as an operand or goal
  int need = 0;       // registers its evaluation takes, sharing ignored (Sethi and Ullman 1970)
  int position = -1;  // in the order of evaluation
  int last_use = -1;
  bool stored = false;  // somebody reads it from a register
  Operand home;
};

class Emission {
 public:
  Emission(Graph const& graph, std::span<Goal const> goals, Locate const& locate, std::uint32_t first_temporary, Order order)
      : graph_(graph), goals_(goals), locate_(locate), first_temporary_(first_temporary), wanted_(order) {}

  Emitted emit() {
    for (Goal const& goal : goals_) lower_below(goal.node);
    for (Goal const& goal : goals_)
      if (auto const found = lowered_.find(goal.node); found != lowered_.end()) ++found->second.uses;
    for (Goal const& goal : goals_) schedule(goal.node);
    if (wanted_ == Order::eager) reorder();
    find_last_uses();
    assign_targets();
    for (std::size_t i = 0; i < order_.size(); ++i) write(static_cast<int>(i));
    finish();
    return std::move(emitted_);
  }

 private:
  std::optional<Operand> located(NodeId node) {
    if (auto const found = located_.find(node); found != located_.end()) return found->second;
    return located_[node] = locate_(node);
  }

  /// The instruction of a node: signs of a fused operation's operands go into its opcode.
  Lowered lower(NodeId id) const {
    Node const& node = graph_[id];
    Lowered lowered;
    if (node.operation == Operation::fused) {
      bool minus_product = false, minus_sum = false;
      auto const strip = [&](NodeId operand, bool& minus) {
        if (graph_[operand].operation != Operation::negate) return operand;
        minus = !minus;
        return graph_[operand].a;
      };
      NodeId const a = strip(node.a, minus_product), b = strip(node.b, minus_product), c = strip(node.c, minus_sum);
      lowered.opcode = minus_product ? (minus_sum ? Opcode::fused_both : Opcode::fused_negate)
                                     : (minus_sum ? Opcode::fused_subtract : Opcode::fused);
      lowered.operands = {a, b, c};
      return lowered;
    }
    if (node.operation == Operation::call) {
      lowered.opcode = node.function->arity == 1 ? Opcode::call_unary : Opcode::call_binary;
      lowered.function = node.function;
    } else {
      lowered.opcode = opcode_of(node.operation);
      if (node.operation == Operation::power) lowered.function = &pow_function;
    }
    NodeId const operands[] = {node.a, node.b, node.c};
    lowered.operands.assign(operands, operands + graph_.operand_count(id));
    return lowered;
  }

  void lower_below(NodeId root) {
    std::vector<NodeId> open{root};
    std::vector<NodeId> found;
    while (!open.empty()) {
      NodeId const id = open.back();
      open.pop_back();
      if (located(id) || lowered_.contains(id)) continue;
      Lowered lowered = lower(id);
      open.insert(open.end(), lowered.operands.begin(), lowered.operands.end());
      lowered_.emplace(id, std::move(lowered));
      found.push_back(id);
    }
    std::sort(found.begin(), found.end());  // operands before users
    for (NodeId const id : found) {
      Lowered& lowered = lowered_.at(id);
      std::vector<int> needs;
      for (NodeId const operand : lowered.operands) {
        auto const below = lowered_.find(operand);
        if (below == lowered_.end()) continue;
        ++below->second.uses;
        needs.push_back(below->second.need);
      }
      std::sort(needs.rbegin(), needs.rend());
      lowered.need = 1;
      for (std::size_t i = 0; i < needs.size(); ++i) lowered.need = std::max(lowered.need, needs[i] + static_cast<int>(i));
    }
  }

  void schedule(NodeId root) {
    struct Frame {
      NodeId node;
      std::vector<NodeId> pending;  // needy ones last, as they are taken from the back
    };
    std::vector<Frame> stack;
    auto const enter = [&](NodeId id) {
      auto const found = lowered_.find(id);
      if (found == lowered_.end() || found->second.position >= 0) return;
      std::vector<NodeId> pending;
      for (NodeId const operand : found->second.operands)
        if (lowered_.contains(operand)) pending.push_back(operand);
      std::stable_sort(pending.begin(), pending.end(),
                       [&](NodeId a, NodeId b) { return lowered_.at(a).need < lowered_.at(b).need; });
      stack.push_back({id, std::move(pending)});
    };
    enter(root);
    while (!stack.empty()) {
      if (stack.back().pending.empty()) {
        NodeId const id = stack.back().node;
        stack.pop_back();
        Lowered& lowered = lowered_.at(id);
        if (lowered.position >= 0) continue;
        lowered.position = static_cast<int>(order_.size());
        order_.push_back(id);
      } else {
        NodeId const next = stack.back().pending.back();
        stack.back().pending.pop_back();
        enter(next);
      }
    }
  }

  void reorder() {
    std::vector<std::vector<std::size_t>> operands(order_.size());
    std::vector<bool> kept(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      for (NodeId const operand : lowered_.at(order_[i]).operands)
        if (auto const found = lowered_.find(operand); found != lowered_.end())
          operands[i].push_back(static_cast<std::size_t>(found->second.position));
      std::sort(operands[i].begin(), operands[i].end());
      operands[i].erase(std::unique(operands[i].begin(), operands[i].end()), operands[i].end());
    }
    for (Goal const& goal : goals_)
      if (auto const found = lowered_.find(goal.node); found != lowered_.end())
        kept[static_cast<std::size_t>(found->second.position)] = true;
    std::vector<NodeId> order;
    for (std::size_t const i : eager_order(operands, kept)) {
      lowered_.at(order_[i]).position = static_cast<int>(order.size());
      order.push_back(order_[i]);
    }
    order_ = std::move(order);
  }

  /// Operands that no executor reads as a uniform are moved to a register first.
  std::vector<bool> moved(Lowered const& lowered) {
    std::vector<bool> result;
    int uniforms = 0;
    bool const call = lowered.opcode == Opcode::call_unary || lowered.opcode == Opcode::call_binary;
    for (std::size_t i = 0; i < lowered.operands.size(); ++i) {
      std::optional<Operand> const place = located(lowered.operands[i]);
      bool const uniform = place && place->place == OperandPlace::uniform;
      bool const only_lane = call || lowered.operands.size() == 1 || (lowered.opcode == Opcode::select && i == 0);
      // Of the two factors or addends at most one may be uniform; the third operand is free.
      bool const second = uniform && uniforms > 0 && i < 2 && lowered.opcode != Opcode::select;
      uniforms += uniform ? 1 : 0;
      result.push_back(uniform && (only_lane || second));
    }
    return result;
  }

  bool reads_accumulator(Lowered const& lowered) {
    if (!capability(lowered.opcode).accumulator) return false;
    std::vector<bool> const moves = moved(lowered);  // a move in between takes the accumulator
    return std::none_of(moves.begin(), moves.end(), [](bool move) { return move; });
  }

  void find_last_uses() {
    for (std::size_t i = 0; i < order_.size(); ++i) {
      int const position = static_cast<int>(i);
      Lowered& user = lowered_.at(order_[i]);
      bool const accumulator = reads_accumulator(user);
      for (NodeId const operand : user.operands) {
        if (auto const found = lowered_.find(operand); found != lowered_.end()) {
          found->second.last_use = position;
          if (!accumulator || found->second.position != position - 1) found->second.stored = true;
        } else if (Operand const place = *located(operand); place.place == OperandPlace::lane) {
          last_read_[place.index] = position;
        }
      }
    }
    for (NodeId const id : order_) {
      Lowered& lowered = lowered_.at(id);
      if (!capability(lowered.opcode).accumulator) lowered.stored = true;
    }
    // What a goal copies at the end must survive until then.
    for (Goal const& goal : goals_) {
      if (auto const found = lowered_.find(goal.node); found != lowered_.end()) {
        found->second.stored = true;
        found->second.last_use = never;
      } else if (Operand const place = *located(goal.node);
                 place.place == OperandPlace::lane && !(goal.target && *goal.target == place.index)) {
        last_read_[place.index] = never;
      }
    }
  }

  /// A goal's value is computed straight into its target when nobody reads the target's old value later.
  void assign_targets() {
    for (Goal const& goal : goals_) {
      auto const found = lowered_.find(goal.node);
      if (found == lowered_.end() || !goal.target || found->second.home.place != OperandPlace::none) continue;
      auto const read = last_read_.find(*goal.target);
      if (read == last_read_.end() || read->second <= found->second.position)
        found->second.home = {OperandPlace::lane, *goal.target};
    }
  }

  Operand take_temporary() {
    auto const free = std::find(free_.begin(), free_.end(), true);
    std::size_t const index = static_cast<std::size_t>(free - free_.begin());
    if (free == free_.end())
      free_.push_back(false);
    else
      *free = false;
    emitted_.temporaries = std::max(emitted_.temporaries, static_cast<int>(free_.size()));
    return {OperandPlace::lane, first_temporary_ + static_cast<std::uint32_t>(index)};
  }

  void release(Operand operand) {
    if (operand.place == OperandPlace::lane && operand.index >= first_temporary_ && operand.index - first_temporary_ < free_.size())
      free_[operand.index - first_temporary_] = true;
  }

  void write(int position) {
    NodeId const id = order_[static_cast<std::size_t>(position)];
    Lowered& lowered = lowered_.at(id);
    std::vector<bool> const moves = moved(lowered);
    bool const accumulator = reads_accumulator(lowered);
    std::vector<Operand> operands, passing;
    for (std::size_t i = 0; i < lowered.operands.size(); ++i) {
      auto const found = lowered_.find(lowered.operands[i]);
      if (found == lowered_.end()) {
        Operand place = *located(lowered.operands[i]);
        if (moves[i]) {
          Operand const copy = take_temporary();
          emitted_.code.push_back({.opcode = Opcode::move, .store = true, .target = copy.index, .a = place});
          passing.push_back(copy);
          place = copy;
        }
        operands.push_back(place);
      } else if (accumulator && found->second.position == position - 1) {
        operands.push_back({OperandPlace::accumulator, 0});
      } else {
        operands.push_back(found->second.home);
      }
    }
    // Elementwise operations read a lane before they write it, so a result may take the register of an operand that ends here.
    for (NodeId const operand : lowered.operands)
      if (auto const found = lowered_.find(operand); found != lowered_.end() && found->second.last_use == position)
        release(found->second.home);
    for (Operand const copy : passing) release(copy);
    if (lowered.stored && lowered.home.place == OperandPlace::none) lowered.home = take_temporary();

    if (capability(lowered.opcode).commutative) {
      auto const rank = [](Operand operand) {
        return operand.place == OperandPlace::accumulator ? 0 : operand.place == OperandPlace::lane ? 1 : 2;
      };
      if (rank(operands[1]) < rank(operands[0])) std::swap(operands[0], operands[1]);
    }
    operands.resize(3);
    emitted_.code.push_back({.opcode = lowered.opcode,
                             .store = lowered.stored,
                             .target = lowered.stored ? lowered.home.index : 0,
                             .a = operands[0],
                             .b = operands[1],
                             .c = operands[2],
                             .function = lowered.function});
  }

  void finish() {
    struct Copy {
      std::uint32_t target;
      Operand from;
    };
    std::vector<Copy> copies;
    for (Goal const& goal : goals_) {
      auto const found = lowered_.find(goal.node);
      Operand const from = found == lowered_.end() ? *located(goal.node) : found->second.home;
      if (goal.target && from != Operand{OperandPlace::lane, *goal.target}) copies.push_back({*goal.target, from});
      emitted_.results.push_back(goal.target ? Operand{OperandPlace::lane, *goal.target} : from);
    }
    // A source that another copy overwrites is saved first.
    for (Copy& copy : copies) {
      bool const overwritten = std::any_of(copies.begin(), copies.end(), [&](Copy const& other) {
        return copy.from == Operand{OperandPlace::lane, other.target};
      });
      if (!overwritten) continue;
      Operand const saved = take_temporary();
      emitted_.code.push_back({.opcode = Opcode::move, .store = true, .target = saved.index, .a = copy.from});
      copy.from = saved;
    }
    for (Copy const& copy : copies)
      emitted_.code.push_back({.opcode = Opcode::move, .store = true, .target = copy.target, .a = copy.from});
  }

  Graph const& graph_;
  std::span<Goal const> goals_;
  Locate const& locate_;
  std::uint32_t first_temporary_;
  Order wanted_;
  std::unordered_map<NodeId, std::optional<Operand>> located_;
  std::unordered_map<NodeId, Lowered> lowered_;
  std::vector<NodeId> order_;
  std::unordered_map<std::uint32_t, int> last_read_;  // of registers that hold located values
  std::vector<bool> free_;
  Emitted emitted_;
};

}  // namespace

Emitted emit(Graph const& graph, std::span<Goal const> goals, Locate const& locate, std::uint32_t first_temporary, Order order) {
  return Emission(graph, goals, locate, first_temporary, order).emit();
}

}  // namespace sysid
