// Where a result comes from: data, settings, the command that makes it again.
#include "report/page/html_parts.hpp"

#include <fmt/format.h>

#include "core/text/number.hpp"
#include "core/text/xml.hpp"
#include "report/page/verb_words.hpp"

namespace sysid {

std::string data_html(Report const& report, int level) {
  std::string out;
  for (DataInfo const& data : report.data) {
    out += fmt::format("<h{0}>{1}</h{0}>\n", level, escape(data.name));
    out += fmt::format("<p>{}, {} rows, {} of them scored{}.</p>\n", code(data.file), data.rows, data.scored,
                       data.scored_rows.empty() ? "" : fmt::format(" ({})", escape(data.scored_rows)));
    if (!data.notes.empty()) {
      out += "<ul>\n";
      for (std::string const& note : data.notes) out += fmt::format("<li>{}</li>\n", marked(pretty_units(note)));
      out += "</ul>\n";
    }
    out += fmt::format("<p class=\"digest\">sha256 {}</p>\n", escape(data.sha256));
  }
  return out;
}

std::string settings_html(Report const& report) {
  auto const table = [](std::string const& caption, std::string const& first, Facts const& facts) {
    HtmlTable out{caption, {first, "value"}, {}, 2};
    for (auto const& [name, value] : facts) out.rows.push_back({escape(name), escape(setting_text(value))});
    return facts.empty() ? "" : html(out);
  };
  return table("Settings, including defaults", "setting", report.settings) + table("Versions", "of", report.versions);
}

std::string repetition_html(Report const& report) {
  std::string out;
  for (std::string const& task : report.unseeded)
    out += fmt::format("<p>The seed of {} was drawn at random. First write it into the task in the file: {}</p>\n", code(task),
                       code(task == report.task ? fmt::format("seed = {}", report.seed) : "seed = the one on its page"));
  if (!report.command.empty())
    out += fmt::format(
        "<p>From the folder in which the run was started:</p>\n<pre class=\"command\" tabindex=\"0\" role=\"group\" "
        "aria-label=\"Command\"><code>{}</code></pre>\n",
        escape(report.command));
  // A track draws nothing, an optimum only where its search begins.
  if (report.verb != "track")
    out += fmt::format(
        "<p>Seed {}. The same file, data, seed and version of the program give the same {}, byte for byte, for any number "
        "of threads.</p>\n",
        report.seed, report.draws.is_optimum() ? "result" : verb_words(report).repeated);
  else
    out += "<p>The same file, data, fit and version of the program give the same table, byte for byte.</p>\n";
  return out + folded("The file that repeats this task, with all settings", report.resolved_text);
}

}  // namespace sysid
