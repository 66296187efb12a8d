// Verdict, files, terminal output and exit code of a finished fit.
#include "app/session/fit_end.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/session/reporting.hpp"
#include "core/system/files.hpp"
#include "diagnostics/convergence.hpp"
#include "diagnostics/residuals/residual_checks.hpp"
#include "diagnostics/verdict.hpp"
#include "model/simulated_parameters.hpp"

namespace sysid {

Diagnostic no_result(Task const& task, Finding const& failure) {
  std::string const code = failure.code == FindingCode::no_finite_start      ? "E5002"
                           : failure.code == FindingCode::improper_posterior ? "E6211"
                                                                             : "E6206";
  return {Severity::error, code, failure.message, Label{task.span, {}}, {}, failure.help};
}

// Of a fit of which nothing is kept whoever asked for it says what becomes of it.
ExitCode stop_early(Session& session, Task const& task, TaskCheckpoint const& checkpoint) {
  if (checkpoint.path().empty()) return ExitCode::interrupted;
  session.notices << fmt::format("{}: interrupted before the first kept draw; {} {}\n", task.name,
                                 to_resume(session.options.surface),
                                 checkpoint.kept() ? "continues from there" : "starts it again");
  return ExitCode::interrupted;
}

ExitCode stop_late(Session& session, Task const& task, TaskCheckpoint& checkpoint, Preparation const& preparation) {
  if (checkpoint.path().empty()) return ExitCode::interrupted;
  if (!checkpoint.kept()) checkpoint.save({{"preparation", store(preparation)}});
  session.notices << fmt::format("{}: interrupted before its result was checked; {} continues from there\n", task.name,
                                 to_resume(session.options.surface));
  return ExitCode::interrupted;
}

Findings failure_findings(Ledger const& sampling) {
  Severity const severity = failure_severity(sampling.failed(), sampling.solves());
  if (severity == Severity::note) return {};
  double const share = static_cast<double>(sampling.failed()) / static_cast<double>(sampling.solves());
  return {{FindingCode::failed_solves,
           severity,
           {},
           fmt::format("{:.1f} % of the simulations failed during sampling, first in {}", 100 * share,
                       sampling.failures().front().where),
           "the model diverges in a part of the posterior: narrow the prior, or check the equation there"}};
}

Summary of_column(Draws const& draws, std::size_t column) {
  ChainValues values;
  for (Chain const& chain : draws.chains) {
    values.emplace_back();
    for (auto const& draw : chain.values) values.back().push_back(draw[column]);
  }
  Summary summary = summarise(draws.names[column], draws.units[column], values);
  if (draws.is_optimum()) summary.sd = summary.mad = summary.q5 = summary.q95 = std::nan("");
  return summary;
}

std::vector<double> best_draw(Draws const& draws) {
  std::vector<double> const* const best = draws.best().values;
  return best == nullptr ? std::vector<double>{} : *best;
}

std::vector<std::string> noise_parameters(ParameterSpace const& space) {
  std::vector<bool> const simulated = simulated_parameters(space.model());
  std::vector<std::string> names;
  for (int const r : space.sampled()) {
    FittedParameter const& row = space.rows()[static_cast<std::size_t>(r)];
    if (!simulated[static_cast<std::size_t>(row.parameter)]) names.push_back(row.name);
  }
  return names;
}

ExitCode conclude_fit(Session& session, int index, Task const& task, TaskCheckpoint const& checkpoint, SolverSettings const& solver,
                      Report report, std::chrono::steady_clock::time_point began, bool interrupted) {
  Verdict const verdict = verdict_of(report.findings);
  report.verdict = verdict.headline;
  add_timing(session, began, report);
  keep_result(session, task, report);
  if (interrupted) {
    session.notices << fmt::format("{}: interrupted; continue with {}\n", task.name, to_resume(session.options.surface));
    return ExitCode::interrupted;
  }
  remove_file(checkpoint.path());
  session.fitted[index] = {std::move(report.draws), solver};
  return verdict.pass ? ExitCode::success : ExitCode::doubtful;
}

}  // namespace sysid
