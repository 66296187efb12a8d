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
  // A prediction takes draws from these without a look at the text they are of.
  fitted.erase(std::string(task));
  selected.erase(std::string(task));
}

}  // namespace sysid::repl
