// Refusals first, then everything that is read of a session.
#include "exchange/stan_fit.hpp"

#include <fmt/format.h>

#include "app/session/reporting.hpp"

namespace sysid {
namespace {

/// The solver whose step a Stan program contains (stan_functions.cpp), beside the exact one.
constexpr std::string_view written_solver = "rk4";

void require_carried(Task const& task, FitTask const& what, Model const& model, SolverSettings const& solver) {
  if (!model.processes.empty())
    throw not_carried(task, fmt::format("`{}` is a Gaussian process over its rows", model.processes.front().name),
                      "an exported program contains no covariance between rows");
  if (what.start.kind == StartRule::Kind::estimated)
    throw not_carried(task, "its start is estimated inside the likelihood", "state `start = record` or `start = rest`");
  if (model.implicit)
    throw not_carried(task, "its equations are implicit in the highest derivatives", "write it without implicit equations");
  if (model.integrated() && solver.method != written_solver && !solver.row().exact)
    throw not_carried(task, fmt::format("it is integrated by {}", solver.method),
                      fmt::format("use `solver = {}`, with as many substeps as needed", written_solver));
}

}  // namespace

UserError not_carried(Task const& task, std::string const& reason, std::string help) {
  return UserError({Severity::error,
                    {},
                    fmt::format("`{}` cannot be written as a Stan program: {}", task.name, reason),
                    Label{task.span, {}},
                    {},
                    std::move(help)});
}

StanFit stan_fit(Session& session, Task const& task, SolverSettings const& solver) {
  FitTask const& what = std::get<FitTask>(task.what);
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  require_carried(task, what, model, solver);
  auto compiled = session.compiled(what, false, solver.method, what.prediction);
  if (compiled->model.filtered())
    throw not_carried(task, "its states are random", "write it without disturbances, random initial values and errors of inputs");
  if (!compiled->model.memories.empty())
    throw not_carried(task, "it uses values of previous rows", "write it without `since_last` and similar functions");
  auto space = parameter_space(compiled->model, what.experiments);
  auto data = load_experiments(session, what.experiments, model, what.start, what.prediction);
  auto priors = priors_of(*space, declared_priors(session, what.model));
  return {task, what, solver, std::move(compiled), std::move(space), std::move(data), std::move(priors)};
}

}  // namespace sysid
