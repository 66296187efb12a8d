// How well the model describes the measurements: each score with its meaning.
#include "report/page/html_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/number.hpp"
#include "core/text/xml.hpp"
#include "diagnostics/scores.hpp"
#include "report/page/html_words.hpp"

namespace sysid {

namespace {

/// left_out: of a Gaussian process, whose scores are those of samples predicted from the others, but for two.
std::string score_title(ScoreName const& name, bool left_out) {
  char const* const of_these = left_out ? ", leave-one-out" : "";
  switch (name.kind) {
    case ScoreKind::log_score:
      return "log score";
    case ScoreKind::nmse:
      return left_out ? "NMSE of the fit [%]" : "NMSE [%]";
    case ScoreKind::nmse_left_out:
      return "NMSE, leave-one-out [%]";
    case ScoreKind::rmse:
      return fmt::format("RMSE{}", of_these);
    case ScoreKind::coverage_95:
      return fmt::format("share inside the 95 % band{}", of_these);
    case ScoreKind::coverage_3sd:
      return left_out ? "share of the residuals of the fit within 3 sd" : "share within 3 sd";
    case ScoreKind::chi_squared:
      return fmt::format("χ² per sample{}", of_these);
    case ScoreKind::whiteness:
      return "whiteness of the residuals, p";
    case ScoreKind::input_correlation:
      return fmt::format("residuals uncorrelated with {}, p", name.input.empty() ? "the input" : escape(name.input));
  }
  return "";
}

}  // namespace

/// Of one channel with what each score says; of several as a table, and what the worst of each score says behind it.
std::string scores_html(Report const& report) {
  std::vector<FitLine> const lines = fit_lines(report);
  if (lines.empty()) return "";
  std::vector<ScoreName> names;
  for (FitLine const& line : lines)
    for (Score const& score : line.scores)
      if (std::find(names.begin(), names.end(), score.name) == names.end()) names.push_back(score.name);
  auto const is_any_of = [&](auto... kinds) {
    return std::ranges::any_of(names, [&](ScoreName const& each) { return ((each.kind == kinds) || ...); });
  };
  bool const left_out = is_any_of(ScoreKind::nmse_left_out);
  auto const cell = [&](FitLine const& line, ScoreName const& name) {
    auto const score = find_score(line.scores, name);
    if (!score) return std::string();
    ScoreRow const& row = row_of(name.kind);
    if (row.p_value && *score < 1e-4) return std::string("&lt;\u00a00.0001");
    std::string const value = pretty_number(significant(*score, row.p_value ? 2 : 4));
    return row.unit == ScoreUnit::of_channel && !line.unit.empty() ? with_unit(value, line.unit) : value;
  };
  std::string out;
  if (lines.size() == 1) {
    HtmlTable table{fmt::format("Scores of {}", lines[0].what()), {"score", "value", "meaning"}, {}, 1};
    table.last_words = 1;
    for (ScoreName const& name : names)
      table.rows.push_back({score_title(name, left_out), cell(lines[0], name), escape(score_words(report, lines, name))});
    out = html(table);
  } else {
    HtmlTable table{"Scores", {"channel"}, {}, 1};
    for (ScoreName const& name : names) table.header.push_back(score_title(name, left_out));
    for (FitLine const& line : lines) {
      table.rows.push_back({escape(line.what())});
      for (ScoreName const& name : names) table.rows.back().push_back(cell(line, name));
    }
    out = html(table) + "<dl>\n";
    for (ScoreName const& name : names)
      if (std::string const words = score_words(report, lines, name); !words.empty())
        out += fmt::format("<dt>{}</dt><dd>{}</dd>\n", score_title(name, left_out), escape(words));
    out += "</dl>\n";
  }
  bool const with_noise = is_any_of(ScoreKind::coverage_95, ScoreKind::coverage_3sd);
  return out +
         paragraph(
             fmt::format("NMSE: mean squared error as a percentage of the measured variance; RMSE: root mean square error, in the "
                         "channel's unit.{}{}",
                         with_noise ? " Bands include the noise." : "",
                         left_out ? " Leave-one-out: each sample is predicted from the others." : ""),
             "note");
}

}  // namespace sysid
