// The table of advice.
#include "app/fit/advice.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/search/solver_refinement.hpp"
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

bool stiff(FitSituation const& fit) { return fit.scales == nullptr && fit.search != nullptr && fit.search->stiff(); }

void add_stiffness(FitSituation const& fit, Finding& finding) {
  Finding const what = stiff_prior(*fit.search, allow_exact_steps(fit.data, fit.model)).front();
  finding.message += "; " + what.message;
  finding.help = what.help;
}

bool time_apart(FitSituation const& fit) { return fit.scales != nullptr; }

void add_scales(FitSituation const& fit, Finding& finding) {
  finding.message += "; " + fit.scales->message;
  finding.help = fit.scales->help;
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
    {FindingCode::no_finite_start, &integrated, &add_other_solver},
    {FindingCode::no_finite_start, &stiff, &add_stiffness},
    {FindingCode::no_finite_start, &runs_out_of_steps, &add_sticking},
    {FindingCode::step_not_settled, &sticks, &add_sticking},
    {FindingCode::no_finite_start, &time_apart, &add_scales},
    {FindingCode::optimum_not_reached, &runs_out_of_steps, &add_sticking},
};

}  // namespace

void advise(FitSituation const& situation, Finding& finding) {
  for (AdviceRow const& row : reasons)
    if (row.about == finding.code && row.applies(situation)) row.add(situation, finding);
}

}  // namespace sysid
