// Runs of the filter for (parameter vector, experiment), shared by the threads.
#include "likelihood/particle/particle_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/numeric/column_word.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/diagnostic.hpp"
#include "likelihood/failures.hpp"
#include "simulate/stepper.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
ParticleTarget::~ParticleTarget() = default;

ParticleTarget::ParticleTarget(std::shared_ptr<ParticleModel const> model, std::shared_ptr<ParameterSpace const> space,
                               std::vector<Experiment> experiments, TargetOptions options, ParticleOptions particles)
    : model_(std::move(model)),
      space_(std::move(space)),
      experiments_(std::make_shared<std::vector<Experiment> const>(std::move(experiments))),
      options_(std::move(options)),
      particles_(particles),
      pool_(make_pool(options_.execution)) {
  if (options_.start_rows > 0) throw InternalError("particles with a start that is estimated from rows");
  auto simulators = std::make_shared<Simulators>();
  for (Experiment const& experiment : *experiments_)
    simulators->emplace_back(model_->densities, Schedule(*model_->densities, experiment, options_.solver), options_.execution,
                             pool_);
  simulators_ = std::move(simulators);
}

ParticleTarget::ParticleTarget(ParticleTarget const& other, ParticleOptions particles)
    : model_(other.model_),
      space_(other.space_),
      experiments_(other.experiments_),
      options_(other.options_),
      particles_(particles),
      pool_(other.pool_),
      simulators_(other.simulators_) {}

std::unique_ptr<ParticleTarget> ParticleTarget::with_particles(int particles) const {
  ParticleOptions other = particles_;
  other.particles = particles;
  return std::unique_ptr<ParticleTarget>(new ParticleTarget(*this, other));
}

std::unique_ptr<ParticleTarget> ParticleTarget::with_numbers(ParticleNumbers numbers) const {
  ParticleOptions other = particles_;
  other.numbers = numbers;
  return std::unique_ptr<ParticleTarget>(new ParticleTarget(*this, other));
}

double ParticleTarget::work() const {
  double total = 0;
  for (Simulator const& each : *simulators_)
    total += work_per_sample(each.program(), each.schedule()) * each.schedule().last_summed();
  return total;
}

ParticleFilter ParticleTarget::filter(int experiment, int particles) const {
  return {*model_, (*simulators_)[static_cast<std::size_t>(experiment)], particles};
}

/// As many as the model had before its starts became parameters.
LaneArray ParticleTarget::parameters(ConstLanes values, int experiment) const {
  LaneArray result(model_->first_start, values.width());
  space_->select(values, experiment, result);
  return result;
}

/// Experiments have streams of their own; steps of a key stay apart.
StreamKey ParticleTarget::key_of(StreamKey key, int experiment) const {
  return key.with_step(key.step * experiments_->size() + static_cast<std::uint64_t>(experiment));
}

void ParticleTarget::run(ConstLanes theta, int particles, MakeNormals const& normals, std::span<double> out, Ledger& ledger) const {
  int const experiments = static_cast<int>(simulators_->size());
  LaneArray const values = space_->values(theta);
  std::vector<FilterOutcome> outcomes(out.size() * simulators_->size());
  std::vector<LaneArray> columns;
  std::vector<Work> work;
  for (int e = 0; e < experiments; ++e) columns.push_back(parameters(values, e));
  for (int e = 0; e < experiments; ++e) {
    Simulator const& simulator = (*simulators_)[static_cast<std::size_t>(e)];
    Work of_experiment;
    of_experiment.given_up = simulator.given_up();
    of_experiment.instructions =
        work_per_sample(simulator.program(), simulator.schedule()) * simulator.schedule().last_summed() * particles * theta.width();
    of_experiment.width = theta.width();
    of_experiment.written = {
        {reinterpret_cast<std::byte*>(outcomes.data() + e), simulators_->size() * sizeof(FilterOutcome), sizeof(FilterOutcome)}};
    of_experiment.blocks = [&, e, each = of_experiment.instructions / theta.width()](int first, int count) {
      Blocks blocks{{}, each * count};
      for (int w = first; w < first + count; ++w)
        blocks.all.push_back([&, e, w] {
          std::unique_ptr<ParticleNormals> const numbers = normals(w, e);
          outcomes[static_cast<std::size_t>(w * experiments + e)] =
              filter(e, particles).run(columns[static_cast<std::size_t>(e)].view().columns(w, 1), *numbers);
        });
      return blocks;
    };
    work.push_back(std::move(of_experiment));
  }
  do_work(work, pool_.get());
  record(theta, outcomes, ledger);
  for (std::size_t w = 0; w < out.size(); ++w) {
    double total = 0;
    for (int e = 0; e < experiments; ++e) total += outcomes[w * simulators_->size() + static_cast<std::size_t>(e)].log_likelihood;
    out[w] = std::isnan(total) ? -infinity : total;
  }
}

