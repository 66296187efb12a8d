// Jacobians of the right-hand sides, once for all parameters, times the derivatives of the states.
#include "program/tangents.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "expression/finite_slope.hpp"
#include "expression/pull_back.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

constexpr int tangent_leaf = 1 << 22;  // + parameter * states + state, of kind `unknown`, until their places are known

class Tangents {
 public:
  Tangents(SimulationSource source, std::span<int const> parameters)
      : source_(std::move(source)),
        graph_(source_.graph),
        states_(source_.states()),
        kept_(states_ - static_cast<int>(source_.memories.size())),
        parameters_(parameters.begin(), parameters.end()) {}

  SimulationSource squared() {
    find_states();
    number_states();
    add_states();
    for (std::size_t c = 0; c < source_.channels.size(); ++c) {
      std::vector<NodeId>& sums = source_.channels[c].sums;
      add_derivatives(sums);
      NodeId const residual = source_.records[c];
      std::vector<NodeId> slopes;
      for (int k = 0; k < count(); ++k) slopes.push_back(derivative(residual, k));
      for (NodeId const slope : slopes) sums.push_back(graph_.multiply(residual, slope));
      for (std::size_t k = 0; k < slopes.size(); ++k)
        for (std::size_t l = 0; l <= k; ++l) sums.push_back(graph_.multiply(slopes[k], slopes[l]));
    }
    source_.records.clear();
    source_.recorded_at.clear();
    place_states();
    return std::move(source_);
  }

  SimulationSource with_derivatives() {
    find_states();
    number_states();
    add_states();
    for (ChannelSource& channel : source_.channels) add_derivatives(channel.sums);
    source_.records.clear();
    source_.recorded_at.clear();
    place_states();
    return std::move(source_);
  }

 private:
  struct Slope {
    int state;
    NodeId value;
  };
  /// By the states and by the parameters, without zeros.
  struct Slopes {
    std::vector<Slope> by_state;
    std::map<int, NodeId> by_parameter;  // the position among the parameters
  };

  Slopes const& slopes_of(NodeId root) {
    auto const [place, fresh] = slopes_.try_emplace(root);
    if (!fresh) return place->second;
    Slopes& slopes = place->second;
    std::vector<NodeId> leaves;
    for (NodeId const id : graph_.reachable({&root, 1}))
      if (graph_[id].operation == Operation::leaf) leaves.push_back(id);
    for (NodeId const leaf : leaves) {
      Node const node = graph_[leaf];
      auto const position = std::find(parameters_.begin(), parameters_.end(), node.index);
      bool const by_state = node.leaf_kind == LeafKind::state;
      if (!by_state && (node.leaf_kind != LeafKind::parameter || position == parameters_.end())) continue;
      NodeId const value = finite_slope(graph_, root, leaf);
      if (graph_.is_constant(value, 0)) continue;
      if (by_state)
        slopes.by_state.push_back({node.index, value});
      else
        slopes.by_parameter.emplace(static_cast<int>(position - parameters_.begin()), value);
    }
    return slopes;
  }

  /// What a state is from sample to sample or step to step: for one that remembers, what it remembers.
  NodeId rule(int state) const {
    return state < kept_ ? source_.derivative[static_cast<std::size_t>(state)]
                         : source_.memories[static_cast<std::size_t>(state - kept_)];
  }

  /// All that moves it: between samples, and at those that correct it.
  std::vector<NodeId> rules(int state) const {
    std::vector<NodeId> result = {rule(state)};
    for (ChannelSource const& channel : source_.channels)
      if (!channel.correct.empty()) result.push_back(channel.correct[static_cast<std::size_t>(state)]);
    return result;
  }

  bool moves(int k, int state) const { return moves_[static_cast<std::size_t>(k)][static_cast<std::size_t>(state)]; }

  /// Which states may depend on which parameter at all.
  void find_states() {
    moves_.assign(parameters_.size(), std::vector<bool>(static_cast<std::size_t>(states_)));
    bool grown = true;
    for (int k = 0; k < count(); ++k)
      for (int i = 0; i < states_; ++i) {
        std::vector<NodeId> const all = rules(i);
        moves_[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] =
            slopes_of(source_.initial[static_cast<std::size_t>(i)]).by_parameter.contains(k) ||
            std::ranges::any_of(all, [&](NodeId each) { return slopes_of(each).by_parameter.contains(k); });
      }
    while (grown) {
      grown = false;
      for (int k = 0; k < count(); ++k)
        for (int i = 0; i < states_; ++i) {
          if (moves(k, i)) continue;
          std::vector<NodeId> const all = rules(i);
          bool const now = std::ranges::any_of(all, [&](NodeId each) {
            return std::ranges::any_of(slopes_of(each).by_state, [&](Slope const& slope) { return moves(k, slope.state); });
          });
          if (now) moves_[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] = grown = true;
        }
    }
  }

  /// States, their derivatives, then what is remembered and its derivatives: that comes last.
  void number_states() {
    int next = kept_;
    place_.assign(parameters_.size(), std::vector<int>(static_cast<std::size_t>(states_), -1));
    auto const number = [&](int from, int to) {
      for (int k = 0; k < count(); ++k)
        for (int i = from; i < to; ++i)
          if (moves(k, i)) place_[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] = next++;
    };
    number(0, kept_);
    first_memory_ = next;
    next += states_ - kept_;
    number(kept_, states_);
  }

