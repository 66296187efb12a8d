// Result folders.
#include "report/file/task_folder.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <vector>

#include "core/system/digest.hpp"
#include "core/system/files.hpp"
#include "core/text/told_apart.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/gnuplot.hpp"
#include "report/file/calibration.hpp"
#include "report/file/csv.hpp"
#include "report/file/discovery.hpp"
#include "report/file/function.hpp"
#include "report/file/report_cbor.hpp"
#include "report/file/result_files.hpp"
#include "report/file/selection.hpp"
#include "report/file/summary_json.hpp"
#include "report/page/html.hpp"

namespace sysid {

namespace {

namespace fs = std::filesystem;

bool is_result_file(std::string const& name, std::string const& task) {
  return result_file_row(name) != nullptr || is_exported_file(name, task);
}

bool is_figure_file(std::string const& name) {
  for (char const* ending : {".svg", ".png", ".pdf", ".txt", ".gnuplot"})
    if (name.ends_with(ending)) return true;
  return false;
}

std::string task_of(fs::path const& folder) { return (folder / "").lexically_normal().parent_path().filename(); }

std::vector<fs::path> files_of_result(fs::path const& folder) {
  std::vector<fs::path> out;
  std::error_code ignored;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder, ignored))
    if (is_result_file(entry.path().filename(), task_of(folder))) out.push_back(entry.path());
  for (fs::directory_entry const& entry : fs::directory_iterator(folder / "figures", ignored))
    if (is_figure_file(entry.path().filename())) out.push_back(entry.path());
  return out;
}

}  // namespace

bool holds_result(fs::path const& folder) { return !files_of_result(folder).empty() || fs::exists(folder / tracked_rows); }

void require_no_result(fs::path const& folder) {
  if (holds_result(folder))
    throw UserError(result_error("", fmt::format("`{}` already contains results", folder.string()), replace_results()));
}

namespace {

/// The summary first: where it stands, the result is whole.
void remove_summary(fs::path const& folder) {
  if (std::error_code ignored; fs::exists(folder / "summary.json", ignored)) remove_file(folder / "summary.json");
}

}  // namespace

void remove_result(fs::path const& folder, fs::path const& but) {
  if (folder / "summary.json" != but) remove_summary(folder);
  for (fs::path const& file : files_of_result(folder))
    if (file != but) remove_file(file);
  if (folder / tracked_rows != but) remove_file(folder / tracked_rows);
}

void remove_partial(fs::path const& folder) {
  std::vector<fs::path> left;
  std::error_code ignored;
  auto const look = [&](fs::path const& where, auto const& written) {
    for (fs::directory_entry const& entry : fs::directory_iterator(where, ignored)) {
      fs::path const whole = entry.path().parent_path() / entry.path().stem();
      if (entry.path() == partial_path(whole) && written(whole.filename().string())) left.push_back(entry.path());
    }
  };
  look(folder, [&](std::string const& name) {
    return is_result_file(name, task_of(folder)) || name == "checkpoint.cbor" || name == "claim" || name == tracked_rows;
  });
  look(folder / "figures", &is_figure_file);
  for (fs::path const& file : left) remove_file(file);
}

std::vector<std::string> write_result(Report const& report, fs::path const& folder, std::vector<FigureFormat> const& pictures) {
  make_folder(folder);
  // What takes long is made while the results of before still stand.
  std::vector<DrawnFigure> const drawn = drawn_figures(report, !pictures.empty());
  std::string const page = report_html(report, drawn), record = record_bytes(report);
  remove_summary(folder);
  // Tables are replaced one by one, so that a run that is killed meanwhile has left some of either result, never none.
  std::vector<fs::path> earlier_tables;
  for (fs::path const& file : files_of_result(folder)) {
    if (is_stored_table(file.filename().string()))
      earlier_tables.push_back(file);
    else
      remove_file(file);
  }
  FileDigests digests;
  auto const write = [&](std::string const& name, std::string const& content) {
    write_file(folder / known_result_file(name), content);
    if (is_stored_table(name)) digests[name] = sha256(content);
  };
  for (std::size_t c = 0; c < report.draws.chains.size(); ++c) write(draws_file(c), draws_csv(report, static_cast<int>(c)));
  if (report.selection)
    for (auto const& [name, content] : selection_files(report)) write(name, content);
  if (report.discovery) {
    for (auto const& [name, content] : discovery_files(report)) write(name, content);
    std::vector<std::string> const names = free_run_files(report);
    for (std::size_t r = 0; r < names.size(); ++r) write(names[r], predict_csv(report, report.discovery->free_runs[r]));
  }
  if (report.calibration) write("ranks.csv", ranks_csv(report));
  std::vector<std::string> const function_names = function_files(report);
  for (std::size_t f = 0; f < report.functions.size(); ++f) write(function_names[f], function_csv(report.functions[f]));
  std::vector<std::string> const prediction_names = prediction_files(report);
  for (std::size_t p = 0; p < report.predictions.size(); ++p)
    write(prediction_names[p], predict_csv(report, report.predictions[p]));
  std::vector<std::string> const states_names = states_files(report);
  for (std::size_t e = 0; e < report.states.size(); ++e) write(states_names[e], predict_csv(report, report.states[e]));
  if (report.criteria && !report.criteria->pointwise.empty()) write("pointwise.csv", pointwise_csv(report));
  // What an interrupted run left may have more tables than its end: chains of models that died later.
  for (fs::path const& file : earlier_tables)
    if (!digests.contains(file.filename().string())) remove_file(file);
  std::vector<std::string> undrawn = write_figures(drawn, folder, pictures);
  write_file(folder / "report.html", page);
  write_file(folder / "report.cbor", record);
  for (auto const& [name, content] : report.resolved_files) write_file(folder / known_result_file(name), content);
  write_file(folder / "timing.json", timing_json(report));
  write_file(folder / "summary.json", summary_json(report, digests));
  return undrawn;
}

