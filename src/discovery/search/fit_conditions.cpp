// Residuals of the leading structure, with coarse and fine steps, and with other roundings of the inputs.
#include "discovery/search/fit_conditions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/hypotenuse.hpp"
#include "core/numeric/random.hpp"
#include "discovery/search/record_noise.hpp"
#include "discovery/search/sample_steps.hpp"

namespace sysid {
namespace {

constexpr double least_accuracy = 1e-8;  // of a channel's size: what simulations are trusted to
constexpr double step_error = 0.02;  // of the noise, that the integrator may be off by: its error is systematic, noise averages out
constexpr int most_substeps = 64;
constexpr int most_lags = 100;
constexpr double rounded_shape = -1, carried_shape = -2;
constexpr double told_noise = 3;  // of its lower bound: less is rounding, whose size is known and no sign of growth

RoundedInputs rounded_inputs(std::vector<Experiment> records, std::size_t inputs) {
  RoundedInputs out;
  for (Experiment const& each : records)
    out.sds.emplace_back(each.time.size(), Eigen::VectorXd::Zero(static_cast<Eigen::Index>(inputs)));
  bool any = false;
  for (std::size_t i = 0; i < inputs; ++i) {
    std::vector<double> all;
    for (Experiment const& each : records)
      for (int row = 0; row < each.inputs[i].rows(); ++row) all.push_back(each.inputs[i].sample(row));
    if (are_levels(all)) continue;
    std::vector<double> const sds = rounding_sds(all);
    if (std::all_of(sds.begin(), sds.end(), [](double sd) { return sd == 0; })) continue;
    any = true;
    Stream stream({0, Purpose::selection, i, 0});
    std::size_t place = 0;
    for (std::size_t e = 0; e < records.size(); ++e) {
      InputSignal& input = records[e].inputs[i];
      std::vector<double> samples;
      for (int row = 0; row < input.rows(); ++row, ++place) {
        samples.push_back(input.sample(row) + sds[place] * stream.normal());
        out.sds[e][static_cast<std::size_t>(row)](static_cast<Eigen::Index>(i)) = sds[place];
      }
      input = InputSignal(input.rule(), records[e].time, std::move(samples));
    }
  }
  if (any) out.otherwise = std::move(records);
  return out;
}

bool every_sample_measured(std::vector<Experiment> const& records) {
  return std::all_of(records.begin(), records.end(), [](Experiment const& each) {
    for (std::size_t c = 0; c < each.measured.size(); ++c)
      for (std::size_t row = 0; row < each.time.size(); ++row)
        if (!each.is_scored(c, row)) return false;
    return true;
  });
}

/// Residuals of a channel, segment by segment; with others, what they differ by.
std::vector<Eigen::VectorXd> residuals_of(SegmentSimulation const& simulation, int channel, std::vector<SegmentSlopes> const& runs,
                                          std::vector<SegmentSlopes> const* others = nullptr) {
  std::vector<Eigen::VectorXd> all;
  for (std::size_t s = 0; s < runs.size(); ++s) {
    Eigen::Index const rows = simulation.rows_of_channel(static_cast<int>(s));
    all.emplace_back(runs[s].residual.segment(channel * rows, rows));
    if (others != nullptr) all.back() -= (*others)[s].residual.segment(channel * rows, rows);
  }
  return all;
}

/// Sum of e_t e_(t+lag).
double product(std::vector<Eigen::VectorXd> const& parts, Eigen::Index lag) {
  double sum = 0;
  for (Eigen::VectorXd const& each : parts)
    if (each.size() > lag) sum += each.head(each.size() - lag).dot(each.tail(each.size() - lag));
  return sum;
}

double root_mean_square(std::vector<Eigen::VectorXd> const& parts) {
  double count = 0;
  for (Eigen::VectorXd const& each : parts) count += static_cast<double>(each.size());
  return std::sqrt(product(parts, 0) / count);
}

/// How many times the variance of white noise has to be larger, to have as much power as these at the frequency where they have
/// most: the peak of the spectrum by correlations up to a quarter of a segment, under a triangular window (Bartlett 1948).
double peak_of_spectrum(std::vector<Eigen::VectorXd> const& parts) {
  double const squares = product(parts, 0);
  Eigen::Index const lags = std::min<Eigen::Index>(parts.front().size() / 4, most_lags);
  if (!(squares > 0) || !std::isfinite(squares)) return 1;
  std::vector<double> correlation;
  for (Eigen::Index lag = 1; lag < lags; ++lag)
    correlation.push_back((1 - static_cast<double>(lag) / static_cast<double>(lags)) * product(parts, lag) / squares);
  double peak = 1;
  for (Eigen::Index f = 0; f <= lags; ++f) {
    double power = 1;
    for (std::size_t k = 0; k < correlation.size(); ++k)
      power += 2 * correlation[k] *
               elementary::cos(std::numbers::pi * static_cast<double>(f) * static_cast<double>(k + 1) / static_cast<double>(lags));
    peak = std::max(peak, power);
  }
  return peak;
}

}  // namespace

RecordLimits::RecordLimits(WholeDictionary const& dictionary) : dictionary_(dictionary) {
  std::vector<Experiment> const& records = dictionary.records();
  std::size_t const channels = dictionary.model().channels.size();
  rounding_of_samples_.resize(records.size());
  for (std::size_t c = 0; c < channels; ++c) {
    std::vector<double> all;
    for (Experiment const& each : records) all.insert(all.end(), each.measured[c].begin(), each.measured[c].end());
    rounding_.push_back(rounding_sd(all));
    std::vector<double> const sds = rounding_sds(all);
    auto next = sds.begin();
    for (std::size_t e = 0; e < records.size(); ++e) {
      auto const end = next + std::ssize(records[e].measured[c]);
      rounding_of_samples_[e].emplace_back(next, end);
      next = end;
    }
  }
  rounded_ = rounded_inputs(records, dictionary.model().inputs.size());
  learnt_.shape.assign(channels, 0);
  learnt_.other_errors.assign(channels, 0);
  learnt_.own_errors.assign(channels, 0);
}

bool RecordLimits::settle_step(FittedTerms const& lead, FitConditions& conditions) {
  int const before = conditions.substeps;
  FitConditions alike = conditions;
  alike.noise = {};
  SegmentSimulation const sizes = dictionary_.simulation(lead.terms, alike);
  std::vector<double> error(rounding_.size());
  std::vector<SegmentSlopes> runs;
  for (int substeps = dictionary_.model().solver.substeps;; substeps *= 2) {
    alike.substeps = 2 * substeps;
    std::vector<SegmentSlopes> const finer = dictionary_.residuals(lead, alike);
    alike.substeps = conditions.substeps = substeps;
    runs = dictionary_.residuals(lead, alike);
    double worst = 0;
    for (std::size_t c = 0; c < error.size(); ++c) {
      error[c] = root_mean_square(residuals_of(sizes, static_cast<int>(c), runs, &finer));
      double const allowed = std::max(
          {step_error * lead.fit.noise_sd[c], least_accuracy * sizes.size(static_cast<int>(c)), step_error * rounding_[c]});
      worst = std::isfinite(error[c]) ? std::max(worst, error[c] / allowed) : std::numeric_limits<double>::infinity();
    }
    if (!(worst > 1) || 2 * substeps > most_substeps) break;
  }
  std::vector<SegmentSlopes> others;
  if (!rounded_.otherwise.empty()) others = dictionary_.residuals(lead, alike, rounded_.otherwise);
  std::vector<double> floor;
  for (std::size_t c = 0; c < error.size(); ++c) {
    auto const channel = static_cast<int>(c);
    double of_inputs = 0;
    if (!rounded_.otherwise.empty()) {
      std::vector<Eigen::VectorXd> const moved = residuals_of(sizes, channel, runs, &others);
      // Free starts follow what runs from fixed ones do not.
      double const size = std::min(root_mean_square(moved), root_mean_square(residuals_of(sizes, channel, runs)));
      if (std::isfinite(size)) of_inputs = size * std::sqrt(peak_of_spectrum(moved));
    }
    learnt_.own_errors[c] = std::max(error[c], least_accuracy * sizes.size(channel));
    learnt_.other_errors[c] = std::max(of_inputs, learnt_.own_errors[c]);
    floor.push_back(hypotenuse(rounding_[c], learnt_.other_errors[c]));
  }
  if (!conditions.noise.carried) conditions.noise.floor = std::move(floor);
  return conditions.substeps != before;
}

bool RecordLimits::settle_noise(FittedTerms const& lead, FitConditions& conditions) {
  if (settle_carried(lead, conditions)) return true;
  if (conditions.noise.carried) return false;
  std::vector<Experiment> const& records = dictionary_.records();
  FitConditions alike = conditions;
  alike.noise = {};
  std::vector<SegmentSlopes> const runs = dictionary_.residuals(lead, alike);
  std::vector<std::vector<std::vector<double>>> relative;
  for (Experiment const& each : records) relative.emplace_back(learnt_.shape.size(), std::vector<double>(each.time.size(), 1.0));
  std::vector<double> shape(learnt_.shape.size(), 0);
  for (std::size_t c = 0; c < shape.size(); ++c)
    shape[c] = lead.fit.noise_sd[c] < told_noise * conditions.noise.floor[c]
                   ? shape_of_rounding(c, relative)
                   : shape_of_growth(c, runs, dictionary_.segments(conditions.halved), relative);
  if (shape == learnt_.shape) return false;
  bool const any = std::any_of(shape.begin(), shape.end(), [](double each) { return each != 0; });
  learnt_.shape = std::move(shape);
  conditions.noise.relative = any ? std::move(relative) : Relative{};
  return true;
}

// Once: along the first structure that leaves no more than the bound.
bool RecordLimits::settle_carried(FittedTerms const& lead, FitConditions& conditions) {
  if (rounded_.otherwise.empty() || conditions.noise.carried) return false;
  for (std::size_t c = 0; c < learnt_.shape.size(); ++c)
    if (!(lead.fit.noise_sd[c] < told_noise * conditions.noise.floor[c])) return false;
  auto const state_of_channel = dictionary_.states_of_channels();
  if (!state_of_channel || !every_sample_measured(dictionary_.records())) return false;
  auto steps = sample_steps(dictionary_, lead, conditions, true);
  if (!steps) return false;
  auto carried = std::make_shared<std::vector<CarriedErrors>>();
  std::vector<double> squares(learnt_.shape.size(), 0), counts(learnt_.shape.size(), 0);
  for (std::size_t e = 0; e < steps->size(); ++e) {
    SampleSteps& of = (*steps)[e];
    CarriedErrors each{std::move(of.ahead), std::move(of.here), std::move(of.next), rounded_.sds[e], *state_of_channel, {}};
    for (std::size_t c = 0; c < learnt_.shape.size(); ++c) {
      each.own_sd.push_back(rounding_of_samples_[e][c]);
      for (double& sd : each.own_sd.back()) sd = hypotenuse(sd, learnt_.own_errors[c]);
    }
    auto const rows = static_cast<int>(each.input_sd.size());
    RowWhitener const whitener(each, 0, rows, [](int) { return true; });
    for (std::size_t row = 0; row < whitener.sds().size(); ++row) {
      std::size_t const c = row / static_cast<std::size_t>(rows);
      squares[c] += whitener.sds()[row] * whitener.sds()[row], ++counts[c];
    }
    carried->push_back(std::move(each));
  }
  for (std::size_t c = 0; c < learnt_.shape.size(); ++c) conditions.noise.floor[c] = std::sqrt(squares[c] / counts[c]);
  conditions.noise.carried = std::move(carried);
  conditions.noise.relative.clear();
  learnt_.shape.assign(learnt_.shape.size(), carried_shape);
  return true;
}

// What is known of each sample: its last digit, and errors that are alike in all.
double RecordLimits::shape_of_rounding(std::size_t channel, Relative& relative) const {
  if (!(rounding_[channel] > 0)) return 0;
  double const least = learnt_.other_errors[channel];
  for (std::size_t e = 0; e < relative.size(); ++e)
    for (std::size_t i = 0; i < rounding_of_samples_[e][channel].size(); ++i)
      relative[e][channel][i] = hypotenuse(rounding_of_samples_[e][channel][i], least) / hypotenuse(rounding_[channel], least);
  return rounded_shape;
}

double RecordLimits::shape_of_growth(std::size_t channel, std::vector<SegmentSlopes> const& runs, std::vector<Segment> const& parts,
                                     Relative& relative) const {
  std::vector<Experiment> const& records = dictionary_.records();
  std::vector<double> signal, residual;
  std::vector<double*> places;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    auto const e = static_cast<std::size_t>(parts[s].experiment);
    std::vector<double> const& measured = records[e].measured[channel];
    for (int i = 0; i < parts[s].count && !measured.empty(); ++i) {
      auto const row = static_cast<std::size_t>(parts[s].first + i);
      double const left = runs[s].residual(static_cast<Eigen::Index>(channel) * parts[s].count + i);
      if (!std::isfinite(measured[row]) || records[e].scored[row] == 0) continue;
      signal.push_back(measured[row] + left);
      residual.push_back(left);
      places.push_back(&relative[e][channel][row]);
    }
  }
  auto const grows = growing_noise(signal, residual);
  if (!grows) return 0;
  for (std::size_t i = 0; i < places.size(); ++i) *places[i] = grows->relative[i];
  return grows->offset;
}

}  // namespace sysid
