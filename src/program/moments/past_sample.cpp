// Column by column of C, then noise by noise.
#include "program/moments/past_sample.hpp"

#include <utility>

namespace sysid {
namespace {

class PastSampleWriter {
 public:
  explicit PastSampleWriter(MomentsSoFar const& moments)
      : moments_(moments),
        source_(moments.source),
        graph_(source_.graph),
        passage_(moments.passage),
        states_(moments.covariance.size()),
        zero_(graph_.constant(0)) {}

  SincePastSample write() {
    auto const n = static_cast<std::size_t>(states_);
    int next = static_cast<int>(source_.derivative.size());
    for (int i = 0; i < next; ++i) since_.begin.push_back(graph_.leaf(LeafKind::state, i));
    since_.states.assign(n * n, zero_);
    for (int j = 0; j < states_; ++j) add_covariances_with(j, next);
    for (std::size_t d = 0; d < moments_.gains.size(); ++d) add_summed_noise(d);
    return std::move(since_);
  }

 private:
  bool is_zero(NodeId id) const { return passage_.is_zero(id); }
  /// The next sample is one step away.
  bool at_once() const { return source_.map && !source_.stepped; }

  /// A further state.
  NodeId add_state(NodeId initial, NodeId derivative) {
    source_.initial.push_back(initial);
    source_.derivative.push_back(derivative);
    return graph_.leaf(LeafKind::state, static_cast<int>(source_.derivative.size()) - 1);
  }

  /// With state j at the last sample. next: the state that comes next.
  void add_covariances_with(int j, int& next) {
    auto const n = static_cast<std::size_t>(states_);
    std::vector<NodeId> column(n, zero_), change(n, zero_);
    for (int i = 0; i < states_ && at_once(); ++i)
      change[static_cast<std::size_t>(i)] = passage_.with_state(moments_.rules[static_cast<std::size_t>(i)], j);
    // Between samples P is closed under A, so that C has its zeros.
    for (int i = 0; i < states_; ++i)
      if (!is_zero(at_once() ? change[static_cast<std::size_t>(i)] : moments_.covariance(i, j)))
        column[static_cast<std::size_t>(i)] = graph_.leaf(LeafKind::state, next++);
    if (!at_once()) change = passage_.moved(moments_.rules, column);
    for (int i = 0; i < states_; ++i) {
      auto const row = static_cast<std::size_t>(i);
      if (is_zero(column[row])) continue;
      add_state(zero_, change[row]);
      since_.begin.push_back(moments_.covariance(i, j));
      since_.states[row * n + static_cast<std::size_t>(j)] = column[row];
    }
  }

  void add_summed_noise(std::size_t d) {
    auto const n = static_cast<std::size_t>(states_);
    std::vector<NodeId> const& gain = moments_.gains[d];
    std::vector<bool> some(n);
    for (bool grown = true; std::exchange(grown, false);)
      for (std::size_t i = 0; i < n; ++i) {
        if (some[i]) continue;
        bool there = !is_zero(gain[i]);
        for (std::size_t k = 0; k < n && !at_once(); ++k)
          there = there || (some[k] && passage_.moves(moments_.rules[i], static_cast<int>(k)));
        if (there) some[i] = grown = true;
      }
    int next = static_cast<int>(source_.derivative.size());
    std::vector<NodeId> column(n, zero_);
    for (std::size_t i = 0; i < n; ++i)
      if (some[i]) column[i] = graph_.leaf(LeafKind::state, next++);
    std::vector<NodeId> change = at_once() ? std::vector<NodeId>(n, zero_) : passage_.moved(moments_.rules, column);
    for (std::size_t i = 0; i < n; ++i) {
      if (some[i]) {
        passage_.add_product(change[i], gain[i], moments_.intensities[d]);
        add_state(zero_, change[i]);
        since_.begin.push_back(zero_);
      }
      since_.noises.push_back(column[i]);
    }
    since_.sums.push_back(add_state(zero_, summed(moments_.intensities[d])));
    since_.begin.push_back(zero_);
  }

  /// The next value, or the derivative, of the variance of a summed noise.
  NodeId summed(NodeId intensity) {
    if (!source_.stepped) return intensity;
    NodeId const now = graph_.leaf(LeafKind::state, static_cast<int>(source_.derivative.size()));
    return graph_.add(now, graph_.multiply(moments_.length, intensity));
  }

  MomentsSoFar const& moments_;
  SimulationSource& source_;
  Graph& graph_;
  MomentPassage& passage_;
  int states_;
  NodeId zero_;
  SincePastSample since_;
};

}  // namespace

SincePastSample with_past_sample(MomentsSoFar const& moments) { return PastSampleWriter(moments).write(); }

}  // namespace sysid
