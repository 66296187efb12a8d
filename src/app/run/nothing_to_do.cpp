// The example in the message is that of the verb's first task.
#include "app/run/nothing_to_do.hpp"

#include <fmt/format.h>

#include "app/run/task_runners.hpp"

namespace sysid {

std::string nothing_to_do(Source const& source, CheckedFile const& file, std::vector<std::string> const& verbs) {
  TaskKindRow const* const asked = verbs.empty() ? nullptr : find_task_kind(verbs.front());
  TaskKind const kind = asked == nullptr ? TaskKind::fit : asked->kind;
  return fmt::format("there is no {}task in {}\nhelp: add one, for example `{}`\n",
                     verbs.empty() ? std::string() : fmt::format("{} ", fmt::join(verbs, " or ")), source.name(),
                     task_runner(kind).example(file));
}

}  // namespace sysid
