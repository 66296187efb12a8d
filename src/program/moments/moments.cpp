// The equations of the moments, written out entry by entry; what is zero whatever the parameters takes no state.
#include "program/moments/moments.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "expression/finite_slope.hpp"
#include "program/embedded.hpp"
#include "program/moments/covariance_pattern.hpp"
#include "program/moments/factored_covariance.hpp"
#include "program/moments/past_sample.hpp"
#include "solver/exact_moments.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

/// More take half as long again as by their equation.
constexpr int most_by_slopes = 3;

/// What a white noise adds to each derivative, at the mean.
struct Gain {
  NodeId intensity = 0;
  std::vector<NodeId> rows;
  std::optional<NodeId> held = {};  // the variance of what keeps its value over a step that an exact method takes
};

class MomentWriter {
 public:
  MomentWriter(SimulationSource source, RandomStates const& random, MomentRule rule)
      : source_(std::move(source)),
        graph_(source_.graph),
        random_(random),
        states_(source_.states()),
        zero_(graph_.constant(0)),
        exact_(!source_.map && find_solver(source_.integrator)->exact),
        covariance_(states_, zero_),
        stored_(states_, zero_),
        noise_(states_, zero_),
        passage_(graph_, means_, covariance_, rule, random.first_column) {
    if (!source_.constraints.empty() || !source_.memories.empty() || !source_.channels.empty() || !source_.records.empty())
      throw InternalError("moments of a source with more than its dynamics");
    for (int i = 0; i < states_; ++i) means_.push_back(graph_.leaf(LeafKind::state, i));
  }

  Moments write(std::span<NormalChannel const> channels, bool since) {
    find_gains();
    if (!source_.map) add_drift();
    std::vector<NodeId> const disturbed = source_.derivative;
    for (NodeId& derivative : source_.derivative) derivative = at_rest(derivative);
    for (NormalChannel const& channel : channels) outputs_.push_back(passage_.row(channel.mean));
    add_noise();
    if (exact_)
      step_exactly();
    else if (may_step_by_slopes())
      step_by_slopes(disturbed);
    if (rules_.empty())
      for (NodeId const derivative : source_.derivative) rules_.push_back(passage_.row(derivative));
    factored_ = random_.by_slopes && source_.map && (!source_.stepped || exact_) && are_linear(rules_) &&
                (passage_.linearises() || are_linear(outputs_));
    number_covariances();
    Moments result;
    std::vector<NodeId> mean = expectations();
    Symmetric const rate = factored_ ? next_factors() : source_.map ? next_covariance() : covariance_rate();
    for (std::size_t c = 0; c < channels.size(); ++c)
      result.channels.push_back(innovation(outputs_[c], channels[c], static_cast<int>(c)));
    source_.settling = entries_that_settle();
    source_.derivative = packed(std::move(mean), rate);
    source_.initial = packed(source_.initial, initial_covariance());
    result.means = static_cast<std::size_t>(states_);
    result.entries = entries_;
    result.factored = factored_;
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j < states_; ++j) result.covariance.push_back(covariance_(i, j));
    if (since) result.since = with_past_sample(so_far());
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

  static bool are_linear(std::vector<MomentRow> const& rows) {
    return std::ranges::all_of(rows, [](MomentRow const& row) { return row.linear; });
  }

