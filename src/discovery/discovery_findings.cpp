// One row for each kind of concern.
#include "discovery/discovery_findings.hpp"

#include <string_view>

#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

struct Row {
  regression::Concern::Kind kind;
  Severity severity;
  std::string_view code, help;
};

using Kind = regression::Concern::Kind;

constexpr Row rows[] = {
    {Kind::not_measured, Severity::error, "not_measured",
     "measure it, leave out the terms that need it, or take `derivatives = weak`"},
    {Kind::unequal_steps, Severity::error, "unequal_steps", "bring the record to equal steps"},
    {Kind::too_few_rows, Severity::error, "too_few_rows", "take a longer record, or fewer terms"},
    {Kind::at_rest, Severity::error, "record_at_rest", "take rows in which it moves, or look whether the column is the right one"},
    {Kind::nothing_to_explain, Severity::error, "nothing_to_explain", "look at `target` and at the columns that it reads"},
    {Kind::nothing_left, Severity::error, "no_term_left", "give the dictionary terms that move on this record"},
    {Kind::always_zero, Severity::warning, "term_always_zero", "a record in which it moves could tell whether it is needed"},
    {Kind::not_finite, Severity::warning, "term_not_finite", "leave it out, or guard it: `if y > 0 then log(y) else 0`"},
    {Kind::repeats, Severity::note, "terms_repeat", ""},
    {Kind::collinear, Severity::warning, "terms_collinear", "exclude one of them, or take a record that moves in another way"},
    {Kind::nearly_collinear, Severity::warning, "terms_nearly_collinear",
     "their coefficients trade against each other: exclude one, or take a record that moves in another way"},
    {Kind::interchangeable, Severity::warning, "terms_interchangeable",
     "`candidates = yes` writes a model for each; a record of other amplitude may tell them apart"},
    {Kind::unexplained, Severity::warning, "unexplained_residual",
     "look for an input that was not recorded, a state that is missing, or add terms"},
    {Kind::correlated, Severity::warning, "residual_correlated",
     "take sds as too small and probabilities as too sure; a longer record, or the terms that are missing, may tell more"},
    {Kind::smoothed, Severity::note, "derivative_smoothed", "measure that derivative, or leave the term out, if it matters"},
    {Kind::missing, Severity::note, "windows_missing", ""},
    {Kind::no_convergence, Severity::warning, "selection_not_settled", "the dictionary may hold terms that stand for each other"},
};

}  // namespace

Finding finding_of(regression::Concern const& concern, std::string const& equation) {
  for (Row const& row : rows)
    if (row.kind == concern.kind)
      return {row.severity, std::string(row.code), (equation.empty() ? "" : equation + ": ") + concern.clause,
              std::string(row.help)};
  throw InternalError("a concern without a finding");
}

}  // namespace sysid
