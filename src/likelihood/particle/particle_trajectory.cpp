// Particles are looked at before each sample, and their ancestors once the samples behind have weighed them.
#include "likelihood/particle/particle_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/normal_quantile.hpp"
#include "core/numeric/not_finite.hpp"
#include "likelihood/particle/ancestry.hpp"
#include "simulate/particle_lanes.hpp"
#include "simulate/stepper.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

using RecordKind = CompiledModel::Record::Kind;

constexpr int most_picks = 20;
constexpr double numbers_of_paths = 2e7;  // 160 MB

// Steps of a vector's stream; a filter takes step 0 alone.
constexpr std::uint64_t predicted_step = 1ULL << 32, smoothed_step = 2ULL << 32, innovation_step = 3ULL << 32;

double from_si_width(Quantity const& quantity, double width) { return std::fabs(quantity.from_si(width) - quantity.from_si(0)); }

std::string declared_unit(Quantity const& quantity) {
  if (!quantity.unit) return {};
  return quantity.unit->text.empty() ? format_dimension(quantity.unit->dimension) : quantity.unit->text;
}

/// The particle in whose share of the weights `at` of their sum lies.
std::size_t chosen(std::span<double const> weights, double at) {
  double sum = 0;
  for (std::size_t w = 0; w < weights.size(); ++w)
    if ((sum += weights[w]) > at) return w;
  return weights.size() - 1;
}

bool reads_any_state(Graph const& graph, NodeId id) {
  return graph.depends(id, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::state; });
}

/// Phi^-1 of the share below, by the smaller of the two tails.
double standard_normal(double below, double above) {
  return below < above ? standard_normal_quantile(below) : -standard_normal_quantile(above);
}

}  // namespace

struct ParticleTrajectory::Path {
  FilterOutcome outcome;
  bool solved() const { return outcome.sample < 0; }
  // [shown][samples], SI; of channels in their order.
  std::vector<std::vector<double>> mean, sd, drawn, noisy, noise_variance;
  std::vector<std::vector<double>> smoothed;  // [smoothed * picks][samples], SI
};

/// One run of the filter, looked at.
class ParticleTrajectory::Recorder {
 public:
  Recorder(ParticleTrajectory const& of, ConstLanes parameters, StreamKey key, int picks, Path& path)
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

  ParticleView view() {
    ParticleView made;
    made.predicted = [this](PredictedParticles const& particles) { predicted(particles); };
    made.weighed = [this](WeighedParticles const& particles) { weighed(particles); };
    made.resampled = [this](std::span<int const> ancestors, std::span<double const> weights) {
      if (picks_ > 0) ancestry_.resample(ancestors, weights);
    };
    return made;
  }

  /// Innovations are found, too.
  void score(ParticleInnovations& innovations) { innovations_ = &innovations; }

  void end() {
    if (picks_ > 0) ancestry_.end(last_weights_);
  }

 private:
  enum Kind { states, averages };

  double value(NodeId id) const {
    Graph const& graph = of_.written_.graph;
    return graph.evaluate(id, [&](NodeId leaf) {
      Node const& node = graph[leaf];
      if (node.leaf_kind != LeafKind::parameter) return not_a_number;
      auto const& parameters = of_.written_.parameters;
      auto const p = static_cast<std::size_t>(node.index);
      if (!parameters[p].per_experiment && parameters[p].value) return value(*parameters[p].value);
      return parameters_(node.index, 0);
    });
  }

