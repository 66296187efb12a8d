// All distributions of the language, in the order `sysid list distributions` prints. A new one is a file and a line of list.hpp.
#include "distribution/rows.hpp"

#include "core/setting/table.hpp"

namespace sysid {

std::span<DistributionRow const> distributions() {
#define CALL_ROW(name) name##_distribution(),
  static DistributionRow const rows[] = {SYSID_DISTRIBUTIONS(CALL_ROW)};
#undef CALL_ROW
  return rows;
}

DistributionRow const* find_distribution(std::string_view name) { return row_named(distributions(), name); }

}  // namespace sysid
