// One simulator per segment; a batch holds the point and its perturbations in lanes.
#include "likelihood/segments/segments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/elementary.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr double least_relative_noise = 1e-9;  // of the channel's sd
/// Of the largest sample: starts are moved by a millionth of the size, which rounding must not hide where a motion comes to rest.
constexpr double least_size = 1e-6;

/// Signals of a channel over all experiments: their sd about the mean.
double size_of(std::span<Experiment const> experiments, std::size_t channel) {
  double sum = 0, squares = 0, count = 0, largest = 0;
  auto const each = [&](auto const& add) {
    for (Experiment const& experiment : experiments)
      for (double const y : experiment.measured[channel])
        if (std::isfinite(y)) add(y);
  };
  each([&](double y) { sum += y, ++count, largest = std::max(largest, std::fabs(y)); });
  if (count == 0) return 1;
  each([&](double y) { squares += (y - sum / count) * (y - sum / count); });
  return squares > 0 ? std::max(std::sqrt(squares / count), least_size * largest) : 1;
}

std::shared_ptr<SimulationProgram const> compile_records_of(CompiledModel const& compiled, CompiledModel::Record::Kind kind) {
  SimulationSource source = compiled.trajectory->source;
  std::vector<NodeId> records;
  for (std::size_t r = 0; r < compiled.records.size(); ++r)
    if (compiled.records[r].kind == kind) records.push_back(source.records[r]);
  source.records = std::move(records);
  return std::make_shared<SimulationProgram const>(compile(std::move(source)));
}

}  // namespace

std::shared_ptr<SimulationProgram const> compile_centres(CompiledModel const& compiled) {
  return compile_records_of(compiled, CompiledModel::Record::Kind::centre);
}

std::shared_ptr<SimulationProgram const> compile_states(CompiledModel const& compiled) {
  return compile_records_of(compiled, CompiledModel::Record::Kind::state);
}

int halvings(int rows, int least) {
  int count = 0;
  while ((rows >> (count + 1)) >= std::max(least, 2)) ++count;
  return count;
}

std::vector<Segment> cut_into_segments(std::span<Experiment const> experiments, int least, int most) {
  std::vector<Segment> segments;
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    auto const rows = static_cast<std::int64_t>(experiments[e].time.size());
    int const halved = std::min(most, halvings(static_cast<int>(rows), least));
    auto const begin = [&](std::int64_t part) { return static_cast<int>(part * rows >> halved); };
    for (int part = 0; part < (1 << halved); ++part)
      segments.push_back({static_cast<int>(e), begin(part), begin(part + 1) - begin(part)});
  }
  return segments;
}

SegmentSimulation::SegmentSimulation(std::shared_ptr<CompiledModel const> compiled, std::span<Experiment const> experiments,
                                     std::vector<Segment> segments, Settings settings)
    : compiled_(std::move(compiled)), segments_(std::move(segments)), settings_(std::move(settings)) {
  if (!settings_.centres) settings_.centres = compile_centres(*compiled_);
  for (int c = 0; c < channels(); ++c) size_.push_back(size_of(experiments, static_cast<std::size_t>(c)));
  per_channel_.assign(static_cast<std::size_t>(channels()), 0);
  log_relative_.assign(static_cast<std::size_t>(channels()), 0);
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    Segment const& segment = segments_[s];
    Experiment const part =
        slice(experiments[static_cast<std::size_t>(segment.experiment)], segment.first, segment.first + segment.count);
    simulators_.emplace_back(settings_.centres, Schedule(*settings_.centres, part, settings_.solver), settings_.execution,
                             settings_.pool);
    std::vector<double> samples, weights;
    int counted = 0;
    for (std::size_t c = 0; c < part.measured.size() && c < per_channel_.size(); ++c)
      for (int i = 0; i < counted_rows(static_cast<int>(s)); ++i) {
        auto const row = static_cast<std::size_t>(i);
        bool const counts = !part.measured[c].empty() && part.scored[row] != 0 && std::isfinite(part.measured[c][row]);
        samples.push_back(counts ? part.measured[c][row] : std::numeric_limits<double>::quiet_NaN());
        if (counts) ++counted, ++per_channel_[c];
        if (settings_.noise.relative.empty() || settings_.noise.carried) continue;
        double const relative =
            settings_.noise
                .relative[static_cast<std::size_t>(segment.experiment)][c][static_cast<std::size_t>(segment.first) + row];
        weights.push_back(1 / relative);
        if (counts) log_relative_[c] += elementary::log(relative);
      }
    samples_.push_back(std::move(samples));
    if (!weights.empty()) weights_.push_back(std::move(weights));
    per_segment_.push_back(counted);
  }
  if (settings_.noise.carried) whiten();
}

void SegmentSimulation::whiten() {
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    int const rows = counted_rows(static_cast<int>(s));
    whiteners_.emplace_back((*settings_.noise.carried)[static_cast<std::size_t>(segments_[s].experiment)], segments_[s].first, rows,
                            [&](int row) { return measured(static_cast<int>(s), row); });
    std::vector<double> weights;
    for (std::size_t row = 0; row < samples_[s].size(); ++row) {
      std::size_t const c = row / static_cast<std::size_t>(rows);
      double const relative = whiteners_.back().sds()[row] / settings_.noise.floor[c];
      bool const counts = !std::isnan(samples_[s][row]);
      weights.push_back(counts ? 1 / relative : 1);
      if (counts) log_relative_[c] += elementary::log(relative);
    }
    weights_.push_back(std::move(weights));
  }
}

