// Records of the trajectory program, in declared units, a few dozen parameter vectors at a time so that long records fit in memory.
#include "likelihood/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/numeric/normals.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/system/memory.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

constexpr int trajectories_at_once = 64;
constexpr double large = 1e8;  // bytes: of less nobody runs out

using RecordKind = CompiledModel::Record::Kind;

/// Of the states along a trajectory: apart from that of the noise of any channel.
StreamKey state_key(StreamKey noise_key, int trajectory, int record) {
  constexpr std::uint64_t behind_channels = 1u << 16;
  return noise_key.at(noise_key.index + static_cast<std::uint64_t>(trajectory),
                      behind_channels + static_cast<std::uint64_t>(record));
}

bool is_shown(CompiledModel::Record const& record) {
  return record.kind == RecordKind::centre || record.kind == RecordKind::state || record.kind == RecordKind::derived;
}

Quantity const& quantity_of(Model const& model, CompiledModel::Record const& record) {
  auto const index = static_cast<std::size_t>(record.index);
  if (record.kind == RecordKind::state) return model.states[index];
  if (record.kind == RecordKind::derived) return model.derived[index];
  return model.channels[index];
}

/// Of a constraint whose value and size are records r and r + 1 of each sample: the largest value, over the largest size.
double largest_drift(LaneArray const& records, int lane, int r, int samples, int rows) {
  double violation = 0, size = 0;
  for (int i = 0; i < samples; ++i) {
    violation = std::max(violation, std::abs(records(i * rows + r, lane)));
    size = std::max(size, records(i * rows + r + 1, lane));
  }
  return size > 0 ? violation / size : 0.0;
}

}  // namespace

Experiment with_corrections(Model const& model, Experiment experiment) {
  if (model.filtered() && !experiment.corrects.empty()) experiment.scored = experiment.corrects;
  return experiment;
}

Trajectory::Trajectory(std::shared_ptr<CompiledModel const> compiled, Experiment const& experiment, SolverSettings const& solver,
                       int start_rows, ExecutionOptions options, Describe describe)
    : compiled_(std::move(compiled)),
      simulator_(compiled_->trajectory, Schedule(*compiled_->trajectory, with_corrections(compiled_->model, experiment), solver),
                 options),
      describe_(std::move(describe)) {
  if (start_rows > 0) start_ = std::make_unique<StartState>(compiled_, experiment, start_rows, solver, options);
  spreads_.assign(compiled_->records.size(), -1);
  for (std::size_t r = 0; r < compiled_->records.size(); ++r)
    if (compiled_->records[r].kind == RecordKind::spread)
      spreads_[static_cast<std::size_t>(compiled_->records[r].index)] = static_cast<int>(r);
  for (auto const& record : compiled_->records) {
    if (!is_shown(record)) continue;
    Quantity const& quantity = quantity_of(compiled_->model, record);
    quantities_.push_back({quantity.name, quantity.unit_of_numbers(), record.kind == RecordKind::centre ? record.index : -1});
  }
}

void Trajectory::record_failures(LaneArray const& parameters, std::vector<Outcome> const& outcome, Ledger& ledger) const {
  if (std::all_of(outcome.begin(), outcome.end(), [](Outcome const& each) { return each.ok; })) {
    ledger.add_solves(outcome.size());
    return;
  }
  // A solve is looked into up to the last sample to score; a trajectory goes on to the last one.
  Experiment whole = simulator_.schedule().experiment();
  whole.scored.back() = 1;
  whole.has_lags.clear();
  for (auto& channel : whole.measured) {
    if (channel.empty()) channel.assign(whole.time.size(), std::nan(""));
    channel.back() = 0;
  }
  Simulator const simulator(compiled_->trajectory, Schedule(*compiled_->trajectory, whole, simulator_.schedule().solver()),
                            simulator_.options());
  sysid::record_failures(
      {simulator, parameters, start_ != nullptr, {}}, outcome, describe_, [](int) { return std::vector<double>(); }, ledger);
}