std::vector<DrawnFigure> drawn_figures(Report const& report, bool pictures) {
  std::vector<plot::Figure> const all = figures(report);
  std::vector<std::optional<std::string>> svg = pictures ? draw_all(all) : std::vector<std::optional<std::string>>(all.size());
  std::vector<DrawnFigure> drawn;
  for (std::size_t i = 0; i < all.size(); ++i) drawn.push_back({all[i], std::move(svg[i])});
  return drawn;
}

std::vector<std::string> write_figures(std::vector<DrawnFigure> const& figures, fs::path const& folder,
                                       std::vector<FigureFormat> const& pictures) {
  std::vector<std::string> undrawn;
  if (!figures.empty()) make_folder(folder / "figures");
  for (DrawnFigure const& each : figures) {
    write_file(folder / "figures" / (each.figure.name + ".gnuplot"), each.figure.script);
    for (FigureFormat const format : pictures) {
      std::string const name = fmt::format("{}.{}", each.figure.name, extension(format));
      auto const picture = format == FigureFormat::svg && each.svg ? each.svg : draw(each.figure, format);
      if (picture)
        write_file(folder / "figures" / name, *picture);
      else
        undrawn.push_back(name);
    }
  }
  return undrawn;
}

std::string undrawn_words(std::vector<std::string> const& undrawn) {
  return fmt::format("{} {}{}; the scripts are in figures/",
                     gnuplot_installed() ? "gnuplot failed to draw" : "gnuplot is not installed; not drawn:", undrawn.front(),
                     undrawn.size() > 1 ? fmt::format(" and {} more", undrawn.size() - 1) : "");
}

std::string draws_file(std::size_t chain) { return fmt::format("draws_{}.csv", chain + 1); }

namespace {

/// BEGINNING_NAME.csv for each. Two names may differ only in letters that file names do not have.
std::vector<std::string> files_by_name(std::string_view begin, std::vector<std::string> names) {
  for (std::string& name : names) name = plot::identifier(name);
  names = told_apart(std::move(names));
  for (std::string& name : names) name = fmt::format("{}_{}.csv", begin, name);
  return names;
}

std::vector<std::string> files_along(std::vector<Prediction> const& predictions, std::string_view begin) {
  if (predictions.size() == 1) return {fmt::format("{}.csv", begin)};
  std::vector<std::string> names;
  for (Prediction const& prediction : predictions) names.push_back(prediction.experiment);
  return files_by_name(begin, std::move(names));
}

}  // namespace

std::vector<std::string> prediction_files(Report const& report) { return files_along(report.predictions, "predict"); }

std::vector<std::string> states_files(Report const& report) { return files_along(report.states, "states"); }

std::vector<std::string> free_run_files(Report const& report) {
  return report.discovery ? files_along(report.discovery->free_runs, "free_run") : std::vector<std::string>();
}

std::vector<std::string> function_files(Report const& report) {
  std::vector<std::string> names;
  for (FunctionReport const& function : report.functions) names.push_back(function.name);
  return files_by_name("function", std::move(names));
}

std::string model_draws_file(std::string const& model) { return fmt::format("draws_{}.csv", model); }

std::string particles_file(std::string const& model) { return fmt::format("particles_{}.csv", model); }

std::string refined_file(std::string const& model, std::size_t chain) {
  return fmt::format("polished_{}_{}.csv", model, chain + 1);
}

}  // namespace sysid
