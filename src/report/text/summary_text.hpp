// A summary of draws as text, rounded to its Monte Carlo error.
#pragma once
#include <string>
#include <utility>

#include "result/summary.hpp"

namespace sysid {

/// The numbers of one row, all with the digits the Monte Carlo error leaves and one exponent, "4.986e9"; a spread of quite another
/// size has its own.
struct SummaryText {
  std::string mean, median, sd, mad, q5, q95, rhat, ess_bulk, ess_tail;
};
/// for_page: no digit below a hundredth of the sd, however well the mean is known, so that columns stay narrow.
SummaryText format_summary(Summary const& summary, bool for_page = false);

/// "1.00004 ± 0.00063", "(5.000 ± 0.033)·10⁹".
std::string mean_and_sd(Summary const& summary);

/// A coefficient and its sd with the digits that the sd leaves.
std::pair<std::string, std::string> coefficient_text(double value, double sd);

}  // namespace sysid
