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
std::string score_title(std::string const& name, bool left_out) {
  if (left_out && (name == "rmse" || name == "coverage_95" || name == "chi_squared_per_sample"))
    return score_title(name, false) + ", leave-one-out";
  if (left_out && name == "nmse") return "NMSE of the fit [%]";
  if (left_out && name == "coverage_3sd") return "share of the residuals of the fit within 3 sd";
  if (name == "nmse") return "NMSE [%]";
  if (name == "nmse_left_out") return "NMSE, leave-one-out [%]";
  if (name == "rmse") return "RMSE";
  if (name == "log_score") return "log score";
  if (name == "chi_squared_per_sample") return "χ² per sample";
  if (name == "coverage_95") return "share inside the 95 % band";
  if (name == "coverage_3sd") return "share within 3 sd";
  if (name == "whiteness_p") return "whiteness of the residuals, p";
  if (name == "input_correlation_p") return "residuals uncorrelated with the input, p";
  if (name.starts_with("input_correlation_p("))
    return fmt::format("residuals uncorrelated with {}, p", escape(name.substr(20, name.size() - 21)));
  return escape(name);
}

}  // namespace

/// Of one channel with what each score says; of several as a table, and what the worst of each score says behind it.
std::string scores_html(Report const& report) {
  std::vector<FitLine> const lines = fit_lines(report);
  if (lines.empty()) return "";
  std::vector<std::string> names;
  for (FitLine const& line : lines)
    for (Score const& score : line.scores)
      if (std::find(names.begin(), names.end(), score.name) == names.end()) names.push_back(score.name);
  bool const left_out = std::find(names.begin(), names.end(), "nmse_left_out") != names.end();
  auto const cell = [&](FitLine const& line, std::string const& name) {
    auto const score = std::find_if(line.scores.begin(), line.scores.end(), [&](Score const& each) { return each.name == name; });
    if (score == line.scores.end()) return std::string();
    bool const chance = name.starts_with("whiteness_p") || name.starts_with("input_correlation_p");
    if (chance && score->value < 1e-4) return std::string("&lt;\u00a00.0001");
    std::string const value = pretty_number(significant(score->value, chance ? 2 : 4));
    return name.starts_with("rmse") && !line.unit.empty() ? with_unit(value, line.unit) : value;
  };
  std::string out;
  if (lines.size() == 1) {
    HtmlTable table{fmt::format("Scores of {}", lines[0].what()), {"score", "value", "meaning"}, {}, 1};
    table.last_words = 1;
    for (std::string const& name : names)
      table.rows.push_back({score_title(name, left_out), cell(lines[0], name), escape(score_words(report, lines, name))});
    out = html(table);
  } else {
    HtmlTable table{"Scores", {"channel"}, {}, 1};
    for (std::string const& name : names) table.header.push_back(score_title(name, left_out));
    for (FitLine const& line : lines) {
      table.rows.push_back({escape(line.what())});
      for (std::string const& name : names) table.rows.back().push_back(cell(line, name));
    }
    out = html(table) + "<dl>\n";
    for (std::string const& name : names)
      if (std::string const words = score_words(report, lines, name); !words.empty())
        out += fmt::format("<dt>{}</dt><dd>{}</dd>\n", score_title(name, left_out), escape(words));
    out += "</dl>\n";
  }
  bool const with_noise =
      std::any_of(names.begin(), names.end(), [](std::string const& each) { return each.starts_with("coverage"); });
  return out +
         paragraph(
             fmt::format("NMSE: mean squared error as a percentage of the measured variance; RMSE: root mean square error, in the "
                         "channel's unit.{}{}",
                         with_noise ? " Bands include the noise." : "",
                         left_out ? " Leave-one-out: each sample is predicted from the others." : ""),
             "note");
}

}  // namespace sysid
