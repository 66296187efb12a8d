// The task's own solver, then dopri5 for all draws, then cvode for some of those that are still open.
#include "app/preflight/prior_simulations.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr double comparable = 1e-4;                                        // of a range that is compared within orders of magnitude
constexpr std::size_t explicit_steps = 200'000, implicit_steps = 200'000;  // in all: a lane each, all lanes together
constexpr std::size_t many_states = 64;
constexpr std::size_t fewest_steps = 20;  // between two samples: less is no attempt
constexpr std::size_t few_tried = 8;      // draws, which tell most from few

LaneArray gathered(ConstLanes from, std::vector<int> const& lanes) {
  LaneArray to(from.rows(), static_cast<int>(lanes.size()));
  for (int r = 0; r < to.rows(); ++r)
    for (std::size_t w = 0; w < lanes.size(); ++w) to(r, static_cast<int>(w)) = from(r, lanes[w]);
  return to;
}

class PriorSimulation {
 public:
  PriorSimulation(Session& session, FitTask const& what, std::shared_ptr<ParameterSpace const> const& space,
                  std::vector<Experiment> const& experiments, std::shared_ptr<CompiledModel const> const& compiled,
                  ConstLanes theta, ConstLanes points, PriorSimulations& result)
      : session_(session),
        what_(what),
        last_compiled_(compiled),
        last_solver_(what.solver),
        space_(space),
        experiments_(experiments),
        theta_(theta),
        points_(points),
        result_(result),
        pool_(make_pool(session.options.execution)) {
    for (Experiment const& each : experiments) samples_ += each.time.size();
  }

