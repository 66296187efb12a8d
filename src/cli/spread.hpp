// Work that all processes of an mpirun do together.
#pragma once
#include <functional>

#include "cli/messages.hpp"

namespace sysid::cli {

/// Joins the other processes where there are some, and does the work with them: the first alone prints, and its exit code is that
/// of the work; threads that are not asked for by number are divided among those of a node. Else as `work`.
ExitCode among_ranks(Messages const& messages, int& threads, std::function<ExitCode()> const& work);

}  // namespace sysid::cli
