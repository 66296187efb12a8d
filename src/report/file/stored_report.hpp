// A task's folder of results back to its report: what `write_result` wrote, read.
#pragma once
#include <filesystem>

#include "result/report.hpp"

namespace sysid {

/// Of a folder with a whole result. Densities of priors are left out: they follow from `PriorInfo::numbers`. IoError where a file
/// is missing or cannot be read; UserError where one is damaged, or the result is of a program that kept no record.
Report read_result(std::filesystem::path const& folder);

}  // namespace sysid
