// Rules and shifts as candidates of one comparison: the one that explains most is told. In discrete time, which reads nothing
// between samples, the candidates are shifts by whole samples.
#include "diagnostics/inputs/input_checks.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "data/input_rule.hpp"
#include "data/input_spectrum.hpp"
#include "data/scored_samples.hpp"
#include "diagnostics/inputs/input_leaves.hpp"
#include "diagnostics/inputs/input_words.hpp"
#include "diagnostics/inputs/steady_gain.hpp"
#include "result/experiment_words.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

constexpr double gain_per_sample = 0.2;                                       // nats
constexpr double whole_gain_per_sample = 0.35, whole_gain_of_squares = 0.25;  // half of the squared residuals is gone
constexpr double gain_at_least = 20;
constexpr double rule_gain_at_least = 10;
constexpr double as_good = 3;                             // nats: of two rules the simpler, of a rule and a shift the rule
constexpr double noticeable = 1;                          // sds, of a parameter's move
constexpr int refit_rounds = 12, refit_evaluations = 60;  // by residuals; by gradients
constexpr std::uint64_t refit_stream = 2;

/// Whether a sample says little of the next one.
bool changes_at_once(InputSignal const& input) {
  double mean = 0, square = 0, product = 0;
  for (int i = 0; i < input.rows(); ++i) mean += input.sample(i) / input.rows();
  for (int i = 0; i < input.rows(); ++i) {
    double const from_mean = input.sample(i) - mean;
    square += from_mean * from_mean;
    if (i > 0) product += from_mean * (input.sample(i - 1) - mean);
  }
  return product < 0.5 * square;
}

/// Whether the samples come again later: an error of the model then comes again, too, and the parts of the record are no
/// repetitions of an experiment with other errors.
bool repeats(InputSignal const& input) {
  constexpr int most_rows = 4096;
  constexpr double apart = 0.5, again = 0.9;  // correlations
  int const n = std::min(input.rows(), most_rows);
  double mean = 0;
  for (int i = 0; i < n; ++i) mean += input.sample(i) / n;
  bool was_apart = false;
  for (int lag = 1; lag <= n / 2; ++lag) {
    double product = 0, early = 0, late = 0;
    for (int i = 0; i + lag < n; ++i) {
      double const one = input.sample(i) - mean, other = input.sample(i + lag) - mean;
      product += one * other, early += one * one, late += other * other;
    }
    double const scale = std::sqrt(early * late);
    if (was_apart && product > again * scale) return true;
    was_apart = was_apart || product < apart * scale;
  }
  return false;
}

bool changes(InputSignal const& input) {
  for (int i = 1; i < input.rows(); ++i)
    if (input.sample(i) != input.sample(0)) return true;
  return false;
}

/// An input as it might be instead.
struct Alternative {
  std::optional<InputRule> rule;  // absent: shifted
  double shift = 0;               // samples
  InputSignal signal;
  double gain = 0;  // in log density at the mode
  bool clear = false;
  std::vector<double> declared = {};                    // the sampled parameters there
  std::optional<Eigen::VectorXd> theta = std::nullopt;  // the same, the sampler's; before: where the search begins
};

class InputCheck {
 public:
  InputCheck(FitOfExperiments const& fit, Model const& model, std::vector<Experiment> const& experiments,
             ObjectiveKind objective_kind, Mode const& mode, std::vector<LeftByFit> left, std::uint64_t seed, Ledger& ledger)
      : fit_(fit),
        model_(model),
        experiments_(experiments),
        objective_kind_(objective_kind),
        mode_(mode),
        left_(std::move(left)),
        seed_(seed),
        ledger_(ledger) {}

  Findings run() {
    if (model_.dynamics == Dynamics::discrete) return run_by_samples();
    Findings findings;
    for (std::size_t e = 0; e < experiments_.size(); ++e)
      for (std::size_t i = 0; i < model_.inputs.size(); ++i)
        if (auto finding = check(e, i)) findings.push_back(std::move(*finding));
    return findings;
  }

