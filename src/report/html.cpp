// The page around the sections: head, landmarks, contents.
#include "report/html.hpp"

#include <fmt/format.h>

#include <set>

#include "core/xml.hpp"
#include "report/html_sections.hpp"
#include "report/html_style.hpp"

namespace sysid {

namespace {

std::string title_of(Report const& report) {
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
  return fmt::format("<li{}><a href=\"#{}\">{}</a></li>\n", kind.empty() ? "" : fmt::format(" class=\"{}\"", kind), id,
                     escape(title));
}

std::string all(std::vector<HtmlSection> const& sections, int level) {
  std::string out;
  for (HtmlSection const& each : sections) out += html(each, level);
  return out;
}

/// In words, so that colour alone tells nothing.
std::string_view verdict_word(std::string_view kind) {
  return kind == "bad" ? "a check failed" : kind == "doubtful" ? "something to look at" : kind == "good" ? "the checks pass" : "";
}

}  // namespace

std::string report_html(Report const& report, std::vector<DrawnFigure> const& figures) {
  std::vector<HtmlSection> const sections = task_sections(report, figures, "", 2);
  std::string contents;
  for (HtmlSection const& each : sections) contents += entry(each.id, each.title);
  std::string const title = title_of(report);
  return page(fmt::format("{} – {}", report.task, title),
              fmt::format("<p class=\"task\">{}</p>\n<h1>{}</h1>\n<p class=\"what\">{}</p>\n", escape(report.task), escape(title),
                          escape(report.what)),
              contents, all(sections, 2), report.version);
}

std::string run_html(std::vector<ReportedTask> const& tasks) {
  std::string contents, body;
  std::set<std::string> models;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    Report const& report = tasks[i].report;
    models.insert(title_of(report));
    std::string const id = fmt::format("task-{}", i + 1);
    std::string_view const kind = verdict_kind(report);
    contents += fmt::format("<li class=\"{}\"><a href=\"#{}\">{}</a> <span class=\"what\">{}</span>{}</li>\n", kind, id,
                            escape(report.task), escape(report.what),
                            verdict_word(kind).empty() ? "" : fmt::format(" <b>{}</b>", verdict_word(kind)));
    body += html({id, fmt::format("{}: {}", report.task, title_of(report)),
                  paragraph(report.what, "what") + all(task_sections(report, tasks[i].figures, id + "-", 3), 3), "whole"},
                 2);
  }
  std::string const title = models.size() == 1 ? *models.begin() : fmt::format("{} tasks", tasks.size());
  return page(title,
              fmt::format("<p class=\"task\">A run of {} task{}</p>\n<h1>{}</h1>\n", tasks.size(), tasks.size() == 1 ? "" : "s",
                          escape(title)),
              contents, body, tasks.front().report.version);
}

}  // namespace sysid
