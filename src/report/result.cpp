// Result folders.
#include "report/result.hpp"

#include <fmt/format.h>

#include <set>
#include <vector>

#include "core/files.hpp"
#include "report/csv.hpp"
#include "report/figures.hpp"
#include "report/gnuplot.hpp"
#include "report/html.hpp"
#include "report/json.hpp"

namespace sysid {

namespace {

namespace fs = std::filesystem;

/// Names that `write_result` gives.
bool is_result_file(std::string const& name) {
  auto const between = [&](std::string_view begin, std::string_view end) {
    return name.size() >= begin.size() + end.size() && name.starts_with(begin) && name.ends_with(end);
  };
  return name == "summary.json" || name == "timing.json" || name == "report.html" || name == "resolved.sysid" ||
         name == "predict.csv" || name == "terms.csv" || name == "found.sysid" || name == "populations.csv" ||
         between("draws_", ".csv") || between("function_", ".csv") || between("predict_", ".csv") ||
         between("particles_", ".csv") || between("polished_", ".csv");
}

bool is_figure_file(std::string const& name) { return name.ends_with(".svg") || name.ends_with(".gnuplot"); }

std::vector<fs::path> files_of_result(fs::path const& folder) {
  std::vector<fs::path> out;
  std::error_code ignored;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder, ignored))
    if (is_result_file(entry.path().filename())) out.push_back(entry.path());
  for (fs::directory_entry const& entry : fs::directory_iterator(folder / "figures", ignored))
    if (is_figure_file(entry.path().filename())) out.push_back(entry.path());
  return out;
}

}  // namespace

bool holds_result(fs::path const& folder) { return !files_of_result(folder).empty(); }

void prepare_result(fs::path const& folder, bool force) {
  if (!force && holds_result(folder))
    throw UserError({Severity::error,
                     "",
                     fmt::format("`{}` holds results already", folder.string()),
                     std::nullopt,
                     {},
                     "add --force to replace them, or -o DIR to write elsewhere"});
  for (fs::path const& file : files_of_result(folder)) remove_file(file);
  make_folder(folder);
}

void write_result(Report const& report, fs::path const& folder, bool pictures) {
  make_folder(folder);
  // What an interrupted run left may have more files than its end: chains of models that died later.
  for (fs::path const& file : files_of_result(folder)) remove_file(file);
  for (std::size_t c = 0; c < report.draws.chains.size(); ++c)
    write_file(folder / fmt::format("draws_{}.csv", c + 1), draws_csv(report, static_cast<int>(c)));
  if (report.selection)
    for (auto const& [name, content] : selection_files(report)) write_file(folder / name, content);
  if (report.discovery)
    for (auto const& [name, content] : discovery_files(report)) write_file(folder / name, content);
  for (FunctionReport const& function : report.functions)
    write_file(folder / fmt::format("function_{}.csv", plot::identifier(function.name)), function_csv(function));
  std::set<std::string> taken;
  for (Prediction const& prediction : report.predictions) {
    std::string suffix = report.predictions.size() == 1 ? "" : "_" + plot::identifier(prediction.experiment);
    while (!taken.insert(suffix).second) suffix += "_";  // two names may differ only in letters that file names do not have
    write_file(folder / fmt::format("predict{}.csv", suffix), predict_csv(report, prediction));
  }
  std::vector<DrawnFigure> drawn;
  bool const can_draw = pictures && gnuplot_installed();
  for (plot::Figure const& figure : figures(report)) {
    make_folder(folder / "figures");
    drawn.push_back({figure, can_draw ? draw(figure) : std::nullopt});
    write_file(folder / "figures" / (figure.name + ".gnuplot"), figure.script);
    if (drawn.back().svg) write_file(folder / "figures" / (figure.name + ".svg"), *drawn.back().svg);
  }
  write_file(folder / "report.html", report_html(report, drawn));
  if (!report.resolved_text.empty()) write_file(folder / "resolved.sysid", report.resolved_text);
  write_file(folder / "timing.json", timing_json(report));
  write_file(folder / "summary.json", summary_json(report));
}

}  // namespace sysid
