// Places, rows and numbers of particles that can be afforded, and the estimates.
#include "app/fit/particle_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/random.hpp"
#include "diagnostics/tolerance/filter_comparison.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/particle/particle_target.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/laplace.hpp"

namespace sysid {
namespace {

constexpr int compared_places = 4, compared_estimates = 16;
constexpr int fewest_compared = 64, most_compared = 8192;  // particles
constexpr int most_again = 2;
constexpr int fewest_rows = 40;    // of an experiment
constexpr double wanted_sd = 0.8;  // of the log of an estimate
/// Instructions of all estimates, of one lane: from half a second to some seconds, as many particles along the whole record as ten
/// for each draw. The filter that the draws were made with costs far more.
constexpr double least_affordable = 1e9, most_affordable = 2e10, particles_per_draw = 10;
/// Of Purpose::particle: fits by particles have indices below.
constexpr std::uint64_t wanted_index = 7ULL << 40, compared_index = 8ULL << 40, places_index = 9ULL << 40;

/// Draws spread over the chains; around an optimum, itself and draws of its normal distribution. [P x some]
LaneArray places_of(FinishedFit const& fit) {
  int const dimension = fit.target.dimension();
  bool const optimum = fit.result.draws.total() < 2;
  LaneArray const declared = spread(fit.result.draws, compared_places);
  LaneArray found(dimension, declared.width());
  fit.target.unconstrain(declared, found);
  if (!optimum || fit.result.modes.empty()) return found;
  Eigen::MatrixXd const factor = cholesky_or_diagonal(covariance_of(fit.result.modes.front()));
  LaneArray theta(dimension, compared_places);
  for (int w = 0; w < theta.width(); ++w) {
    Stream stream({fit.seed, Purpose::particle, places_index, static_cast<std::uint64_t>(w)});
    Eigen::VectorXd normals = Eigen::VectorXd::Zero(dimension);
    for (int p = 0; p < dimension && w > 0; ++p) normals[p] = stream.normal();
    Eigen::VectorXd const away = factor * normals;
    for (int p = 0; p < dimension; ++p) theta(p, w) = found(p, 0) + (std::isfinite(away[p]) ? away[p] : 0);
  }
  return theta;
}

/// White noise is drawn anew in each step of a method with fixed steps, and only there.
SolverSettings solver_of_particles(FinishedFit const& fit) {
  SolverSettings const& own = fit.preparation.solver;
  bool const suits = !fit.likelihood.model().integrated() || (own.fixed_step() && !own.row().exact);
  return suits ? own : SolverSettings{.substeps = 4};
}

int rows_of(std::vector<Experiment> const& experiments) {
  std::size_t rows = 0;
  for (Experiment const& each : experiments) rows = std::max(rows, each.time.size());
  return static_cast<int>(rows);
}

class ByParticles {
 public:
  explicit ByParticles(FinishedFit& fit)
      : fit_(fit), theta_(places_of(fit)), solver_(solver_of_particles(fit)), all_rows_(rows_of(experiments_of(fit.data))) {}

  /// Of the filter of the fit; nothing where it stays open, and why.
  std::optional<FilterComparison> own(std::string& open) {
    if (!find_size()) {
      open = "particles would take too long";
      return std::nullopt;
    }
    FilterRule const filter = fit_.what.filter;
    FilterComparison found = with(solver_, filter);
    // Other places need more particles than the first: the same work on half of the rows.
    for (int again = 0; again < most_again && found.holds() && !found.known() && rows_ >= 2 * fewest_rows; ++again) {
      rows_ /= 2;
      particles_ = std::min(2 * particles_, most_compared);
      found = with(solver_, filter);
    }
    bool const may_be_finer = fit_.likelihood.model().integrated() && !solver_.as_model && solver_.finer().within_limits();
    if (!found.holds() && may_be_finer) {
      FilterComparison const coarse = std::move(found);
      found = with(solver_.finer(), filter);
      if (found.holds() || !same_offsets(coarse, found)) {
        open = "what particles estimate depends on the steps of the solver";
        return std::nullopt;
      }
    }
    if (found.holds() && !found.known()) {
      open = fmt::format("estimates by {} particles scatter too much", particles_);
      return std::nullopt;
    }
    return found;
  }

  /// After `own`: of another filter, by the same estimates.
  FilterComparison other(FilterRule filter) const { return compared(filter); }

  ComparedPlaces places() const {
    ComparedPlaces words{fit_.result.draws.total() > 1 ? "draw" : "place near the optimum", {}};
    if (rows_ < all_rows_)
      words.rows = fmt::format(", on the first {} rows{}", rows_, fit_.data.size() > 1 ? " of each experiment" : " of the record");
    return words;
  }

