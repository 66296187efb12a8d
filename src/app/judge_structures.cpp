// Climbs from short segments to long ones with the structure that leads, takes the others along, then ranks and scores.
#include "app/judge_structures.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "app/forecast_errors.hpp"
#include "app/found_equation.hpp"
#include "app/found_model.hpp"
#include "app/judged_model.hpp"
#include "core/elementary.hpp"
#include "core/random.hpp"
#include "likelihood/shooting.hpp"
#include "regression/spectrum.hpp"
#include "report/discovery.hpp"
#include "report/number.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

/// Segments are not doubled further when the residual sd of a channel grows by more than this.
constexpr double tolerable_growth = 1.5;
/// Segments on the way up need not be fitted closer than this, in log likelihood.
constexpr double enough_on_the_way = 1e-2;
/// A finer solver is taken where it moves a coefficient by more than this many of its sds.
constexpr double tolerable_move = 0.1;
constexpr int most_refinements = 4;
constexpr int draws = 50;
constexpr int least_rows = 12;     // of a segment
constexpr int rows_per_state = 4;  // the same, and of a window
constexpr int most_window = 200;
constexpr double tolerable_residual = 1.5;  // of the noise
constexpr double idle_sds = 2;              // a coefficient of the model may be zero
constexpr double lost_percent = 100;        // of the sd: no better than the mean

class Judge {
 public:
  Judge(FoundSource const& source, std::vector<FoundStructure> structures, std::vector<ExperimentData> const& aside,
        std::function<bool()> const& interrupted)
      : source_(source),
        structures_(std::move(structures)),
        interrupted_(interrupted),
        dictionary_(source.dictionary),
        pool_(make_pool(source.session.options.execution)) {
    for (FoundStructure const& each : structures_) models_.push_back(judged_model(source_, each));
    fits_.resize(models_.size());
    for (JudgedModel const& each : models_)
      if (each.failure.empty()) states_ = std::max(states_, static_cast<int>(each.states.size()));
    plan(aside);
  }

  Judgement run() {
    Judgement out;
    if (std::all_of(models_.begin(), models_.end(), [](JudgedModel const& each) { return !each.failure.empty(); })) {
      out.order = structures_;
      for (std::size_t m = 0; m < models_.size(); ++m) out.report.structures.push_back(described(m));
      return out;
    }
    StartGuess guess(dictionary_.numbers, pieces_, source_.discovery.noise_sd);
    guess_ = &guess;
    climb();
    refine();
    out.interrupted = interrupted_();
    if (out.interrupted) return out;
    rank();
    score();
    check_stability();
    out.interrupted = interrupted_();
    if (out.interrupted) return out;
    report(out);
    return out;
  }

 private:
  struct Fitted {
    int halved = -1;  // the level it stands at
    ShootingFit fit;
    std::string failure;
    double probability = 0;
    ForecastErrors errors;
    int bounded = 0;
  };

  // --- which rows
  void plan(std::vector<ExperimentData> const& aside) {
    std::vector<std::vector<double>> signals;
    for (ExperimentData const& each : source_.data)
      for (std::vector<double> const& channel : each.experiment.measured)
        if (!channel.empty()) signals.push_back(channel);
    std::vector<double> const& time = source_.data.front().experiment.time;
    step_ = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
    double const period = regression::dominant_period(signals, step_);
    horizon_ = std::max(1, static_cast<int>(std::lround(period / step_)));
    int const least_window = std::max(least_rows, rows_per_state * states_);
    least_ = std::max({2 * source_.discovery.half_width, horizon_ / 4, least_window});

    int const needed = 3 * least_window;
    for (ExperimentData const& each : aside)
      if (static_cast<int>(each.experiment.time.size()) >= needed) aside_.push_back(each.experiment);
    bool const split = aside_.empty() && std::all_of(source_.data.begin(), source_.data.end(), [&](ExperimentData const& each) {
                         return static_cast<int>(each.experiment.time.size() / 5) >= needed;
                       });
    for (ExperimentData const& each : source_.data) {
      Experiment const& experiment = each.experiment;
      int const rows = static_cast<int>(experiment.time.size()), first = split ? rows - rows / 5 : rows;
      begins_.push_back(static_cast<int>(pieces_.size()));
      pieces_.push_back(rows_of(experiment, 0, first));
      seen_.push_back(true);
      if (!split) continue;
      pieces_.push_back(rows_of(experiment, first, rows - first));
      seen_.push_back(false);
      aside_.push_back(pieces_.back());
    }
    split_ = split;
    std::string names;
    if (split)
      for (ExperimentData const& each : source_.data) names += (names.empty() ? "the last fifth of " : ", ") + each.experiment.name;
    else
      for (Experiment const& each : aside_) names += (names.empty() ? "" : ", ") + each.name;
    aside_name_ = names;
    int shortest = std::numeric_limits<int>::max();
    for (Experiment const& each : aside_) shortest = std::min(shortest, static_cast<int>(each.time.size()));
    if (!aside_.empty()) {
      window_ = std::clamp(horizon_, least_window, std::max(least_window, std::min(most_window, shortest / 4)));
      horizon_ = std::min(horizon_, shortest - window_ - 1);
    }
    for (Experiment const& each : pieces_)
      most_halvings_ = std::max(most_halvings_, halvings(static_cast<int>(each.time.size()), least_));
  }

