// What the program answers to a .sysid text: front end, data, tasks; as rendered messages and an exit code.
#pragma once
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "app/run/pipeline.hpp"
#include "app/session/preconditions.hpp"
#include "experiment/experiments.hpp"
#include "temporary_folder.hpp"

namespace sysid::test {

inline std::filesystem::path const error_examples = std::filesystem::path(SYSID_SOURCE_DIR) / "tests/golden/errors";

/// Data paths are relative to the folder of the .sysid file, here the current one.
class WorkingFolder {
 public:
  explicit WorkingFolder(std::filesystem::path const& folder) : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder);
  }
  ~WorkingFolder() { std::filesystem::current_path(before_); }
  WorkingFolder(WorkingFolder const&) = delete;
  WorkingFolder& operator=(WorkingFolder const&) = delete;

 private:
  std::filesystem::path before_;
};

inline std::string content(std::filesystem::path const& path) {
  std::ifstream const in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

inline void write(std::filesystem::path const& path, std::string const& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

/// How far a file is taken.
enum class Depth {
  front,  // as `sysid check` does
  data,   // and the data of each fit are read and cut
  run,    // as `sysid run` does
};

struct Answer {
  std::string messages;
  ExitCode exit = ExitCode::success;
};

/// Exit codes and messages as the command line gives them. output: stands as OUT in messages.
inline Answer answer(std::string const& name, std::string const& text, Depth depth, std::filesystem::path const& output,
                     RunOptions options = {}, std::vector<std::string> const& verbs = {}) {
  Source source(name, text);
  Diagnostics diagnostics;
  Answer answer;
  auto const failed = [&](Diagnostic const& diagnostic, ExitCode exit) {
    diagnostics.add(diagnostic);
    answer.exit = exit;
  };
  std::string unlocated;
  try {
    auto const file = load(source, diagnostics);
    if (!file) answer.exit = ExitCode::user_error;
    if (file && depth == Depth::data) {
      SilentProgress progress;
      std::ostringstream ignored;
      Session session(source, *file, options, progress, ignored, ignored);
      check_preconditions(session, [](Task const& task) { return std::holds_alternative<FitTask>(task.what); }).require();
    }
    if (file && depth == Depth::run) {
      SilentProgress progress;
      std::ostringstream summaries, notices;
      options.output = output;
      options.figures = false;
      if (!options.seed) options.seed = 1;
      answer.exit = run_tasks(source, *file, verbs, options, progress, summaries, notices);
    }
  } catch (UnusableData const& error) {
    for (Diagnostic const& each : error.diagnostics().all()) failed(each, ExitCode::user_error);
  } catch (UserError const& error) {
    failed(error.diagnostic(), ExitCode::user_error);
  } catch (UnreadableData const& error) {
    for (Diagnostic const& each : error.diagnostics().all()) failed(each, ExitCode::io);
  } catch (IoError const& error) {
    unlocated = std::string("sysid: error: ") + error.what() + "\nhelp: " + error.help() + "\n";
    answer.exit = ExitCode::io;
  }
  answer.messages = render(diagnostics, source) + unlocated;
  std::string const folder = output.string();
  for (std::size_t at = answer.messages.find(folder); !folder.empty() && at != std::string::npos; at = answer.messages.find(folder))
    answer.messages.replace(at, folder.size(), "OUT");
  return answer;
}

inline std::size_t count(std::string const& text, std::string const& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

}  // namespace sysid::test
