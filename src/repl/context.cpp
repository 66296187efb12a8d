// Results by task.
#include "repl/context.hpp"

#include <algorithm>

namespace sysid::repl {

Result const* TaskResults::find(std::string_view task) const {
  auto const place = std::find_if(all.begin(), all.end(), [&](Result const& each) { return each.task == task; });
  return place == all.end() ? nullptr : &*place;
}

std::set<std::string> TaskResults::tasks() const {
  std::set<std::string> names;
  for (Result const& each : all) names.insert(each.task);
  return names;
}

void TaskResults::erase(std::string_view task) {
  std::erase_if(all, [&](Result const& each) { return each.task == task; });
}

}  // namespace sysid::repl
