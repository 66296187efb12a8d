// Cuts the data to the examined rows, lists solvers from coarse to fine, and estimates the work.
#include "app/preflight/preflight.hpp"

#include <algorithm>

#include "app/preflight/rows_ahead.hpp"
#include "app/preflight/time_scales.hpp"
#include "app/session/fit_target.hpp"
#include "experiment/sticking.hpp"
#include "expression/switching.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr std::size_t most_steps = 1U << 20;  // of one trajectory
constexpr int enough_candidates = 12;         // fewer than that cost more than a refinement less
constexpr double most_work = 1.2e9;           // operations of the equations at the steps of all trajectories: about a second

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

// Operations of the equations along the records, with one step per sample.
double work_of(Model const& model, std::vector<Experiment> const& experiments) {
  std::vector<NodeId> roots = model.residuals;
  roots.insert(roots.end(), model.memories.begin(), model.memories.end());
  for (State const& state : model.states) roots.push_back(state.derivative);
  for (Channel const& channel : model.channels)
    roots.insert(roots.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  std::size_t samples = 0;
  for (Experiment const& each : experiments) samples += each.time.size();
  return static_cast<double>(model.graph.reachable(roots).size()) * static_cast<double>(samples);
}

// Shares of the work: a quarter for draws, each tried by several solvers; a quarter for finer and finer solvers; half for slopes,
// which take 16 trajectories for each coordinate.
Effort effort_of(double work, int coordinates, Effort effort) {
  double const trajectories = most_work / std::max(1.0, work);
  auto const within = [](double wanted, int least, int most) {
    return static_cast<int>(std::clamp(wanted, static_cast<double>(least), static_cast<double>(most)));
  };
  effort.prior_draws = within(trajectories / 4 / 8, 16, effort.prior_draws);
  auto const refined = [&] { return trajectories / 4 / static_cast<double>(1 << (effort.refinements + 1)); };
  while (effort.refinements > 2 && refined() < enough_candidates) --effort.refinements;
  effort.candidates = within(refined(), std::min(4, effort.candidates), effort.candidates);
  double const slopes = trajectories / 2 / (1 + 16.0 * coordinates);
  effort.examined = slopes < 1 ? 0 : within(slopes, 2, std::min(effort.examined, effort.candidates));
  return effort;
}

}  // namespace

Preflight::Preflight(Session& session, FitTask const& stated, std::vector<ExperimentData> const& data, PreflightPage& page)
    : session(session),
      stated(stated.solver),
      what(stated),
      page(page),
      compiled(session.compiled(what, what.solver.method)),
      space(parameter_space(compiled->model, what.experiments)),
      scales(time_scales_apart(session.file, compiled->model, *space, data)),
      sticking(sticking_advice(compiled->model, data)) {
  std::size_t longest = 0;
  for (ExperimentData const& each : data) {
    exact_steps = exact_steps && allows_exact_steps(each.experiment, model());
    experiments.push_back(slice(each.experiment, 0, rows_ahead(each.experiment, most_scored)));
    longest = std::max(longest, experiments.back().time.size());
    shortened = shortened || experiments.back().time.size() < each.experiment.time.size();
  }
  // To 64 times the steps, fewer on records that would take long; to a 1e-4 of the tolerances. What no solver integrates is exact
  // as it stands, and so is an exact step.
  effort.refinements = !model().integrated() || what.solver.row().exact ? 0 : what.solver.fixed_step() ? 6 : 2;
  while (effort.refinements > 2 && (longest * static_cast<std::size_t>(what.solver.substeps)) << effort.refinements > most_steps)
    --effort.refinements;
  step_work = work_of(model(), experiments) * what.solver.substeps;
  effort = effort_of(what.solver.row().in_program ? step_work : step_work * solver_work(), space->dimension(), effort);
  bound_steps();
  solvers.push_back(what.solver);
  while (static_cast<int>(solvers.size()) <= effort.refinements) solvers.push_back(solvers.back().finer());
  pool_ = make_pool(session.options.execution);
  outputs_ = std::vector<Lazily<Output>>(solvers.size());
  jumps_ = what.solver.fixed_step() && jumps(model());
}

// How many steps an adaptive solver takes between two samples only a trial shows: at few draws, along few rows. A stiff transient,
// which some draws have within one interval, is no reason.
void Preflight::bound_steps() {
  constexpr int tried_draws = 8, tried_rows = 16, fewest_steps = 100;
  if (!what.solver.row().adaptive || !model().integrated()) return;
  double const most_own_steps = what.solver.row().in_program ? 6e6 : 2e6;  // of all draws together: some seconds
  std::vector<Experiment> begun;
  double samples = 0;
  for (Experiment const& each : experiments) {
    begun.push_back(slice(each, 0, std::min(tried_rows, static_cast<int>(each.time.size()))));
    samples += static_cast<double>(each.time.size());
  }
  int const affordable = std::max(fewest_steps, static_cast<int>(most_own_steps / (samples * effort.prior_draws)));
  if (affordable >= what.solver.steps) return;
  SolverSettings bounded = what.solver;
  bounded.steps = affordable;
  LaneArray theta(space->dimension(), tried_draws);
  space->sample_prior({1, Purpose::start, 0, 0}, theta);
  std::vector<double> density(tried_draws);
  Ledger solves;
  make_fit_target(session, what, compiled, space, begun, bounded, session.abandonable())->log_likelihood(theta, density, solves);
  std::uint64_t too_many = 0;
  for (Failure const& each : solves.failures())
    if (each.kind == FailureClass::step_limit) too_many += each.count;
  if (2 * too_many > tried_draws * experiments.size()) what.solver.steps = affordable;
}

Output Preflight::output_of(std::shared_ptr<CompiledModel const> const& with_method, SolverSettings const& solver) const {
  return {with_method, space, experiments, solver, start_rows(what.start), session.abandonable(), pool_};
}

Output Preflight::output_along(std::vector<Experiment> const& along) const {
  return {compiled, space, along, solvers.front(), start_rows(what.start), session.abandonable(), pool_};
}

Output const& Preflight::output(std::size_t solver) const {
  return outputs_[solver].get([&] { return output_of(compiled, solvers[solver]); });
}

Output const* Preflight::output_on_jumps() const {
  if (!jumps_) return nullptr;
  return &on_jumps_.get([&] {
    SolverSettings const adaptive{.method = std::string(adaptive_solver().name), .relative = smooth_enough};
    return output_of(session.compiled(what, adaptive.method), adaptive);
  });
}

double Preflight::solver_work() const {
  SolverRow const& row = what.solver.row();
  return !row.adaptive ? 1 : row.in_program ? 10 : 200;
}

void Preflight::add(FindingCode code, Severity severity, std::vector<std::string> names, std::string message,
                    std::string help) const {
  if (code == FindingCode::integration_step && !sticking.empty()) help = sticking;
  if (code == FindingCode::prior_fails && !sticking.empty()) help = sticking + "; else " + help;
  page.findings.push_back({code, severity, std::move(names), std::move(message), std::move(help)});
}

std::vector<std::pair<int, int>> Preflight::responses() const {
  std::vector<std::pair<int, int>> all;
  std::vector<Output::Place> const& places = output().places();
  for (int r = 0; r < static_cast<int>(places.size()); ++r) {
    Output::Place const& place = places[static_cast<std::size_t>(r)];
    if (all.empty() || places[static_cast<std::size_t>(all.back().first)].experiment != place.experiment ||
        places[static_cast<std::size_t>(all.back().first)].channel != place.channel)
      all.emplace_back(r, r);
    all.back().second = r + 1;
  }
  return all;
}

}  // namespace sysid