void Trajectory::collect(LaneArray const& records, std::vector<Outcome> const& outcome, int first, StreamKey noise_key, int noises,
                         Result& result) const {
  Model const& model = compiled_->model;
  int const samples = this->samples(), rows = static_cast<int>(compiled_->records.size());
  double const nan = std::nan("");
  result.values.resize(quantities_.size());
  result.random.resize(quantities_.size());
  result.spread.resize(quantities_.size());
  result.noisy_spread.resize(model.channels.size());
  result.noisy.resize(model.channels.size());
  result.drift.resize(model.invariants.size());
  for (int w = 0; w < records.width(); ++w) {
    bool const good = outcome[static_cast<std::size_t>(w)].ok;
    result.solved.push_back(good ? 1 : 0);
    std::size_t q = 0;
    for (int r = 0; r < rows; ++r) {
      auto const& record = compiled_->records[static_cast<std::size_t>(r)];
      if (record.kind == RecordKind::constraint)
        result.drift[static_cast<std::size_t>(record.index)].push_back(good ? largest_drift(records, w, r, samples, rows) : nan);
      if (!is_shown(record)) continue;
      Quantity const& quantity = quantity_of(model, record);
      std::vector<double> values(static_cast<std::size_t>(samples), nan);
      if (good)
        for (int i = 0; i < samples; ++i) values[static_cast<std::size_t>(i)] = records(i * rows + r, w);
      auto const declared = [&](std::vector<double> si) {
        for (double& value : si) value = quantity.from_si(value);
        return si;
      };
      result.values[q].push_back(declared(values));
      if (int const spread = spreads_[static_cast<std::size_t>(r)]; spread >= 0) {
        std::vector<double> sds(values.size(), nan);
        for (int i = 0; good && i < samples; ++i)
          sds[static_cast<std::size_t>(i)] = std::fabs(quantity.from_si(records(i * rows + spread, w)) - quantity.from_si(0));
        result.spread[q].push_back(std::move(sds));
        add_spread(records, w, spread, state_key(noise_key, first + w, r), values);
        result.random[q].push_back(declared(std::move(values)));
      }
      ++q;
    }
  }
  for (int r = 0; r < rows; ++r) {
    auto const& record = compiled_->records[static_cast<std::size_t>(r)];
    if (record.kind != RecordKind::centre) continue;
    for (int lane = first; lane < first + noises * records.width(); lane += records.width())
      for (auto& noisy :
           with_noise(records, outcome, r,
                      noise_key.at(noise_key.index + static_cast<std::uint64_t>(lane), static_cast<std::uint64_t>(record.index))))
        result.noisy[static_cast<std::size_t>(record.index)].push_back(std::move(noisy));
    if (model.filtered()) add_noisy_spreads(records, outcome, r, result);
  }
}

/// Of the channel whose centre is record `row`, whose noise is normal: its arguments are a mean and an sd.
void Trajectory::add_noisy_spreads(LaneArray const& records, std::vector<Outcome> const& outcome, int row, Result& result) const {
  int const samples = this->samples(), rows = static_cast<int>(compiled_->records.size());
  auto const c = static_cast<std::size_t>(compiled_->records[static_cast<std::size_t>(row)].index);
  Channel const& channel = compiled_->model.channels[c];
  for (int w = 0; w < records.width(); ++w) {
    std::vector<double> sds(static_cast<std::size_t>(samples), not_a_number);
    for (int i = 0; outcome[static_cast<std::size_t>(w)].ok && i < samples; ++i)
      sds[static_cast<std::size_t>(i)] = std::fabs(channel.from_si(records(i * rows + row + 2, w)) - channel.from_si(0));
    result.noisy_spread[c].push_back(std::move(sds));
  }
}

/// What random states add to a quantity at each sample.
void Trajectory::add_spread(ConstLanes records, int lane, int spread, StreamKey key, std::vector<double>& values) const {
  int const rows = static_cast<int>(compiled_->records.size());
  Stream stream(key);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += records(static_cast<int>(i) * rows + spread, lane) * stream.normal();
}

