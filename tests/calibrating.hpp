// Calibrates the fits of a text as the command line would.
#pragma once
#include <filesystem>
#include <sstream>
#include <string>

#include "app/calibration/calibrate.hpp"
#include "core/system/files.hpp"
#include "load/load.hpp"

namespace sysid {

struct CalibrateResult {
  int exit = 0;
  std::string out, notices;
};

/// Front-end errors throw UserError with the first one. name: beside its data.
inline CalibrateResult calibrate_text(std::filesystem::path const& name, std::string const& text, RunOptions run,
                                      CalibrateOptions const& options) {
  run.figures = false;
  Source source(name.string(), text);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  if (!file) throw UserError(diagnostics.all().front());
  SilentProgress silent;
  std::ostringstream out, notices;
  Session session(source, *file, run, silent, out, notices);
  ExitCode const code = calibrate(session, options);
  return {static_cast<int>(code), out.str(), notices.str()};
}

}  // namespace sysid
