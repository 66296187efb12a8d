// Result folders.
#include "report/file/task_folder.hpp"

#include <fmt/format.h>

#include <functional>
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
#include "report/file/replacement.hpp"
#include "report/file/report_cbor.hpp"
#include "report/file/result_files.hpp"
#include "report/file/selection.hpp"
#include "report/file/stored_files.hpp"
#include "report/file/summary_json.hpp"
#include "report/page/html.hpp"

namespace sysid {

namespace {

namespace fs = std::filesystem;

/// Each file of the figures: its name in figures/, and its content.
using PutFigure = std::function<void(std::string const& name, std::string const& content)>;

/// Returns the pictures that gnuplot did not draw.
std::vector<std::string> put_figures(std::vector<DrawnFigure> const& figures, std::vector<FigureFormat> const& pictures,
                                     PutFigure const& put) {
  std::vector<std::string> undrawn;
  for (DrawnFigure const& each : figures) {
    put(each.figure.name + ".gnuplot", each.figure.script);
    for (FigureFormat const format : pictures) {
      std::string const name = fmt::format("{}.{}", each.figure.name, extension(format));
      auto const picture = format == FigureFormat::svg && each.svg ? each.svg : draw(each.figure, format);
      if (picture)
        put(name, *picture);
      else
        undrawn.push_back(name);
    }
  }
  return undrawn;
}

/// Every table of a result, with its name.
template <class Put>
void put_tables(Report const& report, Put const& put) {
  for (std::size_t c = 0; c < report.draws.chains.size(); ++c) put(draws_file(c), draws_csv(report, static_cast<int>(c)));
  if (report.selection)
    for (auto const& [name, content] : selection_files(report)) put(name, content);
  if (report.discovery) {
    for (auto const& [name, content] : discovery_files(report)) put(name, content);
    std::vector<std::string> const names = free_run_files(report);
    for (std::size_t r = 0; r < names.size(); ++r) put(names[r], predict_csv(report, report.discovery->free_runs[r]));
  }
  if (report.calibration) put("ranks.csv", ranks_csv(report));
  std::vector<std::string> const function_names = function_files(report);
  for (std::size_t f = 0; f < report.functions.size(); ++f) put(function_names[f], function_csv(report.functions[f]));
  std::vector<std::string> const prediction_names = prediction_files(report);
  for (std::size_t p = 0; p < report.predictions.size(); ++p) put(prediction_names[p], predict_csv(report, report.predictions[p]));
  std::vector<std::string> const states_names = states_files(report);
  for (std::size_t e = 0; e < report.states.size(); ++e) put(states_names[e], predict_csv(report, report.states[e]));
  if (report.criteria && !report.criteria->pointwise.empty()) put("pointwise.csv", pointwise_csv(report));
}

}  // namespace

std::vector<std::string> write_result(Report const& report, fs::path const& folder, std::vector<FigureFormat> const& pictures,
                                      std::vector<std::string> const& written) {
  NewFiles files(folder);
  for (std::string const& name : written) files.take(name);
  make_folder(folder);
  std::vector<DrawnFigure> const drawn = drawn_figures(report, !pictures.empty());
  FileDigests digests;
  put_tables(report, [&](std::string const& name, std::string const& content) {
    files.write(known_result_file(name), content);
    if (is_stored_table(name)) digests[name] = sha256(content);
  });
  std::vector<std::string> undrawn = put_figures(
      drawn, pictures, [&](std::string const& name, std::string const& content) { files.write("figures/" + name, content); });
  files.write("report.html", report_html(report, drawn));
  files.write("report.cbor", record_bytes(report));
  for (auto const& [name, content] : report.resolved_files) files.write(known_result_file(name), content);
  files.write("timing.json", timing_json(report));
  files.write("summary.json", summary_json(report, digests));
  files.replace();
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
  if (!figures.empty()) make_folder(folder / "figures");
  return put_figures(figures, pictures,
                     [&](std::string const& name, std::string const& content) { write_file(folder / "figures" / name, content); });
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
