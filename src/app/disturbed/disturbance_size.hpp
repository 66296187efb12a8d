// How large a disturbance may be: as large as what moves the equations of a fit along its record.
#pragma once
#include <filesystem>
#include <vector>

#include "app/disturbed/changed_file.hpp"
#include "app/session/session.hpp"

namespace sysid {

/// Of each equation, at draws of the fit whose results are in `results`. `like`: the session of that fit; its file is compiled once
/// more, with the equations' quantities derived. UserError where a fit does not move at all, or the equation has no value.
std::vector<DisturbanceSize> disturbance_sizes(Session& like, Task const& fit, std::filesystem::path const& results,
                                               std::vector<DisturbedEquation> const& equations);

}  // namespace sysid
