// The page: sections in the order in which an engineer asks. Text comes escaped, figures as inline SVG.
#include "report/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/gnuplot.hpp"
#include "report/html_style.hpp"
#include "report/number.hpp"
#include "report/typeset.hpp"

namespace sysid {

namespace {

/// Cells already HTML; the first `left` columns are words, the rest numbers.
std::string table(std::vector<std::string> const& header, std::vector<std::vector<std::string>> const& rows, std::size_t left) {
  auto const row_html = [&](std::vector<std::string> const& row, std::string_view tag) {
    std::string out = "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c)
      out += fmt::format("<{0}{1}>{2}</{0}>", tag, c < left ? "" : " class=\"n\"", row[c]);
    return out + "</tr>\n";
  };
  std::string out = "<div class=\"scroll\"><table>\n";
  if (!header.empty()) out += "<thead>" + row_html(header, "th") + "</thead>\n";
  out += "<tbody>\n";
  for (auto const& row : rows) out += row_html(row, "td");
  return out + "</tbody></table></div>\n";
}

std::string section(std::string_view title, std::string const& body) {
  return body.empty() ? "" : fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", title, body);
}

std::string facts_table(Facts const& facts) {
  if (facts.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  for (auto const& [name, value] : facts) rows.push_back({escape(name), escape(setting_text(value))});
  return table({}, rows, 2);
}

std::string verdict_box(Report const& report) {
  if (!has_verdict(report)) return "";
  Severity const worst = grade(report);
  std::string_view const kind = worst == Severity::error ? "bad" : worst == Severity::warning ? "doubtful" : "good";
  std::string out = fmt::format("<div class=\"verdict {}\">\n<p><strong>{}</strong></p>\n", kind, escape(verdict_headline(report)));
  if (!report.findings.empty()) {
    out += "<ul>\n";
    std::vector<Finding> findings = report.findings;
    std::stable_sort(findings.begin(), findings.end(), [](Finding const& a, Finding const& b) { return a.severity < b.severity; });
    for (Finding const& finding : findings)
      out += fmt::format("<li class=\"{}\">{}{}</li>\n", severity_word(finding.severity), escape(finding.message),
                         finding.help.empty() ? "" : fmt::format(" <em>{}</em>", escape(finding.help)));
    out += "</ul>\n";
  }
  return out + "</div>\n";
}

std::string model_section(Report const& report) {
  std::string out;
  if (!report.equations.empty()) {
    out += "<div class=\"equations\">\n";
    for (std::string const& equation : report.equations) out += fmt::format("<p>{}</p>\n", typeset(equation));
    out += "</div>\n";
  }
  if (!report.priors.empty()) {
    std::vector<std::vector<std::string>> rows;
    for (PriorInfo const& prior : report.priors)
      rows.push_back({escape(prior.name), escape(pretty_unit(prior.unit)), fmt::format("<code>{}</code>", escape(prior.text))});
    out += table({"parameter", "unit", "prior"}, rows, 3);
  }
  if (!report.model_text.empty())
    out +=
        fmt::format("<details><summary>The model as it was written</summary><pre>{}</pre></details>\n", escape(report.model_text));
  return out;
}

std::string data_section(Report const& report) {
  std::string out;
  for (DataInfo const& data : report.data) {
    out += fmt::format(
        "<p><strong>{}</strong>: <code>{}</code>, {} rows, {} of them scored.<br><span class=\"digest\">sha256 {}</span></p>\n",
        escape(data.name), escape(data.file), data.rows, data.scored, escape(data.sha256));
    if (data.notes.empty()) continue;
    out += "<ul>\n";
    for (std::string const& note : data.notes) out += fmt::format("<li>{}</li>\n", escape(note));
    out += "</ul>\n";
  }
  return out;
}

std::string summary_section(Report const& report) {
  std::string out;
  if (!report.summary.empty()) {
    bool const optimum = report.draws.total() == 1;
    std::vector<std::vector<std::string>> rows;
    for (Summary const& s : report.summary) {
      if (s.coefficient) continue;
      SummaryText const t = format_summary(s);
      if (optimum)
        rows.push_back({"<b>" + escape(s.name) + "</b>", escape(pretty_unit(s.unit)), pretty_number(t.mean), pretty_number(t.sd)});
      else
        rows.push_back({"<b>" + escape(s.name) + "</b>", escape(pretty_unit(s.unit)), pretty_number(t.mean), pretty_number(t.sd),
                        pretty_number(t.q5), pretty_number(t.median), pretty_number(t.q95)});
    }
    if (optimum)
      out += table({"", "unit", "optimum", "sd of its Laplace approximation"}, rows, 2);
    else
      out += table({"", "unit", "mean", "sd", "5 %", "median", "95 %"}, rows, 2) +
             "<p class=\"caption\">Digits end where the Monte Carlo error begins.</p>\n";
  }
  if (report.evidence)
    if (std::string const text = evidence_text(*report.evidence); !text.empty())
      out += fmt::format("<p>The model as a whole: {}.</p>\n", escape(text));
  for (ReportTable const& extra : report.tables) {
    std::vector<std::vector<std::string>> rows;
    std::vector<std::string> header;
    for (std::string const& cell : extra.header) header.push_back(escape(cell));
    for (auto const& row : extra.rows) {
      rows.emplace_back();
      for (std::string const& cell : row) rows.back().push_back(escape(cell));
    }
    out += fmt::format("<h3>{}</h3>\n{}", escape(extra.title), table(header, rows, 1));
    if (!extra.caption.empty()) out += fmt::format("<p class=\"caption\">{}</p>\n", escape(extra.caption));
  }
  return out;
}

std::string score_title(std::string const& name) {
  if (name == "nmse") return "NMSE [%]";
  if (name == "rmse") return "RMSE";
  if (name == "chi_squared_per_sample") return "χ² per sample";
  if (name == "coverage_95") return "share inside the 95 % band";
  if (name == "coverage_3sd") return "share within 3 sd";
  if (name == "whiteness_p") return "whiteness of the residuals, p";
  if (name == "input_correlation_p") return "residuals uncorrelated with the input, p";
  return escape(name);
}

/// A row per score, a column per channel.
std::string fit_section(Report const& report) {
  std::vector<FitLine> const lines = fit_lines(report);
  if (lines.empty()) return "";
  std::vector<std::string> header = {""}, names;
  for (FitLine const& line : lines) {
    header.push_back(escape(line.what()));
    for (Score const& score : line.scores)
      if (std::find(names.begin(), names.end(), score.name) == names.end()) names.push_back(score.name);
  }
  std::vector<std::vector<std::string>> rows;
  for (std::string const& name : names) {
    rows.push_back({score_title(name)});
    for (FitLine const& line : lines) {
      std::string cell;
      for (Score const& score : line.scores) {
        if (score.name != name) continue;
        cell = pretty_number(significant(score.value, 4));
        if (name == "rmse" && !line.unit.empty()) cell += " " + escape(pretty_unit(line.unit));
      }
      rows.back().push_back(std::move(cell));
    }
  }
  return table(header, rows, 1) +
         "<p class=\"caption\">NMSE: mean squared error as a percentage of the variance of what was measured. Bands include the "
         "noise.</p>\n";
}

std::string convergence_section(Report const& report) {
  if (report.summary.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  for (Summary const& s : report.summary) {
    if (s.coefficient) continue;
    SummaryText const t = format_summary(s);
    rows.push_back({"<b>" + escape(s.name) + "</b>", t.rhat, t.ess_bulk, t.ess_tail, pretty_number(significant(s.mcse_mean, 2))});
  }
  return table({"", "R-hat", "bulk ESS", "tail ESS", "MCSE of the mean"}, rows, 1) +
         "<p class=\"caption\">Rank-normalised split R-hat and effective sample sizes after Vehtari et al. (2021); chains agree "
         "below 1.01.</p>\n";
}

std::string modes_section(Report const& report) {
  if (report.modes.empty()) return "";
  std::vector<std::string> header = {"mode", "share", "log density"};
  std::size_t const count = std::min(report.modes[0].declared.size(), report.draws.names.size());
  for (std::size_t i = 0; i < count; ++i) header.push_back(escape(report.draws.names[i]));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t m = 0; m < report.modes.size(); ++m) {
    Mode const& mode = report.modes[m];
    rows.push_back(
        {std::to_string(m + 1), pretty_number(significant(mode.share, 3)), pretty_number(significant(mode.log_density, 6))});
    for (std::size_t i = 0; i < count; ++i) rows.back().push_back(pretty_number(significant(mode.declared[i], 4)));
  }
  return table(header, rows, 1) +
         "<p class=\"caption\">Modes the global search over the prior found; share: of their Laplace masses.</p>\n";
}

std::string ledger_section(Ledger const& ledger) {
  if (ledger.solves() == 0 && ledger.failures().empty()) return "";
  std::string out = fmt::format("<p>{} simulations, {} of them failed.</p>\n", ledger.solves(), ledger.failed());
  if (ledger.failures().empty()) return out;
  std::vector<std::vector<std::string>> rows;
  for (Failure const& failure : ledger.failures())
    rows.push_back({escape(name(failure.kind)), escape(failure.where), std::to_string(failure.count),
                    std::isnan(failure.time) ? "" : significant(failure.time, 4)});
  return out + table({"class", "where", "count", "first at t [s]"}, rows, 2);
}

struct FigureHtml {
  std::string shown, left_out;
};

FigureHtml figures_html(std::vector<DrawnFigure> const& figures) {
  FigureHtml out;
  std::size_t number = 0;
  for (DrawnFigure const& drawn : figures) {
    if (!drawn.svg) {
      out.left_out +=
          fmt::format("<li>{} (<code>figures/{}.gnuplot</code>)</li>\n", escape(drawn.figure.title), escape(drawn.figure.name));
      continue;
    }
    out.shown += fmt::format("<figure>\n{}<figcaption><b>Figure {}.</b> {}</figcaption>\n</figure>\n",
                             embedded(*drawn.svg, drawn.figure), ++number, escape(drawn.figure.caption));
  }
  if (!out.left_out.empty())
    out.shown += fmt::format(
        "<p>These figures were left out, since gnuplot is not installed or refused them. Install it (<code>apt-get install "
        "gnuplot-nox</code>) and run the task again, or draw the scripts beside this page:</p>\n<ul>\n{}</ul>\n",
        out.left_out);
  return out;
}

}  // namespace

std::string report_html(Report const& report, std::vector<DrawnFigure> const& figures) {
  FigureHtml const pictures = figures_html(figures);
  std::string const title = report.model_title.empty() ? report.model_name : report.model_title;
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\">\n<title>{} – {}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n",
      escape(report.task), escape(title), page_style);
  out += fmt::format("<header>\n<p class=\"task\">{}</p>\n<h1>{}</h1>\n<p class=\"what\">{}</p>\n</header>\n", escape(report.task),
                     escape(title), escape(report.what));
  out += verdict_box(report);
  out += section("Model", model_section(report));
  out += section("Data", data_section(report));
  out += section("Result", summary_section(report));
  out += section("Fit", fit_section(report));
  out += section("Figures", pictures.shown);
  out += section("Convergence", convergence_section(report));
  out += section("Modes", modes_section(report));
  out += section("Simulations", ledger_section(report.ledger));
  std::string reproduction = fmt::format("<p>Seed {}. The same seed gives the same draws, byte for byte.</p>\n", report.seed);
  reproduction += facts_table(report.settings);
  reproduction += facts_table(report.versions);
  if (!report.resolved_text.empty())
    reproduction += fmt::format("<details><summary>The file that repeats this run</summary><pre>{}</pre></details>\n",
                                escape(report.resolved_text));
  out += section("To repeat this", reproduction);
  out += fmt::format("<footer>sysid {}</footer>\n</main>\n</body>\n</html>\n", escape(report.version));
  return out;
}

}  // namespace sysid
