// Names of members, each parameter of the model once; a vector of parameters is one.
#include "app/fit/hierarchies.hpp"
#include "core/text/without_index.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace sysid {

std::vector<std::string> parameters_of(ParameterSpace const& space, std::vector<MemberCoordinate> const& standardised) {
  std::vector<std::string> names;
  for (MemberCoordinate const& member : standardised) {
    int const parameter = parameter_of(space, member.coordinate);
    std::string const& name = space.model().parameters[static_cast<std::size_t>(parameter)].name;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::vector<std::string> declared_names(std::vector<std::string> const& parameters) {
  std::vector<std::string> names;
  for (std::string const& parameter : parameters) {
    std::string name = without_index(parameter);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

std::string standardised_notice(std::vector<std::string> const& names) {
  bool const one = names.size() == 1;
  return fmt::format("`{}` {} sampled relative to {} (non-centred), because the data determine {} weakly\n",
                     fmt::join(names, "`, `"), one ? "is" : "are", one ? "the population" : "their populations",
                     one ? "it" : "them");
}

void excuse_hierarchies(ParameterSpace const& space, Findings& findings) {
  auto const infos = space.infos();
  for (Finding& each : findings) {
    if (each.code != FindingCode::flat_direction) continue;
    std::size_t members = 0;
    bool proper = true;
    for (std::string const& name : each.names) {
      auto const info = std::find_if(infos.begin(), infos.end(), [&](ParameterInfo const& known) { return known.name == name; });
      if (info == infos.end()) continue;  // an unknown function
      int const parameter = parameter_of(space, static_cast<int>(info - infos.begin()));
      proper = proper && info->improper == Improper::no;
      members += is_standardised(space.model(), space.model().parameters[static_cast<std::size_t>(parameter)]);
    }
    if (members == 0 || members == each.names.size() || !proper) continue;
    each.severity = Severity::note;
    each.message += "; only their priors separate them, as is usual in a hierarchy `mean + spread*z`";
    each.help = "nothing: the data determine `mean + spread*z` of each experiment; to see its posterior, write it with `derive`";
  }
}

}  // namespace sysid
