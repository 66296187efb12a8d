// The equations of the moments, written out entry by entry; what is zero whatever the parameters takes no state.
#include "program/moments.hpp"

#include <algorithm>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "expression/finite_slope.hpp"
#include "program/embedded.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

/// What a white noise adds to each derivative, at the mean.
struct Gain {
  NodeId intensity = 0;
  std::vector<NodeId> rows;
};

class MomentWriter {
 public:
  MomentWriter(SimulationSource source, RandomStates const& random, MomentRule rule)
      : source_(std::move(source)),
        graph_(source_.graph),
        random_(random),
        states_(source_.states()),
        zero_(graph_.constant(0)),
        covariance_(states_, zero_),
        noise_(states_, zero_),
        passage_(graph_, means_, covariance_, rule, random.first_column) {
    if (!source_.constraints.empty() || !source_.memories.empty() || !source_.channels.empty() || !source_.records.empty())
      throw InternalError("moments of a source with more than its dynamics");
    for (int i = 0; i < states_; ++i) means_.push_back(graph_.leaf(LeafKind::state, i));
  }

  Moments write(std::span<NormalChannel const> channels, bool since) {
    find_gains();
    if (!source_.map) add_drift();
    for (NodeId const derivative : source_.derivative) rules_.push_back(passage_.row(at_rest(derivative)));
    for (NormalChannel const& channel : channels) outputs_.push_back(passage_.row(channel.mean));
    add_noise();
    number_covariances();
    Moments result;
    std::vector<NodeId> mean = expectations();
    Symmetric const rate = source_.map ? next_covariance() : covariance_rate();
    for (std::size_t c = 0; c < channels.size(); ++c)
      result.channels.push_back(innovation(outputs_[c], channels[c], static_cast<int>(c)));
    source_.derivative = packed(std::move(mean), rate);
    source_.initial = packed(source_.initial, initial_covariance());
    result.means = static_cast<std::size_t>(states_);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j < states_; ++j) result.covariance.push_back(covariance_(i, j));
    if (since) add_past(result);
    result.source = std::move(source_);
    return result;
  }

 private:
  bool is_zero(NodeId id) const { return passage_.is_zero(id); }
  void add_product(NodeId& to, NodeId a, NodeId b) const { passage_.add_product(to, a, b); }

  /// Without disturbances, which have mean 0.
  NodeId at_rest(NodeId id) {
    return graph_.substitute(id, [&](NodeId leaf) -> std::optional<NodeId> {
      return graph_[leaf].leaf_kind == LeafKind::disturbance ? std::optional(zero_) : std::nullopt;
    });
  }

  // --- G Q G'
  void find_gains() {
    for (std::size_t d = 0; d < random_.noises.size(); ++d) {
      RandomStates::Noise const& noise = random_.noises[d];
      NodeId const leaf = graph_.leaf(LeafKind::disturbance, static_cast<int>(d));
      Gain gain;
      gain.intensity = noise.held && !source_.map ? graph_.multiply(noise.intensity, sampling_interval()) : noise.intensity;
      for (NodeId const derivative : source_.derivative) gain.rows.push_back(at_rest(graph_.differentiate(derivative, leaf)));
      gains_.push_back(std::move(gain));
    }
  }

  /// Noise that a state multiplies has a mean effect, in the sense of Stratonovich: the limit of noise that is fast against the
  /// states, but has a memory of its own.
  void add_drift() {
    NodeId const half = graph_.constant(0.5);
    for (Gain const& gain : gains_)
      for (std::size_t i = 0; i < gain.rows.size(); ++i) {
        NodeId drift = zero_;
        for (std::size_t k = 0; k < gain.rows.size(); ++k)
          if (!is_zero(gain.rows[k])) add_product(drift, finite_slope(graph_, gain.rows[i], means_[k]), gain.rows[k]);
        if (!is_zero(drift))
          source_.derivative[i] = graph_.add(source_.derivative[i], graph_.multiply(half, graph_.multiply(gain.intensity, drift)));
      }
  }

  void add_noise() {
    for (Gain const& gain : gains_)
      for (int i = 0; i < states_; ++i)
        for (int j = 0; j <= i; ++j)
          add_product(noise_(i, j), gain.intensity,
                      graph_.multiply(gain.rows[static_cast<std::size_t>(i)], gain.rows[static_cast<std::size_t>(j)]));
  }

  NodeId sampling_interval() {
    bool const exact = find_solver(source_.integrator)->exact;  // whose matrices are those of one step for all samples
    return exact ? graph_.leaf(LeafKind::equal_step) : graph_.leaf(LeafKind::interval, static_cast<int>(IntervalData::length));
  }

  // --- which covariances there are
  void number_covariances() {
    std::vector<std::vector<bool>> some(static_cast<std::size_t>(states_), std::vector<bool>(static_cast<std::size_t>(states_)));
    auto const is = [&](int i, int j) { return some[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]; };
    bool grown = true;
    auto const mark = [&](int i, int j, bool there) {
      if (!there || is(i, j)) return;
      some[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          some[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] = true;
      grown = true;
    };
    // Whether what a row gives varies together with state j.
    auto const varies_with = [&](MomentRow const& row, int j) {
      for (int k = 0; k < states_; ++k)
        if (!is_zero(row.slopes[static_cast<std::size_t>(k)]) && is(k, j)) return true;
      return false;
    };
    auto const vary_together = [&](MomentRow const& a, MomentRow const& b) {
      for (int k = 0; k < states_; ++k)
        if (!is_zero(b.slopes[static_cast<std::size_t>(k)]) && varies_with(a, k)) return true;
      return false;
    };
    for (int i = 0; i < states_; ++i) {
      mark(i, i, random_.initial_variances[static_cast<std::size_t>(i)].has_value());
      for (int j = 0; j <= i; ++j) mark(i, j, !is_zero(noise_(i, j)));
    }
    while (std::exchange(grown, false)) {
      for (int i = 0; i < states_; ++i)
        for (int j = 0; j <= i; ++j) {
          if (is(i, j)) continue;
          MomentRow const &of_i = rules_[static_cast<std::size_t>(i)], &of_j = rules_[static_cast<std::size_t>(j)];
          mark(i, j, source_.map ? vary_together(of_i, of_j) : varies_with(of_i, j) || varies_with(of_j, i));
          for (MomentRow const& output : outputs_) mark(i, j, varies_with(output, i) && varies_with(output, j));
        }
    }
    int next = states_;
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        if (is(i, j)) covariance_(i, j) = graph_.leaf(LeafKind::state, next++);
  }

  std::vector<NodeId> packed(std::vector<NodeId> means, Symmetric const& values) const {
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        if (!is_zero(covariance_(i, j))) means.push_back(values(i, j));
    return means;
  }

  Symmetric initial_covariance() const {
    Symmetric result(states_, zero_);
    for (int i = 0; i < states_; ++i) result(i, i) = random_.initial_variances[static_cast<std::size_t>(i)].value_or(zero_);
    return result;
  }

  // --- between samples
  std::vector<NodeId> expectations() {
    std::vector<NodeId> result;
    for (MomentRow const& each : rules_) result.push_back(passage_.expectation(each));
    return result;
  }

  Symmetric covariance_rate() {
    Symmetric result(states_, zero_);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        if (!is_zero(covariance_(i, j)))
          result(i, j) = graph_.add(graph_.add(passage_.with_state(rules_[static_cast<std::size_t>(i)], j),
                                               passage_.with_state(rules_[static_cast<std::size_t>(j)], i)),
                                    noise_(i, j));
    return result;
  }

  Symmetric next_covariance() {
    Symmetric result(states_, zero_);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        if (!is_zero(covariance_(i, j)))
          result(i, j) =
              graph_.add(passage_.between(rules_[static_cast<std::size_t>(i)], rules_[static_cast<std::size_t>(j)]), noise_(i, j));
    return result;
  }

  // --- what was at the last sample
  /// A further state.
  NodeId add_state(NodeId initial, NodeId derivative) {
    source_.initial.push_back(initial);
    source_.derivative.push_back(derivative);
    return graph_.leaf(LeafKind::state, static_cast<int>(source_.derivative.size()) - 1);
  }

  void add_past(Moments& result) {
    SincePastSample since;
    auto const n = static_cast<std::size_t>(states_);
    int next = static_cast<int>(source_.derivative.size());
    for (int i = 0; i < next; ++i) since.begin.push_back(graph_.leaf(LeafKind::state, i));
    since.states.assign(n * n, zero_);
    for (int j = 0; j < states_; ++j) {
      std::vector<NodeId> column(n, zero_), change(n, zero_);
      for (int i = 0; i < states_ && source_.map; ++i)
        change[static_cast<std::size_t>(i)] = passage_.with_state(rules_[static_cast<std::size_t>(i)], j);
      // Between samples P is closed under A, so that C has its zeros.
      for (int i = 0; i < states_; ++i)
        if (!is_zero(source_.map ? change[static_cast<std::size_t>(i)] : covariance_(i, j)))
          column[static_cast<std::size_t>(i)] = graph_.leaf(LeafKind::state, next++);
      if (!source_.map) change = passage_.moved(rules_, column);
      for (int i = 0; i < states_; ++i) {
        auto const row = static_cast<std::size_t>(i);
        if (is_zero(column[row])) continue;
        add_state(zero_, change[row]);
        since.begin.push_back(covariance_(i, j));
        since.states[row * n + static_cast<std::size_t>(j)] = column[row];
      }
    }
    for (std::size_t d = 0; d < gains_.size(); ++d) add_summed_noise(d, since);
    result.since = std::move(since);
  }

  void add_summed_noise(std::size_t d, SincePastSample& since) {
    auto const n = static_cast<std::size_t>(states_);
    std::vector<bool> some(n);
    for (bool grown = true; std::exchange(grown, false);)
      for (std::size_t i = 0; i < n; ++i) {
        if (some[i]) continue;
        bool there = !is_zero(gains_[d].rows[i]);
        for (std::size_t k = 0; k < n && !source_.map; ++k) there = there || (some[k] && !is_zero(rules_[i].slopes[k]));
        if (there) some[i] = grown = true;
      }
    int next = static_cast<int>(source_.derivative.size());
    std::vector<NodeId> column(n, zero_);
    for (std::size_t i = 0; i < n; ++i)
      if (some[i]) column[i] = graph_.leaf(LeafKind::state, next++);
    std::vector<NodeId> change = source_.map ? std::vector<NodeId>(n, zero_) : passage_.moved(rules_, column);
    for (std::size_t i = 0; i < n; ++i) {
      if (some[i]) {
        add_product(change[i], gains_[d].rows[i], gains_[d].intensity);
        add_state(zero_, change[i]);
        since.begin.push_back(zero_);
      }
      since.noises.push_back(column[i]);
    }
    since.sums.push_back(add_state(zero_, gains_[d].intensity));
    since.begin.push_back(zero_);
  }

  // --- at a sample
  Innovation innovation(MomentRow const& output, NormalChannel const& channel, int index) {
    Innovation result;
    result.mean = passage_.expectation(output);
    std::vector<NodeId> gains;
    for (int i = 0; i < states_; ++i) gains.push_back(passage_.with_state(output, i));
    result.variance = graph_.add(passage_.variance(output, gains), channel.variance);
    NodeId const inverse = graph_.divide(graph_.constant(1), result.variance);
    NodeId const error = graph_.subtract(graph_.leaf(LeafKind::measured, index), result.mean);
    std::vector<NodeId> corrected = means_, weighted;
    for (NodeId const gain : gains) weighted.push_back(is_zero(gain) ? zero_ : graph_.multiply(gain, inverse));
    for (int i = 0; i < states_; ++i)
      add_product(corrected[static_cast<std::size_t>(i)], weighted[static_cast<std::size_t>(i)], error);
    Symmetric left = covariance_;
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j) {
        NodeId const a = weighted[static_cast<std::size_t>(i)], b = gains[static_cast<std::size_t>(j)];
        if (!is_zero(a) && !is_zero(b)) left(i, j) = graph_.subtract(left(i, j), graph_.multiply(a, b));
      }
    result.correct = packed(std::move(corrected), left);
    return result;
  }

  SimulationSource source_;
  Graph& graph_;
  RandomStates const& random_;
  int states_;
  NodeId zero_;
  std::vector<NodeId> means_;
  std::vector<Gain> gains_;
  std::vector<MomentRow> rules_, outputs_;
  Symmetric covariance_;  // leaves, or zero
  Symmetric noise_;
  MomentPassage passage_;
};

}  // namespace

Moments with_moments(SimulationSource dynamics, RandomStates const& random, std::span<NormalChannel const> channels,
                     MomentRule rule, bool since) {
  return MomentWriter(std::move(dynamics), random, rule).write(channels, since);
}

}  // namespace sysid