 private:
  std::optional<Finding> check(std::size_t e, std::size_t i) {
    InputSignal const& input = experiments_[e].inputs[i];
    if (!changes(input)) return std::nullopt;
    std::vector<Alternative> all = rules(input, static_cast<int>(i));
    for (double const shift : {-0.5, 0.5}) all.push_back({std::nullopt, shift, input.shifted(shift)});
    int const scored = scored_count(experiments_[e]);
    for (Alternative& each : all) weigh(each, e, i, scored);
    add_whole_samples(all, e, i, scored);
    if (std::none_of(all.begin(), all.end(), [](Alternative const& each) { return each.clear; })) return undecided(all, e, i);
    std::erase_if(all, [](Alternative const& each) { return !each.clear; });
    double const most = std::max_element(all.begin(), all.end(), less_gain)->gain;
    // The first of those that are as good as the best: rules stand before shifts.
    auto const told = std::find_if(all.begin(), all.end(), [&](Alternative const& each) { return each.gain > most - as_good; });
    return told->rule ? other_rule(input_of(e, i), *told->rule, told->gain, scored)
                      : other_timing(input_of(e, i), told->shift, told->gain, scored);
  }

  // Each direction goes on while shifts gain. Where an input changes much from sample to sample, half of one says nothing of
  // several, and all are tried.
  void add_whole_samples(std::vector<Alternative>& all, std::size_t e, std::size_t i, int scored) {
    InputSignal const& input = experiments_[e].inputs[i];
    if (input.rows() < 4 * most_samples) return;
    bool const coloured = left_[e].coloured, every = (coloured || model_.filtered()) && changes_at_once(input);
    for (double const half : {-0.5, 0.5}) {
      Alternative const begin = *std::ranges::find_if(all, [&](Alternative const& each) { return each.shift == half; });
      if (!every && !begin.clear && !(coloured && begin.gain > as_good)) continue;
      Alternative last = begin;
      for (int samples = 1; samples <= most_samples; ++samples) {
        double const shift = 2 * half * samples;
        Alternative next{std::nullopt, shift, input.shifted(shift)};
        next.theta = last.theta;
        weigh(next, e, i, scored);
        all.push_back(next);
        if (!every && !(next.gain > last.gain)) break;
        if (std::isfinite(next.gain)) last = std::move(next);
      }
    }
  }

  // A lag in the equation is the same for all experiments, the delay of a recorder need not be.
  Findings run_by_samples() {
    Findings findings;
    std::vector<std::size_t> all(experiments_.size());
    std::iota(all.begin(), all.end(), 0);
    for (std::size_t i = 0; i < model_.inputs.size(); ++i) {
      if (auto finding = check_by_samples(all, i)) {
        findings.push_back(std::move(*finding));
      } else if (all.size() > 1) {
        for (std::size_t const e : all)
          if (auto own = check_by_samples({e}, i)) findings.push_back(std::move(*own));
      }
    }
    return findings;
  }

  // A shifted record lacks samples at one of its ends. Those that would read them are scored in no comparison.
  std::optional<Finding> check_by_samples(std::vector<std::size_t> const& of, std::size_t i) {
    std::vector<Experiment> cut = experiments_;
    int scored = 0;
    bool moves = false;
    for (std::size_t const e : of) {
      std::vector<std::uint8_t>& rows = cut[e].scored;
      if (rows.size() < 4 * most_samples) return std::nullopt;
      std::fill_n(rows.begin(), most_samples, 0);
      std::fill_n(rows.rbegin(), most_samples, 0);
      scored += scored_count(cut[e]);
      moves = moves || changes(cut[e].inputs[i]);
    }
    if (!moves || scored == 0) return std::nullopt;
    Alternative stated{std::nullopt, 0, cut[of.front()].inputs[i]};
    follow(stated, cut);
    Alternative best = stated;
    for (int const samples : {1, -1, 2, -2, 3, -3, 4, -4, 5, -5}) {
      Alternative other{std::nullopt, static_cast<double>(samples), cut[of.front()].inputs[i].shifted(samples)};
      std::vector<Experiment> changed = cut;
      for (std::size_t const e : of) changed[e].inputs[i] = cut[e].inputs[i].shifted(samples);
      follow(other, changed);
      other.gain -= stated.gain;
      other.clear = other.gain > gain_at_least &&
                    (other.gain > gain_per_sample * scored || everywhere(of, i, cut, stated.declared, changed, other.declared));
      if (other.clear && (!best.clear || best.gain < other.gain)) best = std::move(other);
    }
    if (!best.clear) return std::nullopt;
    InputOf input = input_of(of.front(), i);
    if (of.size() == experiments_.size()) input.on.clear();
    return other_lag(input, static_cast<int>(best.shift), best.gain, scored);
  }

