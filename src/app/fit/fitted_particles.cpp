// How many particles, and what they show.
#include "app/fit/fitted_particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/session/fit_target.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/scores.hpp"
#include "inference/backend/backend.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

/// Of Purpose::particle: populations have indices below.
constexpr std::uint64_t need_index = 2ULL << 40, seen_index = 3ULL << 40, innovation_index = 4ULL << 40, around_index = 5ULL << 40,
                        draws_index = 6ULL << 40;

/// More are not taken without being asked for: the chain would hardly come to its end.
constexpr int most_particles = 8192;
constexpr int need_repeats = 32;
/// sd of the log of an estimate: beyond the first a chain stays long where an estimate is large, beyond the second longer than it
/// runs.
constexpr double large_sd = 1.7, useless_sd = 3;
/// Particles that count at a sample.
constexpr double few_effective = 20, hardly_any = 5;

/// Places of the posterior where the spread of estimates is looked at, and repeats at each.
constexpr int looked_at = 12;

/// sd of the log of an estimate at one place [P x 1]; infinite where particles are lost.
double spread_at(ParticleTarget const& target, ConstLanes theta, StreamKey key) {
  LaneArray lanes(theta.rows(), need_repeats);
  for (int p = 0; p < theta.rows(); ++p) std::fill(lanes.row(p).begin(), lanes.row(p).end(), theta(p, 0));
  std::vector<double> out(static_cast<std::size_t>(need_repeats));
  Ledger unused;
  target.estimate(lanes, key, out, unused);
  bool const alive = std::all_of(out.begin(), out.end(), [](double value) { return std::isfinite(value); });
  return alive ? std::sqrt(sample_variance(out)) : infinity;
}

/// The same at several places [P x W].
std::vector<double> spreads_at(ParticleTarget const& target, ConstLanes theta, StreamKey key) {
  std::vector<double> sds;
  for (int w = 0; w < theta.width(); ++w)
    sds.push_back(spread_at(target, theta.columns(w, 1), key.with_step(key.step + static_cast<std::uint64_t>(w))));
  return sds;
}

double upper_quartile(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() * 3 / 4];
}

/// Draws of the normal distribution at a mode.
LaneArray around(Mode const& mode, StreamKey key) {
  Eigen::MatrixXd const factor = cholesky_or_diagonal(covariance_of(mode));
  LaneArray theta(static_cast<int>(mode.theta.size()), looked_at);
  for (int w = 0; w < looked_at; ++w) {
    Stream stream(key.with_step(static_cast<std::uint64_t>(w)));
    Eigen::VectorXd normals(theta.rows());
    for (double& each : normals) each = stream.normal();
    Eigen::VectorXd const place = theta_of(mode) + factor * normals;
    for (int p = 0; p < theta.rows(); ++p)
      theta(p, w) = std::isfinite(place[p]) ? place[p] : mode.theta[static_cast<std::size_t>(p)];
  }
  return theta;
}

}  // namespace

FittedParticles::~FittedParticles() = default;

FittedParticles::FittedParticles(Session& session, FitTask const& what, Model const& model, std::vector<ExperimentData> const& data,
                                 std::uint64_t seed)
    : session_(session), what_(what), model_(model), data_(data), seed_(seed) {}

Target const& FittedParticles::set_target(std::shared_ptr<ParameterSpace const> space, SolverSettings const& solver,
                                          ExecutionOptions const& execution, std::vector<Mode> const& modes) {
  bool const known = solver_ == solver && need_.particles > 0;
  if (!known) {
    particle_model_ = particle_model(model_, solver.method);
    need_ = {};
  }
  solver_ = solver;
  execution_ = execution;
  trajectories_.clear();
  seen_.clear();
  innovations_.clear();
  ParticleOptions options;
  options.numbers = ParticleNumbers::of_parameters;
  options.key.seed = seed_;
  options.particles = what_.particles > 0 ? what_.particles : known ? need_.particles : default_particles;
  TargetOptions const how = fit_target_options(session_, what_, solver, execution);
  target_ = std::make_unique<ParticleTarget>(particle_model_, std::move(space), experiments_of(data_), how, options);
  if (known) return *target_;
  if (!modes.empty()) {
    LaneArray const theta = to_lanes({theta_of(modes.front())});
    StreamKey const key{seed_, Purpose::particle, need_index, 0};
    if (what_.particles > 0)
      need_ = {what_.particles, spread_at(*target_, theta, key)};
    else
      need_ = target_->needed(theta, key, 1, need_repeats, most_particles);
    target_ = target_->with_particles(need_.particles);
    LaneArray const places = around(modes.front(), key.with_index(around_index));
    StreamKey const looking = key.with_index(around_index + 1);
    around_ = upper_quartile(spreads_at(*target_, places, looking));
    if (double const factor = around_ * around_; what_.particles == 0 && factor > 1.5 && need_.particles < most_particles) {
      need_.particles = std::min(most_particles, static_cast<int>(std::ceil(std::min(factor, 8.0) * need_.particles / 32)) * 32);
      target_ = target_->with_particles(need_.particles);
      need_.sd = spread_at(*target_, theta, key.with_step(looked_at));
      around_ = upper_quartile(spreads_at(*target_, places, looking));
    }
  } else {
    need_ = {options.particles, not_a_number};
  }
  return *target_;
}

