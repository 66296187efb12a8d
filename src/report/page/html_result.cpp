// What a task found: parameters, tables of its kind, the evidence of the model, modes.
#include "report/page/html_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/number.hpp"
#include "core/text/xml.hpp"
#include "diagnostics/prior_checks.hpp"
#include "report/page/html_words.hpp"
#include "report/text/report_text.hpp"
#include "report/text/summary_text.hpp"

namespace sysid {

namespace {

/// "sigma 3.93 µm, nu 4": breaks after commas alone.
std::string unbroken(std::string_view list) {
  std::string out;
  for (std::size_t i = 0; i < list.size(); ++i)
    out += list[i] == ' ' && (i == 0 || list[i - 1] != ',') ? std::string("\u00a0") : std::string(1, list[i]);
  return out;
}

/// A cell of a table that other writers share: a number or a unit as a page shows it.
std::string cell_html(std::string const& text, std::string const& column) {
  if (column == "unit") return escape(pretty_unit(text));
  if (column == "noise") return escape(unbroken(pretty_powers(pretty_numbers(text))));
  if (column == "prior") return escape(text);
  return number_html(text);
}

/// Where a posterior lies whose middle is outside the prior's 90 %: how far beyond, in the width of that. Else empty.
std::string outside_words(PriorInfo const& prior, double middle) {
  double const width = *prior.q95 - *prior.q5, beyond = std::max(*prior.q5 - middle, middle - *prior.q95);
  if (!(beyond > 0)) return "";
  return fmt::format("{} the prior's 90 % interval, by {} times its width", middle > *prior.q95 ? "above" : "below",
                     pretty_number(significant(beyond / width, 2)));
}

/// The prior as it was written, with its 90 % interval.
std::string prior_cell(PriorInfo const& prior) {
  std::string out = code(prior.text);
  if (prior.q5 && prior.q95)
    out += fmt::format("<br/><span class=\"unit\">{} to {}</span>", pretty_number(significant(*prior.q5, 3)),
                       pretty_number(significant(*prior.q95, 3)));
  return out;
}

/// Where the posterior lies in its prior, as a chart and in words; empty where that is not known.
std::string within_prior(PriorInfo const& prior, Summary const& s) {
  auto const ratio = contraction(prior, s);
  if (!ratio) return "";
  auto const [low, high] = interval_90(s);
  std::string out = range_chart(*prior.q5, *prior.q95, low, high, s.mean,
                                fmt::format("{} from {} to {}, prior from {} to {}", s.name, significant(low, 3),
                                            significant(high, 3), significant(*prior.q5, 3), significant(*prior.q95, 3)));
  out += fmt::format(
      "<br/><span class=\"unit\">{}</span>",
      *ratio < hardly_narrower ? "hardly narrower" : pretty_number(significant(*ratio, *ratio < 10 ? 2 : 3)) + " times narrower");
  if (std::string const words = outside_words(prior, s.mean); !words.empty())
    out += fmt::format("<br/><span class=\"outside\">{}</span>", words);
  return out;
}

std::string parameters(Report const& report) {
  if (report.summary.empty()) return "";
  bool const optimum = report.draws.is_optimum();
  // What was found comes first: on a narrow screen it stands there without scrolling.
  HtmlTable table{"Posteriors against priors", {"parameter"}, {}, 1, 2};
  for (std::string const& column :
       optimum ? std::vector<std::string>{"optimum", "sd"} : std::vector<std::string>{"mean", "sd", "5 %", "median", "95 %"})
    table.header.push_back(column);
  bool const priors = !report.priors.empty();
  table.header.push_back(priors ? "posterior within prior" : "");
  table.header.push_back("prior");
  for (Summary const& s : report.summary) {
    if (s.coefficient) continue;
    SummaryText const t = format_summary(s, true);
    auto const prior =
        std::find_if(report.priors.begin(), report.priors.end(), [&](PriorInfo const& each) { return each.name == s.name; });
    bool const known = prior != report.priors.end();
    std::vector<std::string> row = {with_unit(s.name, s.unit)};
    for (std::string const& cell :
         optimum ? std::vector<std::string>{t.mean, t.sd} : std::vector<std::string>{t.mean, t.sd, t.q5, t.median, t.q95})
      row.push_back(pretty_number(cell));
    row.push_back(known ? within_prior(*prior, s) : "");
    row.push_back(known ? prior_cell(*prior) : "derived from the others");
    table.rows.push_back(std::move(row));
  }
  for (FixedValue const& each : report.fixed) {
    table.rows.push_back({with_unit(each.name, each.unit), number_html(each.value)});
    table.rows.back().resize(table.header.size());
    table.rows.back().back() = "fixed";
  }
  std::string out = html(table) + paragraph(learning_words(report));
  for (std::string const& each : without_sd_texts(report)) out += paragraph(capitalised(each) + ".", "note");
  return out +
         paragraph(
             std::string(
                 optimum ? "sd: of the normal approximation at the optimum (Laplace); that of a derived quantity is computed from "
                           "its first derivatives there (the delta method). "
                         : "Digits below the Monte Carlo error, or below a hundredth of the sd, are not shown. ") +
                 (priors ? "Below each prior is its 90 % interval. The bar beside it shows the 90 % interval of the posterior "
                           "(the thick bar, with a stroke at the mean) within that of the prior, on a logarithmic scale if the "
                           "prior's "
                           "interval is positive and spans more than a decade; an arrow marks a posterior that extends beyond it."
                         : ""),
             "note");
}

}  // namespace

std::string result_html(Report const& report) {
  std::string out = parameters(report);
  if (std::string const text = likelihood_text(report); !text.empty())
    out +=
        paragraph(fmt::format("The model as a whole: {}. It is meaningful only in comparison with another model of the same "
                              "samples.",
                              text));
  if (report.evidence)
    if (std::string const text = evidence_text(*report.evidence); !text.empty())
      out += paragraph(fmt::format("The model as a whole: {}. {}", pretty_numbers(text),
                                   report.evidence->log_evidence
                                       ? "It is meaningful only in comparison with another model of the "
                                         "same samples (`sysid compare`): a difference above 3 is strong, above 5 "
                                         "very strong."
                                       : ""));
  for (ReportTable const& table : report.tables) out += table_html(table);
  return out;
}

namespace {

/// Each on a line of its own.
std::string notes(std::string_view lines) {
  std::string out;
  while (!lines.empty()) {
    std::size_t const end = std::min(lines.find('\n'), lines.size());
    out += paragraph(capitalised(pretty_numbers(lines.substr(0, end))), "note");
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  return out;
}

}  // namespace

std::string table_html(ReportTable const& table, std::size_t words, TitleBegins title) {
  HtmlTable out{title == TitleBegins::with_a_name ? table.title : capitalised(table.title), {}, {}, words};
  for (std::string const& cell : table.header) out.header.push_back(escape(cell));
  for (auto const& row : table.rows) {
    out.rows.emplace_back();
    for (std::size_t c = 0; c < row.size(); ++c)
      out.rows.back().push_back(cell_html(row[c], c < table.header.size() ? table.header[c] : ""));
  }
  return html(out) + notes(table.caption);
}

std::string modes_html(Report const& report) {
  if (report.modes.empty()) return "";
  HtmlTable table{"Modes found by the global search over the prior", {"mode", "share", "log density"}, {}, 1};
  for (std::string const& name : report.sampled_names) {
    auto const known =
        std::find_if(report.summary.begin(), report.summary.end(), [&](Summary const& each) { return each.name == name; });
    table.header.push_back(known == report.summary.end() ? escape(name) : with_unit(name, known->unit));
  }
  for (std::size_t m = 0; m < report.modes.size(); ++m) {
    Mode const& mode = report.modes[m];
    table.rows.push_back(
        {std::to_string(m + 1), pretty_number(significant(mode.share, 3)), pretty_number(significant(mode.log_density, 6))});
    for (double const value : mode.declared) table.rows.back().push_back(pretty_number(significant(value, 4)));
  }
  return paragraph(mode_words(report)) + html(table) +
         paragraph("Share: a mode's fraction of the integral over all modes, each by the Laplace approximation.", "note");
}

}  // namespace sysid
