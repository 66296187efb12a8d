// compare, report: what can be made of results that are there.
#include <unistd.h>

#include "app/comparison/compare.hpp"
#include "app/run/report_results.hpp"
#include "cli/command.hpp"
#include "cli/options.hpp"
#include "core/text/wrapped.hpp"

namespace sysid::cli {

Work declare_compare(CLI::App& verb) {
  auto const folders = std::make_shared<std::vector<std::filesystem::path>>();
  verb.add_option("FOLDER", *folders, "folders of tasks or of whole runs")->required();
  return [folders](Messages const& messages) {
    Comparison const comparison = sysid::compare(*folders);
    if (messages.json)
      std::cout << comparison_json(comparison);
    else
      std::cout << wrapped(comparison_text(comparison), terminal_columns(STDOUT_FILENO));
    return ExitCode::success;
  };
}

Work declare_report(CLI::App& verb) {
  struct Options {
    std::filesystem::path folder;
    std::optional<std::filesystem::path> page;
    RunOptions run;
  };
  auto const options = std::make_shared<Options>();
  options->run.figure_formats.clear();  // drawn anew where they are asked for
  verb.add_option("FOLDER", options->folder, "folder of a task or of a whole run")->required();
  verb.add_option("-o,--output", options->page, "the page to write (default: report.html in the folder)")
      ->type_name("FILE")
      ->check(refuse_no_path);
  add_figures(verb, options->run, "write no figures");
  return [options](Messages const&) {
    if (!options->run.figure_formats.empty()) redraw_figures(options->folder, options->run.figure_formats);
    std::cout << report_results(options->folder, options->page, options->run.figures).string() << '\n';
    return ExitCode::success;
  };
}

}  // namespace sysid::cli