  NodeId derivative(NodeId root, int k) {
    Slopes const& slopes = slopes_of(root);
    auto const direct = slopes.by_parameter.find(k);
    NodeId sum = direct == slopes.by_parameter.end() ? graph_.constant(0) : direct->second;
    for (Slope const& slope : slopes.by_state) {
      if (!moves(k, slope.state)) continue;
      NodeId const state = graph_.leaf(LeafKind::unknown, tangent_leaf + k * states_ + slope.state);
      sum = graph_.add(sum, graph_.multiply(slope.value, state));
    }
    return sum;
  }

  void add_states() {
    std::vector<NodeId> initial(source_.initial.begin(), source_.initial.begin() + kept_),
        rules(source_.derivative.begin(), source_.derivative.begin() + kept_), remembered = source_.memories;
    std::vector<NodeId> last_initial(source_.initial.begin() + kept_, source_.initial.end());
    for (int k = 0; k < count(); ++k) {
      for (int i = 0; i < states_; ++i) {
        if (!moves(k, i)) continue;
        bool const keeps = i < kept_;
        // An initial value reads parameters and data alone.
        Slopes const& first = slopes_of(source_.initial[static_cast<std::size_t>(i)]);
        auto const at = first.by_parameter.find(k);
        (keeps ? initial : last_initial).push_back(at == first.by_parameter.end() ? graph_.constant(0) : at->second);
        (keeps ? rules : remembered).push_back(derivative(rule(i), k));
      }
    }
    initial.insert(initial.end(), last_initial.begin(), last_initial.end());
    rules.insert(rules.end(), remembered.size(), graph_.constant(0));
    source_.initial = std::move(initial);
    source_.derivative = std::move(rules);
    source_.memories = std::move(remembered);
    for (ChannelSource& channel : source_.channels) add_corrections(channel.correct);
  }

  /// In the order of the states; sources with memories correct nothing.
  void add_corrections(std::vector<NodeId>& correct) {
    if (correct.empty()) return;
    std::vector<NodeId> const given = correct;
    for (int k = 0; k < count(); ++k)
      for (int i = 0; i < states_; ++i)
        if (moves(k, i)) correct.push_back(derivative(given[static_cast<std::size_t>(i)], k));
  }

  void add_derivatives(std::vector<NodeId>& values) {
    std::size_t const given = values.size();
    for (int k = 0; k < count(); ++k)
      for (std::size_t i = 0; i < given; ++i) values.push_back(derivative(values[i], k));
  }

  /// Leaves of states become those of the places that the states have now.
  void place_states() {
    auto const replacement = [&](NodeId leaf) -> std::optional<NodeId> {
      Node const node = graph_[leaf];
      if (node.leaf_kind == LeafKind::state && node.index >= kept_)
        return graph_.leaf(LeafKind::state, first_memory_ + node.index - kept_);
      if (node.leaf_kind != LeafKind::unknown || node.index < tangent_leaf) return std::nullopt;
      int const which = node.index - tangent_leaf;
      return graph_.leaf(LeafKind::state,
                         place_[static_cast<std::size_t>(which / states_)][static_cast<std::size_t>(which % states_)]);
    };
    auto const place = [&](std::vector<NodeId>& nodes) { nodes = graph_.substitute(nodes, replacement); };
    for (auto* const nodes : {&source_.initial, &source_.derivative, &source_.memories, &source_.records}) place(*nodes);
    for (ChannelSource& channel : source_.channels) {
      place(channel.sums);
      place(channel.correct);
    }
  }

  int count() const { return static_cast<int>(parameters_.size()); }

  SimulationSource source_;
  Graph& graph_;
  int states_;  // as they were given
  int kept_;    // those that do not remember
  std::vector<int> parameters_;
  std::map<NodeId, Slopes> slopes_;
  std::vector<std::vector<bool>> moves_;  // [parameters][states]
  std::vector<std::vector<int>> place_;   // [parameters][states]
  int first_memory_ = 0;
};

}  // namespace

bool has_tangents(SimulationSource const& source) {
  if (!source.constraints.empty() || ((source.map || source.corrects()) && !source.memories.empty())) return false;
  SolverRow const* const solver = find_solver(source.integrator);
  if (!source.map && (solver == nullptr || solver->step == nullptr)) return false;
  bool known = true;
  for (auto const* nodes : {&source.initial, &source.derivative, &source.memories, &source.records})
    known = known && knows_derivatives(source.graph, *nodes);
  for (ChannelSource const& channel : source.channels)
    known = known && knows_derivatives(source.graph, channel.sums) && knows_derivatives(source.graph, channel.correct);
  return known;
}

SimulationSource with_squares(SimulationSource source, std::span<int const> parameters) {
  if (!has_tangents(source)) throw InternalError("derivatives of a program that has none");
  if (source.records.size() != source.channels.size()) throw InternalError("residuals of other channels");
  return Tangents(std::move(source), parameters).squared();
}

SimulationSource with_gradient(SimulationSource source, std::span<int const> parameters) {
  if (!has_tangents(source)) throw InternalError("derivatives of a program that has none");
  return Tangents(std::move(source), parameters).with_derivatives();
}

namespace {

constexpr int most_states = 64, most_sums = 160;  // larger programs take longer to compile than a search saves

}  // namespace

bool gradient_is_cheap(SimulationSource const& source, int parameters) {
  int const sums = static_cast<int>(source.channels.size()) * (parameters + 1);
  return source.states() * (parameters + 1) <= most_states && sums <= most_sums;
}

bool squares_are_cheap(SimulationSource const& source, int parameters) {
  int const sums = static_cast<int>(source.channels.size()) * (parameters * (parameters + 1) / 2 + 2 * parameters + 1);
  return source.states() * (parameters + 1) <= most_states && sums <= most_sums;
}

}  // namespace sysid
