// Predictive scores beside what they would be as a deviance, and in words how far each can be trusted.
#include "report/page/html_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/number.hpp"
#include "core/text/words.hpp"

namespace sysid {

namespace {

std::string tenth(double value) { return std::isfinite(value) ? pretty_number(fmt::format("{:.1f}", value)) : "-"; }

std::vector<std::string> score_row(std::string const& name, LogScore const& score, std::string const& effective) {
  return {name, tenth(score.sum), tenth(score.error), effective, tenth(-2 * score.sum)};
}

/// Of a criterion on the scale of the deviance.
std::vector<std::string> deviance_row(std::string const& name, double value, double effective) {
  return {name, tenth(-value / 2), "", tenth(effective), tenth(value)};
}

std::string rows_text(std::vector<LeftOutBlocks> const& blocks) {
  std::string text;
  for (LeftOutBlocks const& each : blocks)
    if (each.first_row > 0)
      text += fmt::format("{}{} to {}{}", text.empty() ? "" : "; ", each.first_row, each.last_row,
                          blocks.size() > 1 ? " of " + each.experiment : "");
  return text;
}

/// For so many draws: 0.67 of 1000.
std::string limit_text(Criteria const& criteria) { return significant(largest_k(criteria.draws), 2); }

std::string pareto_words(Criteria const& criteria) {
  int const doubtful = criteria.doubtful;
  std::string worst;
  if (doubtful > 0)
    worst = fmt::format(", above 1 for {}", criteria.pareto_counts[3]);
  else if (std::isfinite(criteria.worst_k))
    worst = fmt::format(" (largest {})", significant(criteria.worst_k, 2));
  std::string words = fmt::format("Leave-one-out: of {} samples, Pareto’s k is above {} for {}{}. ", criteria.loo->samples,
                                  limit_text(criteria), doubtful, worst);
  if (doubtful > 0)
    words += "The posterior without such a sample lies where there are too few draws; its score is usually too high. ";
  if (criteria.unstable_waic > 0)
    words += fmt::format("WAIC: the log density of {} varies by more than 0.4 among the draws, so use leave-one-out instead. ",
                         counted(criteria.unstable_waic, "sample"));
  return words;
}

/// Which records have no leave-future-out, or one of their later rows only, and why.
std::string future_words(std::vector<LeftOutBlocks> const& futures) {
  std::vector<std::string> short_ones, far;
  for (LeftOutBlocks const& each : futures)
    if (each.asked == 0)
      short_ones.push_back(each.experiment);
    else if (each.first_row == 0)
      far.push_back(each.experiment);
  std::string words;
  auto const on = [&](std::vector<std::string> const& names) { return futures.size() > 1 ? " of " + listed(names) : ""; };
  if (!short_ones.empty()) words += fmt::format("No leave-future-out{}: it needs six scored rows. ", on(short_ones));
  if (!far.empty())
    words += fmt::format(
        "No leave-future-out{}: the posterior from the rows before the last tenth is too far from that of the whole record "
        "(Pareto’s k above 0.7). ",
        on(far));
  bool const partly = std::ranges::any_of(futures, [](LeftOutBlocks const& each) {
    return each.first_row > 0 && each.pareto_k.size() < static_cast<std::size_t>(each.asked);
  });
  if (partly)
    words += fmt::format("Leave-future-out covers only rows {}: for earlier ones Pareto’s k is above 0.7. ", rows_text(futures));
  return words;
}

std::string time_words(Criteria const& criteria, bool measured_past) {
  std::string words =
      "The rows follow one another in time. If one is left out, its neighbours remain, so leave-one-out and WAIC show how well the "
      "model interpolates. Leave-block-out predicts each tenth of the record from the other nine, leave-future-out each of the "
      "last five tenths from the rows before it. ";
  if (measured_past)
    words +=
        "In both, only the parameters are estimated from those rows: each sample is predicted one step ahead, from the measured "
        "samples before it. ";
  words += "The standard errors assume independent samples; if residuals are correlated, they are too small. ";
  if (!all_reached(criteria.blocks, criteria.draws))
    words +=
        fmt::format("Leave-block-out: Pareto’s k of a block is above {}, and its score is not reliable. ", limit_text(criteria));
  return words + future_words(criteria.futures);
}

std::string none_words(Criteria const& criteria) {
  return criteria.reason.empty() ? "" : fmt::format("No predictive scores: {}.", criteria.reason);
}

}  // namespace

std::string criteria_html(Report const& report) {
  if (!report.criteria) return "";
  Criteria const& criteria = *report.criteria;
  HtmlTable table{"Expected accuracy on new samples",
                  {"criterion", "log score [nats]", "standard error", "effective parameters", "−2 log score"},
                  {},
                  1};
  if (criteria.loo) table.rows.push_back(score_row("leave-one-out (PSIS-LOO)", *criteria.loo, tenth(criteria.p_loo)));
  if (criteria.block) table.rows.push_back(score_row("leave-block-out", *criteria.block, ""));
  if (criteria.future)
    table.rows.push_back(score_row(fmt::format("leave-future-out, rows {}", rows_text(criteria.futures)), *criteria.future, ""));
  if (criteria.waic) table.rows.push_back(score_row("WAIC", *criteria.waic, tenth(criteria.p_waic)));
  if (auto const& deviance = criteria.deviance) {
    if (auto const p_d = deviance->p_d())
      table.rows.push_back(deviance_row("DIC, by the mean of the draws", deviance->mean + *p_d, *p_d));
    table.rows.push_back(deviance_row("DIC, by the variance of the deviance", deviance->mean + deviance->p_v(), deviance->p_v()));
  }
  if (auto const& mode = criteria.at_mode) {
    std::string const at = mode->of_likelihood ? "" : " at the posterior’s mode";
    table.rows.push_back(deviance_row("AIC" + at, mode->aic(), mode->parameters));
    table.rows.push_back(deviance_row("BIC" + at, mode->bic(), mode->parameters));
  }
  if (table.rows.empty()) return paragraph(none_words(criteria), "note");
  std::string const out = html(table);
  if (!criteria.loo) return out + paragraph(none_words(criteria), "note");
  return out + paragraph((criteria.in_time ? time_words(criteria, report.measured_past) : "") + pareto_words(criteria)) +
         paragraph(
             fmt::format("A log score is a sum of log densities of samples, each predicted without having been used ({} draws); "
                         "larger is better. It is meaningful only in comparison with another model of the same samples "
                         "(`sysid compare`).",
                         criteria.draws),
             "note");
}

}  // namespace sysid
