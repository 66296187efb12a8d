// What an average adds to pages: weights and scores of its members, and where its variance comes from.
#pragma once
#include "result/report.hpp"

namespace sysid {

/// notes: below the first table.
void add_average_tables(AverageReport const& average, std::vector<std::string> const& notes, std::vector<ReportTable>& tables);

}  // namespace sysid
