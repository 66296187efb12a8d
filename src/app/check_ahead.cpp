// Prior draws with the actual input: do they simulate, are they of the size measured, which solver do they need, and what could the
// data tell about the parameters there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/check_file.hpp"
#include "app/check_information.hpp"
#include "app/settled_draws.hpp"
#include "app/tolerance.hpp"
#include "core/elementary.hpp"
#include "inference/convergence.hpp"
#include "report/number.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr int prior_draws = 128;
constexpr int looked_at = 8;                  // draws whose slopes are taken
constexpr int candidates = 24;                // draws among which those are looked for
constexpr double wild = 1000;                 // predicted and measured ranges this far apart: a wrong unit or a wild prior
constexpr double many_failures = 0.2;         // share of failed solves that deserves a warning
constexpr double right_enough = 1e-2;         // change of a response, of its size, when the solver is refined: good for slopes
constexpr double converged = 1e-3;            // at the last refinement: neither unstable nor chaotic
constexpr double tolerable_roughness = 1e-3;  // error of the slopes as a part of them
constexpr double smooth_enough = 1e-8;
constexpr std::size_t most_numbers = 1U << 23;
constexpr std::size_t most_scored = 10000;    // rows of an experiment that are looked at
constexpr std::size_t most_steps = 1U << 20;  // of one trajectory

// The experiment up to its so many scored rows: enough to look ahead, and done in a second.
Experiment shortened(Experiment experiment) {
  std::size_t rows = 0, counted = 0;
  while (rows < experiment.time.size() && counted < most_scored) counted += experiment.scored[rows++] != 0;
  if (rows == experiment.time.size()) return experiment;
  experiment.time.resize(rows);
  experiment.scored.resize(rows);
  for (InputSignal& input : experiment.inputs) input = input.view(0, static_cast<int>(rows));
  for (auto& channel : experiment.measured)
    if (!channel.empty()) channel.resize(rows);
  return experiment;
}

struct Draw {
  int lane;
  double mismatch;  // sum over channels of |log(predicted range / measured range)|
};

// A draw whose response an ever finer solver leaves where it is.
struct Converged {
  int lane;
  std::size_t level;       // the first solver whose response is right enough
  Eigen::MatrixXd errors;  // [R x solvers - 1] what each refinement changes, SI
};

// The largest part of a slope that is not known; parameters without influence apart.
double roughness(Sensitivity const& s) {
  double worst = s.nuisance_error;
  for (Eigen::Index p = 0; p < s.error.size(); ++p)
    if (double const length = s.slopes.col(p).norm(); length > 3 * s.error(p)) worst = std::max(worst, s.error(p) / length);
  return worst;
}

