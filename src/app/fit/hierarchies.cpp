// Names of members, each parameter of the model once.
#include "app/fit/hierarchies.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace sysid {
namespace {

std::vector<std::string> parameters_of(ParameterSpace const& space, std::vector<MemberCoordinate> const& standardised) {
  std::vector<std::string> names;
  for (MemberCoordinate const& member : standardised) {
    int const row = space.sampled()[static_cast<std::size_t>(member.coordinate)];
    int const parameter = space.rows()[static_cast<std::size_t>(row)].parameter;
    std::string const& name = space.model().parameters[static_cast<std::size_t>(parameter)].name;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace

std::string names_of(ParameterSpace const& space, std::vector<MemberCoordinate> const& standardised) {
  return fmt::format("{}", fmt::join(parameters_of(space, standardised), ", "));
}

std::string standardised_notice(ParameterSpace const& space, std::vector<MemberCoordinate> const& standardised) {
  std::vector<std::string> const names = parameters_of(space, standardised);
  return fmt::format("`{}` {} sampled relative to {} (non-centred), because the data alone do not determine {} much better\n",
                     fmt::join(names, "`, `"), names.size() == 1 ? "is" : "are",
                     names.size() == 1 ? "its population" : "their populations", names.size() == 1 ? "it" : "them");
}

}  // namespace sysid
