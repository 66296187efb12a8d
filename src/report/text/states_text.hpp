// Random states and disturbances, smoothed, as a table.
#pragma once
#include "result/report.hpp"

namespace sysid {

/// Root mean squares along a record, where there are numbers: of the mean, and of the sd.
struct StateSize {
  double rms = 0, sd = 0;
};
StateSize size_of(PredictedQuantity const& quantity);

/// Of all records that have states; no rows where there are none.
ReportTable states_table(Report const& report);

}  // namespace sysid
