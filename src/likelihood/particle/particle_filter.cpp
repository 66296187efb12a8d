// From sample to sample: move, weigh, choose.
#include "likelihood/particle/particle_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "likelihood/particle/resampling.hpp"
#include "simulate/particle_lanes.hpp"

namespace sysid {
namespace {

std::size_t numbers_of_start(ParticleModel const& model, int particles) {
  return static_cast<std::size_t>(particles) * static_cast<std::size_t>(model.starts);
}
/// Of the step that begins with it, and one for the choice among the particles.
std::size_t numbers_of_sample(ParticleModel const& model, int particles) {
  return static_cast<std::size_t>(particles) * static_cast<std::size_t>(model.numbers) + 1;
}
/// Of each later step of a sampling interval: white noise alone is drawn anew.
std::size_t numbers_of_step(ParticleModel const& model, int particles) {
  int numbers = 0;
  for (ParticleNoise const& noise : model.noises) numbers += noise.white ? noise.numbers() : 0;
  return static_cast<std::size_t>(particles) * static_cast<std::size_t>(numbers);
}
/// Lines of white noise in a sampling interval.
int steps_between(ParticleModel const& model, Simulator const& simulator, int particles) {
  SolverSettings const& solver = simulator.schedule().solver();
  return solver.fixed_step() && numbers_of_step(model, particles) > 0 ? solver.substeps : 1;
}

/// Particles are resampled where their weights are worth less than this part of them.
constexpr double fewest_effective = 0.5;

class ParticleRun {
 public:
  ParticleRun(ParticleModel const& model, Simulator const& simulator, int particles)
      : model_(model),
        simulator_(simulator),
        schedule_(simulator.schedule()),
        particles_(simulator, particles),
        order_(particles),
        steps_(steps_between(model, simulator, particles)),
        means_(static_cast<int>(model.noises.size()), particles),
        weights_(static_cast<std::size_t>(particles), 1.0 / particles),
        density_(weights_.size()),
        ancestors_(weights_.size()) {}

  /// to: behind the last sample.
  FilterOutcome run(ConstLanes parameters, ParticleNormals& normals, ParticleView const& view, int to) {
    start(parameters, normals);
    int const end = schedule_.last_summed();
    for (int sample = 0; sample < to; ++sample) {
      if (simulator_.stopped()) return failed(sample);
      if (sample > 0) {
        move(particles_, sample - 1, normals, view.moved ? &means_ : nullptr);
        if (view.moved) view.moved({sample - 1, means_});
      }
      std::span<double const> numbers = normals.take(numbers_of_sample(model_, particles_.count()));
      if (view.ahead > 1) {
        kept_.assign(numbers.begin(), numbers.end());
        numbers = kept_;
      }
      set_noises(particles_.states(), sample, numbers, true);
      bool const weighed = is_weighed(sample);
      ConstLanes const densities = weighed ? particles_.record(sample) : ConstLanes();
      if (view.predicted && view.ahead == 1) view.predicted({sample, particles_.states(), weights_, densities});
      if (view.predicted && view.ahead > 1) go_ahead(sample, parameters, normals, view);
      if (weighed && !weigh(sample, densities)) return failed(sample);
      if (view.weighed) view.weighed({sample, particles_.states(), weights_});
      if (weighed && sample + 1 < end && effective_ < fewest_effective) resample(numbers.back(), view);
      set_noises(particles_.states(), sample, numbers, false);
      if (view.ahead > 1 && sample + view.ahead < to) leave(sample);
    }
    return outcome_;
  }

  bool is_weighed(int sample) const {
    for (int c = 0; c < simulator_.program().registers.records; ++c)
      if (schedule_.summed(c, sample)) return true;
    return false;
  }

 private:
  void start(ConstLanes parameters, ParticleNormals& normals) {
    std::span<double const> const numbers = normals.take(numbers_of_start(model_, particles_.count()));
    ConstLanes const own(numbers.data(), model_.starts, particles_.count());
    particles_.start({parameters.data(), model_.first_start, 1, parameters.stride()}, own);
  }

  /// Particles as they are behind a sample, which no later one weighs.
  struct Left {
    int sample;
    LaneArray states;
    std::vector<double> weights;
  };
  void leave(int sample) {
    ConstLanes const states = particles_.states();
    Left left{sample, LaneArray(states.rows(), states.width()), weights_};
    copy(states, left.states);
    left_.push_back(std::move(left));
  }
  static void copy(ConstLanes from, Lanes to) {
    for (int s = 0; s < from.rows(); ++s) std::copy_n(from.row(s).begin(), from.width(), to.row(s).begin());
  }