 private:
  /// Those that are compared: no later row is scored.
  std::vector<Experiment> experiments() const {
    std::vector<Experiment> all = experiments_of(fit_.data);
    for (Experiment& each : all)
      for (std::size_t i = static_cast<std::size_t>(rows_); i < each.scored.size(); ++i) each.scored[i] = 0;
    return all;
  }

  std::shared_ptr<ParticleTarget const> target(SolverSettings const& solver) const {
    return fit_.likelihood.by_particles(experiments(), solver, fit_.session.interruptible());
  }

  /// So many rows that particles which can be afforded estimate their likelihood well: the variance of the log of an estimate is
  /// proportional to rows, and to the inverse of particles. Where no part of the record is that easy, all that can be afforded on
  /// the whole of it: large differences show nevertheless. False: not even that.
  bool find_size() {
    StreamKey const key{fit_.seed, Purpose::particle, wanted_index, 0};
    int of_all = 0;
    double limit = 0;
    for (rows_ = all_rows_; rows_ == all_rows_ || rows_ >= fewest_rows;) {
      auto const tried = target(solver_);
      double const wished = particles_per_draw * static_cast<double>(fit_.result.draws.total()) * tried->work();
      if (rows_ == all_rows_) limit = std::clamp(wished, least_affordable, most_affordable);
      double const affordable = limit / (tried->work() * compared_estimates * (theta_.width() + 2));
      ParticleNeed need{0, infinity};
      if (affordable >= fewest_compared)
        need = tried->needed(theta_.view().columns(0, 1), key, wanted_sd, compared_estimates,
                             static_cast<int>(std::min(affordable, double{most_compared})));
      particles_ = need.particles;
      if (need.sd <= 1.2 * wanted_sd) return true;
      if (rows_ == all_rows_) of_all = need.particles;
      double const part = need.particles == 0 ? affordable / (2 * fewest_compared) : std::max(0.25, wanted_sd / need.sd);
      rows_ = static_cast<int>(rows_ * std::min(part, 0.75));
    }
    rows_ = all_rows_;
    particles_ = of_all;
    return of_all > 0;
  }

  FilterComparison with(SolverSettings const& solver, FilterRule filter) {
    int const places = theta_.width();
    LaneArray lanes(theta_.rows(), places * compared_estimates);
    for (int w = 0; w < lanes.width(); ++w)
      for (int p = 0; p < lanes.rows(); ++p) lanes(p, w) = theta_(p, w / compared_estimates);
    estimates_.assign(static_cast<std::size_t>(lanes.width()), 0);
    Ledger unused;
    target(solver)
        ->with_particles(particles_)
        ->estimate(lanes, {fit_.seed, Purpose::particle, compared_index, 0}, estimates_, unused);
    return compared(filter);
  }

  FilterComparison compared(FilterRule filter) const {
    std::vector<double> values(static_cast<std::size_t>(theta_.width()));
    fit_.likelihood.with_filter(filter, experiments(), fit_.preparation.solver, fit_.session.interruptible())
        ->log_likelihood(theta_, values, fit_.extra);
    std::vector<FilterOffset> offsets;
    for (std::size_t w = 0; w < values.size(); ++w)
      offsets.push_back(filter_offset(std::span(estimates_).subspan(w * compared_estimates, compared_estimates), values[w]));
    return compare_filter(std::move(offsets));
  }

  FinishedFit& fit_;
  LaneArray theta_;
  SolverSettings solver_;
  int all_rows_, rows_ = 0, particles_ = 0;
  std::vector<double> estimates_;  // place by place
};

}  // namespace

std::string without_particle_comparison(FinishedFit const& fit) {
  if (fit.what.start.kind == StartRule::Kind::estimated) return "the start is estimated from rows";
  return {};
}

Findings compare_with_particles(FinishedFit& fit) {
  Findings& before = fit.report.findings;
  auto const known = std::ranges::find(before, FindingCode::linearisation_matters, &Finding::code);
  bool const unscented = fit.what.filter == FilterRule::unscented;
  ByParticles particles(fit);
  std::optional<FilterComparison> const own = particles.own(fit.report.checks.back().skipped);
  if (!own) return {};
  std::optional<FilterComparison> other;
  if (!unscented && (!own->holds() || known != before.end())) other = particles.other(FilterRule::unscented);
  if (own->holds()) {
    if (known != before.end() && !other->holds()) before.erase(known);
    return {};
  }
  Finding found =
      filter_finding(*own, unscented ? FilterRule::unscented : FilterRule::extended, other ? &*other : nullptr, particles.places());
  if (known == before.end()) return {std::move(found)};
  known->message += "; " + found.message;
  known->help = std::move(found.help);
  known->severity = std::min(known->severity, found.severity);  // the worse one
  return {};
}

}  // namespace sysid
