// Where the numbers of a result come from.
#pragma once
#include "app/experiments.hpp"
#include "report/report.hpp"

namespace sysid {

/// Adds file, digest, rows and columns of one experiment to the report, and what its numbers give to think.
void add_data(CheckedFile const& file, ExperimentData const& data, Model const& model, Report& report);

}  // namespace sysid
