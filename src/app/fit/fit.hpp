// `fit`: one flow for every kind of likelihood.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "inference/backend/backend.hpp"
#include "result/report.hpp"

namespace sysid {

ExitCode run_fit(Session& session, int index, Task const& task, FitTask const& what);

/// A fit that was asked for its draws and checks alone.
struct UnkeptFit {
  Report report;        // draws, summaries, findings, settings and ledger
  std::string backend;  // that drew them: what `auto` stands for
  double log_likelihood = 0;
  FitResult result;
};

/// The same way from the search to the checks, without a checkpoint or a file. Nothing where it was interrupted; UserError as
/// `run_fit`. at: declared values of the sampled parameters, of which `log_likelihood` is wanted under the fit's own solver; or
/// none. backend: the task's own, or another.
std::optional<UnkeptFit> fit_unkept(Session& session, int index, Task const& task, FitTask const& what, std::uint64_t seed,
                                    std::vector<double> const& at, BackendRow const* backend);

}  // namespace sysid
