// Channels whose sensor froze or was out of its range for a part of the record.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `sensor_stuck`, a warning, of each channel with a frozen or clipped part among its scored samples
/// (`data/cell/stuck_sensor.hpp`). Counts, and rows without order, are left alone.
Findings find_stuck_sensors(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
