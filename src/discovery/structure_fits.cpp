// Extends the leading structure from short segments to long ones, and fits the others over the same segments.
#include "discovery/structure_fits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "diagnostics/tolerance/tolerance.hpp"
#include "likelihood/segments/segment_differences.hpp"
#include "likelihood/segments/segment_starts.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

/// Segments are not joined further when the residual sd of a channel grows by more than this.
constexpr double tolerable_growth = 1.5;
/// Segments on the way up need not be fitted closer than this, in log likelihood.
constexpr double enough_on_the_way = 1e-2;
constexpr int most_refinements = 4;
/// Where a start moves the last quarter of a segment by so many times what it moves the first, relative to the channel's sd in
/// units of the noise, optima beside the right one are as high as it, and sds at one of them mean nothing.
constexpr double parted = 1000;
/// How often segments are halved again, and by how much less probable than the best a structure counts there, in log.
constexpr int most_returns = 3;
constexpr double within_reach = 7;
/// What solvers that take one simulation after the other may simulate, all structures together: 15 to 60 µs a row.
constexpr double most_rows_one_by_one = 400'000;
/// Steps of such a solver between two samples: a trial that needs more is lost, near values that do not solve the equation.
constexpr int most_steps_one_by_one = 200;
/// No refit takes fewer rounds.
constexpr double least_rounds = 15;

bool follows(ShootingFit const& before, ShootingFit const& after) {
  if (!after.finite || !after.converged) return false;
  for (std::size_t c = 0; c < after.noise_sd.size(); ++c)
    if (!(after.noise_sd[c] <= tolerable_growth * before.noise_sd[c])) return false;
  return true;
}

}  // namespace

StructureFits::StructureFits(std::vector<ValidatedModel> const& models, StartGuess& guess, StructureFitSettings settings)
    : models_(models), guess_(guess), settings_(std::move(settings)), fits_(models.size()), shorter_(models.size()) {
  for (Experiment const& each : settings_.records)
    most_halvings_ = std::max(most_halvings_, halvings(static_cast<int>(each.time.size()), settings_.least));
  halved_ = most_halvings_;
  substeps_ = settings_.substeps;
  spent_.assign(models_.size(), 0);
  int sharing = 0;
  for (std::size_t m = 0; m < models_.size(); ++m) sharing += one_by_one(m) ? 1 : 0;
  allowance_ = most_rows_one_by_one / std::max(1, sharing);
}

void StructureFits::run() {
  climb();
  if (!settings_.interrupted()) refine();  // else some have not begun, and not all have segments of one length
}

std::string const& StructureFits::failure(std::size_t m) const {
  static std::string const costs = "skipped: the refit of this implicit equation needs too many simulations";
  if (given_up(m)) return costs;
  return models_[m].failure.empty() ? fits_[m].failure : models_[m].failure;
}

double StructureFits::reached(std::size_t m) const {
  if (!fits_[m].fit.finite) return -std::numeric_limits<double>::infinity();
  return fits_[m].fit.log_evidence + settings_.log_prior[m] + log_prior_of_inner(m);
}

double StructureFits::log_posterior(std::size_t m) const {
  return validated(m) ? reached(m) : -std::numeric_limits<double>::infinity();
}

double StructureFits::log_posterior_reached(std::size_t m) const {
  ShootingFit const& fit = fits_[m].fit;
  bool const on_its_way = models_[m].failure.empty() && !given_up(m) && fit.finite && fit.determined && !fit.converged &&
                          !fits_[m].failure.empty() && fits_[m].halved == halved_;
  return on_its_way ? reached(m) : -std::numeric_limits<double>::infinity();
}

double StructureFits::log_prior_of_inner(std::size_t m) const {
  double sum = 0;
  auto row = static_cast<Eigen::Index>(models_[m].coefficients.size());
  for (ValidatedModel::Inner const& each : models_[m].inner)
    sum += log_density(settings_.inner[each.index], fits_[m].fit.point.coefficients(row++));
  return sum;
}

SolverSettings StructureFits::solver(std::size_t m) const {
  SolverSettings out = models_[m].solver;
  if (out.fixed_step()) out.substeps = std::max(out.substeps, substeps_);
  if (one_by_one(m)) out.steps = std::min(out.steps, most_steps_one_by_one);
  return out;
}

