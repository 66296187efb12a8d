// Particles are looked at before each sample, and their ancestors once the samples behind have weighed them.
#include "likelihood/particle/particle_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/normal_quantile.hpp"
#include "core/numeric/not_finite.hpp"

namespace sysid {
namespace {

// Steps of a vector's stream; a filter takes step 0 alone.
constexpr std::uint64_t predicted_step = 1ULL << 32, smoothed_step = 2ULL << 32, innovation_step = 3ULL << 32;

/// The particle in whose share of the weights `at` of their sum lies.
std::size_t chosen(std::span<double const> weights, double at) {
  double sum = 0;
  for (std::size_t w = 0; w < weights.size(); ++w)
    if ((sum += weights[w]) > at) return w;
  return weights.size() - 1;
}

/// Phi^-1 of the share below, by the smaller of the two tails.
double standard_normal(double below, double above) {
  return below < above ? standard_normal_quantile(below) : -standard_normal_quantile(above);
}

}  // namespace

ParticleTrajectory::Recorder::Recorder(ParticleTrajectory const& of, ConstLanes parameters, StreamKey key, int picks, Path& path)
    : of_(of),
      parameters_(parameters),
      key_(key),
      picks_(picks),
      path_(path),
      lanes_(of.records_, of.particles_),
      ancestry_(of.particles_, [this](int kind, int sample, ConstLanes values, std::span<int const> origin,
                                      std::span<double const> weights) { emit(kind, sample, values, origin, weights); }) {
  LaneArray const starts(of.model_->starts, of.particles_);
  lanes_.start({parameters.data(), of.model_->first_start, 1, parameters.stride()}, starts);
  auto const samples = static_cast<std::size_t>(of.samples());
  for (auto* const each : {&path.mean, &path.sd, &path.drawn})
    each->assign(of.shown_.size(), std::vector<double>(samples, not_a_number));
  for (auto* const each : {&path.noisy, &path.noise_variance})
    each->assign(of.written_.channels.size(), std::vector<double>(samples, not_a_number));
  path.smoothed.assign(of.smoothed_.size() * static_cast<std::size_t>(picks), std::vector<double>(samples, not_a_number));
  for (std::size_t d = 0; d < of.written_.disturbances.size(); ++d)
    sizes_.push_back(std::sqrt(value(of.written_.disturbances[d].intensity)));
}

ParticleView ParticleTrajectory::Recorder::view() {
  ParticleView made;
  if (picks_ > 0) made.moved = [this](IntervalMeans const& means) { add_averages(means); };
  made.predicted = [this](PredictedParticles const& particles) { predicted(particles); };
  made.weighed = [this](WeighedParticles const& particles) { weighed(particles); };
  made.resampled = [this](std::span<int const> ancestors, std::span<double const> weights) {
    if (picks_ > 0) ancestry_.resample(ancestors, weights);
  };
  return made;
}

void ParticleTrajectory::Recorder::end() {
  if (picks_ > 0) ancestry_.end(last_weights_);
}

double ParticleTrajectory::Recorder::value(NodeId id) const {
  Graph const& graph = of_.written_.graph;
  return graph.evaluate(id, [&](NodeId leaf) {
    Node const& node = graph[leaf];
    if (node.leaf_kind != LeafKind::parameter) return not_a_number;
    auto const& parameters = of_.written_.parameters;
    auto const p = static_cast<std::size_t>(node.index);
    if (auto const fixed = parameters[p].value_of_all()) return value(*fixed);
    return parameters_(node.index, 0);
  });
}

void ParticleTrajectory::Recorder::predicted(PredictedParticles const& particles) {
  int const sample = particles.sample;
  Lanes const own = lanes_.states();
  for (int s = 0; s < own.rows(); ++s) std::copy_n(particles.states.row(s).begin(), own.width(), own.row(s).begin());
  records_ = lanes_.record(sample);
  Stream stream(key_.with_step(predicted_step + static_cast<std::uint64_t>(sample)));
  std::size_t const pick = chosen(particles.weights, stream.uniform());
  auto const i = static_cast<std::size_t>(sample);
  for (std::size_t q = 0; q < of_.shown_.size(); ++q) {
    std::span<double const> const row = records_.row(of_.shown_[q]);
    double mean = 0, variance = 0;
    for (std::size_t w = 0; w < row.size(); ++w)
      if (particles.weights[w] > 0) mean += particles.weights[w] * row[w];
    for (std::size_t w = 0; w < row.size(); ++w)
      if (particles.weights[w] > 0) variance += particles.weights[w] * (row[w] - mean) * (row[w] - mean);
    path_.mean[q][i] = mean;
    path_.sd[q][i] = std::sqrt(variance);
    path_.drawn[q][i] = row[pick];
  }
  for (std::size_t c = 0; c < of_.written_.channels.size(); ++c) add_noise(c, pick, particles.weights, i, stream);
  if (innovations_ != nullptr) add_innovations(particles);
}

std::vector<double> const& ParticleTrajectory::Recorder::arguments(std::size_t channel, std::size_t particle) {
  numbers_.clear();
  for (int const row : of_.arguments_[channel]) numbers_.push_back(records_(row, static_cast<int>(particle)));
  return numbers_;
}

bool ParticleTrajectory::Recorder::usable(DistributionRow const& row, std::vector<double> const& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); }) &&
         (row.refuse == nullptr || row.refuse(numbers).empty());
}