  // Tries the lanes; where the method follows one, its response is the answer. How many it follows.
  int attempt(SolverRow const& row, std::size_t budget, std::vector<int> const& lanes) {
    std::size_t const steps = budget / std::max<std::size_t>(1, samples_);
    if (lanes.empty() || steps < fewest_steps) return 0;
    std::string const method(row.name);
    auto const compiled = session_.compiled(what_, method);
    SolverSettings const solver{
        .method = method, .relative = comparable, .steps = static_cast<int>(std::min<std::size_t>(steps, 10'000))};
    LaneArray const theta = gathered(theta_, lanes);
    LaneArray points = gathered(points_, lanes);
    std::vector<double> density(lanes.size());
    Ledger ledger;
    make_fit_target(session_, what_, compiled, space_, experiments_, solver, session_.abandonable())
        ->log_likelihood(theta, density, ledger);
    last_compiled_ = compiled;
    last_solver_ = solver;
    Output const output(compiled, space_, experiments_, solver, start_rows(what_.start), session_.abandonable(), pool_);
    LaneArray centres(result_.centres.rows(), points.width());
    output.start(points);
    output.centres(points, centres);
    int followed = 0;
    for (std::size_t w = 0; w < lanes.size(); ++w) {
      if (!std::isfinite(density[w])) continue;
      ++followed;
      result_.followed[static_cast<std::size_t>(lanes[w])] = true;
      for (int r = 0; r < centres.rows(); ++r) result_.centres(r, lanes[w]) = centres(r, static_cast<int>(w));
    }
    return followed;
  }

  // All that are open share the budget; where it is too little for most of them, a few have all of it.
  void attempt_stiff() {
    std::vector<int> lanes = open();
    if (lanes.empty()) return;
    if (implicit_steps / lanes.size() >= fewest_steps * samples_) try_stiff(lanes, implicit_steps / lanes.size());
    if (2 * result_.stiff_followed > result_.stiff_tried) return;
    lanes = open();
    if (lanes.size() > few_tried) lanes.resize(few_tried);
    auto const compiled = last_compiled_;
    SolverSettings const solver = last_solver_;
    try_stiff(lanes, std::max(implicit_steps / lanes.size(), fewest_steps * samples_));
    if (result_.stiff_followed > 0) return;
    last_compiled_ = compiled;  // where it ends is the budget's fault
    last_solver_ = solver;
  }

  // Where the draws fail that nothing follows, each counted once.
  void trace() {
    constexpr std::size_t traced = 8;
    std::vector<int> lanes = open();
    std::size_t const all = lanes.size();
    if (!tried_stiff_.empty())  // the rest is not known to fail with the last solver
      std::erase_if(lanes,
                    [&](int lane) { return std::find(tried_stiff_.begin(), tried_stiff_.end(), lane) == tried_stiff_.end(); });
    auto const target =
        make_fit_target(session_, what_, last_compiled_, space_, experiments_, last_solver_, session_.abandonable());
    for (std::size_t i = 0; i < std::min(traced, lanes.size()); ++i) {
      double density = 0;
      Ledger solves;
      target->log_likelihood(gathered(theta_, {lanes[i]}), {&density, 1}, solves);
      if (solves.failures().empty()) {
        result_.ledger.add_failure(FailureClass::non_finite, "the likelihood of the simulated response", 0, {});
        continue;
      }
      Failure const& first = solves.failures().front();
      result_.ledger.add_failure(first.kind, first.where, first.time, first.example);
    }
    result_.untraced = static_cast<int>(all - std::min(traced, lanes.size()));
  }

  void try_stiff(std::vector<int> const& lanes, std::size_t budget) {
    result_.stiff_left = static_cast<int>(open().size());
    result_.stiff_followed = attempt(stiff_solver(), budget, lanes);
    result_.stiff_tried = static_cast<int>(lanes.size());
    tried_stiff_ = lanes;
  }

  // Those that nothing has followed so far.
  std::vector<int> open() const {
    std::vector<int> lanes;
    for (std::size_t w = 0; w < result_.followed.size(); ++w)
      if (!result_.followed[w]) lanes.push_back(static_cast<int>(w));
    return lanes;
  }

 private:
  Session& session_;
  FitTask const& what_;
  std::shared_ptr<CompiledModel const> last_compiled_;
  SolverSettings last_solver_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<Experiment> const& experiments_;
  ConstLanes theta_, points_;
  PriorSimulations& result_;
  std::shared_ptr<ThreadPool> pool_;
  std::size_t samples_ = 0;
  std::vector<int> tried_stiff_;
};

}  // namespace

PriorSimulations simulate_prior(Session& session, FitTask const& what, std::shared_ptr<CompiledModel const> const& compiled,
                                std::shared_ptr<ParameterSpace const> const& space, std::vector<Experiment> const& experiments,
                                Output const& stated, ConstLanes theta, ConstLanes points) {
  auto const width = static_cast<std::size_t>(theta.width());
  PriorSimulations result;
  result.centres = LaneArray(static_cast<int>(stated.places().size()), theta.width());
  result.followed.resize(width);
  result.density.resize(width);
  Ledger untold;
  make_fit_target(session, what, compiled, space, experiments, what.solver, session.abandonable())
      ->log_likelihood(theta, result.density, untold);
  stated.centres(points, result.centres);
  for (std::size_t w = 0; w < width; ++w) result.followed[w] = std::isfinite(result.density[w]);
  result.failed_as_stated = static_cast<int>(std::count(result.followed.begin(), result.followed.end(), false));
  result.failed_explicit = result.failed_as_stated;  // nothing is integrated, or nothing else tried
  Model const& model = compiled->model;
  PriorSimulation simulation(session, what, space, experiments, compiled, theta, points, result);
  bool const lost = result.failed_as_stated > 0;
  bool const exact = what.solver.row().exact;  // what it loses explicit steps lose, too
  if (model.integrated() && !model.implicit && (lost || (what.solver.fixed_step() && !exact))) {
    // Where adaptive steps begin they take a Jacobian, which many states make dear: there only what fixed steps lose is tried.
    std::vector<int> lanes(width);
    std::iota(lanes.begin(), lanes.end(), 0);
    if (model.states.size() > many_states || !what.solver.fixed_step()) lanes = simulation.open();
    if (!what.solver.row().stiff && !exact) simulation.attempt(adaptive_solver(), explicit_steps, lanes);
    result.failed_explicit = static_cast<int>(simulation.open().size());
    simulation.attempt_stiff();
  }
  simulation.trace();
  return result;
}

}  // namespace sysid
