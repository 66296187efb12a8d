// Rules and shifts as candidates of one comparison: the one that explains most is told. In discrete time, which reads nothing
// between samples, the candidates are shifts by whole samples.
#include "diagnostics/input_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <set>

#include "core/numeric/statistics.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/words.hpp"
#include "data/input_rule.hpp"
#include "data/input_spectrum.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

constexpr double gain_per_sample = 0.2;  // nats
constexpr double gain_at_least = 20;
constexpr double rule_gain_at_least = 10;
constexpr std::size_t record_parts = 16;
constexpr double steady_gain = 3.2;  // t with 15 degrees of freedom: 0.3 %, of a rule that is as good as the stated one
constexpr double as_good = 3;        // nats: of two rules the simpler, of a rule and a shift the rule
constexpr double noticeable = 1;     // sds, of a parameter's move
constexpr int most_samples = 5;      // of a shift in whole samples
constexpr int refit_rounds = 12, refit_evaluations = 60;  // by residuals; by gradients
constexpr std::uint64_t refit_stream = 2;

/// Over all channels, as a likelihood reads them.
int scored_samples(Experiment const& experiment) {
  int count = 0;
  for (std::size_t c = 0; c < experiment.measured.size(); ++c)
    for (std::size_t i = 0; i < experiment.measured[c].size(); ++i) count += experiment.is_scored(c, i) ? 1 : 0;
  return count;
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
  std::vector<double> declared = {};  // the sampled parameters there
};

