// data: a look at a record before there is a model.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "app/record/record_text.hpp"
#include "app/session/repetition.hpp"
#include "cli/command.hpp"
#include "core/system/files.hpp"
#include "core/text/words.hpp"
#include "core/text/wrapped.hpp"
#include "report/figure/gnuplot.hpp"

namespace sysid::cli {
namespace {

struct DataOptions {
  std::string file, plot;
  bool json = false;
};

/// A file of models in place of a record: the records that it names are meant.
ExitCode model_in_place_of_record(Messages const& messages, std::string const& path) {
  Diagnostics ignored;
  std::vector<std::string> commands;
  Source source = read_source(path);
  if (auto const file = load(source, ignored))
    for (DataBlock const& block : file->data)
      commands.push_back(
          fmt::format("sysid data {}", quoted_for_shell((std::filesystem::path(path).parent_path() / block.path).string())));
  messages.complain(
      fmt::format("`{}` is a file of models, not a record", path),
      commands.empty() ? fmt::format("give a record, such as a CSV file; `sysid check {}` checks this file", quoted_for_shell(path))
                       : fmt::format("describe the record that it reads: {}", quoted(commands, "or")));
  return ExitCode::user_error;
}

/// By its ending; SVG without one that is known.
FigureFormat format_of_picture(std::string const& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  auto const format = find_figure_format(ending);
  return format && *format != FigureFormat::text ? *format : FigureFormat::svg;
}

ExitCode look(Messages const& messages, DataOptions const& options) {
  if (std::filesystem::path(options.file).extension() == ".sysid") return model_in_place_of_record(messages, options.file);
  RecordLook const look = look_at_record(options.file);
  if (options.json)
    std::cout << record_json(look);
  else
    std::cout << wrapped_rows(record_text(look), terminal_columns(STDOUT_FILENO));
  if (options.plot.empty()) return ExitCode::success;
  auto const picture = draw(record_figure(look), format_of_picture(options.plot));
  if (!picture) {
    if (gnuplot_installed())
      messages.complain("the plot was not drawn: gnuplot failed",
                        "check that the folder for temporary files has room, and that `gnuplot` works");
    else
      messages.complain("the plot was not drawn: gnuplot is not installed", "apt install gnuplot-nox");
    return ExitCode::io;
  }
  write_file(options.plot, *picture);
  return ExitCode::success;
}

}  // namespace

Work declare_data(CLI::App& verb) {
  auto const options = std::make_shared<DataOptions>();
  verb.add_option("FILE", options->file, "a record: a table as text, a MATLAB, NetCDF or HDF5 file")->required();
  verb.add_flag("--json", options->json, "print JSON");
  verb.add_option("--plot", options->plot, "draw the columns over time into this file: as SVG, or by its ending as PNG or PDF")
      ->type_name("PICTURE");
  return [options](Messages const& messages) { return look(messages, *options); };
}

}  // namespace sysid::cli
