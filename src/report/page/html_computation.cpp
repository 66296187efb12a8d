// Whether the computation is reliable: diagnostics of the chains, simulations that failed.
#include "report/page/html_parts.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/text/number.hpp"
#include "core/text/xml.hpp"
#include "report/page/html_words.hpp"
#include "report/text/summary_text.hpp"

namespace sysid {

std::string chains_html(Report const& report) {
  std::vector<ChainWords> const words = chain_words(report);
  if (words.empty()) return "";
  std::string out = "<dl>\n";
  for (ChainWords const& each : words)
    out += fmt::format("<dt class=\"{}\">{} {}</dt><dd>{}</dd>\n", each.good ? "good" : "bad", each.good ? "✓" : "✗",
                       escape(each.name), escape(each.words));
  out += "</dl>\n";
  HtmlTable table{"Convergence", {"parameter", "R-hat", "bulk ESS", "tail ESS", "Monte Carlo error of the mean"}, {}, 1};
  for (Summary const& s : report.summary) {
    if (s.coefficient) continue;
    SummaryText const t = format_summary(s);
    table.rows.push_back({with_unit(s.name, s.unit), t.rhat, t.ess_bulk, t.ess_tail, pretty_number(significant(s.mcse_mean, 2))});
  }
  return out + html(table) +
         paragraph("Rank-normalised split R-hat and effective sample sizes (ESS) as defined by Vehtari et al. (2021).", "note");
}

std::string simulations_html(Report const& report) {
  std::string out = paragraph(ledger_words(report));
  if (report.ledger.failures().empty()) return out;
  std::string unit = "s";
  double scale = 1;
  if (!report.predictions.empty()) unit = report.predictions.front().time_unit, scale = report.predictions.front().time_scale;
  HtmlTable table{"Failures by kind and place", {"kind", "where", "count", fmt::format("first at t [{}]", escape(unit))}, {}, 2};
  bool const timed = report.predictions.empty() || !report.predictions.front().rows;
  if (!timed) table.header.pop_back();
  for (Failure const& failure : report.ledger.failures()) {
    table.rows.push_back({escape(name(failure.kind)), escape(failure.where), std::to_string(failure.count),
                          std::isnan(failure.time) ? "" : pretty_number(significant(failure.time / scale, 4))});
    if (!timed) table.rows.back().pop_back();
  }
  return out + html(table);
}

}  // namespace sysid