void ParticleTrajectory::Recorder::add_noise(std::size_t c, std::size_t pick, std::span<double const> weights, std::size_t i,
                                             Stream& stream) {
  DistributionRow const& row = *of_.written_.channels[c].noise.row;
  if (std::vector<double> const& numbers = arguments(c, pick); usable(row, numbers))
    path_.noisy[c][i] = draw(row, numbers, -infinity, infinity, stream);
  if (!row.gaussian) return;
  std::span<double const> const sds = records_.row(of_.arguments_[c][1]);
  double variance = 0;
  for (std::size_t w = 0; w < weights.size(); ++w)
    if (weights[w] > 0) variance += weights[w] * sds[w] * sds[w];
  path_.noise_variance[c][i] = variance;
}

void ParticleTrajectory::Recorder::add_innovations(PredictedParticles const& particles) {
  std::vector<double> weights(particles.weights.begin(), particles.weights.end());
  Schedule const& schedule = of_.densities_.schedule();
  Stream stream(key_.with_step(innovation_step + static_cast<std::uint64_t>(particles.sample)));
  auto const i = static_cast<std::size_t>(particles.sample);
  for (std::size_t c = 0; c < of_.written_.channels.size(); ++c) {
    innovations_->predicted[c][i] = of_.written_.channels[c].from_si(path_.mean[c][i]);
    if (!schedule.summed(static_cast<int>(c), particles.sample)) continue;
    innovations_->standardised[c][i] = innovation(c, schedule.experiment().measured[c][i], weights, stream);
    std::span<double const> const density = particles.densities.row(static_cast<int>(c));
    double const most = *std::max_element(density.begin(), density.end());
    double sum = 0;
    for (std::size_t w = 0; w < weights.size(); ++w) {
      weights[w] *= density[w] > -infinity ? elementary::exp(density[w] - most) : 0;
      sum += weights[w];
    }
    if (!(sum > 0)) return;
    for (double& each : weights) each /= sum;
  }
}

double ParticleTrajectory::Recorder::innovation(std::size_t c, double measured, std::span<double const> weights, Stream& stream) {
  DistributionRow const& row = *of_.written_.channels[c].noise.row;
  double below = 0, above = 0, equal = 0;
  for (std::size_t w = 0; w < weights.size(); ++w) {
    if (!(weights[w] > 0)) continue;
    std::vector<double> const& numbers = arguments(c, w);
    if (!usable(row, numbers)) continue;
    if (row.gaussian) {
      double const z = (measured - numbers[0]) / numbers[1] / std::numbers::sqrt2;
      below += weights[w] * 0.5 * elementary::erfc(-z);
      above += weights[w] * 0.5 * elementary::erfc(z);
      continue;
    }
    double const drawn = draw(row, numbers, -infinity, infinity, stream);
    (drawn < measured ? below : drawn > measured ? above : equal) += weights[w];
  }
  if (row.gaussian) return standard_normal(std::max(below, 1e-300), std::max(above, 1e-300));
  double const share = equal > 0 ? stream.uniform() : 0, least = 0.5 / of_.particles_;
  return standard_normal(std::max(below + share * equal, least), std::max(above + (1 - share) * equal, least));
}

void ParticleTrajectory::Recorder::weighed(WeighedParticles const& particles) {
  last_weights_.assign(particles.weights.begin(), particles.weights.end());
  if (picks_ == 0) return;
  LaneArray values(static_cast<int>(of_.smoothed_.size()), of_.particles_);
  for (std::size_t q = 0; q < of_.smoothed_.size(); ++q) {
    Smoothed const& shown = of_.smoothed_[q];
    if (shown.kind == Smoothed::Kind::average) continue;
    std::span<double const> const from =
        shown.kind == Smoothed::Kind::state ? particles.states.row(shown.index) : records_.row(shown.index);
    std::copy(from.begin(), from.end(), values.row(static_cast<int>(q)).begin());
  }
  ancestry_.add(states, particles.sample, std::move(values));
  ancestry_.forget(particles.sample, particles.weights);
}

void ParticleTrajectory::Recorder::add_averages(IntervalMeans const& means) {
  LaneArray values(static_cast<int>(of_.smoothed_.size()), of_.particles_);
  bool any = false;
  for (std::size_t q = 0; q < of_.smoothed_.size(); ++q) {
    Smoothed const& shown = of_.smoothed_[q];
    if (shown.kind != Smoothed::Kind::average) continue;
    double const size = sizes_[static_cast<std::size_t>(shown.index)];
    any = true;
    for (int w = 0; w < of_.particles_; ++w) values(static_cast<int>(q), w) = size * means.values(shown.index, w);
  }
  if (any) ancestry_.add(averages, means.sample, std::move(values));
}

void ParticleTrajectory::Recorder::emit(int kind, int sample, ConstLanes values, std::span<int const> origin,
                                        std::span<double const> weights) {
  Stream stream(key_.with_step(smoothed_step + 2 * static_cast<std::uint64_t>(sample) + static_cast<std::uint64_t>(kind)));
  double const first = stream.uniform();
  double sum = 0;
  std::size_t w = 0;
  for (int k = 0; k < picks_; ++k) {
    double const at = (first + k) / picks_;
    while (w + 1 < weights.size() && sum + weights[w] <= at) sum += weights[w++];
    int const from = origin[w];
    for (std::size_t q = 0; q < of_.smoothed_.size(); ++q)
      if ((of_.smoothed_[q].kind == Smoothed::Kind::average) == (kind == averages))
        path_.smoothed[q * static_cast<std::size_t>(picks_) + static_cast<std::size_t>(k)][static_cast<std::size_t>(sample)] =
            values(static_cast<int>(q), from);
  }
}

}  // namespace sysid