  void predicted(PredictedParticles const& particles) {
    int const sample = particles.sample;
    if (picks_ > 0 && sample > 0) add_averages(sample - 1, particles.states);
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

  /// [arguments] of the noise of a channel for a particle.
  std::vector<double> const& arguments(std::size_t channel, std::size_t particle) {
    numbers_.clear();
    for (int const row : of_.arguments_[channel]) numbers_.push_back(records_(row, static_cast<int>(particle)));
    return numbers_;
  }

  static bool usable(DistributionRow const& row, std::vector<double> const& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); }) &&
           (row.refuse == nullptr || row.refuse(numbers).empty());
  }

  void add_noise(std::size_t c, std::size_t pick, std::span<double const> weights, std::size_t i, Stream& stream) {
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

  void add_innovations(PredictedParticles const& particles) {
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

  double innovation(std::size_t c, double measured, std::span<double const> weights, Stream& stream) {
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

  void weighed(WeighedParticles const& particles) {
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

  /// Of the interval that begins with `sample`: as its noises are at its end.
  void add_averages(int sample, ConstLanes states) {
    LaneArray values(static_cast<int>(of_.smoothed_.size()), of_.particles_);
    Schedule const& schedule = of_.densities_.schedule();
    double const step = schedule.time(sample + 1) - schedule.time(sample);
    bool any = false;
    for (std::size_t q = 0; q < of_.smoothed_.size(); ++q) {
      Smoothed const& shown = of_.smoothed_[q];
      if (shown.kind != Smoothed::Kind::average) continue;
      ParticleNoise const& noise = of_.model_->noises[static_cast<std::size_t>(shown.index)];
      double const size = sizes_[static_cast<std::size_t>(shown.index)];
      if (noise.observed) continue;  // drawn anew for the next interval before anybody looks
      any = true;
      for (int w = 0; w < of_.particles_; ++w)
        values(static_cast<int>(q), w) =
            size * (states(noise.state, w) - (noise.white ? 0.5 * step * states(noise.state + 1, w) : 0));
    }
    if (any) ancestry_.add(averages, sample, std::move(values));
  }

  void emit(int kind, int sample, ConstLanes values, std::span<int const> origin, std::span<double const> weights) {
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

  ParticleTrajectory const& of_;
  ConstLanes parameters_;
  StreamKey key_;
  int picks_;
  Path& path_;
  ParticleLanes lanes_;
  Ancestry ancestry_;
  ConstLanes records_;
  ParticleInnovations* innovations_ = nullptr;
  std::vector<double> sizes_;  // of the disturbances
  std::vector<double> numbers_, last_weights_;
};

ParticleTrajectory::~ParticleTrajectory() = default;

ParticleTrajectory::ParticleTrajectory(std::shared_ptr<ParticleModel const> model, Model const& written,
                                       Experiment const& experiment, SolverSettings const& solver, int particles,
                                       ExecutionOptions const& options)
    : model_(std::move(model)),
      written_(written),
      compiled_(compile(model_->model, false, solver.method)),
      pool_(make_pool(options)),
      densities_(model_->densities, Schedule(*model_->densities, with_corrections(written, experiment), solver), options, pool_),
      records_(compiled_->trajectory, Schedule(*compiled_->trajectory, with_corrections(written, experiment), solver), options,
               pool_),
      particles_(particles) {
  choose_shown();
}

Quantity const& ParticleTrajectory::quantity_of(CompiledModel::Record const& record) const {
  auto const index = static_cast<std::size_t>(record.index);
  if (record.kind == RecordKind::state) return written_.states[index];
  if (record.kind == RecordKind::derived) return written_.derived[index];
  return written_.channels[index];
}

Quantity const& ParticleTrajectory::quantity_of(Smoothed const& shown) const {
  auto const index = static_cast<std::size_t>(shown.index);
  if (shown.kind == Smoothed::Kind::state) return written_.states[index];
  if (shown.kind == Smoothed::Kind::average) return written_.disturbances[index];
  return quantity_of(compiled_->records[index]);
}

void ParticleTrajectory::choose_shown() {
  bool const map = written_.dynamics == Dynamics::discrete;
  std::vector<Smoothed> derived;
  arguments_.resize(written_.channels.size());
  for (std::size_t r = 0; r < compiled_->records.size(); ++r) {
    auto const& record = compiled_->records[r];
    if (record.kind == RecordKind::noise_argument)
      arguments_[static_cast<std::size_t>(record.index)].push_back(static_cast<int>(r));
    bool const own = record.kind != RecordKind::state || record.index < model_->states;
    bool const kind = record.kind == RecordKind::centre || record.kind == RecordKind::state || record.kind == RecordKind::derived;
    if (kind && own) shown_.push_back(static_cast<int>(r));
    if (record.kind == RecordKind::derived &&
        reads_any_state(written_.graph, written_.derived[static_cast<std::size_t>(record.index)].value))
      derived.push_back({Smoothed::Kind::derived, static_cast<int>(r)});
  }
  for (int s = 0; s < model_->states && !map; ++s) smoothed_.push_back({Smoothed::Kind::state, s});
  for (std::size_t d = 0; d < written_.disturbances.size(); ++d) {
    if (int const state = written_.disturbances[d].state; state < 0)
      smoothed_.push_back({Smoothed::Kind::average, static_cast<int>(d)});
    else if (map)
      smoothed_.push_back({Smoothed::Kind::state, state});
  }
  smoothed_.insert(smoothed_.end(), derived.begin(), derived.end());
  for (Smoothed const& each : smoothed_) {
    Quantity const& quantity = quantity_of(each);
    smoothed_names_.push_back({quantity.name, declared_unit(quantity), each.kind == Smoothed::Kind::average});
  }
}

ParticleTrajectory::Path ParticleTrajectory::path(ConstLanes parameters, StreamKey key, int picks, int ahead) const {
  Path path;
  Recorder recorder(*this, parameters, key, picks, path);
  StreamNormals normals(key);
  ParticleView view = recorder.view();
  view.ahead = std::clamp(ahead, 1, std::max(1, samples()));
  path.outcome = ParticleFilter(*model_, densities_, particles_).run(parameters, normals, view);
  if (path.solved()) recorder.end();
  return path;
}

ParticleTrajectory::Result ParticleTrajectory::run(ConstLanes parameters, StreamKey key, bool smooth, int ahead) const {
  Result result;
  double const each = static_cast<double>(smoothed_.size()) * samples() * parameters.width();
  result.picks =
      smooth && ahead == 1 ? std::clamp(static_cast<int>(std::min(numbers_of_paths / std::max(each, 1.0), 1e6)), 1, most_picks) : 0;
  std::vector<Path> paths(static_cast<std::size_t>(parameters.width()));
  Work work;
  work.given_up = densities_.given_up();
  work.instructions =
      work_per_sample(densities_.program(), densities_.schedule().solver()) * samples() * particles_ * parameters.width() * ahead;
  work.width = parameters.width();
  work.blocks = [&](int first, int count) {
    Blocks blocks{{}, work.instructions / work.width * count};
    for (int d = first; d < first + count; ++d)
      blocks.all.push_back([&, d] {
        paths[static_cast<std::size_t>(d)] =
            path(parameters.columns(d, 1), key.with_index(key.index + static_cast<std::uint64_t>(d)), result.picks, ahead);
      });
    return blocks;
  };
  do_work({&work, 1}, pool_.get());
  collect(paths, result);
  return result;
}

void ParticleTrajectory::collect(std::vector<Path>& paths, Result& result) const {
  Trajectory::Result& out = result.predicted;
  out.values.resize(shown_.size());
  out.random.resize(shown_.size());
  out.spread.resize(shown_.size());
  out.noisy.resize(written_.channels.size());
  out.noisy_spread.resize(written_.channels.size());
  out.drift.resize(written_.invariants.size());
  result.smoothed.resize(smoothed_.size());
  out.ledger.add_solves(paths.size());
  auto const declared = [](Quantity const& quantity, std::vector<double> values) {
    for (double& value : values) value = quantity.from_si(value);
    return values;
  };
  for (Path& path : paths) {
    if (!path.solved()) {
      for (auto* const all : {&path.mean, &path.sd, &path.drawn, &path.noisy, &path.smoothed})
        for (auto& row : *all) std::fill(row.begin(), row.end(), not_a_number);
      out.ledger.add_failure(FailureClass::non_finite, "the densities of all particles",
                             densities_.schedule().time(std::max(path.outcome.sample, 0)), {});
    }
    out.solved.push_back(path.solved() ? 1 : 0);
    for (std::size_t q = 0; q < shown_.size(); ++q) {
      Quantity const& quantity = quantity_of(compiled_->records[static_cast<std::size_t>(shown_[q])]);
      std::vector<double> sds = path.sd[q];
      for (double& sd : sds) sd = from_si_width(quantity, sd);
      out.values[q].push_back(declared(quantity, path.mean[q]));
      out.spread[q].push_back(std::move(sds));
      out.random[q].push_back(declared(quantity, path.drawn[q]));
    }
    for (std::size_t c = 0; c < written_.channels.size(); ++c) {
      Channel const& channel = written_.channels[c];
      out.noisy[c].push_back(declared(channel, path.noisy[c]));
      if (!channel.noise.row->gaussian) continue;
      std::vector<double> sds = path.noise_variance[c];
      for (std::size_t i = 0; i < sds.size(); ++i)
        sds[i] = from_si_width(channel, std::sqrt(sds[i] + path.sd[c][i] * path.sd[c][i]));
      out.noisy_spread[c].push_back(std::move(sds));
    }
    for (std::size_t q = 0; q < smoothed_.size(); ++q)
      for (int k = 0; k < result.picks; ++k)
        result.smoothed[q].push_back(
            declared(quantity_of(smoothed_[q]),
                     std::move(path.smoothed[q * static_cast<std::size_t>(result.picks) + static_cast<std::size_t>(k)])));
  }
}

ParticleInnovations ParticleTrajectory::innovations(ConstLanes parameters, StreamKey key) const {
  ParticleInnovations innovations;
  std::vector<double> const none(static_cast<std::size_t>(samples()), not_a_number);
  innovations.standardised.assign(written_.channels.size(), none);
  innovations.predicted = innovations.standardised;
  Path path;
  Recorder recorder(*this, parameters, key, 0, path);
  recorder.score(innovations);
  StreamNormals normals(key);
  innovations.outcome = ParticleFilter(*model_, densities_, particles_).run(parameters, normals, recorder.view());
  return innovations;
}

}  // namespace sysid