  /// Shows a sample as it is known from those `ahead` rows before it and earlier: particles that were left there have gone on by
  /// themselves. The first ones have nothing before them but the start.
  void go_ahead(int sample, ConstLanes parameters, ParticleNormals& normals, ParticleView const& view) {
    if (!free_) {
      free_.emplace(simulator_, particles_.count());
      LaneArray const starts(model_.starts, particles_.count());  // only a start reads them
      free_->start({parameters.data(), model_.first_start, 1, parameters.stride()}, starts);
      leave(-1);
    }
    for (Left& each : left_) {
      Lanes const states = free_->states();
      copy(each.states, states);
      if (sample > 0) move(*free_, sample - 1, normals, nullptr);
      std::span<double const> const numbers = normals.take(numbers_of_sample(model_, particles_.count()));
      if (sample > 0) set_noises(states, sample, numbers, true);
      bool const is_start = each.sample < 0;
      if (is_start ? sample < view.ahead : each.sample + view.ahead == sample)
        view.predicted({sample, states, each.weights, ConstLanes()});
      set_noises(states, sample, numbers, false);
      copy(states, each.states);
    }
    std::erase_if(left_, [&](Left const& each) { return std::max(each.sample, -1) + view.ahead <= sample; });
  }

  FilterOutcome failed(int sample) const {
    FilterOutcome outcome = outcome_;
    outcome.log_likelihood = -infinity;
    outcome.sample = sample;
    return outcome;
  }

  /// From a sample to the next one, the noises of the first step being set. means [noises x N], if wanted.
  void move(ParticleLanes& particles, int sample, ParticleNormals& normals, LaneArray* means) const {
    Lanes const states = particles.states();
    double const step = length_of_step(sample);
    if (means != nullptr) {
      for (int d = 0; d < means->rows(); ++d) std::ranges::fill(means->row(d), 0.0);
      add_means(states, step, *means);
    }
    if (steps_ == 1) return particles.step(sample);
    for (int substep = 0; substep < steps_; ++substep) {
      if (substep > 0) {
        draw_white(states, step, normals.take(numbers_of_step(model_, particles.count())));
        if (means != nullptr) add_means(states, step, *means);
      }
      particles.step(sample, substep);
    }
  }

  double length_of_step(int sample) const {
    int const from = sample + 1 < schedule_.samples() ? sample : sample - 1;
    return from < 0 ? 1 : (schedule_.time(from + 1) - schedule_.time(from)) / steps_;
  }

  /// What the noises add to their means over a sampling interval in a step whose begin the states are.
  void add_means(ConstLanes states, double step, LaneArray& means) const {
    for (std::size_t d = 0; d < model_.noises.size(); ++d) {
      ParticleNoise const& noise = model_.noises[d];
      std::span<double> const mean = means.row(static_cast<int>(d));
      for (std::size_t w = 0; w < weights_.size(); ++w) {
        auto const lane = static_cast<int>(w);
        double const in_step =
            noise.white ? states(noise.state, lane) + 0.5 * step * states(noise.state + 1, lane) : states(noise.state, lane);
        mean[w] += in_step / steps_;
      }
    }
  }

  /// Disturbances of the step that begins with a sample: those that a channel reads there, or the others.
  void set_noises(Lanes states, int sample, std::span<double const> numbers, bool observed) const {
    auto const count = weights_.size();
    double const step = length_of_step(sample);
    std::size_t first = 0;
    for (ParticleNoise const& noise : model_.noises) {
      double const* const xi = numbers.data() + first;
      first += count * static_cast<std::size_t>(noise.numbers());
      if (noise.observed != observed) continue;
      if (noise.white)
        set_line(states, noise, step, xi);
      else
        std::copy_n(xi, count, states.row(noise.state).data());
    }
  }

  void draw_white(Lanes states, double step, std::span<double const> numbers) const {
    std::size_t first = 0;
    for (ParticleNoise const& noise : model_.noises) {
      if (!noise.white) continue;
      set_line(states, noise, step, numbers.data() + first);
      first += weights_.size() * static_cast<std::size_t>(noise.numbers());
    }
  }

  void set_line(Lanes states, ParticleNoise const& noise, double step, double const* xi) const {
    std::size_t const count = weights_.size();
    double* const value = states.row(noise.state).data();
    double* const rate = states.row(noise.state + 1).data();
    double const *const slope = xi + count, size = 1 / std::sqrt(step);
    for (std::size_t w = 0; w < count; ++w) {
      value[w] = size * (xi[w] - std::numbers::sqrt3 * slope[w]);
      rate[w] = 2 * std::numbers::sqrt3 * size / step * slope[w];
    }
  }