  // Lines through a smooth curve act like a smaller input, which the parameters take up: the response cannot show it, but the
  // samples of the input do.
  std::optional<Finding> undecided(std::vector<Alternative> const& all, std::size_t e, std::size_t i) const {
    InputSignal const& input = experiments_[e].inputs[i];
    if (input.rule() != InputRule::linear || !cut_by_lines(input_spectrum(input, 1))) return std::nullopt;
    auto const cubic = std::find_if(all.begin(), all.end(), [](Alternative const& each) { return each.rule == InputRule::cubic; });
    if (cubic == all.end() || !(cubic->gain > -as_good)) return std::nullopt;
    double most = 0;
    std::size_t which = 0;
    for (std::size_t p = 0; p < cubic->declared.size(); ++p) {
      double const move = std::fabs(cubic->declared[p] - mode_.declared[p]) / mode_.sd[p];
      if (mode_.sd[p] > 0 && move > most) most = move, which = p;
    }
    if (most < noticeable) return std::nullopt;
    return smooth_input(input_of(e, i), parameters_[which], most);
  }

  static bool less_gain(Alternative const& a, Alternative const& b) { return a.gain < b.gain; }

  // In the order of the table, from simple to elaborate.
  std::vector<Alternative> rules(InputSignal const& input, int index) const {
    std::vector<Alternative> all;
    for (InputRuleRow const& row : input_rules()) {
      if (row.rule == input.rule() || (!row.has_rate && reads_rate(index))) continue;
      if (auto signal = input.under(row.rule)) all.push_back({row.rule, 0, std::move(*signal)});
    }
    return all;
  }

