// Sums of terms.
#include "discovery/found_equation.hpp"

#include <fmt/format.h>

#include <cmath>

#include "report/text/summary_text.hpp"
#include "result/discovery.hpp"

namespace sysid {

std::string equation_text(DictionaryEquation const& equation, std::vector<PrintedTerm> const& terms) {
  std::string sum;
  for (PrintedTerm const& each : terms) {
    DictionaryTerm const& term = equation.terms[each.term];
    if (term.in_target) continue;
    std::string const size = coefficient_text(std::fabs(each.coefficient), each.sd).first;
    std::string const sign = sum.empty() ? (each.coefficient < 0 ? "-" : "") : (each.coefficient < 0 ? " - " : " + ");
    bool const is_sum = term.text.find(" + ") != std::string::npos || term.text.find(" - ") != std::string::npos;
    sum += sign + size + (term.text == "1" ? "" : is_sum ? "*(" + term.text + ")" : "*" + term.text);
  }
  return fmt::format("{} = {}", equation.text, sum.empty() ? "0" : sum);
}

}  // namespace sysid
