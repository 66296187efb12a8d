// The stages from text to results, one line each; and the requests that the command line can make.
#pragma once
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "app/session/options.hpp"
#include "core/text/diagnostic.hpp"
#include "load/load.hpp"

namespace sysid {

class Session;

/// What `--dump STAGE` prints: ast, flat, model or program.
std::string dump_stage(Source& source, std::string const& stage, Diagnostics& diagnostics);

/// Runs the tasks of a file in order; verbs: which kinds ("simulate", "fit", "predict"); empty: all. Summaries go to `out`,
/// progress to `progress`, notices to `notices`. UserError, IoError and InternalError leave through the caller.
ExitCode run_tasks(Source const& source, CheckedFile const& file, std::vector<std::string> const& verbs, RunOptions const& options,
                   Progress& progress, std::ostream& out, std::ostream& notices);

/// Those tasks of a session that are asked for, in order; there is one at least.
ExitCode run_tasks(Session& session, std::function<bool(Task const&)> const& asked);

}  // namespace sysid
