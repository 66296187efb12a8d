// Columns are tried the other way round, and with the other sign; likelihoods of different records are compared by what each
// explains of its own.
#include "app/fit/other_readings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/periodogram.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "experiment/crossed_columns.hpp"
#include "model/lags.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

constexpr std::size_t most_pairs = 6, search_starts = 8;
constexpr int searched_draws = 256, search_rounds = 20;
constexpr double share_explained_otherwise = 0.05, better_by = 4, worth_a_search = 0.003;
constexpr std::uint64_t search_step = 7;  // of Purpose::start

/// Of normal noise about the mean of each channel of each experiment, with the sd that fits; and the number of samples.
struct Baseline {
  double log_likelihood = 0, samples = 0;
};
Baseline baseline(Model const& model, std::vector<Experiment> const& experiments) {
  Baseline sum;
  for (Experiment const& each : experiments)
    for (std::size_t c = 0; c < each.measured.size(); ++c) {
      std::vector<double> values;
      for (std::size_t i = 0; i < each.measured[c].size(); ++i)
        if (each.is_scored(c, i)) values.push_back(model.channels[c].from_si(each.measured[c][i]));
      if (values.size() < 2) continue;
      auto const n = static_cast<double>(values.size());
      sum.log_likelihood -= 0.5 * n * (elementary::log(2 * std::numbers::pi * population_variance(values)) + 1);
      sum.samples += n;
    }
  return sum;
}

/// About the share of the variance that is not explained.
double unexplained(double log_likelihood, Baseline const& of) {
  double const share = elementary::exp(-2 * (log_likelihood - of.log_likelihood) / of.samples);
  return std::isfinite(share) ? share : 1e300;
}

double log_likelihood_at(Target const& target, Eigen::VectorXd const& theta, Ledger& ledger) {
  double value = 0;
  target.log_likelihood(to_lanes({theta}), {&value, 1}, ledger);
  return value;
}

/// The largest log likelihood that a short search finds.
double search_otherwise(FinishedFit const& fit, Target const& target, Ledger& ledger) {
  LaneArray draws(target.dimension(), searched_draws);
  target.sample_prior({fit.seed, Purpose::start, 0, search_step}, draws);
  Objective const objective = make_objective(target, fit.objective_kind, draws);
  std::vector<double> const density = log_density_in_blocks(objective, draws, ledger);
  std::vector<int> order(searched_draws);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return density[static_cast<std::size_t>(a)] > density[static_cast<std::size_t>(b)]; });
  std::vector<Climber> climbers;
  for (int const lane : order)
    if (climbers.size() < search_starts && std::isfinite(density[static_cast<std::size_t>(lane)]))
      climbers.push_back(climber_at(column(draws, lane), density[static_cast<std::size_t>(lane)]));
  if (climbers.empty()) return -1e300;
  climb(objective, climbers, search_rounds, ledger, {});
  auto const best = std::ranges::max_element(climbers, {}, [](Climber const& each) { return each.log_density; });
  return log_likelihood_at(target, best->theta, ledger);
}

/// Whether the model reads measured samples: from them it predicts the next ones well, whichever column they come from.
bool reads_measured(Model const& model) {
  for (int channel = -1; channel < static_cast<int>(model.channels.size()); ++channel)
    if (!lagged_samples(model, channel).empty()) return true;
  return false;
}

/// Whether samples are several periods of one sinusoid about a constant; NaN where they are missing.
bool is_one_tone(std::vector<double> samples) {
  constexpr double nearly_all = 0.95;
  constexpr std::size_t around = 4;            // frequencies of its main lobe, to each side
  constexpr std::size_t fewest = 32;           // samples, so that there are frequencies beside it
  constexpr std::size_t slowest = 2 * around;  // below, the main lobe is that of a step or a drift
  if (samples.size() < fewest) return false;
  double sum = 0, count = 0;
  for (double const each : samples)
    if (std::isfinite(each)) sum += each, count += 1;
  for (double& each : samples) each = std::isfinite(each) ? each - sum / count : 0;
  taper(samples);
  std::vector<double> const power = periodogram(std::move(samples));
  auto const peak = static_cast<std::size_t>(std::ranges::max_element(power) - power.begin());
  double tone = 0, all = 0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    all += power[k];
    if (k + around >= peak && k <= peak + around) tone += power[k];
  }
  return peak > slowest && tone > nearly_all * all;
}

