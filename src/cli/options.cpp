// Each option once, in the same words wherever it stands.
#include "cli/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/text/diagnostic.hpp"
#include "core/text/words.hpp"
#include "report/figure/figure_format.hpp"

namespace sysid::cli {
namespace {

/// Why figures cannot be drawn as this, before hours of sampling and not after; empty when they can.
std::string refuse_figure_format(std::string const& name) {
  auto const format = find_figure_format(name);
  if (!format) return fmt::format("`{}` is not a format of figures; the formats are svg, png, pdf and text", name);
  // Without gnuplot there are scripts, which the page says: nobody has asked for more.
  if (*format != FigureFormat::svg && !can_draw(*format))
    return fmt::format("the installed gnuplot cannot draw {}; install the Debian package gnuplot-nox", name);
  return "";
}

/// Each once, in the order asked for.
std::vector<FigureFormat> figure_formats(std::vector<std::string> const& names) {
  std::vector<FigureFormat> formats;
  for (std::string const& name : names) {
    FigureFormat const format = *find_figure_format(name);
    if (std::find(formats.begin(), formats.end(), format) == formats.end()) formats.push_back(format);
  }
  return formats;
}

std::string refuse_seed(std::string const& text) {
  std::uint64_t seed = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error == std::errc() && end == text.data() + text.size()) return "";
  return fmt::format("a seed is a whole number from 0 to {}, not `{}`", std::numeric_limits<std::uint64_t>::max(), text);
}

}  // namespace

std::string refuse_no_path(std::string const& path) { return path.empty() ? "the path is empty; `.` is the current folder" : ""; }

std::string refuse_other_name(std::string const& text, std::vector<std::string> const& names) {
  if (std::find(names.begin(), names.end(), text) != names.end()) return "";
  std::vector<std::string> const near = nearest(text, names);
  if (near.empty()) return fmt::format("`{}` is none of {}", text, quoted(names));
  return fmt::format("`{}` is none of {}; the nearest is `{}`", text, quoted(names), near.front());
}

std::string refuse_no_duration(std::string const& text) {
  double seconds = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error == std::errc() && end == text.data() + text.size() && seconds > 0 && std::isfinite(seconds)) return "";
  return fmt::format("a time is a positive number of seconds, not `{}`", text);
}

void add_seed(CLI::App& verb, std::optional<std::uint64_t>& seed, char const* help) {
  verb.add_option("--seed", seed, help)->type_name("N")->check(refuse_seed);
}

void add_file(CLI::App& verb, std::string& file) { verb.add_option("FILE", file, "the .sysid file")->required(); }

void add_output(CLI::App& verb, std::filesystem::path& folder, char const* help) {
  verb.add_option("-o,--output", folder, help)->type_name("FOLDER")->check(refuse_no_path)->default_str(folder.string());
}

void add_threads(CLI::App& verb, int& threads) {
  verb.add_option("--threads", threads, "number of threads, 0: one per processor; results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

void add_figures(CLI::App& verb, RunOptions& run, char const* without) {
  verb.add_flag("!--no-figures", run.figures, without);
  verb.add_option_function<std::vector<std::string>>(
          "--figures", [&run](std::vector<std::string> const& names) { run.figure_formats = figure_formats(names); },
          "formats of figures: svg, png, pdf, text, or several separated by commas")
      ->delimiter(',')
      ->type_name("FORMATS")
      ->check(refuse_figure_format, "{svg,png,pdf,text}")
      ->default_str(run.figure_formats.empty() ? "" : "svg");
}

void add_result_options(CLI::App& verb, ResultOptions& options) {
  add_file(verb, options.file);
  add_output(verb, options.run.output);
  verb.add_flag("--force", options.run.force, "replace existing results");
  add_seed(verb, options.run.seed, "seed of all random numbers, in place of the seeds in the file");
  verb.add_flag("-q,--quiet", options.quiet, "print no progress and no notices");
  add_figures(verb, options.run, "draw no figures, but write their gnuplot scripts");
  options.run.execution.threads = 0;
  add_threads(verb, options.run.execution.threads);
}

}  // namespace sysid::cli