NoiseShape StructureFits::noise(std::size_t m) const {
  NoiseShape own;
  for (std::size_t const c : models_[m].channels)
    if (!settings_.noise.floor.empty()) own.floor.push_back(settings_.noise.floor[c]);
  for (auto const& experiment : settings_.noise.relative) {
    auto& channels = own.relative.emplace_back();
    for (std::size_t const c : models_[m].channels) channels.push_back(experiment[c]);
  }
  if (!settings_.noise.carried) return own;
  auto carried = std::make_shared<std::vector<CarriedErrors>>(*settings_.noise.carried);
  for (std::size_t e = 0; e < carried->size(); ++e) {
    CarriedErrors const& all = (*settings_.noise.carried)[e];
    CarriedErrors& each = (*carried)[e];
    each.state_of_channel.clear(), each.own_sd.clear();
    for (std::size_t const c : models_[m].channels) {
      each.state_of_channel.push_back(all.state_of_channel[c]);
      each.own_sd.push_back(all.own_sd[c]);
    }
  }
  own.carried = std::move(carried);
  return own;
}

// starts_alone: coefficients are held at the regression's.
SegmentSimulation StructureFits::simulation(std::size_t m, std::vector<Segment> const& segments, bool starts_alone) const {
  ValidatedModel const& model = models_[m];
  std::vector<Experiment> own;
  for (Experiment const& each : settings_.records) own.push_back(model.view(each));
  SegmentSimulation::Settings settings{{},      model.others, 0, solver(m), settings_.execution, settings_.pool, model.centres,
                                       noise(m)};
  if (starts_alone)
    for (ValidatedModel::Coefficient const& each : model.coefficients)
      settings.others[static_cast<std::size_t>(each.parameter)] = each.start;
  else
    settings.fitted = model.fitted(), settings.inner = static_cast<int>(model.inner.size());
  return SegmentSimulation(model.compiled, own, segments, std::move(settings));
}

bool StructureFits::one_by_one(std::size_t m) const {
  if (!models_[m].failure.empty()) return false;
  return !models_[m].solver.row().in_program;
}

// The point and each perturbation simulate all rows.
double StructureFits::rows_of_round(std::size_t m) const {
  double rows = 0;
  for (Experiment const& each : settings_.records) rows += static_cast<double>(each.time.size());
  return rows * static_cast<double>(1 + models_[m].fitted().size() + models_[m].states.size());
}

// Asked once a round.
std::function<bool()> StructureFits::stop(std::size_t m) {
  if (!one_by_one(m)) return settings_.interrupted;
  return [this, m, rows = rows_of_round(m)] {
    spent_[m] += rows;
    return settings_.interrupted() || given_up(m);
  };
}

ShootingOptions StructureFits::options(std::size_t m, bool last) {
  ShootingOptions out;
  if (!last) out.gain = enough_on_the_way;
  out.interrupted = stop(m);
  return out;
}

ShootingFit StructureFits::fit_before(std::size_t m, std::vector<int> const& ends) const {
  std::vector<Segment> const all = segments();
  std::vector<Segment> parts;
  ShootingPoint point = fits_[m].fit.point;
  for (std::size_t s = 0; s < all.size(); ++s) {
    Segment part = all[s];
    part.count = std::min(part.count, ends[static_cast<std::size_t>(part.experiment)] - part.first);
    if (part.count < std::min(settings_.least, all[s].count)) continue;  // too little for its start
    point.starts.col(static_cast<Eigen::Index>(parts.size())) = fits_[m].fit.point.starts.col(static_cast<Eigen::Index>(s));
    parts.push_back(part);
  }
  point.starts.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(parts.size()));
  return fit_by_shooting(simulation(m, parts), std::move(point), {.interrupted = settings_.interrupted});
}

