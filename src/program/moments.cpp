// The equations of the moments, written out entry by entry; what is zero whatever the parameters takes no state.
#include "program/moments.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "expression/finite_slope.hpp"
#include "program/embedded.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

/// Symmetric, packed by rows of the lower triangle.
class Symmetric {
 public:
  Symmetric(int size, NodeId zero) : size_(size), entries_(static_cast<std::size_t>(size * (size + 1) / 2), zero) {}
  int size() const { return size_; }
  NodeId& operator()(int i, int j) { return entries_[place(i, j)]; }
  NodeId operator()(int i, int j) const { return entries_[place(i, j)]; }

 private:
  static std::size_t place(int i, int j) {
    auto const [row, column] = std::pair(std::max(i, j), std::min(i, j));
    return static_cast<std::size_t>(row * (row + 1) / 2 + column);
  }
  int size_;
  std::vector<NodeId> entries_;
};

/// A function of the states with its slopes.
struct MomentRow {
  NodeId value = 0;
  std::vector<NodeId> slopes;  // by each state, at the mean
  bool linear = true;          // the slopes read no state
};

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
        rule_(rule),
        states_(source_.states()),
        zero_(graph_.constant(0)),
        covariance_(states_, zero_),
        noise_(states_, zero_) {
    if (!source_.constraints.empty() || !source_.memories.empty() || !source_.channels.empty() || !source_.records.empty())
      throw InternalError("moments of a source with more than its dynamics");
    for (int i = 0; i < states_; ++i) means_.push_back(graph_.leaf(LeafKind::state, i));
  }

  Moments write(std::span<NormalChannel const> channels, bool since) {
    find_gains();
    if (!source_.map) add_drift();
    for (NodeId const derivative : source_.derivative) rules_.push_back(row(at_rest(derivative)));
    for (NormalChannel const& channel : channels) outputs_.push_back(row(channel.mean));
    add_noise();
    number_covariances();
    Moments result;
    std::vector<NodeId> mean = source_.map ? next_means() : expectations();
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
  // --- small algebra; products with zero are no nodes
  bool is_zero(NodeId id) const { return graph_.is_constant(id, 0); }
  void add_product(NodeId& to, NodeId a, NodeId b) {
    if (!is_zero(a) && !is_zero(b)) to = graph_.add(to, graph_.multiply(a, b));
  }

  /// Without disturbances, which have mean 0.
  NodeId at_rest(NodeId id) {
    return graph_.substitute(id, [&](NodeId leaf) -> std::optional<NodeId> {
      return graph_[leaf].leaf_kind == LeafKind::disturbance ? std::optional(zero_) : std::nullopt;
    });
  }

  bool reads_states(NodeId id) const {
    return graph_.depends(id, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::state; });
  }

  MomentRow row(NodeId value) {
    MomentRow result{value, {}, true};
    for (NodeId const state : means_) {
      result.slopes.push_back(finite_slope(graph_, value, state));
      result.linear = result.linear && !reads_states(result.slopes.back());
    }
    return result;
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

  /// Noise that a state multiplies has a mean effect: that of noise which is white for the states, but not for itself.
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

  // --- sigma points
  struct Point {
    std::vector<NodeId> ahead, behind;  // the states at m + offset, m - offset
    std::vector<NodeId> offset;         // sqrt(c) times a column of the Cholesky factor
    int state = 0;                      // of whose variance that column takes what is left
    std::vector<NodeId> column;         // of the factor
    NodeId positive = 0, root = 0;      // whether that is more than 0; its root
  };

  bool by_points(MomentRow const& row) const { return rule_ == MomentRule::sigma_points && !row.linear; }

  /// Made at the first need. A state whose variance is not positive, as that of a known start, has no column.
  std::vector<Point> const& points() {
    if (!points_.empty()) return points_;
    std::vector<int> random;
    for (int k = 0; k < states_; ++k)
      if (int const i = (random_.first_column + k) % states_; !is_zero(covariance_(i, i))) random.push_back(i);
    int const count = static_cast<int>(random.size());
    spread_ = std::max(count, 3);
    NodeId const scale = graph_.constant(std::sqrt(spread_));
    std::vector<std::vector<NodeId>> columns;  // of the factor, by state
    for (auto place = random.begin(); place != random.end(); ++place) {
      int const j = *place;
      Point point;
      point.state = j;
      std::vector<NodeId> column(static_cast<std::size_t>(states_), zero_);
      auto const left = [&](int i) {  // of P after the columns so far
        NodeId rest = covariance_(i, j);
        for (auto const& earlier : columns)
          rest = graph_.subtract(rest, graph_.multiply(earlier[static_cast<std::size_t>(i)], earlier[static_cast<std::size_t>(j)]));
        return rest;
      };
      // What rounding leaves of a variance that is zero is no spread.
      NodeId const pivot = left(j), least = graph_.multiply(graph_.constant(1e-13), covariance_(j, j));
      NodeId const positive = graph_.binary(Operation::less, graph_.binary(Operation::maximum, least, zero_), pivot);
      NodeId const root = graph_.unary(Operation::square_root, graph_.select(positive, pivot, graph_.constant(1)));
      column[static_cast<std::size_t>(j)] = graph_.select(positive, root, zero_);
      for (auto later = place + 1; later != random.end(); ++later)
        column[static_cast<std::size_t>(*later)] = graph_.select(positive, graph_.divide(left(*later), root), zero_);
      point.positive = positive;
      point.root = root;
      for (int i = 0; i < states_; ++i) {
        NodeId const offset = graph_.multiply(scale, column[static_cast<std::size_t>(i)]);
        point.offset.push_back(offset);
        point.ahead.push_back(graph_.add(means_[static_cast<std::size_t>(i)], offset));
        point.behind.push_back(graph_.subtract(means_[static_cast<std::size_t>(i)], offset));
      }
      columns.push_back(column);
      point.column = std::move(column);
      points_.push_back(std::move(point));
    }
    return points_;
  }

  NodeId at(NodeId value, std::vector<NodeId> const& states) {
    return graph_.substitute(value, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = graph_[leaf];
      return node.leaf_kind == LeafKind::state ? std::optional(states[static_cast<std::size_t>(node.index)]) : std::nullopt;
    });
  }

  /// Values of a row at the points.
  struct Values {
    NodeId centre = 0, mean = 0;
    std::vector<NodeId> ahead, behind;
  };
  Values values(NodeId value) {
    Values result;
    result.centre = value;
    NodeId sum = zero_;
    for (Point const& point : points()) {
      result.ahead.push_back(at(value, point.ahead));
      result.behind.push_back(at(value, point.behind));
      sum = graph_.add(sum, graph_.add(result.ahead.back(), result.behind.back()));
    }
    result.mean = graph_.multiply(weight(), sum);
    add_product(result.mean, centre_weight(), value);
    return result;
  }
  NodeId weight() { return graph_.constant(0.5 / spread_); }
  NodeId centre_weight() { return graph_.constant(1 - static_cast<double>(points_.size()) / spread_); }

  NodeId expectation(MomentRow const& row) { return by_points(row) ? values(row.value).mean : row.value; }

  /// By point: how a row differs ahead of the mean and behind it, beyond its slope.
  std::vector<NodeId> bent(MomentRow const& row) {
    std::vector<NodeId> result;
    Values const of = values(row.value);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      NodeId straight = zero_;
      for (int k = 0; k < states_; ++k)
        add_product(straight, row.slopes[static_cast<std::size_t>(k)], points_[p].offset[static_cast<std::size_t>(k)]);
      result.push_back(graph_.subtract(graph_.subtract(of.ahead[p], of.behind[p]), graph_.multiply(graph_.constant(2), straight)));
    }
    return result;
  }

  /// cov(x_j, row): what is linear about the mean passes by the covariance itself, so that points are needed only for the rest.
  /// They reproduce the covariance where it has a Cholesky factor, which at the stages of an integrator, near a known start, it
  /// need not.
  NodeId with_state(MomentRow const& row, int j) {
    NodeId sum = zero_;
    for (int k = 0; k < states_; ++k) add_product(sum, row.slopes[static_cast<std::size_t>(k)], covariance_(k, j));
    if (!by_points(row)) return sum;
    NodeId rest = zero_;
    std::vector<NodeId> const bends = bent(row);
    for (std::size_t p = 0; p < points_.size(); ++p) add_product(rest, points_[p].offset[static_cast<std::size_t>(j)], bends[p]);
    return graph_.add(sum, graph_.multiply(weight(), rest));
  }

  /// cov(a, b)
  NodeId between(MomentRow const& a, MomentRow const& b) {
    NodeId sum = zero_;
    if (by_points(a) && by_points(b)) {
      Values const of_a = values(a.value), of_b = values(b.value);
      auto const product = [&](NodeId left, NodeId right) {
        return graph_.multiply(graph_.subtract(left, of_a.mean), graph_.subtract(right, of_b.mean));
      };
      for (std::size_t p = 0; p < points_.size(); ++p)
        sum = graph_.add(sum, graph_.add(product(of_a.ahead[p], of_b.ahead[p]), product(of_a.behind[p], of_b.behind[p])));
      sum = graph_.multiply(weight(), sum);
      add_product(sum, centre_weight(), product(of_a.centre, of_b.centre));
      return sum;
    }
    bool const swap = by_points(b);
    MomentRow const &whole = swap ? b : a, &linear = swap ? a : b;
    for (int k = 0; k < states_; ++k)
      if (!is_zero(linear.slopes[static_cast<std::size_t>(k)]))
        add_product(sum, linear.slopes[static_cast<std::size_t>(k)], with_state(whole, k));
    return sum;
  }

  // --- between samples
  std::vector<NodeId> expectations() {
    std::vector<NodeId> result;
    for (MomentRow const& each : rules_) result.push_back(expectation(each));
    return result;
  }
  std::vector<NodeId> next_means() { return expectations(); }

  Symmetric covariance_rate() {
    Symmetric result(states_, zero_);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        if (!is_zero(covariance_(i, j)))
          result(i, j) = graph_.add(
              graph_.add(with_state(rules_[static_cast<std::size_t>(i)], j), with_state(rules_[static_cast<std::size_t>(j)], i)),
              noise_(i, j));
    return result;
  }

  // --- what was at the last sample
  /// A c of a column c in the range of P, one entry per row of the rules; A as P is moved by it.
  std::vector<NodeId> moved(std::vector<NodeId> const& column) {
    std::vector<NodeId> result, whitened;
    for (MomentRow const& row : rules_) {
      NodeId sum = zero_;
      for (int k = 0; k < states_; ++k)
        add_product(sum, row.slopes[static_cast<std::size_t>(k)], column[static_cast<std::size_t>(k)]);
      if (by_points(row)) {
        if (whitened.empty()) whitened = whiten(column);
        NodeId rest = zero_;
        std::vector<NodeId> const bends = bent(row);
        for (std::size_t p = 0; p < points_.size(); ++p) add_product(rest, whitened[p], bends[p]);
        sum = graph_.add(sum, graph_.multiply(graph_.constant(0.5 / std::sqrt(spread_)), rest));
      }
      result.push_back(sum);
    }
    return result;
  }

  /// The v with L v = column, L the Cholesky factor of P; 0 where that has no column.
  std::vector<NodeId> whiten(std::vector<NodeId> const& column) {
    std::vector<NodeId> result;
    for (Point const& point : points()) {
      NodeId left = column[static_cast<std::size_t>(point.state)];
      for (std::size_t k = 0; k < result.size(); ++k) {
        NodeId const entry = points_[k].column[static_cast<std::size_t>(point.state)];
        if (!is_zero(entry) && !is_zero(result[k])) left = graph_.subtract(left, graph_.multiply(entry, result[k]));
      }
      result.push_back(is_zero(left) ? zero_ : graph_.select(point.positive, graph_.divide(left, point.root), zero_));
    }
    return result;
  }

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
        change[static_cast<std::size_t>(i)] = with_state(rules_[static_cast<std::size_t>(i)], j);
      // Between samples P is closed under A, so that C has its zeros.
      for (int i = 0; i < states_; ++i)
        if (!is_zero(source_.map ? change[static_cast<std::size_t>(i)] : covariance_(i, j)))
          column[static_cast<std::size_t>(i)] = graph_.leaf(LeafKind::state, next++);
      if (!source_.map) change = moved(column);
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
    std::vector<NodeId> change = source_.map ? std::vector<NodeId>(n, zero_) : moved(column);
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

  Symmetric next_covariance() {
    Symmetric result(states_, zero_);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        if (!is_zero(covariance_(i, j)))
          result(i, j) =
              graph_.add(between(rules_[static_cast<std::size_t>(i)], rules_[static_cast<std::size_t>(j)]), noise_(i, j));
    return result;
  }

  // --- at a sample
  Innovation innovation(MomentRow const& output, NormalChannel const& channel, int index) {
    Innovation result;
    result.mean = expectation(output);
    std::vector<NodeId> gains;
    for (int i = 0; i < states_; ++i) gains.push_back(with_state(output, i));
    result.variance = graph_.add(by_points(output) ? between(output, output) : spread(output, gains), channel.variance);
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

  NodeId spread(MomentRow const& output, std::vector<NodeId> const& gains) {
    NodeId sum = zero_;
    for (int k = 0; k < states_; ++k)
      add_product(sum, output.slopes[static_cast<std::size_t>(k)], gains[static_cast<std::size_t>(k)]);
    return sum;
  }

  SimulationSource source_;
  Graph& graph_;
  RandomStates const& random_;
  MomentRule rule_;
  int states_;
  NodeId zero_;
  std::vector<NodeId> means_;
  std::vector<Gain> gains_;
  std::vector<MomentRow> rules_, outputs_;
  Symmetric covariance_;  // leaves, or zero
  Symmetric noise_;
  std::vector<Point> points_;
  int spread_ = 3;  // c
};

}  // namespace

Moments with_moments(SimulationSource dynamics, RandomStates const& random, std::span<NormalChannel const> channels,
                     MomentRule rule, bool since) {
  return MomentWriter(std::move(dynamics), random, rule).write(channels, since);
}

}  // namespace sysid
