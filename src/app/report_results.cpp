// Folders to reports to one page.
#include "app/report_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/prior_density.hpp"
#include "core/diagnostic.hpp"
#include "core/files.hpp"
#include "report/html.hpp"
#include "report/result.hpp"
#include "report/stored.hpp"

namespace sysid {

namespace {

namespace fs = std::filesystem;

bool is_result(fs::path const& folder) { return fs::exists(folder / "summary.json") || fs::exists(folder / "report.cbor"); }

Report whole_result(fs::path const& folder) {
  if (!fs::exists(folder / "summary.json"))
    throw UserError({Severity::error,
                     "",
                     fmt::format("`{}` holds no whole result: it has no `summary.json`", folder.string()),
                     std::nullopt,
                     {},
                     "run the task again with --force"});
  Report report = read_result(folder);
  for (PriorInfo& prior : report.priors) add_density(prior);
  return report;
}

std::set<fs::path> task_folders(fs::path const& run) {
  std::set<fs::path> tasks;
  for (fs::directory_entry const& entry : fs::directory_iterator(run))
    if (entry.is_directory() && is_result(entry.path())) tasks.insert(entry.path());
  return tasks;
}

/// Of a run's tasks, in the order of its file.
std::vector<Report> reports_in(fs::path const& folder) {
  if (!fs::is_directory(folder)) throw IoError(fmt::format("there is no folder `{}`", folder.string()));
  std::vector<Report> reports;
  if (is_result(folder)) {
    reports.push_back(whole_result(folder));
    return reports;
  }
  for (fs::path const& task : task_folders(folder)) reports.push_back(whole_result(task));
  std::stable_sort(reports.begin(), reports.end(), [](Report const& a, Report const& b) { return a.place < b.place; });
  if (reports.empty())
    throw UserError({Severity::error,
                     "",
                     fmt::format("`{}` holds no results", folder.string()),
                     std::nullopt,
                     {},
                     "give the folder of a task, such as results/posterior, or of a whole run, such as results"});
  return reports;
}

}  // namespace

fs::path report_results(fs::path const& folder, std::optional<fs::path> const& output, bool pictures) {
  std::vector<Report> const reports = reports_in(folder);
  std::vector<ReportedTask> pages;
  for (Report const& report : reports) pages.push_back({report, drawn_figures(report, pictures)});
  fs::path path = output ? *output : folder / "report.html";
  std::string const page = is_result(folder) ? report_html(reports.front(), pages.front().figures) : run_html(pages);
  write_file(path, page);
  return path;
}

void redraw_figures(fs::path const& folder, std::vector<FigureFormat> const& formats) {
  (void)reports_in(folder);  // says what is wrong with any before the first is written
  for (fs::path const& task : is_result(folder) ? std::set{folder} : task_folders(folder)) {
    Report const report = whole_result(task);
    write_figures(drawn_figures(report, true), task, formats);
  }
}

}  // namespace sysid