/// Whether a channel of the data block is one sinusoid. A linear model with that as its output explains any input that is one, too,
/// and one that is hardly damped has it as its free motion.
bool has_one_tone(FinishedFit const& fit, std::vector<Experiment> const& experiments, int data) {
  for (std::size_t e = 0; e < experiments.size(); ++e)
    if (fit.data[e].use.data == data && std::ranges::any_of(experiments[e].measured, &is_one_tone)) return true;
  return false;
}

/// The experiments of a fit with a data block as it might be instead; nothing where that cannot be read so.
std::vector<Experiment> read_otherwise(FinishedFit const& fit, int data, DataBlock const& block) {
  Model const& model = fit.session.file.models[static_cast<std::size_t>(fit.what.model)];
  Model const as_predicted = with_prediction(model, fit.what.prediction).value_or(model);
  std::vector<Experiment> experiments = experiments_of(fit.data);
  try {
    Record const record = load_record(block, model, fit.session.folder());
    for (std::size_t e = 0; e < fit.data.size(); ++e) {
      if (fit.data[e].use.data != data) continue;
      std::string name = experiments[e].name;
      experiments[e] = cut(record, block, as_predicted, fit.data[e].use.part, fit.what.start);
      experiments[e].name = std::move(name);
    }
  } catch (UserError const&) {  // an input with gaps, a unit that the file states
    return {};
  } catch (IoError const&) {
    return {};
  }
  return experiments;
}

/// Tries readings of the records of a fit, one after the other, and keeps the one that leaves least unexplained.
class OtherReadings {
 public:
  explicit OtherReadings(FinishedFit& fit) : fit_(fit), model_(fit.likelihood.model()) {
    stated_ = unexplained(log_likelihood_at(fit.target, theta_of(fit.preparation.modes.front()), ledger_),
                          baseline(model_, experiments_of(fit.data)));
    least_ = std::min(share_explained_otherwise, stated_ / better_by);
  }

  bool explained() const { return stated_ < worth_a_search; }

  void exchange_columns() {
    for (int const data : data_blocks()) {
      DataBlock const& block = this->block(data);
      std::vector<ExchangedColumns> const exchanges = exchanged_columns(block, model_);
      if (exchanges.size() > most_pairs) continue;
      for (ExchangedColumns const& each : exchanges) {
        std::vector<Experiment> experiments = read_otherwise(fit_, data, each.block);
        if (experiments.empty() || (each.of_channel && has_one_tone(fit_, experiments, data))) continue;
        consider(std::move(experiments),
                 {FindingCode::column_used_twice,
                  Severity::warning,
                  {each.one, each.other, block.name},
                  fmt::format("the columns `{}` and `{}` of {} exchanged", each.one, each.other, block.name),
                  "the columns may be exchanged",
                  fmt::format("if they are exchanged, write {}", each.lines)});
      }
    }
  }

  /// Of each input; and of each channel beside others, since the sign of the only one is that of all inputs. In every block that
  /// has it: these are of one sensor, or of one term.
  void reverse_signs() {
    if (model_.inputs.size() + model_.channels.size() > most_pairs) return;
    for (std::size_t i = 0; i < model_.inputs.size(); ++i)
      reverse(
          &DataBlock::inputs, &DataInputUse::input, model_.inputs[i].name,
          [i](Experiment& each) { each.inputs[i] = each.inputs[i].reversed(); },
          fmt::format("check the direction of the sensor and the sign of `{0}` in the equations; if the file is right, write "
                      "`-{0}` in place of `{0}`",
                      model_.inputs[i].name));
    for (std::size_t c = 0; c < model_.channels.size() && model_.channels.size() > 1; ++c)
      reverse(
          &DataBlock::measured, &DataMeasureUse::channel, model_.channels[c].name,
          [c](Experiment& each) {
            for (double& sample : each.measured[c]) sample = -sample;
          },
          fmt::format("check the direction of the sensor; if the file is right, reverse the sign of what `observe {}` expects",
                      model_.channels[c].name));
  }

