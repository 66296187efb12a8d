// What the page of every selection begins with and ends with, whichever back end has chosen.
#pragma once
#include "app/selection/candidate.hpp"
#include "app/session/session.hpp"
#include "result/report.hpp"
#include "result/selection.hpp"

namespace sysid {

/// Names in each model the parameters that its arguments take out of it.
void name_absent(std::vector<Candidate> const& candidates, SelectionResult& result);

/// The leading model's report, with its priors, the record and what is to be said of that, and the findings of the back end.
Report begin_selection_report(Session& session, Task const& task, SelectTask const& what, std::vector<Candidate> const& candidates,
                              SelectionReport const& selection, std::uint64_t seed);

/// Draws of the leading model, each a run of the fitted record.
struct LeadingDraws {
  ParameterSpace const& space;  // whose values they are
  LaneArray values;             // [values of the space x draws]
  SolverSettings solver;
  bool with_noise;  // they say how large it is
};

/// Bands over the fitted rows, restoring forces, and whether unknown functions can be believed there.
void add_leading_predictions(Candidate const& leading, LeadingDraws const& draws, std::uint64_t seed,
                             ExecutionOptions const& execution, Report& report);

}  // namespace sysid