void Trajectory::collect_moments(LaneArray const& records, std::vector<Outcome> const& outcome, Result& result) const {
  int const samples = this->samples(), rows = static_cast<int>(compiled_->records.size());
  result.noise_mean.resize(compiled_->model.channels.size());
  result.noise_variance.resize(compiled_->model.channels.size());
  for (int r = 0; r < rows; ++r) {
    auto const& record = compiled_->records[static_cast<std::size_t>(r)];
    if (record.kind != RecordKind::centre) continue;
    auto const c = static_cast<std::size_t>(record.index);
    Channel const& channel = compiled_->model.channels[c];
    double const slope = channel.from_si(1) - channel.from_si(0);
    DistributionRow const& noise = *compiled_->noise[c];
    std::vector<double> numbers(noise.arguments.size());
    for (int w = 0; w < records.width(); ++w) {
      std::vector<double> means(static_cast<std::size_t>(samples), not_a_number), variances = means;
      for (int i = 0; outcome[static_cast<std::size_t>(w)].ok && i < samples; ++i) {
        for (std::size_t a = 0; a < numbers.size(); ++a) numbers[a] = records(i * rows + r + 1 + static_cast<int>(a), w);
        bool const finite = std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
        if (!finite || (noise.refuse != nullptr && !noise.refuse(numbers).empty())) continue;
        NoiseMoments const moments = noise.moments(numbers);
        means[static_cast<std::size_t>(i)] = channel.from_si(moments.mean);
        variances[static_cast<std::size_t>(i)] = slope * slope * moments.variance;
      }
      result.noise_mean[c].push_back(std::move(means));
      result.noise_variance[c].push_back(std::move(variances));
    }
  }
}

/// Draws of the channel whose centre is record `row`, lane by lane; NaN where the noise has none.
std::vector<std::vector<double>> Trajectory::with_noise(LaneArray const& records, std::vector<Outcome> const& outcome, int row,
                                                        StreamKey key) const {
  int const samples = this->samples(), rows = static_cast<int>(compiled_->records.size()), width = records.width();
  auto const c = static_cast<std::size_t>(compiled_->records[static_cast<std::size_t>(row)].index);
  Channel const& channel = compiled_->model.channels[c];
  DistributionRow const& noise = *compiled_->noise[c];
  std::vector<double> numbers(noise.arguments.size());
  auto const usable = [&](int sample, int lane) {
    for (std::size_t a = 0; a < numbers.size(); ++a) numbers[a] = records(sample * rows + row + 1 + static_cast<int>(a), lane);
    return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); }) &&
           (noise.refuse == nullptr || noise.refuse(numbers).empty());
  };
  std::vector<std::vector<double>> all(static_cast<std::size_t>(width),
                                       std::vector<double>(static_cast<std::size_t>(samples), not_a_number));
  std::vector<int> whole;  // lanes of normal noise at every sample: their streams are drawn from side by side, which is cheaper
  std::vector<Stream> streams;
  for (int w = 0; w < width; ++w) {
    if (!outcome[static_cast<std::size_t>(w)].ok) continue;
    Stream stream(key.with_index(key.index + static_cast<std::uint64_t>(w)));
    bool normal = noise.gaussian;
    for (int i = 0; normal && i < samples; ++i) normal = usable(i, w);
    if (normal) {
      whole.push_back(w);
      streams.push_back(stream);
      continue;
    }
    for (int i = 0; i < samples; ++i)
      if (usable(i, w))
        all[static_cast<std::size_t>(w)][static_cast<std::size_t>(i)] =
            channel.from_si(draw(noise, numbers, -infinity, infinity, stream));
  }
  constexpr int at_once = 256;  // samples; even, as normal numbers come in pairs
  for (int from = 0; from < samples && !whole.empty(); from += at_once) {
    LaneArray normals(std::min(at_once, samples - from), static_cast<int>(whole.size()));
    draw_normals(streams, normals);
    for (std::size_t k = 0; k < whole.size(); ++k)
      for (int i = 0; i < normals.rows(); ++i) {
        int const at = (from + i) * rows + row;
        all[static_cast<std::size_t>(whole[k])][static_cast<std::size_t>(from + i)] =
            channel.from_si(records(at + 1, whole[k]) + records(at + 2, whole[k]) * normals(i, static_cast<int>(k)));
      }
  }
  return all;
}

LaneArray Trajectory::no_records(int width) const {
  int const rows = recorded_numbers(samples(), static_cast<int>(compiled_->records.size()));
  double const bytes = sizeof(double) * static_cast<double>(rows) * width;
  if (bytes > large) require_memory(fmt::format("a simulation of {} samples", samples()), bytes, "simulate fewer samples");
  return {rows, width};
}

