// One row for each kind of concern.
#include "discovery/discovery_findings.hpp"

#include <string_view>
#include <utility>

#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

struct Row {
  regression::Concern::Kind kind;
  Severity severity;
  FindingCode code;
  std::string_view help;
};

using Kind = regression::Concern::Kind;

constexpr Row rows[] = {
    {Kind::not_measured, Severity::error, FindingCode::not_measured,
     "measure it, leave out the terms that need it, or use `derivatives = weak`"},
    {Kind::unequal_steps, Severity::error, FindingCode::unequal_steps,
     "if it was sampled regularly, write `step` or `rate` in place of `time` in the data block; otherwise resample it to equal "
     "steps"},
    {Kind::too_few_rows, Severity::error, FindingCode::too_few_rows, "use a longer record, or fewer terms"},
    {Kind::at_rest, Severity::error, FindingCode::record_at_rest,
     "use rows in which it moves, or check that the column is the right one"},
    {Kind::nothing_to_explain, Severity::error, FindingCode::nothing_to_explain, "check `target` and the columns that it uses"},
    {Kind::nothing_left, Severity::error, FindingCode::no_term_left, "add terms that vary on this record"},
    {Kind::always_zero, Severity::warning, FindingCode::term_always_zero,
     "use a record in which it varies, to find out whether it is needed"},
    {Kind::not_finite, Severity::warning, FindingCode::term_not_finite, "leave it out, or guard it: `if y > 0 then log(y) else 0`"},
    {Kind::repeats, Severity::note, FindingCode::terms_repeat, ""},
    {Kind::collinear, Severity::warning, FindingCode::terms_collinear,
     "exclude one of them, or use a record with another kind of motion"},
    {Kind::nearly_collinear, Severity::warning, FindingCode::terms_nearly_collinear,
     "their coefficients are nearly confounded: exclude one, or use a record with another kind of motion"},
    {Kind::interchangeable, Severity::warning, FindingCode::terms_interchangeable,
     "use a record of another amplitude, which may distinguish them; `candidates = yes` writes a model for each"},
    {Kind::unexplained, Severity::warning, FindingCode::unexplained_residual,
     "look for an input that was not recorded or a state that is missing, or add terms"},
    {Kind::correlated, Severity::warning, FindingCode::residual_correlated,
     "use a longer record, or add the terms that are missing: the sds are underestimated and the probabilities overconfident"},
    {Kind::not_white, Severity::warning, FindingCode::residual_correlated,
     "add lags or terms, or allow a longer moving average: `spike_slab(moving_average = 8)`; until then the coefficients are "
     "biased"},
    {Kind::short_runs, Severity::warning, FindingCode::residual_correlated,
     "use a part of the record without gaps: if the noise is correlated, the coefficients are biased"},
    {Kind::input_left, Severity::warning, FindingCode::input_in_residuals,
     "add that lag of the input to the terms, or that power of it: until then the coefficients are biased"},
    {Kind::outside_better, Severity::warning, FindingCode::other_terms_fit,
     "the equation only imitates what the dictionary lacks: add terms in the samples that this one reads, such as higher powers or "
     "functions of them, and run again"},
    {Kind::explains_nothing, Severity::warning, FindingCode::unexplained_residual,
     "add terms or lags, or use a record in which the target depends on them more clearly"},
    {Kind::other_rule, Severity::warning, FindingCode::input_rule,
     "if the input followed that rule, write it in the data block and run again: the present terms and coefficients may be wrong"},
    {Kind::smoothed, Severity::note, FindingCode::derivative_smoothed,
     "if its accuracy matters, measure that derivative or leave the term out"},
    {Kind::missing, Severity::note, FindingCode::windows_missing, ""},
    {Kind::no_convergence, Severity::warning, FindingCode::selection_not_settled,
     "look for terms that can replace each other, and exclude some of them"},
};

}  // namespace

Finding finding_of(regression::Concern const& concern, std::string const& equation, std::vector<std::string> names) {
  for (Row const& row : rows)
    if (row.kind == concern.kind)
      return {row.code, row.severity, std::move(names), (equation.empty() ? "" : equation + ": ") + concern.clause,
              std::string(row.help)};
  throw InternalError("a concern without a finding");
}

}  // namespace sysid