// The shortest segments, from the regression's coefficients.
void StructureFits::begin(std::size_t m) {
  if (one_by_one(m) && least_rounds * rows_of_round(m) > allowance_) spent_[m] = 2 * allowance_;
  if (given_up(m)) return;
  std::vector<Segment> const parts = segments(most_halvings_);
  ShootingPoint point{Eigen::VectorXd(), models_[m].starts(parts, guess_)};
  std::vector<double> noise;
  for (std::size_t const c : models_[m].channels) noise.push_back(settings_.noise_sd[c]);
  fit_starts(simulation(m, parts, true), point, noise, stop(m));
  point.coefficients = models_[m].begin();
  fits_[m] = {most_halvings_, fit_by_shooting(simulation(m, parts), std::move(point), options(m, most_halvings_ == 0)), {}};
  if (!fits_[m].fit.finite) fits_[m].failure = "does not stay finite";
}

// Where each segment begins, the shorter ones have an estimate.
ShootingPoint StructureFits::longer(Fitted const& from, std::vector<Segment> const& parts) const {
  std::map<std::pair<int, int>, Eigen::Index> known;
  std::vector<Segment> const before = segments(from.halved);
  for (std::size_t s = 0; s < before.size(); ++s) known[{before[s].experiment, before[s].first}] = static_cast<Eigen::Index>(s);
  ShootingPoint point{from.fit.point.coefficients,
                      Eigen::MatrixXd(from.fit.point.starts.rows(), static_cast<Eigen::Index>(parts.size()))};
  for (std::size_t s = 0; s < parts.size(); ++s)
    point.starts.col(static_cast<Eigen::Index>(s)) = from.fit.point.starts.col(known.at({parts[s].experiment, parts[s].first}));
  return point;
}

StructureFits::Fitted StructureFits::at(std::size_t m, Fitted const& from, int halved, bool last) {
  std::vector<Segment> const parts = segments(halved);
  Fitted out = from;
  out.halved = halved;
  out.fit = fit_by_shooting(simulation(m, parts), longer(from, parts), options(m, last));
  return out;
}

/// As in chaotic motion.
bool StructureFits::neighbours_part(std::size_t m, Fitted const& fitted) const {
  if (one_by_one(m)) return false;
  SegmentSimulation const simulated = simulation(m, segments(fitted.halved));
  std::vector<SegmentSlopes> const slopes = SegmentDifferences(simulated, fitted.fit.point).at(fitted.fit.point, most_probes);
  double signal = std::numeric_limits<double>::infinity();
  for (int c = 0; c < simulated.channels(); ++c)
    signal = std::min(signal, simulated.size(c) / fitted.fit.noise_sd[static_cast<std::size_t>(c)]);
  for (std::size_t s = 0; s < slopes.size(); ++s) {
    int const rows = simulated.rows_of_channel(static_cast<int>(s)), part = std::max(rows / 4, 1);
    auto const mean_square = [&](Eigen::Index x, int first) {  // of measured rows
      double sum = 0, count = 0;
      for (int c = 0; c < simulated.channels(); ++c)
        for (int row = c * rows + first; row < c * rows + first + part; ++row)
          if (simulated.measured(static_cast<int>(s), row))
            sum += std::pow(slopes[s].by_start(row, x) / simulated.size(c), 2), ++count;
      return sum / count;
    };
    for (Eigen::Index x = 0; x < slopes[s].by_start.cols(); ++x)
      if (mean_square(x, rows - part) > std::pow(parted * signal, 2) * mean_square(x, 0)) return true;
  }
  return false;
}

/// As far as it follows the record.
void StructureFits::climb_alone(std::size_t m) {
  while (fits_[m].halved > 0 && !settings_.interrupted()) {
    Fitted next = at(m, fits_[m], fits_[m].halved - 1, false);
    if (!follows(fits_[m].fit, next.fit) || neighbours_part(m, next)) return;
    shorter_[m].push_back(std::exchange(fits_[m], std::move(next)));
  }
}

/// To segments of that length, whether it follows or not.
void StructureFits::climb_to(std::size_t m, int halved) {
  while (validated(m) && fits_[m].halved > halved && !settings_.interrupted()) {
    Fitted next = at(m, fits_[m], fits_[m].halved - 1, false);
    if (!next.fit.finite)
      fits_[m].failure = "does not stay finite over segments of this length";
    else
      shorter_[m].push_back(std::exchange(fits_[m], std::move(next)));
  }
}

