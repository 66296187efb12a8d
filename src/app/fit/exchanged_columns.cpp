// Columns are tried the other way round, and with the other sign; likelihoods of different records are compared by what each
// explains of its own.
#include "app/fit/exchanged_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/periodogram.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
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

/// A data block as it might be instead.
struct OtherReading {
  DataBlock block;
  int input = -1, channel = -1;  // whose numbers have the other sign
  bool one_tone_explains = false;
  std::function<Finding(std::string const& left, std::string const& stated)> finding;  // shares of the variance, in per cent
};

void reverse(std::vector<double>& values) {
  for (double& each : values) each = -each;
}

Record with_reversed_signs(Record record, OtherReading const& reading) {
  if (reading.input >= 0) {
    InputSignal& input = record.inputs[static_cast<std::size_t>(reading.input)];
    std::vector<double> values;
    for (int row = 0; row < input.rows(); ++row) values.push_back(input.sample(row));
    reverse(values);
    input = InputSignal(input.rule(), record.time, std::move(values));
  }
  if (reading.channel >= 0) reverse(record.measured[static_cast<std::size_t>(reading.channel)]);
  return record;
}

/// The experiments of a fit with a data block as it might be instead; nothing where that cannot be read so.
std::vector<Experiment> read_otherwise(FinishedFit const& fit, int data, OtherReading const& reading) {
  Model const& model = fit.session.file.models[static_cast<std::size_t>(fit.what.model)];
  Model const as_predicted = with_prediction(model, fit.what.prediction).value_or(model);
  std::vector<Experiment> experiments = experiments_of(fit.data);
  try {
    Record const record = with_reversed_signs(load_record(reading.block, model, fit.session.folder()), reading);
    for (std::size_t e = 0; e < fit.data.size(); ++e) {
      if (fit.data[e].use.data != data) continue;
      std::string name = experiments[e].name;
      experiments[e] = cut(record, reading.block, as_predicted, fit.data[e].use.part, fit.what.start);
      experiments[e].name = std::move(name);
    }
  } catch (UserError const&) {  // an input with gaps, a unit that the file states
    return {};
  } catch (IoError const&) {
    return {};
  }
  return experiments;
}

void add_exchanged(DataBlock const& block, Model const& model, std::vector<OtherReading>& readings) {
  std::vector<ExchangedColumns> exchanges = exchanged_columns(block, model);
  if (exchanges.size() > most_pairs) return;
  for (ExchangedColumns& each : exchanges) {
    DataBlock exchanged = std::move(each.block);
    readings.push_back({std::move(exchanged), -1, -1, each.of_channel, [each, &block](auto const& left, auto const& stated) {
                          return Finding{
                              FindingCode::column_used_twice,
                              Severity::warning,
                              {each.one, each.other, block.name},
                              fmt::format("with the columns `{}` and `{}` of {} exchanged, the model leaves {} % of the variance "
                                          "unexplained, instead of {} %: the columns may be exchanged",
                                          each.one, each.other, block.name, left, stated),
                              fmt::format("if they are exchanged, write {}", each.lines)};
                        }});
  }
}

Finding reversed(std::string const& column, std::string const& block, std::string const& left, std::string const& stated,
                 std::string const& cure) {
  return {FindingCode::sign_reversed,
          Severity::warning,
          {column, block},
          fmt::format("with the sign of column `{}` of {} reversed, the model leaves {} % of the variance unexplained, instead of "
                      "{} %: the sign may be wrong in the file or in the equations",
                      column, block, left, stated),
          cure};
}

/// Inputs; and channels beside others, since the sign of the only one is that of all inputs.
void add_reversed(DataBlock const& block, Model const& model, std::vector<OtherReading>& readings) {
  if (block.inputs.size() + block.measured.size() > most_pairs) return;
  auto const index_of = [](auto const& all, std::string const& name) {
    return static_cast<int>(std::ranges::find(all, name, [](auto const& each) { return each.name; }) - all.begin());
  };
  for (DataInputUse const& each : block.inputs)
    readings.push_back({block, index_of(model.inputs, each.input), -1, false, [&](auto const& left, auto const& stated) {
                          return reversed(each.column, block.name, left, stated,
                                          fmt::format("check the direction of the sensor and the sign of `{0}` in the "
                                                      "equations; if the file is right, write `-{0}` in place of `{0}`",
                                                      each.input));
                        }});
  for (DataMeasureUse const& each : block.measured)
    if (block.measured.size() > 1)
      readings.push_back({block, -1, index_of(model.channels, each.channel), false, [&](auto const& left, auto const& stated) {
                            return reversed(each.column, block.name, left, stated,
                                            fmt::format("check the direction of the sensor; if the file is right, reverse the "
                                                        "sign of what `observe {}` expects",
                                                        each.channel));
                          }});
}

}  // namespace

bool doubts_columns(Finding const& finding) {
  return finding.code == FindingCode::noise_size || finding.code == FindingCode::explains_little ||
         finding.code == FindingCode::worse_than_the_mean || finding.code == FindingCode::residuals_not_white ||
         finding.code == FindingCode::input_in_residuals;
}

Findings check_exchanged_columns(FinishedFit& fit) {
  Model const& model = fit.likelihood.model();
  bool const normal = std::ranges::all_of(model.channels, [](Channel const& each) { return each.noise.row->gaussian; });
  if (model.dynamics == Dynamics::none || model.filtered() || !model.processes.empty() || !normal || fit.target.is_expensive() ||
      fit.target.is_estimated() || model.improper() != nullptr || fit.preparation.modes.empty() || reads_measured(model))
    return {};
  Ledger ledger;  // failures with exchanged columns say nothing of the fit
  double const stated = unexplained(log_likelihood_at(fit.target, theta_of(fit.preparation.modes.front()), ledger),
                                    baseline(model, experiments_of(fit.data)));
  if (stated < worth_a_search) return {};
  Findings findings;
  std::vector<int> seen;
  for (ExperimentData const& each : fit.data) {
    if (std::ranges::find(seen, each.use.data) != seen.end()) continue;
    seen.push_back(each.use.data);
    DataBlock const& block = fit.session.file.data[static_cast<std::size_t>(each.use.data)];
    std::vector<OtherReading> readings;
    add_exchanged(block, model, readings);
    add_reversed(block, model, readings);
    OtherReading const* best = nullptr;
    double least = std::min(share_explained_otherwise, stated / better_by);
    for (OtherReading const& reading : readings) {
      std::vector<Experiment> experiments = read_otherwise(fit, each.use.data, reading);
      if (experiments.empty() || (reading.one_tone_explains && has_one_tone(fit, experiments, each.use.data))) continue;
      Baseline const of = baseline(model, experiments);
      auto const target = fit.likelihood.make_target(std::move(experiments), fit.preparation.solver, fit.session.interruptible());
      double const left = unexplained(search_otherwise(fit, *target, ledger), of);
      if (left < least) least = left, best = &reading;
    }
    if (best != nullptr)
      findings.push_back(best->finding(significant(100 * least, 2), significant(100 * std::min(1.0, stated), 2)));
  }
  fit.extra.add_solves(ledger.solves());
  return findings;
}

}  // namespace sysid