  std::vector<Segment> segments(int halved) const { return cut_into_segments(pieces_, least_, halved); }

  // --- fits
  SolverSettings solver(std::size_t m) const {
    SolverSettings out = models_[m].solver;
    if (out.fixed_step()) out.substeps = std::max(out.substeps, substeps_);
    return out;
  }

  std::vector<Experiment> views(std::size_t m, std::vector<Experiment> const& experiments) const {
    std::vector<Experiment> own;
    for (Experiment const& each : experiments) own.push_back(models_[m].view(each));
    return own;
  }

  SegmentSimulation simulation(std::size_t m, std::vector<Segment> const& segments) const {
    return SegmentSimulation(models_[m].compiled, views(m, pieces_), segments,
                             {models_[m].fitted(), models_[m].others, 0, solver(m), source_.session.options.execution, pool_});
  }

  ShootingOptions options(bool last) const {
    ShootingOptions out;
    if (!last) out.gain = enough_on_the_way;
    out.interrupted = interrupted_;
    return out;
  }

  // The shortest segments, from the regression's coefficients.
  void begin(std::size_t m) {
    std::vector<Segment> const parts = segments(most_halvings_);
    SegmentSimulation const simulated = simulation(m, parts);
    ShootingPoint point{models_[m].of_regression(), models_[m].starts(parts, *guess_)};
    std::vector<double> noise;
    for (std::size_t const c : models_[m].channels) noise.push_back(source_.discovery.noise_sd[c]);
    fit_starts(simulated, point, noise, interrupted_);
    fits_[m] = {most_halvings_, fit_by_shooting(simulated, std::move(point), options(most_halvings_ == 0)), {}, {}, {}, {}};
    if (!fits_[m].fit.finite) fits_[m].failure = "does not stay finite";
  }

  // Where each segment begins, the shorter ones have an estimate.
  ShootingPoint longer(Fitted const& from, std::vector<Segment> const& parts) const {
    std::map<std::pair<int, int>, Eigen::Index> known;
    std::vector<Segment> const before = segments(from.halved);
    for (std::size_t s = 0; s < before.size(); ++s) known[{before[s].experiment, before[s].first}] = static_cast<Eigen::Index>(s);
    ShootingPoint point{from.fit.point.coefficients,
                        Eigen::MatrixXd(from.fit.point.starts.rows(), static_cast<Eigen::Index>(parts.size()))};
    for (std::size_t s = 0; s < parts.size(); ++s)
      point.starts.col(static_cast<Eigen::Index>(s)) = from.fit.point.starts.col(known.at({parts[s].experiment, parts[s].first}));
    return point;
  }

  Fitted at(std::size_t m, Fitted const& from, int halved, bool last) const {
    std::vector<Segment> const parts = segments(halved);
    Fitted out = from;
    out.halved = halved;
    out.fit = fit_by_shooting(simulation(m, parts), longer(from, parts), options(last));
    return out;
  }

  bool follows(ShootingFit const& before, ShootingFit const& after) const {
    if (!after.finite || !after.converged) return false;
    for (std::size_t c = 0; c < after.noise_sd.size(); ++c)
      if (!(after.noise_sd[c] <= tolerable_growth * before.noise_sd[c])) return false;
    return true;
  }

