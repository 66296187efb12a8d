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
#include "expression/switching.hpp"
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
constexpr double bare_mention = 3.2;          // a Bayes factor "not worth more than a bare mention" (Kass and Raftery 1995)
constexpr double visible_shift = 0.05;        // of the distance that noise leaves; what a selection checks at its end
constexpr double gross_move = 0.1;            // of a response's sd: an nmse of 1, which a model is called excellent below
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
  double moved;            // by the first: of a channel's response, the largest part of its sd
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

// Whether states switch an equation from one branch to another that does not begin where the first ends. A fixed step that passes
// the place makes no difference between a little earlier and a little later: the response is constant in what moves the place, but
// for leaps from one step to the next, and its slopes mean nothing.
bool jumps(Model const& model) {
  if (!model.integrated() || model.implicit) return false;
  Graph graph = model.graph;
  std::vector<NodeId> derivatives;
  for (State const& state : model.states) derivatives.push_back(state.derivative);
  std::vector<SwitchingSurface> const surfaces = switching_surfaces(graph, derivatives);
  return std::any_of(surfaces.begin(), surfaces.end(),
                     [](SwitchingSurface const& each) { return each.reads_states && each.jumps; });
}

// The middle one; what is not finite comes last.
double middle(std::vector<double> values) {
  for (double& value : values)
    if (!std::isfinite(value)) value = std::numeric_limits<double>::infinity();
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

class LookAhead {
 public:
  LookAhead(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, Outlook& page)
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
    if (what.solver.fixed_step() && jumps(model_))
      on_jumps_.emplace(session.compiled(what.model, what.start.kind == StartRule::Kind::estimated, "dopri5", what.prediction),
                        space_, experiments_, SolverSettings{.method = "dopri5", .relative = smooth_enough}, start_rows(what.start),
                        session.options.execution, pool);
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

  bool candidate() const { return !page_.candidate.empty(); }
  // Whether the task makes the solver finer until it settles the result: fits do, selections take theirs as it is.
  bool settles() const { return what_.settle && !candidate(); }

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

  // Rows [first, end) of the predictions: one channel of one experiment each.
  std::vector<std::pair<int, int>> responses() const {
    std::vector<std::pair<int, int>> all;
    std::vector<Output::Place> const& places = outputs_.front().places();
    for (int r = 0; r < static_cast<int>(places.size()); ++r) {
      Output::Place const& place = places[static_cast<std::size_t>(r)];
      if (all.empty() || places[static_cast<std::size_t>(all.back().first)].experiment != place.experiment ||
          places[static_cast<std::size_t>(all.back().first)].channel != place.channel)
        all.emplace_back(r, r);
      all.back().second = r + 1;
    }
    return all;
  }

  // Ranges of all channels; the draws that predict them within a factor of `wild`, nearest first.
  std::vector<Draw> predict() {
    Output const& coarse = outputs_.front();
    std::vector<Draw> draws;
    for (int w = 0; w < prior_draws; ++w)
      if (settled_.followed[static_cast<std::size_t>(w)]) draws.push_back({w, 0});
    for (auto const& [first, end] : responses())
      compare(coarse.places()[static_cast<std::size_t>(first)], first, end, settled_.centres, draws);
    double const share = static_cast<double>(page_.prior->failed) / prior_draws;
    double const lost = static_cast<double>(page_.prior->failed_as_stated - page_.prior->failed) / prior_draws;
    if (page_.prior->failed == prior_draws)
      add(Severity::error, "prior_fails", fmt::format("the simulation fails at every one of {} prior draws", prior_draws),
          "look at the priors, the units of the input and the equation at the place named");
    else if (share > many_failures)
      add(!candidate() || 1 / (1 - share) > bare_mention ? Severity::warning : Severity::note, "prior_fails",
          fmt::format("{:.0f} % of the simulations of prior draws fail{}", 100 * share,
                      candidate() ? fmt::format(": they cost the candidate a factor of {:.2g} in probability, if all else is equal",
                                                1 / (1 - share))
                                  : ""),
          "narrow the priors, or look at the equation at the place named");
    if (!settles() && lost > many_failures)
      add(Severity::warning, "integration_step",
          fmt::format("with {} {:.0f} % of the prior draws leave the range of numbers that adaptive steps follow",
                      what_.solver.text(), 100 * lost),
          fmt::format("{}: take shorter steps, or `solver = dopri5` or `cvode`",
                      candidate() ? "what fails is never accepted" : "the search does not see what fails"));
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
    std::vector<double> response_moves, shifts;
    for (Converged const& draw : converge(sane)) {
      if (static_cast<int>(locals.size()) == looked_at) break;
      double shift = 0;
      LocalSlopes local = slopes_at(draw, shift);
      if (!local.sensitivity.finite || roughness(local.sensitivity) > tolerable_roughness) continue;
      for (std::size_t level = 0; level < moves.size(); ++level)
        moves[level] = std::max(moves[level], move_of(local, static_cast<Eigen::Index>(level)));
      locals.push_back(std::move(local));
      response_moves.push_back(draw.moved);
      shifts.push_back(shift);
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
    if (moves.empty()) return;
    describe_solvers(moves);
    if (candidate()) describe_distances(middle(std::move(response_moves)), middle(std::move(shifts)));
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
      all.push_back({sane[static_cast<std::size_t>(w)].lane, solvers_.size(), Eigen::MatrixXd(rows, refinements), 0});
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
        double& moved = last[static_cast<std::size_t>(w)];
        moved = 0;
        for (auto const& [first, end] : responses()) {
          double size = 0, change = 0, mean = 0;
          for (int r = first; r < end; ++r) mean += now(r, w) / (end - first);
          for (int r = first; r < end; ++r) {
            double const difference = now(r, w) - before(r, w);
            draw.errors(r, static_cast<Eigen::Index>(level)) = difference;
            change += difference * difference;
            size += (now(r, w) - mean) * (now(r, w) - mean);
          }
          double const part = change == 0 ? 0 : std::sqrt(change / size);  // NaN where a solve failed
          if (!(part <= moved)) moved = part;
        }
        if (level == 0) draw.moved = moved;
        if (last[static_cast<std::size_t>(w)] < right_enough) draw.level = std::min(draw.level, level);
      }
      std::swap(before, now);
    }
    std::vector<Converged> kept;
    for (std::size_t w = 0; w < all.size(); ++w)
      if (last[w] < converged) kept.push_back(std::move(all[w]));
    return kept;
  }

  // Slopes of the response in units of its noise; first states are nuisances. shift: mean square, in the same units, of what the
  // first refinement changes.
  LocalSlopes slopes_at(Converged const& draw, double& shift) const {
    // Slopes of adaptive steps need a tolerance far below the steps of their differences.
    std::size_t level = draw.level;
    while (!what_.solver.fixed_step() && level + 1 < solvers_.size() && solvers_[level].relative > smooth_enough) ++level;
    Output const& output = on_jumps_ ? *on_jumps_ : outputs_[level];
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
    if (errors.cols() > 0) shift = errors.col(0).squaredNorm() / rows;
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
    if (!settles()) information.taken = what_.solver.text();
    for (std::size_t level = 0; level < moves.size(); ++level) {
      information.moves.emplace_back(solvers_[level].text(), moves[level]);
      if (moves[level] > tolerable_move) continue;
      information.advised = solvers_[level].text();
      break;
    }
    if (!what_.settle && !candidate() && moves.front() > tolerable_move)
      add(Severity::warning, "integration_step",
          fmt::format("with {} the solver shapes the result: with {} parameters move by up to {}", what_.solver.text(),
                      what_.solver.finer_words(), moves.front() > 5 ? "many sds" : fmt::format("{:.2g} sd", moves.front())),
          information.advised.empty() ? "leave its settings out and they are chosen"
                                      : fmt::format("take {}, or leave its settings out and they are chosen", information.advised));
  }

  // What a selection compares are distances, and its thresholds end where noise or the best model leaves them: so the integrator is
  // judged by what it does to those.
  void describe_distances(double response_move, double shift) {
    page_.information->response_move = response_move;
    std::string const help =
        page_.information->advised.empty() ? "take a finer solver" : fmt::format("take {}", page_.information->advised);
    if (!(response_move <= gross_move))
      add(Severity::warning, "integration_step",
          fmt::format("with {} the solver shapes the distances: {} moves the middle response by {} of its sd", what_.solver.text(),
                      what_.solver.finer_words(),
                      std::isfinite(response_move) ? fmt::format("{:.2g} %", 100 * response_move) : "more than all"),
          help);
    else if (noise_.empty() && shift > visible_shift)
      add(Severity::warning, "integration_step",
          fmt::format("with {} the solver shapes the distances: {} moves them by {:.2g} of what the stated noise leaves",
                      what_.solver.text(), what_.solver.finer_words(), shift),
          help);
  }

  Session& session_;
  FitTask const& what_;
  Outlook& page_;
  std::shared_ptr<CompiledModel const> compiled_;
  Model const& model_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<Experiment> experiments_;
  bool shortened_ = false;
  std::vector<SolverSettings> solvers_;  // as stated, then ever finer
  std::vector<Output> outputs_;          // of each
  std::optional<Output> on_jumps_;       // ends its steps where the equations jump
  std::vector<JudgedParameter> coordinates_;
  LaneArray draws_;  // [point rows x prior_draws]
  SettledDraws settled_;
  std::string noise_;  // the level of noise taken, in words
};

}  // namespace

void look_ahead(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, Outlook& page) {
  LookAhead(session, what, data, page).run();
}

}  // namespace sysid