void SegmentSimulation::in_relative_noise(int segment, Eigen::Ref<Eigen::MatrixXd> columns) const {
  auto const s = static_cast<std::size_t>(segment);
  if (!whiteners_.empty()) whiteners_[s].apply(columns);
  if (!weights_.empty())
    columns.array().colwise() *=
        Eigen::Map<Eigen::ArrayXd const>(weights_[s].data(), static_cast<Eigen::Index>(weights_[s].size()));
}

double SegmentSimulation::least_noise(int channel) const {
  auto const c = static_cast<std::size_t>(channel);
  return std::max(least_relative_noise * size_[c], settings_.noise.floor.empty() ? 0.0 : settings_.noise.floor[c]);
}

bool SegmentSimulation::measured(int segment, int row) const {
  return !std::isnan(samples_[static_cast<std::size_t>(segment)][static_cast<std::size_t>(row)]);
}

int SegmentSimulation::counted_rows(int segment) const {
  int const rows = segments_[static_cast<std::size_t>(segment)].count;
  return settings_.counted > 0 ? std::min(rows, settings_.counted) : rows;
}

std::vector<SegmentSlopes> SegmentSimulation::slopes(ShootingPoint const& at, Eigen::VectorXd const& step,
                                                     Eigen::MatrixXd const& start_step) const {
  return run(at, &step, &start_step);
}

std::vector<SegmentSlopes> SegmentSimulation::residuals(ShootingPoint const& at) const { return run(at, nullptr, nullptr); }

std::vector<SegmentSlopes> SegmentSimulation::run(ShootingPoint const& at, Eigen::VectorXd const* step,
                                                  Eigen::MatrixXd const* start_step) const {
  int const k = step == nullptr ? 0 : coefficients(), d = start_step == nullptr ? 0 : states(), lanes = 1 + k + d;
  int const records = channels();
  int const parameters = static_cast<int>(compiled_->model.parameters.size());
  std::size_t const count = segments_.size();
  std::vector<LaneArray> points, out;
  std::vector<std::vector<Outcome>> outcome(count, std::vector<Outcome>(static_cast<std::size_t>(lanes)));
  for (std::size_t s = 0; s < count; ++s) {
    LaneArray point(compiled_->parameter_rows(), lanes);
    for (int w = 0; w < lanes; ++w) {
      for (int p = 0; p < parameters; ++p) point(p, w) = settings_.others[static_cast<std::size_t>(p)];
      for (int j = 0; j < coefficients(); ++j)
        point(settings_.fitted[static_cast<std::size_t>(j)], w) = at.coefficients(j) + (w == 1 + j && j < k ? (*step)(j) : 0.0);
      for (int x = 0; x < states(); ++x)
        point(parameters + x, w) = at.starts(x, static_cast<Eigen::Index>(s)) +
                                   (d > 0 && w == 1 + k + x ? (*start_step)(x, static_cast<Eigen::Index>(s)) : 0.0);
    }
    points.push_back(std::move(point));
    out.emplace_back(counted_rows(static_cast<int>(s)) * records, lanes);
  }
  std::vector<Work> work;
  for (std::size_t s = 0; s < count; ++s)
    work.push_back(simulators_[s].records_work(points[s], 0, counted_rows(static_cast<int>(s)), out[s], outcome[s]));
  do_work(work, settings_.pool.get());

  std::vector<SegmentSlopes> all;
  for (std::size_t s = 0; s < count; ++s) {
    int const rows = counted_rows(static_cast<int>(s));
    auto const size = static_cast<Eigen::Index>(samples_[s].size());
    SegmentSlopes slopes{Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, k), Eigen::MatrixXd::Zero(size, d)};
    Eigen::Index row = 0;
    for (int record = 0; record < records; ++record)
      for (int i = 0; i < rows; ++i, ++row) {
        double const sample = samples_[s][static_cast<std::size_t>(row)];
        if (std::isnan(sample)) continue;
        int const place = i * records + record;
        double const here = out[s](place, 0);
        slopes.residual(row) = here - sample;
        for (int j = 0; j < k; ++j) slopes.by_coefficient(row, j) = out[s](place, 1 + j) - here;
        for (int x = 0; x < d; ++x) slopes.by_start(row, x) = out[s](place, 1 + k + x) - here;
      }
    if (!weights_.empty()) {
      in_relative_noise(static_cast<int>(s), slopes.residual);
      in_relative_noise(static_cast<int>(s), slopes.by_coefficient);
      in_relative_noise(static_cast<int>(s), slopes.by_start);
    }
    // A lane that failed is not a number in every row, measured or not.
    if (!outcome[s].front().ok) slopes.residual.setConstant(std::numeric_limits<double>::quiet_NaN());
    all.push_back(std::move(slopes));
  }
  return all;
}

}  // namespace sysid
