// A folder with a summary is a task's; one that holds such folders is a run's.
#include "exchange/results_folder.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/system/files.hpp"
#include "exchange/refused.hpp"
#include "report/file/replacement.hpp"
#include "report/file/standing_files.hpp"

namespace sysid {
namespace {

namespace fs = std::filesystem;

/// Where a folder comes from nobody knows: what it names is read, and quoted in messages, only if it is called a model.
std::string recorded_file(fs::path const& folder) {
  if (!fs::exists(folder / "timing.json")) return {};
  auto const timing = nlohmann::json::parse(read_regular_file(folder / "timing.json"), nullptr, false);
  std::string const file =
      timing.is_object() && timing.contains("file") && timing["file"].is_string() ? timing["file"].get<std::string>() : "";
  return file.ends_with(".sysid") ? file : "";
}

/// Without a slash behind it; `.` and `..` by their names.
fs::path named(fs::path const& folder) {
  fs::path given = folder.lexically_normal();
  if (!given.has_filename()) given = given.parent_path();
  bool const nameless = given.empty() || given.filename() == "." || given.filename() == "..";
  return nameless ? fs::canonical(folder) : given;
}

ResultsFolder one_task(fs::path const& folder) {
  ResultsFolder found;
  found.one_task = true;
  found.results.push_back(read_stored_result(folder));
  found.run = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  found.file = recorded_file(folder);
  return found;
}

}  // namespace

ResultsFolder find_results(fs::path const& folder) {
  if (fs::is_regular_file(folder))
    throw refused(fmt::format("`{}` is a file, not a folder of results", folder.string()),
                  "run the file and give the folder of its results, or add --stan or --latex");
  if (!fs::is_directory(folder)) throw no_results_folder(folder);
  fs::path const given = named(folder);
  if (summary_stands(given)) return one_task(given);
  ResultsFolder found;
  found.run = given;
  std::set<fs::path> tasks;
  for (fs::directory_entry const& entry : fs::directory_iterator(given))
    if (summary_stands(entry.path())) tasks.insert(entry.path());
  for (fs::path const& task : tasks) {
    found.results.push_back(read_stored_result(task));
    if (found.file.empty()) found.file = recorded_file(task);
  }
  if (tasks.empty() && holds_result(given)) throw no_complete_result(folder, run_again());
  if (tasks.empty())
    throw refused(fmt::format("`{}` contains no results", folder.string()),
                  "give the folder of a task, such as results/posterior, or of a whole run, such as results");
  return found;
}

int find_task(Session& session, StoredResult const& stored) {
  for (std::size_t t = 0; t < session.file.tasks.size(); ++t) {
    Task const& task = session.file.tasks[t];
    if (task.name != stored.task()) continue;
    session.find_results_in(stored.folder, task);
    return static_cast<int>(t);
  }
  throw refused(
      fmt::format("`{}` contains results of the task `{}`, but `{}` has no such task", stored.folder.string(), stored.task(),
                  session.source.name()),
      "name the .sysid file of these results with --model FILE, or use --draws 0 to export only what the folder contains");
}

}  // namespace sysid
