// Reads the folders of results into reports and writes one page.
#include "app/run/report_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "app/comparison/compare.hpp"
#include "app/session/made_from.hpp"
#include "app/session/results.hpp"
#include "check/checked/task_kinds.hpp"
#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "experiment/prior_density.hpp"
#include "report/file/replacement.hpp"
#include "report/file/standing_files.hpp"
#include "report/file/stored_report.hpp"
#include "report/file/task_folder.hpp"
#include "report/page/comparison.hpp"
#include "report/page/html.hpp"

namespace sysid {

namespace {

namespace fs = std::filesystem;

bool is_result(fs::path const& folder) { return summary_stands(folder) || fs::exists(folder / "report.cbor"); }

Report whole_result(fs::path const& folder) {
  if (!summary_stands(folder)) throw no_complete_result(folder, run_again());
  Report report = read_result(folder);
  for (PriorInfo& prior : report.priors) add_density(prior);
  if (auto finding = made_from_earlier(folder)) report.findings.push_back(std::move(*finding));
  return report;
}

/// A task's result with where it lies.
struct StoredTask {
  fs::path folder;
  Report report;
};

struct StoredRun {
  std::vector<StoredTask> tasks;        // in the order of their file
  std::vector<std::string> unfinished;  // names of folders of which there is a checkpoint and no more
};

/// Of a task's folder, or of a whole run's.
StoredRun stored_run(fs::path const& folder) {
  if (!fs::is_directory(folder)) throw no_results_folder(folder);
  StoredRun run;
  if (is_result(folder)) {
    run.tasks.push_back({folder, whole_result(folder)});
    return run;
  }
  std::set<fs::path> found;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder))
    if (entry.is_directory()) found.insert(entry.path());
  for (fs::path const& task : found) {
    if (is_result(task))
      run.tasks.push_back({task, whole_result(task)});
    else if (fs::exists(checkpoint_path(task)))
      run.unfinished.push_back(task.filename().string());
  }
  std::stable_sort(run.tasks.begin(), run.tasks.end(),
                   [](StoredTask const& a, StoredTask const& b) { return a.report.place < b.report.place; });
  if (run.tasks.empty() && run.unfinished.empty()) {
    // What a run refuses to write over without being forced is not nothing.
    if (holds_result(folder)) throw no_complete_result(folder, run_again());
    for (fs::path const& task : found)
      if (holds_result(task)) throw no_complete_result(task, run_again());
    throw UserError({Severity::error,
                     "",
                     fmt::format("`{}` contains no results", folder.string()),
                     std::nullopt,
                     {},
                     "give the folder of a task, such as results/posterior, or of a whole run, such as results"});
  }
  return run;
}

/// What a fit's evidence is a density of; empty where the result does not say.
std::string samples_of(Report const& report) {
  std::string all;
  for (DataInfo const& data : report.data) {
    if (data.samples_sha256.empty()) return "";
    all += data.samples_sha256 + "\n";
  }
  return all;
}

/// Tables of fits that were fitted to the same samples and of predictions of the same ones, as `compare` makes them; and why not
/// all fits stand in one.
void add_comparisons(std::vector<StoredTask> const& tasks, RunReport& run) {
  std::vector<std::pair<std::string, std::vector<fs::path>>> fits;  // by their samples
  std::vector<fs::path> predictions;
  for (StoredTask const& task : tasks) {
    if (task.report.verb == row_of(TaskKind::predict).verb) predictions.push_back(task.folder);
    std::string const samples = samples_of(task.report);
    if (!task.report.evidence || !task.report.evidence->log_evidence || samples.empty()) continue;
    auto group = std::find_if(fits.begin(), fits.end(), [&](auto const& each) { return each.first == samples; });
    if (group == fits.end()) group = fits.insert(group, {samples, {}});
    group->second.push_back(task.folder);
  }
  auto const add = [&](std::vector<fs::path> const& folders) {
    if (folders.size() < 2) return;
    Comparison const comparison = compare(folders);
    std::vector<ReportTable> tables = comparison_tables(comparison);
    std::erase_if(tables, [](ReportTable const& table) { return table.rows.size() < 2; });
    if (tables.empty()) return;
    std::string& caption = tables.front().caption;
    for (std::string const& note : comparison.notes) caption += (caption.empty() ? "" : "\n") + note;
    std::move(tables.begin(), tables.end(), std::back_inserter(run.comparisons));
  };
  for (auto const& [samples, folders] : fits) add(folders);
  add(predictions);
  if (fits.size() > 1)
    run.apart =
        fmt::format("The fits use {} different sets of samples; evidences can be compared only within one set. ", fits.size());
}

}  // namespace

fs::path report_results(fs::path const& folder, std::optional<fs::path> const& output, bool pictures) {
  StoredRun const stored = stored_run(folder);
  RunReport run;
  for (StoredTask const& task : stored.tasks) run.tasks.push_back({task.report, drawn_figures(task.report, pictures)});
  fs::path path = output ? *output : folder / "report.html";
  if (is_result(folder)) {
    write_file(path, report_html(run.tasks.front().report, run.tasks.front().figures));
    return path;
  }
  run.unfinished = stored.unfinished;
  add_comparisons(stored.tasks, run);
  write_file(path, run_html(run));
  return path;
}

void redraw_figures(fs::path const& folder, std::vector<FigureFormat> const& formats) {
  // All are read before the first is written: what is wrong with any is said first.
  std::string words;
  for (StoredTask const& task : stored_run(folder).tasks)
    if (auto const undrawn = write_figures(drawn_figures(task.report, false), task.folder, formats); !undrawn.empty())
      words += fmt::format("{}`{}`: {}", words.empty() ? "" : "; ", task.folder.string(), undrawn_words(undrawn));
  if (!words.empty())
    throw UserError({Severity::error,
                     "",
                     words,
                     std::nullopt,
                     {},
                     "run gnuplot on one of the scripts, as its first line shows, to see the error"});
}

}  // namespace sysid
