// `select` and `predict` of a selection.
#pragma once
#include "app/session/session.hpp"

namespace sysid {

ExitCode run_select(Session& session, int index, Task const& task, SelectTask const& what);
/// With a back end that sees likelihoods.
ExitCode run_select_by_likelihood(Session& session, int index, Task const& task, SelectTask const& what);
/// Of a selection: each candidate's particles as often as it is probable, the tutorial's (8.8).
ExitCode run_predict_selection(Session& session, Task const& task, PredictTask const& what);

}  // namespace sysid
