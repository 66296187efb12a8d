// The page around the sections: head, landmarks, contents.
#include "report/page/html.hpp"
#include "core/text/words.hpp"
#include "diagnostics/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>

#include <set>

#include "core/text/xml.hpp"
#include "report/page/html_parts.hpp"
#include "report/page/html_sections.hpp"
#include "report/page/html_style.hpp"
#include "report/page/html_words.hpp"

namespace sysid {

namespace {

/// "bouc_wen(n = 2), linear"; of many models their number.
std::string candidates_title(SelectionReport const& selection) {
  constexpr std::size_t most = 60;
  std::vector<std::string> names;
  for (SelectedModel const& each : selection.result.models) names.push_back(each.name);
  std::string const all = listed(names, "or");
  return all.size() <= most ? capitalised(all) : fmt::format("Selection among {} models", names.size());
}

std::string title_of(Report const& report) {
  if (report.selection && report.selection->result.models.size() > 1) return candidates_title(*report.selection);
  for (std::string const* each : {&report.model_title, &report.model_name, &report.task})
    if (!each->empty()) return *each;
  return "Report";
}

/// The security policy lets no request leave the page, whatever stands in it.
std::string page(std::string const& title, std::string const& header, std::string const& contents, std::string const& body,
                 std::string const& version) {
  return legible(fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{}</title>\n<style>\n{}</style>\n</head>\n"
      "<body>\n<a class=\"skip\" href=\"#content\">Skip to the content</a>\n<header>\n{}</header>\n"
      "<nav aria-label=\"Contents\">\n<ul>\n{}</ul>\n</nav>\n<main id=\"content\">\n{}</main>\n<footer>sysid {}</footer>\n</body>\n"
      "</html>\n",
      escape(title), page_style, header, contents, body, escape(version)));
}

std::string entry(std::string const& id, std::string const& title, std::string_view kind = {}) {
  return fmt::format("<li class=\"link{}{}\"><a href=\"#{}\">{}</a></li>\n", kind.empty() ? "" : " ", kind, id, escape(title));
}

std::string all(std::vector<HtmlSection> const& sections, int level) {
  std::string out;
  for (HtmlSection const& each : sections) out += html(each, level);
  return out;
}

/// "A run of 5 tasks".
std::string run_title(std::size_t tasks) { return "A run of " + counted(tasks, "task"); }

/// The columns of a table of fits as a narrow screen needs them: what decides stands first.
ReportTable answer_first(ReportTable table) {
  std::size_t place = 1;
  for (std::string_view const column : {"probability", "log Bayes factor", "evidence against", "log evidence", "checks"}) {
    auto const at = static_cast<std::size_t>(std::find(table.header.begin(), table.header.end(), column) - table.header.begin());
    if (at == table.header.size()) continue;
    auto const move = [&](std::vector<std::string>& row) {
      if (at < row.size())
        std::rotate(row.begin() + static_cast<std::ptrdiff_t>(place), row.begin() + static_cast<std::ptrdiff_t>(at),
                    row.begin() + static_cast<std::ptrdiff_t>(at) + 1);
    };
    move(table.header);
    for (auto& row : table.rows) move(row);
    ++place;
  }
  return table;
}

/// The models and predictions of a run side by side; empty where none can be compared.
std::string together(RunReport const& run) {
  std::string out;
  bool evidences = false;
  for (ReportTable const& table : run.comparisons) {
    bool const fits = table.header.front() == "fit",
               scores = fits && std::find(table.header.begin(), table.header.end(), "elpd") != table.header.end();
    evidences = evidences || (fits && !scores);
    bool const models = fits && !scores;
    out += table_html(models ? answer_first(table) : table, models ? 1 : 2,
                      fits ? TitleBegins::with_a_word : TitleBegins::with_a_name);
  }
  if (evidences || !run.apart.empty())
    out += paragraph(run.apart + (!evidences ? ""
                                             : "Log Bayes factors are relative to the best fit; a difference above 3 is strong, "
                                               "above 5 very strong. Evidences are "
                                               "densities of the samples, so only fits to the same samples are compared."),
                     "note");
  return out;
}

}  // namespace

std::string report_html(Report const& report, std::vector<DrawnFigure> const& figures) {
  std::vector<HtmlSection> const sections = task_sections(report, figures, "", 2);
  std::string contents;
  for (HtmlSection const& each : sections) contents += entry(each.id, each.title);
  std::string const title = title_of(report);
  // Browsers and readers cut longer ones.
  constexpr std::size_t most = 70;
  std::string name = fmt::format("{} – {}", report.task, title);
  if (name.size() > most) name = fmt::format("{} – {}", report.task, report.model_name);
  return page(name.size() > most ? report.task : name,
              fmt::format("<p class=\"task\">{}</p>\n<h1>{}</h1>\n<p class=\"what\">{}</p>\n", escape(report.task), escape(title),
                          escape(report.what)),
              contents, all(sections, 2), report.version);
}

std::string run_html(RunReport const& run) {
  std::string contents, body;
  std::set<std::string> models;
  if (std::string const comparison = together(run); !comparison.empty()) {
    contents += entry("together", "Comparison of models and predictions", "plain");
    body += html({"together", "Comparison of models and predictions", comparison, "whole"}, 2);
  }
  for (std::size_t i = 0; i < run.tasks.size(); ++i) {
    Report const& report = run.tasks[i].report;
    models.insert(title_of(report));
    std::string const id = fmt::format("task-{}", i + 1);
    contents += fmt::format("<li class=\"{}\"><a href=\"#{}\">{}</a> <span class=\"what\">{}</span>{}</li>\n", verdict_kind(report),
                            id, escape(report.task), escape(report.what),
                            has_verdict(report) ? fmt::format(" <b>{}</b>", marked(verdict_words(report))) : "");
    body += html({id, fmt::format("{}: {}", report.task, title_of(report)),
                  paragraph(report.what, "what") + all(task_sections(report, run.tasks[i].figures, id + "-", 3), 3), "whole"},
                 2);
  }
  for (std::string const& task : run.unfinished)
    contents += fmt::format("<li class=\"doubtful\">{} <b>interrupted before it had a result; continue with --resume</b></li>\n",
                            escape(task));
  std::string const count = run_title(run.tasks.size() + run.unfinished.size());
  bool const one_model = models.size() == 1;
  std::string const title = one_model ? *models.begin() : count;
  return page(title,
              fmt::format("{}<h1>{}</h1>\n", one_model ? fmt::format("<p class=\"task\">{}</p>\n", count) : "", escape(title)),
              contents, body, run.tasks.empty() ? SYSID_VERSION : run.tasks.front().report.version);
}

}  // namespace sysid
