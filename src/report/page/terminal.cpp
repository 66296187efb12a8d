// Aligned columns under the user's names and units; numbers are rounded to their Monte Carlo error.
#include "report/page/terminal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "diagnostics/scores.hpp"
#include "diagnostics/verdict.hpp"
#include "report/text/report_text.hpp"
#include "report/text/states_text.hpp"
#include "report/text/summary_text.hpp"

namespace sysid {

namespace {

std::string draws_line(Draws const& draws) {
  if (draws.chains.empty()) return "";
  if (draws.is_optimum()) return "optimum, a single point";
  std::size_t const chains = draws.chains.size();
  return fmt::format("{} of {} draws", counted(chains, "chain"), draws.chains[0].values.size());
}

std::string summary_table(Report const& report) {
  if (report.draws.is_optimum()) {
    std::vector<std::vector<std::string>> rows = {{"", "unit", "optimum", "Laplace sd"}};
    for (Summary const& s : report.summary)
      if (!s.coefficient) rows.push_back({s.name, s.unit, format_summary(s).mean, format_summary(s).sd});
    std::string out = align_columns(rows, 2);
    for (std::string const& each : without_sd_texts(report)) out += each + "\n";
    return out;
  }
  std::vector<std::vector<std::string>> rows = {{"", "unit", "mean", "sd", "q5", "q95", "rhat", "ess_bulk", "ess_tail"}};
  for (Summary const& s : report.summary) {
    if (s.coefficient) continue;
    SummaryText const t = format_summary(s);
    rows.push_back({s.name, s.unit, t.mean, t.sd, t.q5, t.q95, t.rhat, t.ess_bulk, t.ess_tail});
  }
  return align_columns(rows, 2);
}

std::string scores_line(FitLine const& line) {
  std::string out;
  for (Score const& score : line.scores) {
    ScoreUnit const of = row_of(score.name.kind).unit;
    std::string const unit = of == ScoreUnit::percent ? "%" : of == ScoreUnit::of_channel ? line.unit : "";
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", text_of(score.name), significant(score.value, 4));
    if (!unit.empty()) out += fmt::format(" [{}]", unit);
  }
  return out;
}

// Nothing for what has none by its nature.
std::string evidence_line(Report const& report) {
  if (!report.evidence) return "";
  std::string const text = evidence_text(*report.evidence);
  return text.empty() ? "" : text + "\n";
}

// " (first at t = 2.5 s)" in the unit that the records count their time in; nothing where rows have none.
std::string first_time(Report const& report, Failure const& failure) {
  bool const told = !report.predictions.empty();
  if (std::isnan(failure.time) || (told && report.predictions.front().rows)) return "";
  double const scale = told ? report.predictions.front().time_scale : 1;
  return fmt::format(" (first at t = {} {})", significant(failure.time / scale, 4),
                     told ? report.predictions.front().time_unit : std::string("s"));
}

std::string ledger_text(Report const& report) {
  Ledger const& ledger = report.ledger;
  if (ledger.solves() == 0 && ledger.failed() == 0) return "";
  std::string out = fmt::format("{} simulations, {} failed\n", ledger.solves(), ledger.failed());
  for (Failure const& failure : ledger.failures())
    out += fmt::format("  {} x {}: {}{}\n", failure.count, name(failure.kind), failure.where, first_time(report, failure));
  return out;
}

}  // namespace

std::string terminal_summary(Report const& report, Surface read_at) {
  std::string out = report.task;
  if (!report.what.empty()) out += ": " + report.what;
  std::string const draws = draws_line(report.draws);
  out += fmt::format("\n{}{}seed {}\n", draws, draws.empty() ? "" : ", ", report.seed);
  if (!report.summary.empty()) out += "\n" + summary_table(report);
  for (ReportTable const& table : report.tables) {
    std::vector<std::vector<std::string>> rows = {table.header};
    rows.insert(rows.end(), table.rows.begin(), table.rows.end());
    out += fmt::format("\n{}\n{}", table.title, align_columns(rows, 1));
  }
  if (ReportTable const states = states_table(report); !states.rows.empty()) {
    std::vector<std::vector<std::string>> rows = {states.header};
    rows.insert(rows.end(), states.rows.begin(), states.rows.end());
    out += fmt::format("\n{}\n{}", states.title, align_columns(rows, report.states.size() > 1 ? 3 : 2));
  }
  std::string facts;
  for (FitLine const& line : fit_lines(report)) facts += fmt::format("{}: {}\n", line.what(), scores_line(line));
  if (std::string const text = likelihood_text(report); !text.empty()) facts += text + "\n";
  facts += evidence_line(report) + ledger_text(report);
  if (!facts.empty()) out += "\n" + facts;
  if (has_verdict(report))
    out +=
        fmt::format("\nverdict: {}\n{}", verdict_headline(report), findings_list(report.findings, read_at, findings_shown(report)));
  return out;
}

}  // namespace sysid
