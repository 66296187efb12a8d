// What is shown of a record, and the runs of the filter that tell it.
#include "likelihood/particle/particle_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/not_finite.hpp"
#include "likelihood/particle/particle_recorder.hpp"
#include "simulate/stepper.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

using RecordKind = CompiledModel::Record::Kind;

constexpr int most_picks = 20;
constexpr double numbers_of_paths = 2e7;  // 160 MB

double from_si_width(Quantity const& quantity, double width) { return std::fabs(quantity.from_si(width) - quantity.from_si(0)); }

bool reads_any_state(Graph const& graph, NodeId id) {
  return graph.depends(id, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::state; });
}

}  // namespace

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
    smoothed_names_.push_back({quantity.name, quantity.unit_of_numbers(), each.kind == Smoothed::Kind::average});
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
      work_per_sample(densities_.program(), densities_.schedule()) * samples() * particles_ * parameters.width() * ahead;
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
