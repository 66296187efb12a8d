// Each section with the figures that belong to its numbers.
#include "report/page/html_sections.hpp"
#include "diagnostics/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "core/text/xml.hpp"
#include "report/page/html_parts.hpp"
#include "report/page/html_words.hpp"
#include "report/text/report_text.hpp"
#include "report/text/states_text.hpp"

namespace sysid {

namespace {

std::string verdict_html(Report const& report) {
  if (!has_verdict(report)) return "";
  std::string out = fmt::format("<p class=\"headline\">{}</p>\n", marked(capitalised(verdict_words(report))));
  if (report.discovery && !report.discovery->answer.empty()) out += paragraph(capitalised(report.discovery->answer) + ".");
  out += paragraph(verdict_meaning(report));
  if (report.findings.empty()) return out;
  Findings const weighed = by_weight(report.findings);
  std::size_t const shown = std::min(findings_shown(report), weighed.size());
  out += "<ul>\n";
  for (std::size_t i = 0; i < weighed.size(); ++i) {
    Finding const& finding = weighed[i];
    if (i == shown)
      out +=
          fmt::format("</ul>\n<details><summary>{}</summary>\n<ul>\n", escape(folded_findings(std::span(weighed).subspan(shown))));
    out += fmt::format(
        "<li class=\"{0}\"><b>{1}</b> {2}{3} <span class=\"code\">{4}</span></li>\n", severity_word(finding.severity),
        finding.severity == Severity::error     ? "Failed:"
        : finding.severity == Severity::warning ? "Warning:"
                                                : "Note:",
        marked(finding.message),
        finding.help.empty() ? "" : fmt::format("<br/><span class=\"help\">What to do: {}</span>", marked(finding.help)),
        code(word(finding.code)));
  }
  return out + "</ul>\n" + (shown < weighed.size() ? "</details>\n" : "") +
         "<p class=\"note\"><code>sysid explain CODE</code> explains a code such as those above.</p>\n";
}

/// A prediction of several fits; `average` itself is not stored.
bool is_average(Report const& report) {
  return report.verb == "predict" &&
         std::any_of(report.settings.begin(), report.settings.end(), [](auto const& each) { return each.first == "weights"; });
}

/// Whose equations they are, where there are others.
std::string which_model(Report const& report) {
  if (report.selection)
    if (std::size_t const models = report.selection->result.models.size(); models > 1) {
      auto const lead = static_cast<std::size_t>(report.selection->leader());
      return paragraph(fmt::format("`{}`, the most probable of {} models:", report.selection->result.models[lead].name, models));
    }
  return is_average(report) ? paragraph("The model of the fit with the largest weight:") : "";
}

std::string model_html(Report const& report) {
  std::string out = report.equations.empty() ? "" : which_model(report);
  if (!report.equations.empty()) {
    out += "<div class=\"equations\" role=\"group\" tabindex=\"0\" aria-label=\"Equations\">\n";
    for (std::size_t i = 0; i < report.equations.size(); ++i) {
      bool const formula = i < report.formulas.size() && !report.formulas[i].empty();
      out += fmt::format("<p>{}</p>\n", formula ? report.formulas[i] : code(report.equations[i]));
    }
    out += "</div>\n";
  }
  HtmlTable priors{"Priors", {"parameter", "prior"}, {}, 2};
  // A prediction and a track begin with the draws of a fit.
  bool const from_fit = report.verb == "predict" || report.verb == "track";
  for (PriorInfo const& prior : report.priors)
    if (!from_fit &&
        std::none_of(report.summary.begin(), report.summary.end(), [&](Summary const& s) { return s.name == prior.name; }))
      priors.rows.push_back({with_unit(prior.name, prior.unit), code(prior.text)});
  if (!priors.rows.empty()) out += html(priors);
  // With the others where these have a table of their own.
  HtmlTable fixed{"Fixed parameters", {"parameter", "value"}, {}, 1};
  if (report.summary.empty())
    for (FixedValue const& each : report.fixed) fixed.rows.push_back({with_unit(each.name, each.unit), number_html(each.value)});
  if (!fixed.rows.empty()) out += html(fixed);
  return out + folded("The model as it was written", report.model_text);
}

std::string result_title(Report const& report) {
  if (report.selection) return "Models and their parameters";
  if (report.discovery) return "Terms and coefficients";
  if (report.calibration) return "Calibration";
  if (is_average(report)) return "The average and its members";
  if (report.verb == "track") return "Changes and parameters";
  if (report.verb == "crosscheck") return "Both back ends";
  return "Parameters: from prior to posterior";
}

std::string fit_title(Report const& report) {
  if (report.verb == "track") return "Parameters along the rows";
  return report.draws.total() == 0 && !report.selection ? "Prediction" : "Fit";
}

/// The figures of a page, numbered in the order in which its sections take them.
class Pictures {
 public:
  Pictures(std::vector<DrawnFigure> const& figures, std::string const& prefix) : figures_(figures), prefix_(prefix) {}

