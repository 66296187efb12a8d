// track: parameters of a fit along rows as they arrive.
#include <fmt/format.h>
#include <unistd.h>

#include <charconv>

#include "app/tracking/track.hpp"
#include "cli/command.hpp"
#include "cli/options.hpp"
#include "core/system/interrupt.hpp"
#include "core/system/progress_terminal.hpp"
#include "core/text/wrapped.hpp"

namespace sysid::cli {
namespace {

std::optional<int> row_number(std::string_view text) {
  int row = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), row);
  if (error != std::errc() || end != text.data() + text.size() || row < 1) return std::nullopt;
  return row;
}

/// "501..1500", "501.."; what is wrong with it, or empty.
std::string read_rows(std::string const& text, TrackOptions& options) {
  auto const dots = text.find("..");
  auto const first = row_number(std::string_view(text).substr(0, dots));
  std::string const rest = dots == std::string::npos ? "" : text.substr(dots + 2);
  auto const last = rest.empty() ? std::optional(0) : row_number(rest);
  if (dots == std::string::npos || !first || !last || (*last > 0 && *last <= *first))
    return fmt::format("invalid rows `{}`: rows are a range such as 501..1500 or 501.., counted from 1", text);
  options.first_row = *first;
  options.last_row = *last;
  return "";
}

/// "0.01", "0.01/h"; what is wrong with it, or empty.
std::string read_drift(std::string const& text, DriftOption& drift) {
  auto const slash = text.find('/');
  std::string const number = text.substr(0, slash);
  double relative = 0, time = 0;
  auto const [end, error] = std::from_chars(number.data(), number.data() + number.size(), relative);
  bool good = error == std::errc() && end == number.data() + number.size() && relative >= 0 && relative <= 1;
  if (good && slash != std::string::npos) {
    auto const unit = unit_atom(text.substr(slash + 1));
    good = unit && unit->dimension == unit_atom("s")->dimension;
    if (good) time = unit->scale;
  }
  if (!good)
    return fmt::format(
        "invalid drift `{}`: a drift is a fraction from 0 to 1 per 1000 rows, or per unit of time: 0.01, 0.01/h, 0.05/day", text);
  drift = {relative, time, text};
  return "";
}

std::string refuse_no_rate(std::string const& text) {
  double rate = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  if (error == std::errc() && end == text.data() + text.size() && rate > 0 && rate <= 0.1) return "";
  return fmt::format("invalid rate `{}`: a rate of false alarms is a number of at most 0.1 per row", text);
}

struct Options : ResultOptions {
  TrackOptions track;
  std::string rows, drift = "0.01", filter = "extended";
};

ExitCode run(Messages const& messages, Options& options) {
  install_interrupt_handlers();
  options.track.filter = *find_filter(options.filter);
  return with_checked_file(messages, options.file, [&](Source const& source, CheckedFile const& file, Diagnostics const&) {
    std::ostream nowhere(nullptr);
    SilentProgress silent;
    LineOutput out(std::cout, wrapped_for(STDOUT_FILENO)), notices(std::cerr, wrapped_for(STDERR_FILENO));
    Session session(source, file, options.run, silent, out, options.quiet ? nowhere : static_cast<std::ostream&>(notices));
    return track(session, options.track);
  });
}

}  // namespace

Work declare_track(CLI::App& verb) {
  auto const options = std::make_shared<Options>();
  TrackOptions& track = options->track;
  options->run.output = "results/track";
  add_file(verb, options->file);
  verb.add_option("RESULT", track.result, "the folder of a fit's results")->required();
  verb.add_option("--rows", options->rows, "rows to track: A..B, or A.. from row A to the last (default: all)")
      ->type_name("A..B")
      ->check([&track](std::string const& text) { return read_rows(text, track); });
  verb.add_option("--data", track.data, "the data block (default: the first one of the fit)")->type_name("NAME");
  verb.add_option("--record", track.record, "another file with the same columns; - is standard input")
      ->type_name("CSV")
      ->check(refuse_no_path);
  verb.add_flag("--follow", track.follow, "wait for rows that are appended to the file, until Ctrl-C");
  verb.add_flag("--at-rest", track.at_rest, "the states have the model's initial values in the first tracked row");
  verb.add_option("--parameters", track.parameters, "parameters to track, separated by commas (default: all in the equations)")
      ->delimiter(',')
      ->type_name("NAMES");
  verb.add_option("--drift", options->drift,
                  "relative sd of the change of a parameter per 1000 rows, or per unit of time: 0.05/day")
      ->type_name("DRIFT")
      ->check([&track](std::string const& text) { return read_drift(text, track.drift); })
      ->default_str("0.01");
  verb.add_option("--filter", options->filter, "Kalman filter: extended or unscented")
      ->type_name("NAME")
      ->check(CLI::IsMember({"extended", "unscented"}))
      ->default_str("extended");
  verb.add_option("--false-alarms", track.false_alarms, "upper limit of the false-alarm probability per row")
      ->type_name("RATE")
      ->check(refuse_no_rate)
      ->default_str("1e-5");
  verb.add_option("--window", track.window, "number of past rows in which the start of a change is searched")
      ->type_name("N")
      ->check(CLI::Range(64, 1 << 20))
      ->capture_default_str();
  add_output(verb, options->run.output);
  verb.add_flag("--force", options->run.force, "replace existing results");
  verb.add_flag("-q,--quiet", options->quiet, "print no notices");
  add_figures(verb, options->run, "draw no figures, but write their gnuplot scripts");
  return [options](Messages const& messages) { return run(messages, *options); };
}

}  // namespace sysid::cli