  Findings findings() {
    if (!best_) return {};
    // A fit that stopped at a poor optimum is bettered by any other search, whatever the columns are.
    double const again = left_by(experiments_of(fit_.data));
    if (least_ >= again / better_by) return {};
    return {{best_->code, Severity::warning, best_->names,
             fmt::format("with {}, the model leaves {} % of the variance unexplained, instead of {} %: {}", best_->what,
                         significant(100 * least_, 2), significant(100 * std::min(1.0, stated_), 2), best_->conclusion),
             best_->cure}};
  }

  std::uint64_t solves() const { return ledger_.solves(); }

 private:
  struct Words {
    FindingCode code;
    Severity severity;
    std::vector<std::string> names;
    std::string what, conclusion, cure;
  };

  DataBlock const& block(int data) const { return fit_.session.file.data[static_cast<std::size_t>(data)]; }

  std::vector<int> data_blocks() const {
    std::vector<int> all;
    for (ExperimentData const& each : fit_.data)
      if (std::ranges::find(all, each.use.data) == all.end()) all.push_back(each.use.data);
    return all;
  }

  template <class Use>
  void reverse(std::vector<Use> DataBlock::*uses, std::string Use::*quantity, std::string const& name, auto const& change,
               std::string cure) {
    std::vector<std::string> columns, blocks;
    std::vector<Experiment> experiments = experiments_of(fit_.data);
    for (int const data : data_blocks())
      for (Use const& each : block(data).*uses) {
        if (each.*quantity != name) continue;
        if (std::ranges::find(columns, each.column) == columns.end()) columns.push_back(each.column);
        blocks.push_back(block(data).name);
        for (std::size_t e = 0; e < experiments.size(); ++e)
          if (fit_.data[e].use.data == data) change(experiments[e]);
      }
    if (columns.empty()) return;
    std::vector<std::string> names = columns;
    names.insert(names.end(), blocks.begin(), blocks.end());
    consider(std::move(experiments), {FindingCode::sign_reversed, Severity::warning, std::move(names),
                                      fmt::format("the sign of column {} of {} reversed", quoted(columns), listed(blocks)),
                                      "the sign may be wrong in the file or in the equations", std::move(cure)});
  }

  /// The share of the variance that a short search leaves.
  double left_by(std::vector<Experiment> experiments) {
    Baseline const of = baseline(model_, experiments);
    auto const target = fit_.likelihood.make_target(std::move(experiments), fit_.preparation.solver, fit_.session.interruptible());
    return unexplained(search_otherwise(fit_, *target, ledger_), of);
  }

  void consider(std::vector<Experiment> experiments, Words words) {
    double const left = left_by(std::move(experiments));
    if (left < least_) least_ = left, best_ = std::move(words);
  }

  FinishedFit& fit_;
  Model const& model_;
  Ledger ledger_;  // failures with other columns say nothing of the fit
  double stated_ = 0, least_ = 0;
  std::optional<Words> best_;
};

}  // namespace

bool doubts_columns(Finding const& finding) {
  return finding.code == FindingCode::noise_size || finding.code == FindingCode::explains_little ||
         finding.code == FindingCode::worse_than_the_mean || finding.code == FindingCode::residuals_not_white ||
         finding.code == FindingCode::input_in_residuals;
}

Findings check_other_readings(FinishedFit& fit) {
  Model const& model = fit.likelihood.model();
  bool const normal = std::ranges::all_of(model.channels, [](Channel const& each) { return each.noise.row->gaussian; });
  if (model.dynamics == Dynamics::none || model.filtered() || !model.processes.empty() || !normal || fit.target.is_expensive() ||
      fit.target.is_estimated() || model.improper() != nullptr || fit.preparation.modes.empty() || reads_measured(model))
    return {};
  OtherReadings readings(fit);
  if (readings.explained()) return {};
  readings.exchange_columns();
  readings.reverse_signs();
  Findings findings = readings.findings();
  fit.extra.add_solves(readings.solves());
  return findings;
}

}  // namespace sysid
