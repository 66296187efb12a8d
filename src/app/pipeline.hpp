// The stages from text to results, one line each; and what the command line can ask of them.
#pragma once
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "app/modules.hpp"
#include "app/options.hpp"
#include "check/check.hpp"
#include "core/diagnostic.hpp"

namespace sysid {

class Session;

/// A file that passed the front end: its text, the checked models, data blocks and tasks.
struct Loaded {
  Source source;
  CheckedFile file;
};

/// Parses, puts modules and parts in, checks. Nothing when there are errors in `diagnostics`, which refer to `source`; the texts of
/// modules join it. IoError when a module cannot be read.
std::optional<CheckedFile> load(Source& source, Diagnostics& diagnostics, UnsavedText const& unsaved = {});

/// "fit": the verb that a task is written with.
std::string verb_of(Task const& task);

/// What `--dump STAGE` prints: ast, flat, model or program.
std::string dump_stage(Source& source, std::string const& stage, Diagnostics& diagnostics);

/// Runs the tasks of a file in order; verbs: which kinds ("simulate", "fit", "predict"); empty: all. Summaries go to `out`,
/// progress to `progress`, notices to `notices`. UserError, IoError and InternalError leave through the caller.
ExitCode run_tasks(Source const& source, CheckedFile const& file, std::vector<std::string> const& verbs, RunOptions const& options,
                   Progress& progress, std::ostream& out, std::ostream& notices);

/// Those tasks of a session that are asked for, in order; there is one at least.
ExitCode run_tasks(Session& session, std::function<bool(Task const&)> const& asked);

}  // namespace sysid