class InputCheck {
 public:
  InputCheck(FitOfExperiments const& fit, Model const& model, std::vector<Experiment> const& experiments,
             ObjectiveKind objective_kind, Mode const& mode, std::uint64_t seed, Ledger& ledger)
      : fit_(fit),
        model_(model),
        experiments_(experiments),
        objective_kind_(objective_kind),
        mode_(mode),
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
    int const scored = scored_samples(experiments_[e]);
    for (Alternative& each : all) weigh(each, e, i, scored);
    if (std::none_of(all.begin(), all.end(), [](Alternative const& each) { return each.clear; })) return undecided(all, e, i);
    std::erase_if(all, [](Alternative const& each) { return !each.clear; });
    double const most = std::max_element(all.begin(), all.end(), less_gain)->gain;
    // The first of those that are as good as the best: rules stand before shifts.
    auto const told = std::find_if(all.begin(), all.end(), [&](Alternative const& each) { return each.gain > most - as_good; });
    return told->rule ? other_rule(*told, e, i, scored) : other_timing(*told, e, i, scored);
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
      scored += scored_samples(cut[e]);
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
                    (other.gain > gain_per_sample * scored ||
                     everywhere(fit_.log_densities(cut, stated.declared), fit_.log_densities(changed, other.declared)));
      if (other.clear && (!best.clear || best.gain < other.gain)) best = std::move(other);
    }
    if (!best.clear) return std::nullopt;
    return other_sample(best, of, i, scored);
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
    std::string const& parameter = parameters_[which];
    return Finding{
        FindingCode::input_rule,
        Severity::warning,
        {model_.inputs[i].name, experiments_[e].name, std::string(rule_name(InputRule::cubic)), parameter},
        fmt::format("input {}{} is smooth between its samples: with `hold cubic` in place of `hold linear`, {} changes by {:.1f} "
                    "sds, and the fit is as good",
                    model_.inputs[i].name, on(e), parameter, most),
        fmt::format("write `hold cubic` ({}) unless you know that the input is linear between samples",
                    row_of(InputRule::cubic).summary)};
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
    auto const is_rate = [&](Node const& node) {
      return node.operation == Operation::leaf && node.leaf_kind == LeafKind::input_rate && node.index == input;
    };
    std::vector<NodeId> roots = model_.residuals;
    for (State const& state : model_.states) roots.push_back(state.derivative);
    for (Channel const& channel : model_.channels)
      roots.insert(roots.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
    std::vector<NodeId> const read = model_.graph.reachable(roots);
    return std::any_of(read.begin(), read.end(), [&](NodeId node) { return is_rate(model_.graph[node]); });
  }

  void weigh(Alternative& other, std::size_t e, std::size_t i, int scored) {
    std::vector<Experiment> changed = experiments_;
    changed[e].inputs[i] = other.signal;
    follow(other, changed);
    other.clear = other.gain > gain_at_least && other.gain > gain_per_sample * scored;
    if (other.clear || !other.rule || !(other.gain > rule_gain_at_least)) return;
    other.clear = everywhere(fit_.log_densities(experiments_, mode_.declared), fit_.log_densities(changed, other.declared));
  }

  // The mode with these experiments in place of the fit's own: how much higher it is than the fit's, and where.
  void follow(Alternative& other, std::vector<Experiment> const& changed) {
    std::shared_ptr<Target const> const target = fit_.target(changed);
    if (!widths_) {
      first_ = target;
      widths_.emplace(make_objective(*target, objective_kind_, seed_, refit_stream));
    }
    Objective const objective = widths_->over(*target, objective_kind_);
    std::vector<Eigen::VectorXd> const points = {theta_of(mode_)};
    std::vector<Climber> climbers = {climber_at(points.front(), objective.log_density(to_lanes(points), ledger_).front())};
    climb(objective, climbers, target->is_expensive() ? refit_evaluations : refit_rounds, ledger_, {});
    other.gain = climbers.front().log_density - mode_.log_density;
    if (!std::isfinite(other.gain)) return;
    LaneArray declared(target->dimension(), 1);
    target->constrain(to_lanes({climbers.front().theta}), declared);
    for (int p = 0; p < declared.rows(); ++p) other.declared.push_back(declared(p, 0));
    if (parameters_.empty())
      for (ParameterInfo const& each : target->parameters()) parameters_.push_back(each.name);
  }

  // Whether the gain comes from all parts of the record.
  static bool everywhere(std::vector<std::vector<double>> const& before, std::vector<std::vector<double>> const& after) {
    std::vector<double> gains(record_parts, 0.0);
    if (before.empty()) return false;
    for (std::size_t s = 0; s < before.size(); ++s)
      for (std::size_t k = 0; k < before[s].size(); ++k) gains[k * record_parts / before[s].size()] += after[s][k] - before[s][k];
    double mean = 0, square = 0;
    for (double const gain : gains) mean += gain / record_parts;
    for (double const gain : gains) square += (gain - mean) * (gain - mean);
    return mean > steady_gain * std::sqrt(square / (record_parts * (record_parts - 1)));
  }

  std::string on(std::size_t e) const { return experiments_.size() == 1 ? "" : " on " + experiments_[e].name; }

  Finding other_rule(Alternative const& other, std::size_t e, std::size_t i, int scored) const {
    std::string_view const stated = rule_name(experiments_[e].inputs[i].rule()), better = rule_name(*other.rule);
    return {FindingCode::input_rule,
            Severity::warning,
            {model_.inputs[i].name, experiments_[e].name, std::string(better)},
            fmt::format("the fit is clearly better with `hold {}` than with `hold {}` for input {}{} (log density higher by {:.0f} "
                        "for {} samples)",
                        better, stated, model_.inputs[i].name, on(e), other.gain, scored),
            fmt::format("write `hold {}` if {}; otherwise check whether a channel was recorded with a delay", better,
                        row_of(*other.rule).summary)};
  }

  Finding other_timing(Alternative const& other, std::size_t e, std::size_t i, int scored) const {
    return {FindingCode::input_timing,
            Severity::warning,
            {model_.inputs[i].name, experiments_[e].name},
            fmt::format(
                "the fit is much better with input {}{} shifted {} by half a sample (log density higher by {:.0f} for {} samples)",
                model_.inputs[i].name, on(e), other.shift > 0 ? "later" : "earlier", other.gain, scored),
            "check the delay of the recording: no other rule between input samples explains the record as well"};
  }

  // Samples back that the equations read of an input, each once.
  std::set<int> lags_of(std::size_t input) const {
    std::vector<NodeId> roots = model_.residuals;
    for (State const& state : model_.states) roots.push_back(state.derivative);
    for (Channel const& channel : model_.channels)
      roots.insert(roots.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
    std::set<int> lags;
    for (NodeId const each : model_.graph.reachable(roots)) {
      Node const& node = model_.graph[each];
      if (node.operation == Operation::leaf && node.leaf_kind == LeafKind::input && node.index == static_cast<int>(input))
        lags.insert(node.lag);
    }
    return lags;
  }

  // What to write where the input acts so many samples later than the equations have it.
  std::string lag_advice(std::size_t i, int later) const {
    std::string const& input = model_.inputs[i].name;
    std::string const samples = std::to_string(std::abs(later)) + " " + plural("sample", static_cast<std::size_t>(std::abs(later)));
    std::set<int> const lags = lags_of(i);
    if (lags.empty() || *lags.begin() + later < 0)
      return fmt::format(
          "the column of {0} is {1} late against the response: move it up by {2} {3} in the file, or correct the "
          "delay of the recording",
          input, samples, std::abs(later), plural("row", static_cast<std::size_t>(std::abs(later))));
    auto const written = [&](int lag) { return lag == 0 ? "`" + input + "`" : fmt::format("`lag({}, {})`", input, lag); };
    std::string const read = lags.size() == 1
                                 ? fmt::format("write {} in place of {}", written(*lags.begin() + later), written(*lags.begin()))
                                 : fmt::format("{} {} {} each lag of `{}`", later > 0 ? "add" : "subtract", std::abs(later),
                                               later > 0 ? "to" : "from", input);
    return fmt::format("{} if the system has this delay; otherwise correct the delay of the recording of {}", read, input);
  }

  Finding other_sample(Alternative const& other, std::vector<std::size_t> const& of, std::size_t i, int scored) const {
    int const later = static_cast<int>(other.shift);
    auto const size = static_cast<std::size_t>(std::abs(later));
    return {FindingCode::input_timing,
            Severity::warning,
            {model_.inputs[i].name, experiments_[of.front()].name},
            fmt::format("the fit is much better with input {}{} shifted {} by {} {} (log density higher by {:.0f} for {} samples)",
                        model_.inputs[i].name, of.size() == experiments_.size() ? "" : on(of.front()),
                        later > 0 ? "later" : "earlier", size, plural("sample", size), other.gain, scored),
            lag_advice(i, later)};
  }

  FitOfExperiments const& fit_;
  Model const& model_;
  std::vector<Experiment> const& experiments_;
  ObjectiveKind objective_kind_;
  Mode const& mode_;
  std::uint64_t seed_;
  Ledger& ledger_;
  std::vector<std::string> parameters_ = {};  // names of those sampled
  // No input changes the prior, and a prior of many members is drawn slowly: all targets have the widths of the first.
  std::shared_ptr<Target const> first_ = nullptr;
  std::optional<Objective> widths_ = std::nullopt;
};

}  // namespace

Findings check_inputs(FitOfExperiments const& fit, Model const& model, std::vector<Experiment> const& experiments,
                      ObjectiveKind objective_kind, Mode const& mode, std::uint64_t seed, Ledger& ledger) {
  return InputCheck(fit, model, experiments, objective_kind, mode, seed, ledger).run();
}

}  // namespace sysid