// By how many of its expected sds the worst parameter moves with the finer solver, to first order.
double move_of(LocalSlopes const& local, Eigen::Index level) {
  Eigen::VectorXd const change = local.sensitivity.others.col(level);
  if (!change.allFinite()) return std::numeric_limits<double>::infinity();
  Eigen::MatrixXd const slopes = local.sensitivity.slopes * local.spread.asDiagonal();
  Eigen::JacobiSVD<Eigen::MatrixXd> const svd(slopes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::VectorXd const s = svd.singularValues();
  Eigen::VectorXd const gain = s.array() / (s.array().square() + 1);
  Eigen::VectorXd const move = svd.matrixV() * gain.asDiagonal() * svd.matrixU().transpose() * change;
  return (move.cwiseAbs().array() / expect(local).shrinkage.array()).maxCoeff();
}

class LookAhead {
 public:
  LookAhead(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, TaskPage& page)
      : session_(session),
        what_(what),
        page_(page),
        compiled_(session.compiled(what.model, what.start.kind == StartRule::Kind::estimated, what.solver.method, what.prediction)),
        model_(compiled_->model),
        space_(parameter_space(model_, what.experiments)) {
    std::size_t longest = 0;
    for (ExperimentData const& each : data) {
      experiments_.push_back(shortened(each.experiment));
      longest = std::max(longest, experiments_.back().time.size());
      shortened_ = shortened_ || experiments_.back().time.size() < each.experiment.time.size();
    }
    // To 64 times the steps, fewer on records that would take long; to a 1e-4 of the tolerances. What no solver integrates is
    // exact as it stands.
    int refinements = !model_.integrated() ? 0 : what.solver.fixed_step() ? 6 : 2;
    while (refinements > 2 && (longest * static_cast<std::size_t>(what.solver.substeps)) << refinements > most_steps) --refinements;
    auto const pool = make_pool(session.options.execution);
    solvers_.push_back(what.solver);
    while (static_cast<int>(solvers_.size()) <= refinements) solvers_.push_back(solvers_.back().finer());
    for (SolverSettings const& solver : solvers_)
      outputs_.emplace_back(compiled_, space_, experiments_, solver, start_rows(what.start), session.options.execution, pool);
  }

  void run() {
    for (Parameter const& parameter : model_.parameters)
      if (parameter.prior && !parameter.prior->row->proper) {
        page_.left_out = fmt::format("what needs draws of the prior: that of {} is {}", parameter.name, parameter.prior->row->name);
        return;
      }
    draw_prior();
    std::vector<Draw> const sane = predict();
    if (sane.size() < 2) {
      page_.left_out = unlooked() + "no prior draws predict responses of the size measured";
      return;
    }
    look(sane);
  }

 private:
  void add(Severity severity, std::string code, std::string message, std::string help) {
    page_.findings.push_back({severity, std::move(code), std::move(message), std::move(help)});
  }

  std::string unlooked() const { return model_.integrated() ? "identifiability and the solver: " : "identifiability: "; }

  // Draws in SI, all rows of a point; what only the noise reads at its median, so that one level of noise stands for all.
  void draw_prior() {
    std::uint64_t const seed = session_.options.seed.value_or(what_.seed.value_or(1));
    LaneArray theta(space_->dimension(), prior_draws), declared(space_->dimension(), prior_draws);
    space_->sample_prior({seed, Purpose::prior, 0, 0}, theta);
    space_->constrain(theta, declared);
    std::vector<ParameterRole> const roles = parameter_roles(model_);
    std::vector<std::string> noise;
    for (int k = 0; k < space_->dimension(); ++k) {
      FittedParameter const& row = space_->rows()[static_cast<std::size_t>(space_->sampled()[static_cast<std::size_t>(k)])];
      ParameterInfo const& info = space_->infos()[static_cast<std::size_t>(k)];
      auto const values = declared.row(k);
      JudgedParameter coordinate{
          {row.name, info.unit, row.to_si(1)}, roles[static_cast<std::size_t>(row.parameter)], info.lower >= 0, 0};
      std::vector<double> scaled;
      for (double const value : values) scaled.push_back(coordinate.relative ? elementary::log(value) : row.to_si(value));
      coordinate.spread = (quantile(scaled, 0.84) - quantile(scaled, 0.16)) / 2;  // of the central 68 %: heavy tails leave it alone
      if (coordinate.role == ParameterRole::noise) {
        double const middle = quantile(std::vector<double>(values.begin(), values.end()), 0.5);
        std::fill(values.begin(), values.end(), middle);
        noise.push_back(fmt::format("{} = {}{}", row.name, significant(middle, 2), info.unit.empty() ? "" : " " + info.unit));
      }
      coordinates_.push_back(std::move(coordinate));
    }
    noise_ = listed(noise);
    LaneArray const values = space_->values_of_declared(declared);
    draws_ = LaneArray(outputs_.front().point_rows(), prior_draws);
    for (int r = 0; r < values.rows(); ++r)
      for (int w = 0; w < prior_draws; ++w) draws_(r, w) = values(r, w);
    outputs_.front().start(draws_);
    settled_ = settle_draws(session_, what_, compiled_, space_, experiments_, outputs_.front(), theta, draws_);
    PriorPage prior;
    prior.draws = prior_draws;
    prior.stated = what_.solver.text();
    prior.failed_as_stated = settled_.failed_as_stated;
    prior.failed = static_cast<int>(std::count(settled_.followed.begin(), settled_.followed.end(), false));
    if (prior.failed > 0) prior.failures = settled_.ledger.failures();
    page_.prior = std::move(prior);
  }

  // Ranges of all channels; the draws that predict them within a factor of `wild`, nearest first.
  std::vector<Draw> predict() {
    Output const& coarse = outputs_.front();
    std::vector<Draw> draws;
    for (int w = 0; w < prior_draws; ++w)
      if (settled_.followed[static_cast<std::size_t>(w)]) draws.push_back({w, 0});
    for (std::size_t first = 0, last = 0; first < coarse.places().size(); first = last) {
      Output::Place const& place = coarse.places()[first];
      while (last < coarse.places().size() && coarse.places()[last].experiment == place.experiment &&
             coarse.places()[last].channel == place.channel)
        ++last;
      compare(place, static_cast<int>(first), static_cast<int>(last), settled_.centres, draws);
    }
    double const share = static_cast<double>(page_.prior->failed) / prior_draws;
    double const lost = static_cast<double>(page_.prior->failed_as_stated - page_.prior->failed) / prior_draws;
    if (page_.prior->failed == prior_draws)
      add(Severity::error, "prior_fails", fmt::format("the simulation fails at every one of {} prior draws", prior_draws),
          "look at the priors, the units of the input and the equation at the place named");
    else if (share > many_failures)
      add(Severity::warning, "prior_fails", fmt::format("{:.0f} % of the simulations of prior draws fail", 100 * share),
          "narrow the priors, or look at the equation at the place named");
    if (!what_.settle && lost > many_failures)
      add(Severity::warning, "integration_step",
          fmt::format("with {} {:.0f} % of the prior draws leave the range of numbers that adaptive steps follow",
                      what_.solver.text(), 100 * lost),
          "the search does not see what fails: take shorter steps, or `solver = dopri5` or `cvode`");
    std::erase_if(draws, [](Draw const& draw) { return !std::isfinite(draw.mismatch); });
    std::stable_sort(draws.begin(), draws.end(), [](Draw const& a, Draw const& b) { return a.mismatch < b.mismatch; });
    return draws;
  }

  // One channel of one experiment: rows [first, last) of the predictions.
  void compare(Output::Place const& place, int first, int last, LaneArray const& centres, std::vector<Draw>& draws) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int r = first; r < last; ++r) {
      low = std::min(low, outputs_.front().places()[static_cast<std::size_t>(r)].measured);
      high = std::max(high, outputs_.front().places()[static_cast<std::size_t>(r)].measured);
    }
    double const measured = high - low;
    std::vector<double> finite;
    for (Draw& draw : draws) {
      low = high = centres(first, draw.lane);
      for (int r = first; r < last; ++r) {
        low = std::min(low, centres(r, draw.lane));
        high = std::max(high, centres(r, draw.lane));
      }
      double const predicted = high - low;
      if (std::isfinite(predicted)) finite.push_back(predicted);
      // A record that stays where it is says nothing of size.
      double const apart = measured > 0 ? std::abs(elementary::log(predicted / measured)) : 0 * predicted;
      draw.mismatch += apart <= elementary::log(wild) ? apart : std::nan("");
    }
    if (finite.empty()) return;
    Channel const& channel = model_.channels[static_cast<std::size_t>(place.channel)];
    std::string name = channel.name;
    if (experiments_.size() > 1) name += " on " + experiments_[static_cast<std::size_t>(place.experiment)].name;
    PriorPage::Channel line{name,
                            channel.unit_text(),
                            channel.from_si(quantile(finite, 0.05)),
                            channel.from_si(quantile(finite, 0.5)),
                            channel.from_si(quantile(finite, 0.95)),
                            channel.from_si(measured)};
    double const ratio = line.middle / line.measured;
    if (measured > 0 && (ratio > wild || ratio < 1 / wild))
      add(Severity::warning, "prior_far_from_data",
          fmt::format("half of the prior draws predict a range of {} {} times {} than the one measured", name,
                      significant(ratio > 1 ? ratio : 1 / ratio, 2), ratio > 1 ? "larger" : "smaller"),
          "look at the units of the data columns, and at priors that are wide or misplaced");
    page_.prior->channels.push_back(std::move(line));
  }

  void look(std::vector<Draw> const& sane) {
    if (std::none_of(coordinates_.begin(), coordinates_.end(),
                     [](JudgedParameter const& each) { return each.role == ParameterRole::response; })) {
      page_.left_out = unlooked() + "no sampled parameter enters the response";
      return;
    }
    std::vector<LocalSlopes> locals;
    std::vector<double> moves(solvers_.size() - 1, 0.0);
    for (Converged const& draw : converge(sane)) {
      if (static_cast<int>(locals.size()) == looked_at) break;
      LocalSlopes local = slopes_at(draw);
      if (!local.sensitivity.finite || roughness(local.sensitivity) > tolerable_roughness) continue;
      for (std::size_t level = 0; level < moves.size(); ++level)
        moves[level] = std::max(moves[level], move_of(local, static_cast<Eigen::Index>(level)));
      locals.push_back(std::move(local));
    }
    if (locals.size() < 2) {
      page_.left_out = unlooked() + "the response is not smooth in the parameters at the draws looked at";
      return;
    }
    page_.information.emplace();
    page_.information->draws = static_cast<int>(locals.size());
    page_.information->noise = noise_;
    if (shortened_) page_.information->rows = static_cast<int>(most_scored);
    describe_information(coordinates_, locals, measured_channels(), page_);
    if (!moves.empty()) describe_solvers(moves);
  }

  std::vector<Converged> converge(std::vector<Draw> const& sane) const {
    int const rows = static_cast<int>(outputs_.front().places().size());
    auto const refinements = static_cast<Eigen::Index>(solvers_.size()) - 1;
    // Many at once fill the lanes; long records leave room for fewer.
    int const most =
        std::clamp(static_cast<int>(most_numbers / (static_cast<std::size_t>(rows) * solvers_.size())), looked_at, candidates);
    int const width = std::min(most, static_cast<int>(sane.size()));
    LaneArray points(draws_.rows(), width), before(rows, width), now(rows, width);
    std::vector<Converged> all;
    for (int w = 0; w < width; ++w) {
      all.push_back({sane[static_cast<std::size_t>(w)].lane, solvers_.size(), Eigen::MatrixXd(rows, refinements)});
      for (int r = 0; r < points.rows(); ++r) points(r, w) = draws_(r, all.back().lane);
    }
    outputs_.front().centres(points, before);
    std::vector<double> last(all.size());
    for (int w = 0; w < width && refinements == 0; ++w) {
      all[static_cast<std::size_t>(w)].level = 0;
      for (int r = 0; r < rows; ++r) last[static_cast<std::size_t>(w)] += 0 * before(r, w);  // NaN where a solve failed
    }
    for (std::size_t level = 0; level + 1 < solvers_.size(); ++level) {
      outputs_[level + 1].centres(points, now);
      for (int w = 0; w < width; ++w) {
        Converged& draw = all[static_cast<std::size_t>(w)];
        double size = 0, change = 0, mean = 0;
        for (int r = 0; r < rows; ++r) mean += now(r, w) / rows;
        for (int r = 0; r < rows; ++r) {
          double const moved = now(r, w) - before(r, w);
          draw.errors(r, static_cast<Eigen::Index>(level)) = moved;
          change += moved * moved;
          size += (now(r, w) - mean) * (now(r, w) - mean);
        }
        last[static_cast<std::size_t>(w)] = std::sqrt(change / size);  // NaN where a solve failed
        if (last[static_cast<std::size_t>(w)] < right_enough) draw.level = std::min(draw.level, level);
      }
      std::swap(before, now);
    }
    std::vector<Converged> kept;
    for (std::size_t w = 0; w < all.size(); ++w)
      if (last[w] < converged) kept.push_back(std::move(all[w]));
    return kept;
  }

  // Slopes of the response in units of its noise; first states are nuisances.
  LocalSlopes slopes_at(Converged const& draw) const {
    // Slopes of adaptive steps need a tolerance far below the steps of their differences.
    std::size_t level = draw.level;
    while (!what_.solver.fixed_step() && level + 1 < solvers_.size() && solvers_[level].relative > smooth_enough) ++level;
    Output const& output = outputs_[level];
    int const rows = static_cast<int>(output.places().size()), all = draws_.rows();
    int const own = static_cast<int>(space_->rows().size());
    LaneArray here(all, 1);
    for (int r = 0; r < all; ++r) here(r, 0) = draws_(r, draw.lane);
    std::vector<double> const noise = output.noise(here), sizes = output.state_sizes(here);

    std::vector<int> moved;  // rows of the point
    std::vector<double> point, scale, spread;
    for (std::size_t k = 0; k < coordinates_.size(); ++k) {
      JudgedParameter const& coordinate = coordinates_[k];
      if (coordinate.role != ParameterRole::response) continue;
      moved.push_back(space_->sampled()[k]);
      point.push_back(here(moved.back(), 0));
      scale.push_back(coordinate.relative ? std::abs(point.back()) : coordinate.spread);
      spread.push_back(coordinate.relative ? coordinate.spread : 1);
    }
    auto const asked = static_cast<Eigen::Index>(moved.size());
    LocalSlopes local;
    local.value = Eigen::Map<Eigen::VectorXd const>(point.data(), asked);
    local.scale = Eigen::Map<Eigen::VectorXd const>(scale.data(), asked);
    local.spread = Eigen::Map<Eigen::VectorXd const>(spread.data(), asked);
    for (int r = own; r < all; ++r) {
      double const size = std::max(sizes[static_cast<std::size_t>(r - own)], std::abs(here(r, 0)));
      moved.push_back(r);
      point.push_back(here(r, 0));
      scale.push_back(size > 0 ? size : 1);
    }
    Eigen::MatrixXd errors = draw.errors;
    for (int r = 0; r < rows; ++r) {
      if (!(noise[static_cast<std::size_t>(r)] > 0)) return local;
      errors.row(r) /= noise[static_cast<std::size_t>(r)];
    }
    if (!(local.scale.array() > 0).all()) return local;
    auto const weighted = [&](ConstLanes points, Lanes out) {
      LaneArray whole(all, points.width());
      for (int r = 0; r < all; ++r)
        for (int w = 0; w < points.width(); ++w) whole(r, w) = here(r, 0);
      for (int i = 0; i < points.rows(); ++i)
        for (int w = 0; w < points.width(); ++w) whole(moved[static_cast<std::size_t>(i)], w) = points(i, w);
      output.centres(whole, out);
      for (int r = 0; r < rows; ++r)
        for (int w = 0; w < points.width(); ++w) out(r, w) /= noise[static_cast<std::size_t>(r)];
    };
    local.sensitivity = sensitivity(weighted, rows, point, scale, static_cast<int>(asked), errors);
    return local;
  }

  std::string measured_channels() const {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < model_.channels.size(); ++c)
      if (std::any_of(experiments_.begin(), experiments_.end(), [&](Experiment const& each) { return !each.measured[c].empty(); }))
        names.push_back(model_.channels[c].name);
    return listed(names);
  }

  void describe_solvers(std::vector<double> const& moves) {
    InformationPage& information = *page_.information;
    information.refinement = what_.solver.finer_words();
    if (!what_.settle) information.stated = what_.solver.text();
    for (std::size_t level = 0; level < moves.size(); ++level) {
      information.moves.emplace_back(solvers_[level].text(), moves[level]);
      if (moves[level] > tolerable_move) continue;
      information.advised = solvers_[level].text();
      break;
    }
    if (!what_.settle && moves.front() > tolerable_move)
      add(Severity::warning, "integration_step",
          fmt::format("with {} the solver shapes the result: with {} parameters move by up to {}", what_.solver.text(),
                      what_.solver.finer_words(), moves.front() > 5 ? "many sds" : fmt::format("{:.2g} sd", moves.front())),
          information.advised.empty() ? "leave its settings out and they are chosen"
                                      : fmt::format("take {}, or leave its settings out and they are chosen", information.advised));
  }

  Session& session_;
  FitTask const& what_;
  TaskPage& page_;
  std::shared_ptr<CompiledModel const> compiled_;
  Model const& model_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<Experiment> experiments_;
  bool shortened_ = false;
  std::vector<SolverSettings> solvers_;  // as stated, then ever finer
  std::vector<Output> outputs_;          // of each
  std::vector<JudgedParameter> coordinates_;
  LaneArray draws_;  // [point rows x prior_draws]
  SettledDraws settled_;
  std::string noise_;  // the level of noise taken, in words
};

}  // namespace

void look_ahead(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, TaskPage& page) {
  LookAhead(session, what, data, page).run();
}

}  // namespace sysid
