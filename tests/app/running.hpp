// Runs a text as the command line would, in a folder of its own that goes with the object.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "app/run/pipeline.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "temporary_folder.hpp"

namespace sysid {

struct RunResult {
  int exit = 0;
  std::string out, notices;
};

/// `name` may lie in a folder with data; results go to options.output, progress nowhere unless somebody watches it. Front-end
/// errors throw UserError with the first one.
inline RunResult run_text(std::filesystem::path const& name, std::string const& text, RunOptions options,
                          std::vector<std::string> const& verbs = {}, Progress* progress = nullptr) {
  options.figures = false;
  Source source(name.string(), text);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  if (!file) throw UserError(diagnostics.all().front());
  SilentProgress silent;
  std::ostringstream out, notices;
  ExitCode const code = run_tasks(source, *file, verbs, options, progress == nullptr ? silent : *progress, out, notices);
  return {static_cast<int>(code), out.str(), notices.str()};
}

/// A text run in a folder of its own beside the files that it reads; results stay as long as this.
struct CaseRun {
  TemporaryFolder folder;
  RunResult result;

  CaseRun(std::string const& text, std::vector<std::pair<std::string, std::string>> const& files) {
    for (auto const& [name, content] : files) write_file(folder.path() / name, content);
    RunOptions options;
    options.output = folder.path() / "results";
    result = run_text(folder.path() / "case.sysid", text, options);
  }
  std::string file(std::string const& name) const { return read_file(folder.path() / "results" / name); }
  nlohmann::json summary(std::string const& task) const { return nlohmann::json::parse(file(task + "/summary.json")); }
};

/// The entry of a parameter in a summary.
inline nlohmann::json parameter(nlohmann::json const& summary, std::string const& name) {
  for (auto const& [key, value] : summary.at("parameters").items())
    if (key == name || (value.is_object() && value.contains("name") && value.at("name") == name)) return value;
  throw std::out_of_range("no parameter " + name);
}

/// `text` without any occurrence of `part`.
inline std::string without(std::string text, std::string const& part) {
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at)) text.erase(at, part.size());
  return text;
}

/// `text` with every occurrence of `from` replaced; there is one.
inline std::string with(std::string text, std::string const& from, std::string const& to) {
  if (text.find(from) == std::string::npos) throw std::runtime_error("nothing to replace: " + from);
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
  return text;
}

}  // namespace sysid