  // --- G Q G'
  void find_gains() {
    for (std::size_t d = 0; d < random_.noises.size(); ++d) {
      RandomStates::Noise const& noise = random_.noises[d];
      NodeId const leaf = graph_.leaf(LeafKind::disturbance, static_cast<int>(d));
      Gain gain;
      gain.intensity = noise.held && !source_.map ? graph_.multiply(noise.intensity, sampling_interval()) : noise.intensity;
      for (NodeId const derivative : source_.derivative) gain.rows.push_back(at_rest(graph_.differentiate(derivative, leaf)));
      if (noise.held && exact_) gain.held = noise.intensity;
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
      if (!gain.held) add_square(gain.intensity, gain.rows);
  }

  /// To what is added to the covariance: v g g'.
  void add_square(NodeId v, std::vector<NodeId> const& g) {
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        add_product(noise_(i, j), v, graph_.multiply(g[static_cast<std::size_t>(i)], g[static_cast<std::size_t>(j)]));
  }

  /// The matrices of an exact method are those of one step for all samples.
  NodeId sampling_interval() {
    return exact_ ? graph_.leaf(LeafKind::step_length) : graph_.leaf(LeafKind::interval, static_cast<int>(IntervalData::length));
  }

  /// Means and covariances of an exact method are those of a map.
  void step_exactly() {
    std::vector<NodeId> intensity;
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j < states_; ++j) intensity.push_back(noise_(i, j));
    std::vector<StageVisit> visited;
    ExactMoments exact = exact_moments({graph_, source_.derivative, means_, graph_.leaf(LeafKind::step_size), visited}, intensity);
    auto const n = static_cast<std::size_t>(states_);
    for (std::size_t i = 0; i < n; ++i) {
      auto const row = exact.transition.begin() + static_cast<std::ptrdiff_t>(i * n);
      rules_.push_back({exact.states[i], {row, row + states_}, true, {}});
    }
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        if (std::ranges::any_of(gains_, [](Gain const& each) { return !each.held; }))
          noise_(i, j) = exact.added[static_cast<std::size_t>(i) * n + static_cast<std::size_t>(j)];
    source_.map = source_.stepped = true;
    whole_gains_.assign(gains_.size(), std::vector<NodeId>(n, zero_));
    for (std::size_t d = 0; d < gains_.size(); ++d)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < n; ++k) add_product(whole_gains_[d][i], exact.integral[i * n + k], gains_[d].rows[k]);
    FactoredCovariance const factors = FactoredCovariance::of(graph_, noise_);
    for (int i = 0; i < states_; ++i) {
      weights_.push_back(factors.entries()(i, i));
      for (int j = 0; j < states_; ++j) columns_.push_back(j < i ? zero_ : i == j ? graph_.constant(1) : factors.entries()(j, i));
      for (std::size_t d = 0; d < gains_.size(); ++d)
        if (gains_[d].held) columns_.push_back(whole_gains_[d][static_cast<std::size_t>(i)]);
    }
    for (std::size_t d = 0; d < gains_.size(); ++d)
      if (gains_[d].held) {
        weights_.push_back(*gains_[d].held);
        add_square(*gains_[d].held, whole_gains_[d]);
      }
    length_ = graph_.leaf(LeafKind::step_length);
  }

  /// P' = A P + P A' is cheaper for many states, and a covariance only to the order of the method: with steps that are too long it
  /// has negative variances.
  bool may_step_by_slopes() const {
    SolverRow const* const solver = find_solver(source_.integrator);
    return random_.by_slopes && !source_.map && passage_.linearises() && solver != nullptr && solver->step != nullptr &&
           states_ <= most_by_slopes;
  }

  /// Means and covariances as those of the map that a step is: by its slopes, and by those of its answer to the parts of the noise
  /// that are constant and a straight line over the step, of variance q/h each. What it does not answer to is of higher order.
  void step_by_slopes(std::vector<NodeId> const& disturbed) {
    SolverRow const& solver = *find_solver(source_.integrator);
    constexpr int noise_input = 1 << 20, part_leaf = 1 << 20;
    std::size_t const count = gains_.size();
    std::vector<NodeId> const driven = graph_.substitute(disturbed, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = graph_[leaf];
      if (node.leaf_kind != LeafKind::disturbance) return std::nullopt;
      return graph_.leaf(LeafKind::input, noise_input + node.index);  // what a method reads stage by stage
    });
    length_ = graph_.leaf(LeafKind::step_size);
    std::vector<StageVisit> visited;
    std::vector<NodeId> const next = solver.step({graph_, driven, means_, length_, visited});
    std::vector<NodeId> parts;
    for (std::size_t p = 0; p < 2 * count; ++p) parts.push_back(graph_.leaf(LeafKind::unknown, part_leaf + static_cast<int>(p)));
    auto const put = [&](std::vector<NodeId> const& nodes, bool at_rest) {
      return graph_.substitute(nodes, [&](NodeId leaf) -> std::optional<NodeId> {
        Node const node = graph_[leaf];
        if (at_rest && node.leaf_kind == LeafKind::unknown && node.index >= part_leaf) return zero_;
        if (node.leaf_kind != LeafKind::input || node.index < noise_input) return std::nullopt;
        auto const d = static_cast<std::size_t>(node.index - noise_input);
        double const slope = node.stage == Stage::begin ? -1 : node.stage == Stage::middle ? 0 : 1;
        return graph_.add(parts[d], graph_.multiply(graph_.constant(slope * std::sqrt(3.0)), parts[count + d]));
      });
    };
    std::vector<NodeId> const answers = put(next, false);
    source_.derivative = put(answers, true);
    source_.map = source_.stepped = true;
    std::vector<NodeId> slopes;
    for (NodeId const answer : answers)
      for (NodeId const part : parts) slopes.push_back(finite_slope(graph_, answer, part));
    columns_ = put(slopes, true);
    // The method of order 1 reads noise at the beginning of a step alone.
    for (std::size_t i = 0; i < columns_.size() && solver.order < 2; ++i)
      if (i % (2 * count) >= count) columns_[i] = zero_;
    for (std::size_t p = 0; p < 2 * count; ++p) weights_.push_back(graph_.divide(gains_[p % count].intensity, length_));
    whole_gains_.assign(count, {});
    for (int i = 0; i < states_; ++i)
      for (std::size_t d = 0; d < count; ++d) whole_gains_[d].push_back(columns_[static_cast<std::size_t>(i) * 2 * count + d]);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j) {
        noise_(i, j) = zero_;
        for (std::size_t p = 0; p < 2 * count; ++p)
          add_product(noise_(i, j), weights_[p], graph_.multiply(column(i, p), column(j, p)));
      }
  }
  NodeId column(int i, std::size_t p) const { return columns_[static_cast<std::size_t>(i) * weights_.size() + p]; }

  // --- which covariances there are
  void number_covariances() {
    StatePairs first(states_);
    for (int i = 0; i < states_; ++i) {
      if (random_.initial_variances[static_cast<std::size_t>(i)]) first.add(i, i);
      for (int j = 0; j <= i; ++j)
        if (!is_zero(noise_(i, j))) first.add(i, j);
    }
    StatePairs const there =
        covariance_pattern({passage_, rules_, outputs_, source_.map, random_.first_column, factored_}, std::move(first));
    int next = states_;
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j)
        if (there(i, j)) {
          stored_(i, j) = graph_.leaf(LeafKind::state, next++);
          entries_.emplace_back(i, j);
        }
    FactoredCovariance const factors(graph_, stored_);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j) covariance_(i, j) = factored_ ? factors.covariance(i, j) : stored_(i, j);
  }

  std::vector<SettlingState> entries_that_settle() const {
    std::vector<SettlingState> result;
    if (!are_linear(rules_) || !are_linear(outputs_)) return result;
    auto const place = [&](int i, int j) { return graph_[stored_(i, j)].index; };
    for (auto const& [i, j] : entries_) {
      if (is_zero(stored_(i, i)) || is_zero(stored_(j, j))) return {};
      result.push_back({place(i, j), i, j, factored_});
    }
    return result;
  }

  std::vector<NodeId> packed(std::vector<NodeId> means, Symmetric const& values) const {
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j) {
        bool const there = !is_zero(stored_(i, j));
        if (there) means.push_back(values(i, j));
        if (!there && !is_zero(values(i, j))) throw InternalError("a covariance that was taken for zero");
      }
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
        if (!is_zero(covariance_(i, j))) {
          NodeId const second = passage_.with_state(rules_[static_cast<std::size_t>(j)], i);
          NodeId const first = passage_.with_state(rules_[static_cast<std::size_t>(i)], j);
          result(i, j) = graph_.add(graph_.add(first, second), noise_(i, j));
        }
    return result;
  }

  Symmetric next_factors() {
    std::vector<NodeId> transition;
    for (MomentRow const& row : rules_) transition.insert(transition.end(), row.slopes.begin(), row.slopes.end());
    if (!source_.stepped) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(states_); ++i)
        for (Gain const& gain : gains_) columns_.push_back(gain.rows[i]);
      for (Gain const& gain : gains_) weights_.push_back(gain.intensity);
    }
    return FactoredCovariance(graph_, stored_).moved(transition, columns_, weights_).entries();
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

  MomentsSoFar so_far() {
    MomentsSoFar out{source_, passage_, rules_, covariance_, {}, whole_gains_, length_};
    for (Gain const& gain : gains_) {
      out.intensities.push_back(gain.intensity);
      if (!source_.stepped) out.gains.push_back(gain.rows);
    }
    return out;
  }

  // --- at a sample
  Innovation innovation(MomentRow const& output, NormalChannel const& channel, int index) {
    Innovation result;
    result.mean = passage_.expectation(output);
    std::vector<NodeId> gains;
    Symmetric left = stored_;
    if (factored_) {
      auto corrected = FactoredCovariance(graph_, stored_).corrected(output.slopes, channel.variance);
      gains = std::move(corrected.covariance);
      result.variance = corrected.variance;
      left = corrected.left.entries();
    } else {
      for (int i = 0; i < states_; ++i) gains.push_back(passage_.with_state(output, i));
      result.variance = graph_.add(passage_.variance(output, gains), channel.variance);
    }
    NodeId const inverse = graph_.divide(graph_.constant(1), result.variance);
    NodeId const error = graph_.subtract(graph_.leaf(LeafKind::measured, index), result.mean);
    std::vector<NodeId> corrected = means_, weighted;
    for (NodeId const gain : gains) weighted.push_back(is_zero(gain) ? zero_ : graph_.multiply(gain, inverse));
    for (int i = 0; i < states_; ++i)
      add_product(corrected[static_cast<std::size_t>(i)], weighted[static_cast<std::size_t>(i)], error);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i && !factored_; ++j) {
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
  bool exact_;  // the method's steps
  std::vector<NodeId> means_;
  std::vector<Gain> gains_;
  std::vector<MomentRow> rules_, outputs_;
  Symmetric covariance_;                      // expressions of what is stored, or zero
  Symmetric stored_;                          // leaves: the covariance, or its factors
  std::vector<std::pair<int, int>> entries_;  // where they are
  bool factored_ = false;
  Symmetric noise_;  // what is added to the covariance, per time or by a map
  // Of a map that is a step of a method: independent columns of the noise [n x columns] and their variances, the answer of each
  // state to a noise that stays the same over the step [noises][n], and its length.
  std::vector<NodeId> columns_, weights_;
  std::vector<std::vector<NodeId>> whole_gains_;
  NodeId length_ = 0;
  MomentPassage passage_;
};

}  // namespace

Moments with_moments(SimulationSource dynamics, RandomStates const& random, std::span<NormalChannel const> channels,
                     MomentRule rule, bool since) {
  return MomentWriter(std::move(dynamics), random, rule).write(channels, since);
}

}  // namespace sysid