// Who leads sets the length; who leads at that length may lead further.
void StructureFits::climb() {
  for (std::size_t m = 0; m < models_.size(); ++m)
    if (models_[m].failure.empty() && !settings_.interrupted()) begin(m);
  std::vector<bool> has_led(models_.size(), false);
  halved_ = most_halvings_;
  std::optional<std::size_t> lead;  // the regression's choice before anything is compared
  for (std::size_t m = models_.size(); m-- > 0;)
    if (validated(m)) lead = m;
  for (; lead && !has_led[*lead] && !settings_.interrupted(); lead = best()) {
    has_led[*lead] = true;
    climb_alone(*lead);
    halved_ = std::min(halved_, fits_[*lead].halved);
    for (std::size_t m = 0; m < models_.size(); ++m)
      if (validated(m)) climb_to(m, halved_);
  }
}

std::optional<std::size_t> StructureFits::best() const {
  std::optional<std::size_t> best;
  for (std::size_t m = 0; m < models_.size(); ++m)
    if (validated(m) && (!best || log_posterior(m) > log_posterior(*best))) best = m;
  return best;
}

void StructureFits::refine() {
  for (int returns = 0; !settle() && returns < most_returns && go_back(); ++returns) {
  }
  name_failures();
}

/// To the last digits, with a solver that no longer shapes the best one's coefficients. Whether the best one converges, and those
/// with fewer coefficients that are nearly as probable.
bool StructureFits::settle() {
  std::optional<std::size_t> const first = best();
  if (!first) return true;
  fits_[*first] = at(*first, fits_[*first], halved_, true);
  for (int round = 0; round < most_refinements && solver(*first).fixed_step() && !settings_.interrupted(); ++round) {
    int const before = substeps_;
    substeps_ = solver(*first).finer().substeps;
    Fitted const finer = at(*first, fits_[*first], halved_, true);
    bool const usable = finer.fit.finite && finer.fit.determined;
    double most = 0;
    for (Eigen::Index j = 0; usable && j < finer.fit.point.coefficients.size(); ++j)
      most = std::max(most, std::abs(finer.fit.point.coefficients(j) - fits_[*first].fit.point.coefficients(j)) /
                                std::sqrt(finer.fit.covariance(j, j)));
    if (!usable || most <= tolerable_move) {
      substeps_ = before;
      break;
    }
    fits_[*first] = finer;
  }
  for (std::size_t m = 0; m < models_.size(); ++m)
    if (validated(m) && m != *first && !settings_.interrupted()) fits_[m] = at(m, fits_[m], halved_, true);
  std::optional<std::size_t> const leading = best();
  bool all = true;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    if (!validated(m) || !fits_[m].fit.finite || !fits_[m].fit.determined || fits_[m].fit.converged) continue;
    bool const shorter = models_[m].coefficients.size() < models_[*leading].coefficients.size();
    if (m == *leading || (shorter && log_posterior(m) > log_posterior(*leading) - within_reach)) all = false;
  }
  return all || settings_.interrupted();
}

/// To segments of half the length, as they were fitted on the way; false: there are none.
bool StructureFits::go_back() {
  if (halved_ == most_halvings_) return false;
  ++halved_;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    if (!models_[m].failure.empty()) continue;
    while (fits_[m].halved < halved_ && !shorter_[m].empty()) {
      fits_[m] = std::move(shorter_[m].back());
      shorter_[m].pop_back();
    }
    if (fits_[m].fit.finite && fits_[m].halved == halved_) fits_[m].failure.clear();
  }
  return true;
}

void StructureFits::name_failures() {
  for (std::size_t m = 0; m < models_.size(); ++m) {
    if (!validated(m)) continue;
    if (!fits_[m].fit.finite)
      fits_[m].failure = "does not stay finite";
    else if (!fits_[m].fit.determined)
      fits_[m].failure = "the motion does not determine its coefficients";
    else if (!fits_[m].fit.converged)
      fits_[m].failure = "its fit does not converge";
    else if (!std::isfinite(log_prior_of_inner(m)))
      fits_[m].failure =
          "its fit moves a parameter inside a term to a value where its prior is zero: check the bounds of this prior";
  }
}

}  // namespace sysid
