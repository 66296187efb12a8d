// Rounding by Monte Carlo error.
#include "report/text/summary_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text/number.hpp"

namespace sysid {

SummaryText format_summary(Summary const& s, bool for_page) {
  SummaryText out;
  double largest = 0;
  for (double const v : {s.mean, s.median, s.q5, s.q95})
    if (std::isfinite(v)) largest = std::max(largest, std::fabs(v));
  int const power = largest > 0 ? decade(largest) : 0;
  int const exponent = needs_exponent(power) ? power : 0;
  // The last digit shown is the leading digit of the error: what lies below it is chance.
  double error = std::isfinite(s.mcse_mean) && s.mcse_mean > 0 ? s.mcse_mean : s.sd / 10;
  if (for_page && s.sd > 0) error = std::max(error, s.sd / 100);
  int const decimals = std::isfinite(error) && error > 0 ? exponent - decade(error) : exponent - power + 3;
  auto const location = [&](double v) { return std::isfinite(v) ? with_exponent(v, decimals, exponent) : std::string("-"); };
  // A spread is known to 1/sqrt(2 ess) of itself: two digits.
  auto const spread = [&](double v) {
    if (!std::isfinite(v) || v <= 0) return significant(v, 2);
    // Under the row's power of ten, unless it would read as 20000000e-6 there, or have no digit left.
    int const above = decade(v) - exponent;
    bool const shared = above < 6 && above > -10;
    return shared ? with_exponent(v, exponent - decade(v) + 1, exponent) : significant(v, 2);
  };
  out.mean = location(s.mean);
  out.median = location(s.median);
  out.q5 = location(s.q5);
  out.q95 = location(s.q95);
  out.sd = spread(s.sd);
  out.mad = spread(s.mad);
  out.rhat = std::isfinite(s.rhat) ? fmt::format("{:.3f}", s.rhat) : "-";
  out.ess_bulk = std::isfinite(s.ess_bulk) ? fmt::format("{:.0f}", s.ess_bulk) : "-";
  out.ess_tail = std::isfinite(s.ess_tail) ? fmt::format("{:.0f}", s.ess_tail) : "-";
  return out;
}

std::string mean_and_sd(Summary const& summary) {
  if (!std::isfinite(summary.mean)) return "-";
  if (!std::isfinite(summary.sd) || summary.sd <= 0) return pretty_number(significant(summary.mean, 4));
  int const power = decade(std::max(std::fabs(summary.mean), summary.sd));
  int const exponent = needs_exponent(power) ? power : 0;
  double const unit = std::pow(10.0, exponent);
  int const decimals = std::clamp(exponent - decade(summary.sd) + 1, 0, 15);
  std::string const mean = pretty_number(fmt::format("{:.{}f}", summary.mean / unit, decimals));
  std::string const sd = fmt::format("{:.{}f}", summary.sd / unit, decimals);
  return exponent == 0 ? fmt::format("{} ± {}", mean, sd) : fmt::format("({} ± {})·10{}", mean, sd, superscript(exponent));
}

std::pair<std::string, std::string> coefficient_text(double value, double sd) {
  Summary coefficient;
  coefficient.mean = coefficient.median = coefficient.q5 = coefficient.q95 = value;
  coefficient.sd = sd;
  coefficient.mcse_mean = sd / 10;
  SummaryText const text = format_summary(coefficient);
  return {text.mean, text.sd};
}

}  // namespace sysid