  /// Whether any particle is left.
  bool weigh(int sample, ConstLanes densities) {
    std::fill(density_.begin(), density_.end(), 0.0);
    for (int c = 0; c < densities.rows(); ++c) {
      if (!schedule_.summed(c, sample)) continue;
      double const* const row = densities.row(c).data();
      for (std::size_t w = 0; w < density_.size(); ++w) density_[w] += row[w];
    }
    double most = -infinity;
    for (std::size_t w = 0; w < density_.size(); ++w) {
      if (!(density_[w] < infinity) || !(weights_[w] > 0)) density_[w] = -infinity;  // not a number, or dead before
      most = std::max(most, density_[w]);
    }
    if (most == -infinity) return false;
    for (double& each : density_) each -= most;
    elementary::exp_lanes(density_.data(), density_.data(), static_cast<int>(density_.size()));
    double sum = 0;
    for (std::size_t w = 0; w < density_.size(); ++w) sum += weights_[w] *= density_[w];
    double squares = 0;
    for (double& weight : weights_) weight /= sum, squares += weight * weight;
    outcome_.log_likelihood += most + elementary::log(sum);
    effective_ = 1 / (static_cast<double>(weights_.size()) * squares);
    if (effective_ < outcome_.least_effective) outcome_.least_effective = effective_, outcome_.least_effective_at = sample;
    return true;
  }

  /// Rows that are drawn anew for the next interval are not taken along.
  void resample(double normal, ParticleView const& view) {
    Lanes const states = particles_.states();
    double const uniform = 0.5 * elementary::erfc(-normal / std::numbers::sqrt2);
    ConstLanes const own(states.data(), model_.states, states.width(), states.stride());
    systematic_ancestors(weights_, order_(own), uniform, ancestors_);
    if (view.resampled) view.resampled(ancestors_, weights_);
    particles_.select(ancestors_, 0, model_.states);
    for (ParticleNoise const& noise : model_.noises)
      if (noise.observed) particles_.select(ancestors_, noise.state, noise.state + noise.numbers());
    int const memories = static_cast<int>(model_.model.states.size());
    particles_.select(ancestors_, memories, states.rows());
    std::fill(weights_.begin(), weights_.end(), 1 / static_cast<double>(weights_.size()));
  }

  ParticleModel const& model_;
  Simulator const& simulator_;
  Schedule const& schedule_;
  ParticleLanes particles_;
  ParticleOrder order_;
  int steps_;                              // lines of white noise in a sampling interval
  LaneArray means_;                        // [noises x N] of the last interval
  std::vector<double> kept_;               // numbers of the sample, where others are taken before they are used
  std::vector<double> weights_, density_;  // weights: their sum is 1
  std::vector<int> ancestors_;
  double effective_ = 1;
  FilterOutcome outcome_;
  std::optional<ParticleLanes> free_;  // moves those that were left, the oldest first
  std::vector<Left> left_;
};

}  // namespace

ParticleFilter::ParticleFilter(ParticleModel const& model, Simulator const& simulator, int particles)
    : model_(model), simulator_(simulator), particles_(particles) {}

std::size_t ParticleFilter::numbers() const {
  auto const samples = static_cast<std::size_t>(simulator_.schedule().last_summed());
  auto const later = static_cast<std::size_t>(steps_between(model_, simulator_, particles_) - 1);
  return numbers_of_start(model_, particles_) +
         samples * (numbers_of_sample(model_, particles_) + later * numbers_of_step(model_, particles_));
}

std::vector<double> ParticleFilter::draw(ParticleNormals& normals) const {
  std::vector<double> drawn;
  drawn.reserve(numbers());
  auto const add = [&](std::size_t count) {
    std::span<double const> const some = normals.take(count);
    drawn.insert(drawn.end(), some.begin(), some.end());
  };
  add(numbers_of_start(model_, particles_));
  int const steps = steps_between(model_, simulator_, particles_);
  for (int sample = 0; sample < simulator_.schedule().last_summed(); ++sample) {
    add(numbers_of_sample(model_, particles_));
    for (int step = 1; step < steps; ++step) add(numbers_of_step(model_, particles_));
  }
  return drawn;
}

FilterOutcome ParticleFilter::run(ConstLanes parameters, ParticleNormals& normals, SeeParticles const& see) const {
  ParticleRun run(model_, simulator_, particles_);
  ParticleView view;
  if (see)
    view.weighed = [&](WeighedParticles const& particles) {
      if (run.is_weighed(particles.sample)) see(particles);
    };
  return run.run(parameters, normals, view, simulator_.schedule().last_summed());
}

FilterOutcome ParticleFilter::run(ConstLanes parameters, ParticleNormals& normals, ParticleView const& view) const {
  return ParticleRun(model_, simulator_, particles_).run(parameters, normals, view, simulator_.schedule().samples());
}

}  // namespace sysid