std::unique_ptr<Target> FittedParticles::with_solver(std::shared_ptr<ParameterSpace const> space, SolverSettings const& solver,
                                                     ExecutionOptions const& execution) const {
  ParticleOptions options;
  options.numbers = ParticleNumbers::of_parameters;
  options.key.seed = seed_;
  options.particles = 4 * need_.particles;
  return std::make_unique<ParticleTarget>(particle_model(model_, solver.method), std::move(space), experiments_of(data_),
                                          fit_target_options(session_, what_, solver, execution), options);
}

std::string FittedParticles::chosen() const {
  std::string const number = fmt::format(
      "{} particles: repeated estimates of the log likelihood have an sd of {:.2g} at the mode, and of at most {:.2g} at three "
      "quarters of the points around it",
      need_.particles, need_.sd, around_);
  return what_.particles_because.empty() ? number
                                         : fmt::format("filter = particle, because {}; {}", what_.particles_because, number);
}

StreamKey FittedParticles::key_of(int e) const {
  return {seed_, Purpose::particle, seen_index + (static_cast<std::uint64_t>(e) << 32), 0};
}

ParticleTrajectory const& FittedParticles::trajectory(int e) const {
  trajectories_.resize(data_.size());
  auto& place = trajectories_[static_cast<std::size_t>(e)];
  if (!place)
    place = std::make_unique<ParticleTrajectory>(particle_model_, model_, experiment(e), *solver_, need_.particles,
                                                 session_.interruptible());
  return *place;
}

ParticleTrajectory::Result const& FittedParticles::seen(int e, ConstLanes parameters) const {
  auto& place = seen_[e];
  if (!place) place = trajectory(e).run(parameters, key_of(e), true);
  return *place;
}

Trajectory::Result FittedParticles::along(int e, ConstLanes parameters) const { return seen(e, parameters).predicted; }

Prediction FittedParticles::states(int e, ConstLanes parameters) const {
  ParticleTrajectory::Result const& result = seen(e, parameters);
  Prediction states = record_along(experiment(e), model_);
  states.inputs.clear();
  states.smoothed = true;
  for (std::size_t q = 0; q < result.smoothed.size(); ++q) {
    SmoothedName const& of = trajectory(e).smoothed_quantities()[q];
    Band of_draws = band(result.smoothed[q]);
    of_draws.draws = parameters.width();
    of_draws.excluded /= std::max(1, result.picks);
    PredictedQuantity quantity{of.name, of.unit, std::move(of_draws), {}, {}};
    quantity.average = of.average;
    states.quantities.push_back(std::move(quantity));
  }
  return states;
}

std::vector<ParticleInnovations> const& FittedParticles::innovations(std::vector<LaneArray> const& parameters) const {
  if (innovations_.empty())
    for (int e = 0; e < static_cast<int>(data_.size()); ++e)
      innovations_.push_back(
          trajectory(e).innovations(parameters[static_cast<std::size_t>(e)],
                                    {seed_, Purpose::particle, innovation_index + static_cast<std::uint64_t>(e), 0}));
  return innovations_;
}

FitCheck FittedParticles::check_residuals(std::vector<LaneArray> const& parameters) const {
  std::vector<StandardisedRows> rows;
  for (ParticleInnovations const& each : innovations(parameters)) rows.push_back({each.standardised, each.predicted});
  return sysid::check_residuals(model_, experiments_of(data_), rows);
}

