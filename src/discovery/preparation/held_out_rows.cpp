// By the rows of parts, as far as they are known before the file is read.
#include "discovery/preparation/held_out_rows.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "experiment/experiments.hpp"

namespace sysid {
namespace {

int last_row(DataPart const& part) { return part.last == 0 ? std::numeric_limits<int>::max() : part.last; }

}  // namespace

std::vector<ExperimentUse> unused_parts(CheckedFile const& file, DiscoverTask const& task, int least) {
  std::vector<ExperimentUse> unused;
  std::set<int> blocks;
  for (ExperimentUse const& use : task.experiments) {
    if (use.part < 0 || !blocks.insert(use.data).second) continue;
    DataBlock const& block = file.data[static_cast<std::size_t>(use.data)];
    for (std::size_t p = 0; p < block.parts.size(); ++p) {
      DataPart const& part = block.parts[p];
      bool const used = std::any_of(task.experiments.begin(), task.experiments.end(), [&](ExperimentUse const& other) {
        if (other.data != use.data || other.part < 0) return other.data == use.data;
        DataPart const& theirs = block.parts[static_cast<std::size_t>(other.part)];
        return part.first <= last_row(theirs) && theirs.first <= last_row(part);
      });
      if (used || last_row(part) - part.first < least) continue;
      ExperimentUse other = use;
      other.part = static_cast<int>(p);
      other.name = data_name(block, other.part);
      unused.push_back(std::move(other));
    }
  }
  return unused;
}

}  // namespace sysid
