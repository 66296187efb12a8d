// Looks them up by kind and name.
#include "app/calibration/chosen_fits.hpp"

#include <fmt/format.h>

#include <variant>

#include "check/checked/task_kinds.hpp"

namespace sysid {

std::vector<int> chosen_fits(Session const& session, std::string const& name, std::string const& verb) {
  std::vector<int> fits;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < session.file.tasks.size(); ++i) {
    Task const& task = session.file.tasks[i];
    if (task.name == name && kind_of(task) != TaskKind::fit)
      throw UserError({Severity::error,
                       "",
                       fmt::format("`{}` is a {} task: `sysid {}` takes fits", name, verb_of(task), verb),
                       std::nullopt,
                       {},
                       "name a fit task, or leave out --task"});
    if (kind_of(task) != TaskKind::fit) continue;
    names.push_back(task.name);
    if (name.empty() || task.name == name) fits.push_back(static_cast<int>(i));
  }
  if (!fits.empty()) return fits;
  std::string const guess = did_you_mean(name, names);
  if (names.empty())
    throw UserError({Severity::error,
                     "",
                     fmt::format("there is no fit task in {}", session.source.name()),
                     std::nullopt,
                     {},
                     "add one, for example `posterior = fit MODEL to DATA with mh`"});
  throw UserError({Severity::error,
                   "",
                   fmt::format("there is no fit task `{}` in {}", name, session.source.name()),
                   std::nullopt,
                   {},
                   guess.empty() ? fmt::format("fit tasks: {}", fmt::join(names, ", ")) : guess});
}

}  // namespace sysid
