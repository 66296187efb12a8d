// Fits and predictions side by side, as text and JSON.
#pragma once
#include <string>
#include <vector>

#include "result/comparison.hpp"

namespace sysid {

struct ReportTable;

/// The fits, whose log Bayes factors are against the best of them, then the predictions, those of the same samples together. A
/// table's caption says which fits have no evidence, or a rough one, a line each.
std::vector<ReportTable> comparison_tables(Comparison const& comparison);
std::string comparison_text(Comparison const& comparison);
std::string comparison_json(Comparison const& comparison);

}  // namespace sysid