  /// As far as it follows the record.
  void climb_alone(std::size_t m) {
    while (fits_[m].halved > 0 && !interrupted_()) {
      Fitted next = at(m, fits_[m], fits_[m].halved - 1, false);
      if (!follows(fits_[m].fit, next.fit)) return;
      fits_[m] = std::move(next);
    }
  }

  /// To segments of that length, whether it follows or not.
  void climb_to(std::size_t m, int halved) {
    while (fits_[m].failure.empty() && fits_[m].halved > halved && !interrupted_()) {
      Fitted next = at(m, fits_[m], fits_[m].halved - 1, false);
      if (!next.fit.finite)
        fits_[m].failure = "does not stay finite over segments of this length";
      else
        fits_[m] = std::move(next);
    }
  }

  bool judged(std::size_t m) const { return models_[m].failure.empty() && fits_[m].failure.empty(); }

  // Who leads sets the length; who leads at that length may lead further.
  void climb() {
    for (std::size_t m = 0; m < models_.size(); ++m)
      if (models_[m].failure.empty() && !interrupted_()) begin(m);
    std::vector<bool> has_led(models_.size(), false);
    halved_ = most_halvings_;
    std::optional<std::size_t> lead;  // the regression's choice before anything is compared
    for (std::size_t m = models_.size(); m-- > 0;)
      if (judged(m)) lead = m;
    for (; lead && !has_led[*lead] && !interrupted_(); lead = best()) {
      has_led[*lead] = true;
      climb_alone(*lead);
      halved_ = std::min(halved_, fits_[*lead].halved);
      for (std::size_t m = 0; m < models_.size(); ++m)
        if (judged(m)) climb_to(m, halved_);
    }
  }

  // Every number of terms of an equation is as probable before, and among as many terms every choice (Scott, Berger 2010).
  double log_prior(std::size_t m) const {
    double sum = 0;
    for (std::size_t e = 0; e < structures_[m].equations.size(); ++e) {
      std::vector<DictionaryTerm> const& terms = dictionary_.equations[e].terms;
      std::vector<regression::FoundTerm> const& found = source_.discovery.equations[e].terms;
      int offered = 0, taken = 0;
      for (std::size_t j = 0; j < terms.size(); ++j)
        if (!terms[j].in_target && !found[j].left_out) ++offered;
      for (int const j : structures_[m].equations[e]->terms)
        if (!terms[static_cast<std::size_t>(j)].in_target) ++taken;
      for (int i = 1; i <= taken; ++i) sum -= elementary::log(static_cast<double>(offered - taken + i) / i);
    }
    return sum;
  }

  double evidence(std::size_t m) const {
    return judged(m) ? fits_[m].fit.log_evidence + log_prior(m) : -std::numeric_limits<double>::infinity();
  }

  std::optional<std::size_t> best() const {
    std::optional<std::size_t> best;
    for (std::size_t m = 0; m < models_.size(); ++m)
      if (judged(m) && (!best || evidence(m) > evidence(*best))) best = m;
    return best;
  }