  std::string of(plot::Topic topic) {
    std::string shown, excluded;
    for (DrawnFigure const& drawn : figures_) {
      if (drawn.figure.topic != topic) continue;
      if (drawn.svg) {
        ++number_;
        shown += figure_html(drawn, fmt::format("{}figure-{}", prefix_, number_), number_);
      } else {
        excluded += fmt::format("<li>{} ({})</li>\n", escape(drawn.figure.title),
                                code(fmt::format("figures/{}.gnuplot", drawn.figure.name)));
      }
    }
    if (excluded.empty()) return shown;
    return shown + fmt::format(
                       "<div class=\"missing\"><p>Not drawn, because figures were not requested, or gnuplot is not installed or "
                       "failed. Install it (<code>apt-get install gnuplot-nox</code>) and write this page again with <code>sysid "
                       "report</code>, or run the scripts in the folder of this page:</p>\n<ul>\n{}</ul></div>\n",
                       excluded);
  }

 private:
  std::vector<DrawnFigure> const& figures_;
  std::string const& prefix_;
  int number_ = 0;
};

std::string states_html(Report const& report) {
  ReportTable const table = states_table(report);
  return table.rows.empty() ? "" : table_html(table, report.states.size() > 1 ? 3 : 2);
}

}  // namespace

std::string_view verdict_kind(Report const& report) {
  if (!has_verdict(report)) return "plain";
  Severity const worst = grade(report);
  return worst == Severity::error ? "bad" : worst == Severity::warning ? "doubtful" : "good";
}

std::vector<HtmlSection> task_sections(Report const& report, std::vector<DrawnFigure> const& figures, std::string const& prefix,
                                       int level) {
  std::vector<HtmlSection> out;
  Pictures pictures(figures, prefix);
  auto const add = [&](std::string const& id, std::string const& title, std::string body, std::string kind = {}) {
    if (!body.empty()) out.push_back({prefix + id, title, std::move(body), std::move(kind)});
  };
  add("verdict", "Verdict", verdict_html(report), fmt::format("verdict {}", verdict_kind(report)));
  add("model", report.discovery ? "Equations found" : "Model", model_html(report));
  add("result", result_title(report), result_html(report) + pictures.of(plot::Topic::result));
  add("fit", fit_title(report), scores_html(report) + pictures.of(plot::Topic::fit));
  add("states", "States and disturbances", states_html(report) + pictures.of(plot::Topic::states));
  add("criteria", "Predictive scores and information criteria", criteria_html(report));
  add("diagnostics", "Diagnostics of the chains", chains_html(report) + pictures.of(plot::Topic::chains));
  add("modes", "Modes", modes_html(report));
  add("simulations", "Simulations and failures", simulations_html(report));
  add("data", "Data", data_html(report, level + 1));
  add("settings", "Settings and versions", settings_html(report));
  add("repeat", "How to repeat this run", repetition_html(report));
  return out;
}

}  // namespace sysid