  bool reads_rate(int input) const {
    std::vector<Node> const leaves = leaves_of_input(model_, input);
    return std::ranges::any_of(leaves, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::input_rate; });
  }

  void weigh(Alternative& other, std::size_t e, std::size_t i, int scored) {
    std::vector<Experiment> changed = experiments_;
    changed[e].inputs[i] = other.signal;
    follow(other, changed);
    bool const whole_samples = !other.rule && std::fabs(other.shift) >= 1;
    double const per_sample = whole_samples ? whole_gain_per_sample : gain_per_sample;
    other.clear = other.gain > gain_at_least && other.gain > per_sample * scored &&
                  (!whole_samples || other.gain > whole_gain_of_squares * left_[e].squares);
    if (other.clear || !other.rule || !(other.gain > rule_gain_at_least)) return;
    other.clear = everywhere({e}, i, experiments_, mode_.declared, changed, other.declared);
  }

  // The mode with these experiments in place of the fit's own: how much higher it is than the fit's, and where.
  void follow(Alternative& other, std::vector<Experiment> const& changed) {
    std::shared_ptr<Target const> const target = fit_.target(changed);
    if (!widths_) {
      first_ = target;
      widths_.emplace(make_objective(*target, objective_kind_, seed_, refit_stream));
    }
    Objective const objective = widths_->over(*target, objective_kind_);
    std::vector<Eigen::VectorXd> const points = {other.theta.value_or(theta_of(mode_))};
    std::vector<Climber> climbers = {climber_at(points.front(), objective.log_density(to_lanes(points), ledger_).front())};
    climb(objective, climbers, target->is_expensive() ? refit_evaluations : refit_rounds, ledger_, {});
    other.gain = climbers.front().log_density - mode_.log_density;
    if (!std::isfinite(other.gain)) return;
    other.theta = climbers.front().theta;
    other.declared.clear();
    LaneArray declared(target->dimension(), 1);
    target->constrain(to_lanes({climbers.front().theta}), declared);
    for (int p = 0; p < declared.rows(); ++p) other.declared.push_back(declared(p, 0));
    if (parameters_.empty())
      for (ParameterInfo const& each : target->parameters()) parameters_.push_back(each.name);
  }

  // Whether the gain comes from all parts of these experiments, and not with an error of the model that an input repeats.
  bool everywhere(std::vector<std::size_t> const& of, std::size_t i, std::vector<Experiment> const& before,
                  std::vector<double> const& declared_before, std::vector<Experiment> const& after,
                  std::vector<double> const& declared_after) const {
    if (std::ranges::any_of(of, [&](std::size_t e) { return left_[e].coloured && repeats(before[e].inputs[i]); })) return false;
    std::vector<std::vector<double>> const old = fit_.log_densities(before, declared_before),
                                           now = fit_.log_densities(after, declared_after);
    if (old.empty()) return false;
    std::vector<double> gains, differences;
    std::size_t const channels = model_.channels.size();
    for (std::size_t const e : of) {
      std::vector<double> const apart = squared_differences(before[e].inputs[i], after[e].inputs[i]);
      std::size_t const first = gains.size();
      gains.resize(first + apart.size(), 0.0);
      differences.insert(differences.end(), apart.begin(), apart.end());
      for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t row = 0, k = 0; row < apart.size() && k < old[e * channels + c].size(); ++row)
          if (before[e].is_scored(c, row)) {
            gains[first + row] += now[e * channels + c][k] - old[e * channels + c][k];
            ++k;
          }
    }
    return steady_gain(gains, differences);
  }

  // [N] between each row and the one before; of discrete time, which reads nothing there, at the row.
  std::vector<double> squared_differences(InputSignal const& one, InputSignal const& other) const {
    std::vector<double> squared(static_cast<std::size_t>(one.rows()), 0.0);
    constexpr double places[] = {0.1, 0.3, 0.5, 0.7, 0.9};
    for (int row = 0; row < one.rows(); ++row) {
      double& sum = squared[static_cast<std::size_t>(row)];
      if (model_.dynamics == Dynamics::discrete) {
        sum = std::pow(one.sample(row) - other.sample(row), 2);
      } else if (row > 0) {
        for (double const s : places) sum += std::pow(one.value(row - 1, s) - other.value(row - 1, s), 2);
      }
    }
    return squared;
  }

  std::string on(std::size_t e) const { return on_experiment(experiments_[e].name, experiments_.size() > 1); }
  InputOf input_of(std::size_t e, std::size_t i) const { return {model_, experiments_[e], i, on(e)}; }

  FitOfExperiments const& fit_;
  Model const& model_;
  std::vector<Experiment> const& experiments_;
  ObjectiveKind objective_kind_;
  Mode const& mode_;
  std::vector<LeftByFit> left_;
  std::uint64_t seed_;
  Ledger& ledger_;
  std::vector<std::string> parameters_ = {};  // names of those sampled
  // No input changes the prior, and a prior of many members is drawn slowly: all targets have the widths of the first.
  std::shared_ptr<Target const> first_ = nullptr;
  std::optional<Objective> widths_ = std::nullopt;
};

}  // namespace

Findings check_inputs(FitOfExperiments const& fit, Model const& model, std::vector<Experiment> const& experiments,
                      ObjectiveKind objective_kind, Mode const& mode, std::vector<LeftByFit> left, std::uint64_t seed,
                      Ledger& ledger) {
  return InputCheck(fit, model, experiments, objective_kind, mode, std::move(left), seed, ledger).run();
}

}  // namespace sysid
