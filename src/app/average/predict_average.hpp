// `predict` of several fits: the average of their predictions by weights, and their scores beside its own.
#pragma once
#include "app/session/session.hpp"

namespace sysid {

ExitCode run_predict_average(Session& session, Task const& task, PredictTask const& what);

}  // namespace sysid
