// Fits, ranks, scores and describes structures.
#include "discovery/simulation_validation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"
#include "discovery/coefficient_names.hpp"
#include "discovery/forecast_errors.hpp"
#include "discovery/found_equation.hpp"
#include "discovery/residual_memory.hpp"
#include "discovery/simulated_structure.hpp"
#include "discovery/structure_fits.hpp"
#include "discovery/structure_prior.hpp"
#include "discovery/validation_findings.hpp"
#include "discovery/validation_rows.hpp"
#include "linear_algebra/decompositions.hpp"
#include "regression/column/signals.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr double near_floor = 3, most_of_motion = 0.01;
constexpr int draws = 50, draws_one_by_one = 10;
constexpr int origins = 200, origins_one_by_one = 20;  // of forecasts, in each experiment

/// R of R R^T = covariance: by eigenvalues where rounding has left one below zero.
Eigen::MatrixXd root_of(Eigen::MatrixXd const& covariance) {
  if (auto lower = cholesky(covariance)) return std::move(*lower);
  auto const [values, vectors] = symmetric_eigen(covariance);
  return vectors * values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

class Validator {
 public:
  Validator(FoundSource const& source, std::vector<FoundStructure> structures, std::vector<ExperimentData> const& unused,
            SearchedRecord const& searched, std::function<bool()> const& interrupted)
      : source_(source),
        structures_(std::move(structures)),
        searched_(searched),
        interrupted_(interrupted),
        dictionary_(source.dictionary),
        execution_(source.execution),
        pool_(make_pool(execution_)) {
    int states = 1;
    for (FoundStructure const& each : structures_) {
      models_.push_back(validated_model(source_, each));
      states = std::max(states, static_cast<int>(models_.back().states.size()));
    }
    rows_ = validation_rows(source.data, unused, states, source.discovery.half_width);
    scored_.resize(models_.size());
    for (std::size_t m = 0; m < models_.size(); ++m) order_.push_back(m);
  }

  Validation run() {
    bool const any = std::any_of(models_.begin(), models_.end(), [](ValidatedModel const& each) { return each.failure.empty(); });
    if (any) {
      std::vector<double> const& noise = source_.discovery.noise_sd;
      StartGuess guess(dictionary_.numbers, rows_.records, noise);
      std::vector<double> priors;
      for (std::size_t m = 0; m < models_.size(); ++m) priors.push_back(log_prior(m));
      fits_.emplace(models_, guess,
                    StructureFitSettings{.records = rows_.records,
                                         .noise_sd = noise,
                                         .log_prior = std::move(priors),
                                         .inner = dictionary_.inner,
                                         .least = rows_.least,
                                         .noise = searched_.noise,
                                         .substeps = searched_.substeps,
                                         .execution = execution_,
                                         .pool = pool_,
                                         .interrupted = interrupted_});
      fits_->run();
      if (interrupted_()) return interrupted();
      rank();
      score();
      check_stability();
    }
    if (interrupted_()) return interrupted();
    if (!is_validated(order_.front())) lead_with_regression();
    Validation out;
    report(out);
    if (any) out.findings = validation_findings(out.report);
    if (is_validated(order_.front())) {
      add_memory(order_.front(), out.findings);
      for (FreeMotion const& run : scored_[order_.front()].errors.runs)
        out.free_runs.push_back(shown_motion(run, rows_.held_out[static_cast<std::size_t>(run.experiment)], dictionary_.measured,
                                             models_[order_.front()].channels));
    }
    return out;
  }

 private:
  static Validation interrupted() {
    Validation out;
    out.interrupted = true;
    return out;
  }

  struct Scored {
    double probability = 0;
    ForecastErrors errors;
    int bounded = 0;
  };

  bool is_validated(std::size_t m) const { return fits_ && fits_->failure(m).empty(); }

  double log_prior(std::size_t m) const {
    double sum = 0;
    for (std::size_t e = 0; e < structures_[m].equations.size(); ++e) {
      std::vector<DictionaryTerm> const& terms = dictionary_.equations[e].terms;
      std::vector<double> const odds = log_term_odds(terms, source_.discovery.equations[e]);
      for (int const j : structures_[m].equations[e]->terms) sum += odds[static_cast<std::size_t>(j)];
    }
    return sum;
  }

  void rank() {
    auto const weight = [&](std::size_t m) { return fits_->log_posterior(m); };
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return weight(a) > weight(b); });
    // The same terms from several starts of parameters inside terms are one structure: the best of their optima.
    std::set<std::string> seen;
    std::erase_if(order_, [&](std::size_t m) {
      bool const elsewhere = !structures_[m].inner.empty() && structures_[m].inner != source_.inner;
      return (elsewhere && !is_validated(m)) || !seen.insert(structure_text(dictionary_, structures_[m])).second;
    });
    double sum = searched_.others;
    for (std::size_t const m : order_)
      sum += is_validated(m) ? scored_[m].probability = elementary::exp(weight(m) - weight(order_.front()))
                             : elementary::exp(fits_->log_posterior_reached(m) - weight(order_.front()));
    for (std::size_t const m : order_) scored_[m].probability /= sum > 0 ? sum : 1;
  }

  // What the regression lists is in its order, with its choice first; the others behind it.
  void lead_with_regression() {
    auto const place = [&](std::size_t m) {
      int const of_regression = structures_[m].of_regression;
      return of_regression > 0 ? of_regression : std::numeric_limits<int>::max();
    };
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  }

  std::vector<Experiment> views(std::size_t m, std::vector<Experiment> const& experiments) const {
    std::vector<Experiment> own;
    for (Experiment const& each : experiments) own.push_back(models_[m].view(each));
    return own;
  }

  int draws_of(std::size_t m) const { return fits_->one_by_one(m) ? draws_one_by_one : draws; }
  ForecastSettings forecast(std::size_t m) const {
    return {rows_.window, rows_.horizon, fits_->one_by_one(m) ? origins_one_by_one : origins, fits_->solver(m), execution_, pool_};
  }

  // With coefficients of rows that are not scored.
  void score() {
    if (rows_.held_out.empty()) return;
    StartGuess guess(dictionary_.numbers, rows_.held_out, source_.discovery.noise_sd);
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (!is_validated(m) || interrupted_()) continue;
      ShootingFit const fit = rows_.cut ? fits_->fit_before(m, rows_.ends) : fits_->fit(m);
      if (fit.finite)
        scored_[m].errors =
            forecast_errors(models_[m], fit.point.coefficients, fit.noise_sd, views(m, rows_.held_out), guess, forecast(m));
    }
  }

  // Draws of the coefficients from the normal law about their fit, the start of one experiment moved along.
  LaneArray drawn(std::size_t m, std::size_t segment) const {
    ShootingFit const& fit = fits_->fit(m);
    ValidatedModel const& model = models_[m];
    Eigen::Index const k = fit.point.coefficients.size();
    auto const parameters = static_cast<int>(model.others.size());
    Eigen::MatrixXd const root = root_of(fit.covariance);
    LaneArray out(model.compiled->parameter_rows(), draws_of(m));
    for (int w = 0; w < out.width(); ++w) {
      Stream stream({source_.seed, Purpose::selection, static_cast<std::uint64_t>(w), 0});
      Eigen::VectorXd normal(k);
      for (Eigen::Index j = 0; j < k; ++j) normal(j) = stream.normal();
      Eigen::VectorXd const move = root * normal;
      Eigen::VectorXd const start = fit.point.starts.col(static_cast<Eigen::Index>(segment)) + fit.follows[segment] * move;
      for (int p = 0; p < parameters; ++p) out(p, w) = model.others[static_cast<std::size_t>(p)];
      std::vector<int> const fitted = model.fitted();
      for (Eigen::Index j = 0; j < k; ++j) out(fitted[static_cast<std::size_t>(j)], w) = fit.point.coefficients(j) + move(j);
      auto const first = static_cast<Eigen::Index>(model.coefficients.size());
      for (std::size_t i = 0; i < model.inner.size(); ++i)  // the normal law may reach where its prior is zero
        if (!std::isfinite(log_density(dictionary_.inner[model.inner[i].index], out(model.inner[i].parameter, w))))
          out(model.inner[i].parameter, w) = fit.point.coefficients(first + static_cast<Eigen::Index>(i));
      for (Eigen::Index x = 0; x < start.size(); ++x) out(parameters + static_cast<int>(x), w) = start(x);
    }
    return out;
  }

  void check_stability() {
    std::vector<Segment> const parts = fits_->segments();
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (!is_validated(m) || interrupted_()) continue;
      std::vector<LaneArray> points;
      for (std::size_t s = 0; s < parts.size(); ++s)
        if (parts[s].first == 0) points.push_back(drawn(m, s));
      scored_[m].bounded = bounded_runs(models_[m], views(m, rows_.records), points, forecast(m));
    }
  }

  // As the fit of the written model finds it, so that the two agree; but for noise that grows, which that model does not have.
  void add_memory(std::size_t m, Findings& findings) const {
    for (ResidualMemory const& each : residual_memory(models_[m], fits_->fit(m), views(m, rows_.records), fits_->segments(),
                                                      fits_->solver(m), fits_->noise(m), execution_, pool_))
      findings.push_back(not_white(dictionary_.measured.channels[models_[m].channels[each.channel]].name,
                                   rows_.records[each.experiment].name, each));
  }

  // --- the answer
  double scale(std::size_t equation, std::size_t term) const {
    auto const& unit = dictionary_.equations[equation].terms[term].unit;
    return unit ? unit->scale : 1;
  }

  /// Whether the regression fitted the support.
  bool is_listed(std::size_t equation, regression::Support const& support) const {
    regression::FoundEquation const& found = source_.discovery.equations[equation];
    return &support == &found.chosen || std::any_of(found.supports.begin(), found.supports.end(),
                                                    [&](regression::Support const& each) { return &each == &support; });
  }

  bool is_stated(std::size_t channel) const { return !source_.what.noise.empty() && source_.what.noise[channel].has_value(); }

  /// sd of a channel's noise as the regression took it; of noise that grows, as the same estimate has it with that law. A residual
  /// near what digits, inputs and integrator show is theirs.
  double noise_of(std::size_t channel, double residual) const {
    double noise = source_.discovery.noise_sd[channel];
    if (!searched_.growth.empty() && searched_.growth[channel] > 0 && !is_stated(channel)) {
      std::vector<regression::ChannelSamples> alike, growing;
      for (std::size_t e = 0; e < rows_.records.size(); ++e) {
        alike.push_back({.samples = rows_.records[e].measured[channel], .equal_steps = !unequal_step(rows_.records[e].time)});
        growing.push_back(alike.back());
        growing.back().relative = searched_.noise.relative[e][channel];
      }
      double const plain = regression::estimated_noise(alike);
      if (plain > 0) noise *= regression::estimated_noise(growing) / plain;
    }
    if (searched_.noise.floor.empty()) return noise;
    // In a model that has nothing to do with the motion, the digits of the input may do anything.
    double const floor = std::min(searched_.noise.floor[channel], most_of_motion * sd_of(channel));
    return residual < near_floor * floor ? std::max(noise, floor) : noise;
  }

  /// Of the samples of a channel.
  double sd_of(std::size_t channel) const {
    std::vector<double> values;
    for (Experiment const& each : rows_.records)
      std::ranges::copy_if(each.measured[channel], std::back_inserter(values), [](double y) { return std::isfinite(y); });
    return values.size() > 1 ? std::sqrt(population_variance(values)) : infinity;
  }

  ValidatedStructure described(std::size_t m) const {
    ValidatedStructure out;
    out.terms = structure_text(dictionary_, structures_[m]);
    out.of_regression = structures_[m].of_regression;
    out.failure = fits_ ? fits_->failure(m) : models_[m].failure;
    out.given_up = fits_ && fits_->given_up(m);
    if (!out.failure.empty()) return out;
    ShootingFit const& fit = fits_->fit(m);
    Scored const& scored = scored_[m];
    out.log_evidence = fit.log_evidence;
    out.log_prior = log_prior(m) + fits_->log_prior_of_inner(m);
    out.probability = scored.probability;
    out.draws = draws_of(m);
    out.bounded = scored.bounded;
    out.follows = scored.errors.follows;
    add_coefficients(m, out);
    add_channels(m, out);
    return out;
  }

  /// And the equations with them.
  void add_coefficients(std::size_t m, ValidatedStructure& out) const {
    ShootingFit const& fit = fits_->fit(m);
    std::vector<std::vector<PrintedTerm>> printed(dictionary_.equations.size());
    for (std::size_t j = 0; j < models_[m].coefficients.size(); ++j) {
      ValidatedModel::Coefficient const& of = models_[m].coefficients[j];
      auto const row = static_cast<Eigen::Index>(j);
      DictionaryEquation const& equation = dictionary_.equations[of.equation];
      DictionaryTerm const& term = equation.terms[of.term];
      double const unit = scale(of.equation, of.term);
      bool const listed = is_listed(of.equation, *structures_[m].equations[of.equation]);
      double const none = std::numeric_limits<double>::quiet_NaN();
      double const value = fit.point.coefficients(row) / unit, sd = std::sqrt(fit.covariance(row, row)) / unit;
      out.coefficients.push_back({equation.text, term.text, coefficient_names(dictionary_, static_cast<int>(of.equation))[of.term],
                                  term.unit ? term.unit->text : "", listed ? of.value / unit : none, listed ? of.sd / unit : none,
                                  value, sd, term.in_target});
      printed[of.equation].push_back({of.term, value, sd});
    }
    auto const first = static_cast<Eigen::Index>(models_[m].coefficients.size());
    for (std::size_t i = 0; i < models_[m].inner.size(); ++i) {
      auto const row = first + static_cast<Eigen::Index>(i);
      Quantity const& inner = dictionary_.inner[models_[m].inner[i].index].quantity;
      out.coefficients.push_back({.target = "",
                                  .term = inner.name,
                                  .name = inner.name,
                                  .unit = inner.unit_text(),
                                  .regression = std::numeric_limits<double>::quiet_NaN(),
                                  .regression_sd = std::numeric_limits<double>::quiet_NaN(),
                                  .value = inner.from_si(fit.point.coefficients(row)),
                                  .sd = inner.from_si(std::sqrt(fit.covariance(row, row))),
                                  .inside = true});
    }
    for (std::size_t e = 0; e < printed.size(); ++e) out.equations.push_back(equation_text(dictionary_.equations[e], printed[e]));
  }

  void add_channels(std::size_t m, ValidatedStructure& out) const {
    ShootingFit const& fit = fits_->fit(m);
    Scored const& scored = scored_[m];
    for (std::size_t c = 0; c < models_[m].channels.size(); ++c) {
      Channel const& channel = dictionary_.measured.channels[models_[m].channels[c]];
      double const noise = noise_of(models_[m].channels[c], fit.noise_sd[c]);
      ValidatedChannel of{
          channel.name, channel.unit_text(), 0, channel.from_si(fit.noise_sd[c]), channel.from_si(noise), 0, {}, {}, {}};
      std::size_t const own = models_[m].channels[c];
      if (!searched_.growth.empty() && searched_.growth[own] > 0)
        of.growth = channel.from_si(searched_.growth[own]) - channel.from_si(0);
      if (noise > 0) out.residual_over_noise = std::max(out.residual_over_noise, fit.noise_sd[c] / noise);
      if (c < scored.errors.sd.size()) {
        auto const declared = [&](std::optional<double> value) { return value ? std::optional(channel.from_si(*value)) : value; };
        of.sd = channel.from_si(scored.errors.sd[c]);
        of.one_step = declared(scored.errors.one_step[c]);
        of.horizon = declared(scored.errors.horizon[c]);
        of.free_run = declared(scored.errors.free_run[c]);
      }
      out.channels.push_back(std::move(of));
    }
  }

  void report(Validation& out) const {
    for (std::size_t const m : order_) {
      out.order.push_back(structures_[m]);
      if (!structures_[m].inner.empty() && is_validated(m)) {
        auto row = static_cast<Eigen::Index>(models_[m].coefficients.size());
        for (ValidatedModel::Inner const& each : models_[m].inner)
          out.order.back().inner[each.index] = fits_->fit(m).point.coefficients(row++);
      }
      out.report.structures.push_back(described(m));
    }
    if (!fits_) return;
    ValidationReport& validation = out.report;
    std::vector<Segment> const parts = fits_->segments();
    validation.segments = static_cast<int>(parts.size());
    validation.shortest = std::numeric_limits<double>::infinity();
    for (Segment const& each : parts) {
      std::vector<double> const& time = rows_.records[static_cast<std::size_t>(each.experiment)].time;
      double const length =
          time[static_cast<std::size_t>(each.first + each.count - 1)] - time[static_cast<std::size_t>(each.first)];
      validation.shortest = std::min(validation.shortest, length);
      validation.longest = std::max(validation.longest, length);
    }
    validation.whole = fits_->whole();
    validation.outside = searched_.outside;
    validation.step = rows_.step;
    validation.horizon_rows = rows_.horizon;
    validation.horizon = rows_.horizon * rows_.step;
    validation.window_rows = rows_.window;
    validation.held_out = rows_.held_out_name;
    validation.held_out_seen = rows_.cut;
    if (models_[order_.front()].failure.empty()) validation.solver = fits_->solver(order_.front()).text();
  }

  FoundSource const& source_;
  std::vector<FoundStructure> structures_;
  SearchedRecord const& searched_;
  std::function<bool()> const& interrupted_;
  CheckedDictionary const& dictionary_;
  ExecutionOptions execution_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<ValidatedModel> models_;
  ValidationRows rows_;
  std::optional<StructureFits> fits_;  // none where there is no model
  std::vector<Scored> scored_;
  std::vector<std::size_t> order_;
};

}  // namespace

Validation validate_structures(FoundSource const& source, std::vector<FoundStructure> structures,
                               std::vector<ExperimentData> const& unused, SearchedRecord const& searched,
                               std::function<bool()> const& interrupted) {
  return Validator(source, std::move(structures), unused, searched, interrupted).run();
}

}  // namespace sysid