Trajectory::Result Trajectory::run(ConstLanes parameters, StreamKey noise_key, bool moments, int ahead, int noises) const {
  Result result;
  std::optional<Schedule> uncorrected;
  if (ahead > 1) {
    Experiment free = simulator_.schedule().experiment();
    std::fill(free.scored.begin(), free.scored.end(), std::uint8_t{0});
    uncorrected.emplace(*compiled_->trajectory, free, simulator_.schedule().solver());
  }
  int const states = compiled_->free_start ? static_cast<int>(compiled_->model.states.size()) : 0;
  for (int first = 0; first < parameters.width(); first += trajectories_at_once) {
    int const width = std::min(trajectories_at_once, parameters.width() - first);
    LaneArray block(parameters.rows() + states, width);
    for (int r = 0; r < parameters.rows(); ++r)
      for (int w = 0; w < width; ++w) block(r, w) = parameters(r, first + w);
    if (start_) start_->estimate(block);
    LaneArray records = no_records(width);
    std::vector<Outcome> outcome(static_cast<std::size_t>(width));
    if (uncorrected)
      simulator_.records_ahead(block, *uncorrected, ahead, records, outcome);
    else
      simulator_.records(block, 0, samples(), records, outcome);
    record_failures(block, outcome, result.ledger);
    collect(records, outcome, first, noise_key, noises, result);
    if (moments) collect_moments(records, outcome, result);
  }
  return result;
}

std::vector<std::vector<double>> Trajectory::noise_arguments(ConstLanes parameters, int channel) const {
  LaneArray all(compiled_->parameter_rows(), parameters.width());
  for (int r = 0; r < parameters.rows(); ++r)
    for (int w = 0; w < parameters.width(); ++w) all(r, w) = parameters(r, w);
  if (start_) start_->estimate(all);
  int const rows = static_cast<int>(compiled_->records.size());
  LaneArray records = no_records(all.width());
  std::vector<Outcome> outcome(static_cast<std::size_t>(all.width()));
  simulator_.records(all, 0, samples(), records, outcome);
  std::vector<std::vector<double>> arguments(static_cast<std::size_t>(samples()));
  for (int r = 0; r < rows; ++r) {
    auto const& record = compiled_->records[static_cast<std::size_t>(r)];
    if (record.kind != RecordKind::noise_argument || record.index != channel) continue;
    for (int i = 0; i < samples(); ++i) arguments[static_cast<std::size_t>(i)].push_back(records(i * rows + r, 0));
  }
  return arguments;
}

Trajectory::Result Trajectory::run_redrawn(ConstLanes parameters, int trajectories, StreamKey redraw_key,
                                           StreamKey noise_key) const {
  int const states = compiled_->free_start ? static_cast<int>(compiled_->model.states.size()) : 0;
  LaneArray all(parameters.rows() + states, parameters.width());
  for (int r = 0; r < parameters.rows(); ++r)
    for (int w = 0; w < parameters.width(); ++w) all(r, w) = parameters(r, w);
  if (start_) start_->estimate(all);
  Result result;
  for (int first = 0; first < trajectories; first += trajectories_at_once) {
    int const width = std::min(trajectories_at_once, trajectories - first);
    LaneArray records = no_records(width);
    std::vector<Outcome> outcome(static_cast<std::size_t>(width));
    auto const redraw = [&](int sample, int lane, Lanes drawn) {
      for (int w = 0; w < drawn.width(); ++w) {
        Stream stream(
            redraw_key.at(redraw_key.index + static_cast<std::uint64_t>(first + lane + w), static_cast<std::uint64_t>(sample)));
        int const pick = static_cast<int>(stream.below(static_cast<std::uint64_t>(all.width())));
        for (int r = 0; r < all.rows(); ++r) drawn(r, w) = all(r, pick);
      }
    };
    simulator_.records_redrawn(redraw, 0, samples(), records, outcome);
    result.ledger.add_solves(outcome.size());
    for (Outcome const& each : outcome)  // no one vector of parameters repeats it
      if (!each.ok)
        result.ledger.add_failure(each.kind, "parameters redrawn at each sample",
                                  simulator_.schedule().time(std::max(each.sample, 0)), {});
    collect(records, outcome, first, noise_key, 1, result);
  }
  return result;
}

}  // namespace sysid
