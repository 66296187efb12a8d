// Errors as the command line prints them: text or JSON, and their exit code.
#pragma once
#include <functional>
#include <iostream>
#include <string>

#include "app/session/options.hpp"
#include "core/text/diagnostic.hpp"
#include "load/load.hpp"

namespace sysid::cli {

struct Messages {
  bool json = false;               // one object per message and line
  std::ostream* out = &std::cerr;  // a verb may print messages as part of its answer

  void show(Diagnostics const& diagnostics, Source const& source) const;
  /// What concerns no place in a text: "sysid: error: cannot read ...".
  void complain(std::string message, std::string help = {}) const;
};

/// Does `work`. What it throws is said, with places in `source`, and has its exit code here.
ExitCode guarded(Messages const& messages, Source const& source, std::function<ExitCode()> const& work);

/// IoError where it cannot be read.
Source read_source(std::string const& path);

/// Reads and checks the file at `path` and does `work` with it; `said` is what the front end said of it, shown already. Errors end
/// here, with their exit code.
ExitCode with_checked_file(Messages const& messages, std::string const& path,
                           std::function<ExitCode(Source const&, CheckedFile const&, Diagnostics const& said)> const& work);

}  // namespace sysid::cli
