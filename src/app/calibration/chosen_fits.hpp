// The fit tasks that `calibrate` and `crosscheck` work on: all of a file, or the one of --task.
#pragma once
#include <string>
#include <vector>

#include "app/session/session.hpp"

namespace sysid {

/// Indices of all fit tasks, or of the one of this name. verb: for messages. UserError where there is none, or where the task of
/// that name is no fit.
std::vector<int> chosen_fits(Session const& session, std::string const& task, std::string const& verb);

}  // namespace sysid
