// Checks a text as the command line would, and finds its way on the page.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/preflight/check_file.hpp"
#include "core/system/files.hpp"
#include "load/load.hpp"

namespace sysid {

inline std::filesystem::path const models = std::filesystem::path(SYSID_SOURCE_DIR) / "models";

/// name: as if the text stood there, so that data beside it are found.
inline CheckResult checked(std::filesystem::path const& name, std::string const& text, RunOptions options = {}) {
  Source source(name.string(), text);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  if (!file) throw UserError(diagnostics.all().front());
  SilentProgress silent;
  std::ostream nowhere(nullptr);
  Session session(source, *file, options, silent, nowhere, nowhere);
  return check_file(session);
}

inline TaskPage const& task(CheckResult const& result, std::string const& name) {
  for (TaskPage const& page : result.page.tasks)
    if (page.name == name) return page;
  throw InternalError("no task " + name);
}

/// Of a fit; or of a candidate.
inline PreflightPage const& preflight(CheckResult const& result, std::string const& name, std::string const& candidate = "") {
  for (PreflightPage const& each : task(result, name).preflights)
    if (each.candidate == candidate) return each;
  throw InternalError("no preflight page of " + name + " " + candidate);
}

inline std::vector<std::string> messages(CheckResult const& result, std::string const& code) {
  std::vector<std::string> out;
  for (TaskPage const& page : result.page.tasks)
    for (Finding const& finding : page.all_findings())
      if (word(finding.code) == code) out.push_back(finding.message);
  return out;
}

inline std::string shipped(std::string const& name) { return read_file(models / name); }

}  // namespace sysid
