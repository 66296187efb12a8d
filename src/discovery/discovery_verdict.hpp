// The verdict of a discovery: whether the form is decided, how certain the coefficients are, whether the equation holds on other
// rows.
#pragma once
#include <string>
#include <vector>

#include "regression/discovery.hpp"
#include "result/discovery.hpp"
#include "result/finding.hpp"
#include "result/simulation_validation.hpp"

namespace sysid {

/// Whether the leading structure describes the motion to its noise and is more probable than all others together.
bool is_settled(ValidationReport const& validation);

/// What the regression found of an equation, in the light of the simulation: terms that it cannot tell apart, or a residual that is
/// correlated, are a note where simulation compares the structures; `form_undecided` warns where they remain alike. A term that was
/// left out as a combination of others remains a warning where one of these is in the equation: the record shows either.
/// finding: what was made of the concern of an equation; kept: its terms in the leading structure.
void temper_by_form(ValidationReport const& validation, regression::Concern const& concern, std::vector<int> const& kept,
                    Finding& finding);

/// That the record does not decide the form; nothing where it does, or where no structure could be checked.
Findings undecided_form(ValidationReport const& validation);

/// The same of a regression that no simulation has followed: sets of terms that share the probability, where the one that was kept
/// has less than 0.8 of it. Nothing where its selector knows no probabilities. equation: of `found`, in words.
Findings undecided_terms(regression::FoundEquation const& found, DiscoveredEquation const& equation);
/// Of such a regression: a term left out because others make it up is a note, unless all of these are kept.
void temper_by_terms(regression::Concern const& concern, std::vector<int> const& kept, Finding& finding);

/// That an equation with terms which the dictionary lacks is as probable; a note where it describes the record less well. Nothing
/// where none is, or where no structure could be checked.
Findings other_terms(ValidationReport const& validation);

/// Findings of one code and severity as one, in the place of the first.
Findings merged(Findings const& findings);

/// "the form is decided (probability 0.98), the coefficients have sds of 0.1 to 2 %, the equation holds on bench.test (...)"; empty
/// where no structure could be checked.
std::string verdict_clauses(ValidationReport const& validation);

}  // namespace sysid
