// The table of advice.
#include "app/fit/advice.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/session/solver_refinement.hpp"
#include "experiment/sticking.hpp"

namespace sysid {
namespace {

/// One reason that may stand behind a finding of this code.
struct AdviceRow {
  FindingCode about;
  bool (*applies)(FitSituation const&);
  void (*add)(FitSituation const&, Finding&);
};

bool integrated(FitSituation const& fit) { return fit.model.integrated(); }

void add_other_solver(FitSituation const& fit, Finding& finding) {
  if (std::string const advice = solver_advice(fit.solver, fit.ledger); !advice.empty()) finding.help += "; " + advice;
}

bool stiff(FitSituation const& fit) { return fit.search != nullptr && fit.search->stiff(); }

void add_stiffness(FitSituation const& fit, Finding& finding) {
  Finding const what = stiff_prior(*fit.search).front();
  finding.message += "; " + what.message;
  finding.help = what.help;
}

// Where the motion sticks, an error control makes its steps smaller without an end, and of finer solvers there is none either.
bool sticks(FitSituation const& fit) { return !sticking_advice(fit.model, fit.data).empty(); }

bool runs_out_of_steps(FitSituation const& fit) {
  std::vector<Failure> const& places = fit.ledger.failures();
  return sticks(fit) &&
         std::any_of(places.begin(), places.end(), [](Failure const& each) { return each.kind == FailureClass::step_limit; });
}

void add_sticking(FitSituation const& fit, Finding& finding) { finding.help = sticking_advice(fit.model, fit.data); }

// Each that applies is added, in this order: the surest last.
constexpr AdviceRow reasons[] = {
    {FindingCode::no_finite_start, &integrated, &add_other_solver},        {FindingCode::no_finite_start, &stiff, &add_stiffness},
    {FindingCode::no_finite_start, &runs_out_of_steps, &add_sticking},     {FindingCode::step_not_settled, &sticks, &add_sticking},
    {FindingCode::optimum_not_reached, &runs_out_of_steps, &add_sticking},
};

}  // namespace

void advise(FitSituation const& situation, Finding& finding) {
  for (AdviceRow const& row : reasons)
    if (row.about == finding.code && row.applies(situation)) row.add(situation, finding);
}

Findings stiff_prior(SearchSolver const& search) {
  if (!search.stiff()) return {};
  return {{FindingCode::stiff_prior,
           Severity::warning,
           {},
           fmt::format("{:.0f} % of the prior draws overflow even with {}; {} of these were simulated with {}, {} of them without "
                       "failure: the model is stiff there, and the search ignores that part of the prior",
                       100 * search.failed, accuracy(search.solver), search.tried, stiff_solver().name, search.followed),
           fmt::format("fit with `solver = {}`, or narrow the priors if such fast motion is not intended", stiff_solver().name)}};
}

}  // namespace sysid