std::optional<Finding> FittedParticles::check_estimates(ConstLanes draws) const {
  LaneArray theta(draws.rows(), draws.width());
  target_->unconstrain(draws, theta);
  std::vector<double> const sds = spreads_at(*target_, theta, {seed_, Purpose::particle, draws_index, 0});
  auto const many = std::count_if(sds.begin(), sds.end(), [](double sd) { return !(sd <= large_sd); });
  auto const worst = static_cast<int>(std::max_element(sds.begin(), sds.end()) - sds.begin());
  double const largest = sds[static_cast<std::size_t>(worst)];
  if (many == 0 || (many == 1 && largest <= useless_sd)) return std::nullopt;
  // What is farthest from the others there.
  int farthest = 0;
  double distance = -1;
  for (int p = 0; p < theta.rows(); ++p) {
    double const sd = std::sqrt(sample_variance(theta.row(p))), away = std::fabs(theta(p, worst) - mean(theta.row(p)));
    if (sd > 0 && away / sd > distance) farthest = p, distance = away / sd;
  }
  ParameterInfo const& parameter = target_->parameters()[static_cast<std::size_t>(farthest)];
  bool const useless = 3 * many > draws.width() || need_.sd > useless_sd;
  bool const all_normal = std::ranges::all_of(
      model_.channels, [](Channel const& channel) { return channel.noise.row->gaussian; });  // for others there is no other filter
  return Finding{
      FindingCode::likelihood_too_noisy,
      useless ? Severity::error : Severity::warning,
      {parameter.name},
      fmt::format("with {} particles, estimates of the log likelihood have an sd above {} at {} of {} draws, up to "
                  "{:.2g} where {} = {:.3g}{}: chains get stuck there",
                  need_.particles, large_sd, many, draws.width(), largest, parameter.name, draws(farthest, worst),
                  unit_after_number(parameter.unit)),
      fmt::format("use more particles, `particles = {}` or more, or a prior that excludes such values{}", 4 * need_.particles,
                  all_normal ? "; if the noise of a sensor is small compared with the motion that a disturbance causes within a "
                               "sampling interval, "
                               "`filter = unscented` is the better filter"
                             : "")};
}

std::optional<Finding> FittedParticles::check_lines() const {
  std::vector<std::string> white;
  for (std::size_t d = 0; d < model_.disturbances.size(); ++d)
    if (particle_model_->noises[d].white) white.push_back(model_.disturbances[d].name);
  if (white.empty() || (solver_->fixed_step() && !solver_->row().exact)) return std::nullopt;
  return Finding{FindingCode::noise_in_lines, Severity::note, white,
                 fmt::format("with `solver = {}` the white noise {} is replaced by a straight line between two samples: the "
                             "variance of motion that decays within a sampling interval is underestimated",
                             solver_->method, listed(white)),
                 "where the motion may be that fast, use `solver = rk4(substeps = 4)`, which draws new noise in each step, or "
                 "`filter = unscented`"};
}

Findings FittedParticles::check(std::vector<LaneArray> const& parameters, ConstLanes draws) const {
  Findings findings;
  if (auto noisy = check_estimates(draws)) findings.push_back(std::move(*noisy));
  if (auto lines = check_lines()) findings.push_back(std::move(*lines));
  for (std::size_t e = 0; e < data_.size(); ++e) {
    FilterOutcome const& outcome = innovations(parameters)[e].outcome;
    double const effective = outcome.least_effective * need_.particles;
    if (outcome.sample >= 0 || outcome.least_effective_at < 0 || effective >= few_effective) continue;
    Experiment const& along = experiment(static_cast<int>(e));
    findings.push_back(
        {FindingCode::particles_degenerate,
         effective < hardly_any ? Severity::warning : Severity::note,
         {along.name},
         fmt::format("at row {}{} only {:.1f} of {} particles are effective after the sample: few different states remain",
                     along.first_row + outcome.least_effective_at, data_.size() > 1 ? " of " + along.name : "", effective,
                     need_.particles),
         "check this sample for an outlier, and use noise with heavy tails if it is a measurement; else use more "
         "particles"});
  }
  return findings;
}

Facts FittedParticles::settings() const {
  Facts facts = {{"filter", std::string(filter_name(FilterRule::particle))}};
  if (!what_.particles_because.empty()) facts.emplace_back("filter_because", what_.particles_because);
  facts.emplace_back("particles", static_cast<std::int64_t>(need_.particles));
  if (std::isfinite(need_.sd)) facts.emplace_back("log_likelihood_sd", need_.sd);
  if (std::isfinite(around_)) facts.emplace_back("log_likelihood_sd_around", around_);
  return facts;
}

}  // namespace sysid