  /// To the last digits, with a solver that no longer shapes the best one's coefficients.
  void refine() {
    std::optional<std::size_t> const first = best();
    if (!first) return;
    fits_[*first] = at(*first, fits_[*first], halved_, true);
    for (int round = 0; round < most_refinements && solver(*first).fixed_step() && !interrupted_(); ++round) {
      int const before = substeps_;
      substeps_ = solver(*first).finer().substeps;
      Fitted const finer = at(*first, fits_[*first], halved_, true);
      double most = 0;
      if (!finer.fit.finite || !finer.fit.determined) break;
      for (Eigen::Index j = 0; j < finer.fit.point.coefficients.size(); ++j)
        most = std::max(most, std::abs(finer.fit.point.coefficients(j) - fits_[*first].fit.point.coefficients(j)) /
                                  std::sqrt(finer.fit.covariance(j, j)));
      if (most <= tolerable_move) {
        substeps_ = before;
        break;
      }
      fits_[*first] = finer;
    }
    for (std::size_t m = 0; m < models_.size(); ++m)
      if (judged(m) && m != *first && !interrupted_()) fits_[m] = at(m, fits_[m], halved_, true);
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (!judged(m)) continue;
      if (!fits_[m].fit.finite)
        fits_[m].failure = "does not stay finite";
      else if (!fits_[m].fit.determined)
        fits_[m].failure = "the motion does not tell its coefficients apart";
      else if (!fits_[m].fit.converged)
        fits_[m].failure = "its fit does not converge";
    }
  }

  void rank() {
    for (std::size_t m = 0; m < models_.size(); ++m) order_.push_back(m);
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return evidence(a) > evidence(b); });
    double sum = 0;
    for (std::size_t const m : order_)
      if (judged(m)) sum += fits_[m].probability = elementary::exp(evidence(m) - evidence(order_.front()));
    for (std::size_t const m : order_) fits_[m].probability /= sum;
  }

  // --- scores
  ForecastSettings forecast(std::size_t m) const {
    return {window_, horizon_, solver(m), source_.session.options.execution, pool_};
  }

  // Coefficients of rows that are not scored.
  ShootingFit before_aside(std::size_t m) const {
    std::vector<Segment> const all = segments(halved_);
    std::vector<Segment> parts;
    ShootingFit const& fit = fits_[m].fit;
    ShootingPoint point{fit.point.coefficients, fit.point.starts};
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (!seen_[static_cast<std::size_t>(all[s].experiment)]) continue;
      point.starts.col(static_cast<Eigen::Index>(parts.size())) = fit.point.starts.col(static_cast<Eigen::Index>(s));
      parts.push_back(all[s]);
    }
    point.starts.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(parts.size()));
    return fit_by_shooting(simulation(m, parts), std::move(point), options(true));
  }

  void score() {
    if (aside_.empty()) return;
    StartGuess guess(dictionary_.numbers, aside_, source_.discovery.noise_sd);
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (!judged(m) || interrupted_()) continue;
      ShootingFit const fit = split_ ? before_aside(m) : fits_[m].fit;
      if (fit.finite)
        fits_[m].errors =
            forecast_errors(models_[m], fit.point.coefficients, fits_[m].fit.noise_sd, views(m, aside_), guess, forecast(m));
    }
  }

  void check_stability() {
    std::vector<Experiment> whole;
    for (ExperimentData const& each : source_.data) whole.push_back(each.experiment);
    std::vector<Segment> const parts = segments(halved_);
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (!judged(m) || interrupted_()) continue;
      ShootingFit const& fit = fits_[m].fit;
      Eigen::Index const k = fit.point.coefficients.size();
      Eigen::MatrixXd const root = fit.covariance.llt().matrixL();
      std::vector<LaneArray> points;
      for (int const piece : begins_) {
        auto const s = static_cast<std::size_t>(
            std::find_if(parts.begin(), parts.end(), [&](Segment const& each) { return each.experiment == piece; }) -
            parts.begin());
        LaneArray at(models_[m].compiled->parameter_rows(), draws);
        for (int w = 0; w < draws; ++w) {
          Stream stream({source_.seed, Purpose::selection, static_cast<std::uint64_t>(w), 0});
          Eigen::VectorXd normal(k);
          for (Eigen::Index j = 0; j < k; ++j) normal(j) = stream.normal();
          Eigen::VectorXd const move = root * normal;
          Eigen::VectorXd const start = fit.point.starts.col(static_cast<Eigen::Index>(s)) + fit.follows[s] * move;
          auto const parameters = static_cast<int>(models_[m].others.size());
          for (int p = 0; p < parameters; ++p) at(p, w) = models_[m].others[static_cast<std::size_t>(p)];
          for (Eigen::Index j = 0; j < k; ++j)
            at(models_[m].coefficients[static_cast<std::size_t>(j)].parameter, w) = fit.point.coefficients(j) + move(j);
          for (Eigen::Index x = 0; x < start.size(); ++x) at(parameters + static_cast<int>(x), w) = start(x);
        }
        points.push_back(std::move(at));
      }
      fits_[m].bounded = bounded_runs(models_[m], views(m, whole), points, forecast(m));
    }
  }

  // --- the answer
  double scale(std::size_t equation, std::size_t term) const {
    auto const& unit = dictionary_.equations[equation].terms[term].unit;
    return unit ? unit->scale : 1;
  }

  JudgedStructure described(std::size_t m) const {
    JudgedStructure out;
    out.terms = structure_text(dictionary_, structures_[m]);
    out.of_regression = static_cast<int>(m) + 1;
    out.failure = models_[m].failure.empty() ? fits_[m].failure : models_[m].failure;
    if (!out.failure.empty()) return out;
    Fitted const& fitted = fits_[m];
    out.log_evidence = fitted.fit.log_evidence;
    out.log_prior = log_prior(m);
    out.probability = fitted.probability;
    out.draws = draws;
    out.bounded = fitted.bounded;
    out.follows = fitted.errors.follows;
    std::vector<std::vector<PrintedTerm>> printed(dictionary_.equations.size());
    for (std::size_t j = 0; j < models_[m].coefficients.size(); ++j) {
      JudgedModel::Coefficient const& of = models_[m].coefficients[j];
      auto const row = static_cast<Eigen::Index>(j);
      DictionaryEquation const& equation = dictionary_.equations[of.equation];
      DictionaryTerm const& term = equation.terms[of.term];
      double const unit = scale(of.equation, of.term);
      double const value = fitted.fit.point.coefficients(row) / unit, sd = std::sqrt(fitted.fit.covariance(row, row)) / unit;
      out.coefficients.push_back({equation.text, term.text, coefficient_names(dictionary_, static_cast<int>(of.equation))[of.term],
                                  term.unit ? term.unit->text : "", of.value / unit, of.sd / unit, value, sd});
      printed[of.equation].push_back({of.term, value, sd});
    }
    for (std::size_t e = 0; e < printed.size(); ++e) out.equations.push_back(equation_text(dictionary_.equations[e], printed[e]));
    for (std::size_t c = 0; c < models_[m].channels.size(); ++c) {
      Channel const& channel = dictionary_.measured.channels[models_[m].channels[c]];
      double const noise = source_.discovery.noise_sd[models_[m].channels[c]];
      JudgedChannel of{
          channel.name, channel.unit_text(), 0, channel.from_si(fitted.fit.noise_sd[c]), channel.from_si(noise), {}, {}, {}};
      if (noise > 0) out.residual_over_noise = std::max(out.residual_over_noise, fitted.fit.noise_sd[c] / noise);
      if (c < fitted.errors.sd.size()) {
        auto const declared = [&](std::optional<double> value) { return value ? std::optional(channel.from_si(*value)) : value; };
        of.sd = channel.from_si(fitted.errors.sd[c]);
        of.one_step = declared(fitted.errors.one_step[c]);
        of.horizon = declared(fitted.errors.horizon[c]);
        of.free_run = declared(fitted.errors.free_run[c]);
      }
      out.channels.push_back(std::move(of));
    }
    return out;
  }

  void report(Judgement& out) const {
    for (std::size_t const m : order_) {
      out.order.push_back(structures_[m]);
      out.report.structures.push_back(described(m));
    }
    JudgedReport& judged = out.report;
    std::vector<Segment> const parts = segments(halved_);
    judged.segments = static_cast<int>(parts.size());
    judged.shortest = std::numeric_limits<double>::infinity();
    for (Segment const& each : parts) {
      std::vector<double> const& time = pieces_[static_cast<std::size_t>(each.experiment)].time;
      double const length =
          time[static_cast<std::size_t>(each.first + each.count - 1)] - time[static_cast<std::size_t>(each.first)];
      judged.shortest = std::min(judged.shortest, length);
      judged.longest = std::max(judged.longest, length);
    }
    judged.whole = halved_ == 0;
    judged.step = step_;
    judged.horizon_rows = horizon_;
    judged.horizon = horizon_ * step_;
    judged.window_rows = window_;
    judged.aside = aside_name_;
    judged.aside_seen = split_;
    for (Experiment const& each : aside_)
      judged.aside_length = std::max(judged.aside_length, each.time.back() - each.time[static_cast<std::size_t>(window_ - 1)]);
    judged.solver = models_[order_.front()].failure.empty() ? solver(order_.front()).text() : "";
    find(out);
  }

  bool in_target(JudgedCoefficient const& coefficient) const {
    for (DictionaryEquation const& equation : dictionary_.equations)
      for (DictionaryTerm const& term : equation.terms)
        if (equation.text == coefficient.target && term.text == coefficient.term) return term.in_target;
    return false;
  }

  void find(Judgement& out) const {
    JudgedReport const& judged = out.report;
    JudgedStructure const& best = judged.structures.front();
    auto const add = [&](Severity severity, char const* code, std::string message, char const* help) {
      out.findings.push_back({severity, code, std::move(message), help});
    };
    auto const regression = std::find_if(judged.structures.begin(), judged.structures.end(),
                                         [](JudgedStructure const& each) { return each.of_regression == 1; });
    if (regression != judged.structures.begin())
      add(Severity::warning, "simulation_prefers",
          fmt::format("simulation ranks `{}` first, the regression `{}`, which {}", best.terms, regression->terms,
                      regression->failure.empty() ? fmt::format("has a log evidence of {} less over the motion",
                                                                significant(best.log_evidence - regression->log_evidence, 3))
                                                  : "was not judged: " + regression->failure),
          "the model that is written is the one that simulation ranks first; a record of other amplitude may decide");
    if (!best.failure.empty()) {
      add(Severity::warning, "not_refitted", fmt::format("no structure could be judged by simulation: {}", best.failure),
          "the coefficients are those of the regression: look at the record's length and step, and at terms that diverge");
      return;
    }
    std::string idle;
    for (JudgedCoefficient const& each : best.coefficients)
      if (!in_target(each) && std::abs(each.value) < idle_sds * each.sd)
        idle += fmt::format("{}`{}`{}", idle.empty() ? "" : ", ", each.term, best.equations.size() > 1 ? " of " + each.target : "");
    if (!idle.empty())
      add(Severity::warning, "term_idle", fmt::format("by the motion the coefficient of {} is less than two sds from zero", idle),
          "leave it out of the dictionary, or take a record in which it moves more");
    if (!judged.whole)
      add(Severity::note, "followed_in_parts",
          fmt::format("the record is followed for {} at a time, each from a start of its own",
                      significant(judged.longest, 3) + " s"),
          "expected of a chaotic motion; else a term or an input is missing");
    if (best.residual_over_noise > tolerable_residual)
      add(Severity::warning, "motion_unexplained",
          fmt::format("the residual of the simulated motion is {} times the measurement noise",
                      significant(best.residual_over_noise, 3)),
          "look for an input that was not recorded, a state that is missing, or add terms");
    if (best.bounded < best.draws)
      add(Severity::warning, "draws_not_bounded",
          fmt::format("{} of {} draws of the coefficients do not stay within ten times the range of the record in a free run",
                      best.draws - best.bounded, best.draws),
          "a term may destabilise where the record hardly goes: leave it out, or take a record of larger amplitude");
    std::optional<double> const far = best.percent(&JudgedChannel::horizon), free = best.percent(&JudgedChannel::free_run);
    if (free && !(*free < lost_percent))
      add(far && *far < lost_percent / 2 ? Severity::note : Severity::warning, "free_run_lost",
          fmt::format("a free run on {} is off by {} % of the sd; it follows for {} s", judged.aside,
                      std::isfinite(*free) ? significant(*free, 3) : "more than 1e4", significant(best.follows, 3)),
          "expected of a chaotic motion, which is foretold for a while only; else do not extrapolate");
  }

  FoundSource const& source_;
  std::vector<FoundStructure> structures_;
  std::function<bool()> const& interrupted_;
  CheckedDictionary const& dictionary_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<JudgedModel> models_;
  std::vector<Fitted> fits_;
  int substeps_ = 1;
  int states_ = 1;
  double step_ = 0;
  int horizon_ = 1, window_ = 1, least_ = 2;
  std::vector<Experiment> pieces_, aside_;  // with the dictionary's columns
  std::vector<bool> seen_;                  // per piece: not kept aside
  std::vector<int> begins_;                 // per experiment of the task its first piece
  bool split_ = false;
  std::string aside_name_;
  int most_halvings_ = 0, halved_ = 0;
  StartGuess* guess_ = nullptr;
  std::vector<std::size_t> order_;
};

}  // namespace

Judgement judge_structures(FoundSource const& source, std::vector<FoundStructure> structures,
                           std::vector<ExperimentData> const& aside, std::function<bool()> const& interrupted) {
  return Judge(source, std::move(structures), aside, interrupted).run();
}

}  // namespace sysid