void ParticleTarget::record(ConstLanes theta, std::span<FilterOutcome const> outcomes, Ledger& ledger) const {
  std::size_t const experiments = simulators_->size();
  ledger.add_solves(outcomes.size());
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    if (outcomes[k].log_likelihood > -infinity) continue;
    LaneArray declared(theta.rows(), 1);
    constrain(theta.columns(static_cast<int>(k / experiments), 1), declared);
    std::size_t const e = k % experiments;
    std::string const on = experiments > 1 ? fmt::format(" on `{}`", (*experiments_)[e].name) : std::string();
    ledger.add_failure(FailureClass::non_finite, "the densities of all particles" + on,
                       (*simulators_)[e].schedule().time(std::max(outcomes[k].sample, 0)),
                       std::vector<double>(declared.view().data(), declared.view().data() + declared.rows()));
  }
}

std::unique_ptr<ParticleNormals> ParticleTarget::fixed_normals(int experiment) const {
  std::size_t bytes = 0;
  for (int e = 0; e < static_cast<int>(simulators_->size()); ++e)
    bytes += sizeof(double) * filter(e, particles_.particles).numbers();
  if (bytes > particles_.stored_bytes) return std::make_unique<StreamNormals>(key_of(particles_.key, experiment));
  ParticleAuxiliary const& stored = stored_.get([&] { return draw_auxiliary(particles_.key); });
  return std::make_unique<StoredNormals>(stored[static_cast<std::size_t>(experiment)]);
}

void ParticleTarget::log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const {
  auto const chosen = [&](int lane, int experiment) -> std::unique_ptr<ParticleNormals> {
    if (particles_.numbers == ParticleNumbers::fixed) return fixed_normals(experiment);
    return std::make_unique<StreamNormals>(key_of(particles_.key.with_index(word_of(theta, lane)), experiment));
  };
  run(theta, particles_.particles, chosen, out, ledger);
}

void ParticleTarget::estimate(ConstLanes theta, StreamKey key, std::span<double> out, Ledger& ledger) const {
  auto const fresh = [&](int lane, int experiment) {
    return std::make_unique<StreamNormals>(key_of(key.with_index(key.index + static_cast<std::uint64_t>(lane)), experiment));
  };
  run(theta, particles_.particles, fresh, out, ledger);
}

void ParticleTarget::estimate(ConstLanes theta, std::span<ParticleAuxiliary const> auxiliary, std::span<double> out,
                              Ledger& ledger) const {
  auto const given = [&](int lane, int experiment) {
    return std::make_unique<StoredNormals>(auxiliary[static_cast<std::size_t>(lane)][static_cast<std::size_t>(experiment)]);
  };
  run(theta, particles_.particles, given, out, ledger);
}

ParticleAuxiliary ParticleTarget::draw_auxiliary(StreamKey key) const {
  ParticleAuxiliary drawn;
  for (int e = 0; e < static_cast<int>(simulators_->size()); ++e) {
    StreamNormals stream(key_of(key, e));
    drawn.push_back(filter(e, particles_.particles).draw(stream));
  }
  return drawn;
}

void ParticleTarget::move_auxiliary(ParticleAuxiliary& auxiliary, double correlation, StreamKey key) const {
  for (std::size_t e = 0; e < auxiliary.size(); ++e) move_normals(auxiliary[e], correlation, key_of(key, static_cast<int>(e)));
}

ParticleNeed ParticleTarget::needed(ConstLanes theta, StreamKey key, double sd, int repeats, int most) const {
  LaneArray lanes(theta.rows(), repeats);
  for (int p = 0; p < theta.rows(); ++p) std::fill(lanes.row(p).begin(), lanes.row(p).end(), theta(p, 0));
  std::vector<double> out(static_cast<std::size_t>(repeats));
  constexpr int least = 64;  // fewer lose their way together, and their spread says nothing
  ParticleNeed need{least, infinity};
  for (std::uint64_t round = 0;; ++round) {
    Ledger unused;
    with_particles(need.particles)->estimate(lanes, key.with_step(key.step + round), out, unused);
    bool const alive = std::all_of(out.begin(), out.end(), [](double value) { return std::isfinite(value); });
    need.sd = alive ? std::sqrt(sample_variance(out)) : infinity;
    if (need.sd <= 1.2 * sd || need.particles >= most) return need;
    // The variance falls with the inverse of the number once it is small; where it is large it says little.
    double const factor = std::clamp(need.sd * need.sd / (sd * sd), 1.5, 4.0);
    need.particles = std::min(most, static_cast<int>(std::ceil(factor * need.particles / 32)) * 32);
  }
}

FilterOutcome ParticleTarget::look(ConstLanes theta, int experiment, SeeParticles const& see) const {
  LaneArray const column = parameters(space_->values(theta), experiment);
  return filter(experiment, particles_.particles).run(column, *fixed_normals(experiment), see);
}

void ParticleTarget::residuals(ConstLanes theta, Lanes out, Ledger& ledger) const {
  std::vector<double> values(static_cast<std::size_t>(theta.width()));
  log_likelihood(theta, values, ledger);
  int rows = 0;
  for (Simulator const& simulator : *simulators_)
    for (int c = 0; c < simulator.program().registers.records; ++c) rows += simulator.schedule().count(c);
  for (std::size_t w = 0; w < values.size(); ++w)
    out(0, static_cast<int>(w)) = std::isfinite(values[w]) ? scale_residual(rows, values[w]) : infinity;
}

double ParticleTarget::roughness() const { return 1e-4; }

}  // namespace sysid
