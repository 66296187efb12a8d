// The command that repeats a result, as text.
#pragma once
#include <string>

#include "app/session/options.hpp"

namespace sysid {

/// As one word of a POSIX shell: in quotes where it would not be one by itself, or would be taken for an option.
std::string quoted_for_shell(std::string const& word);
/// What stands behind `-o` in the command that repeats a run: beside its results, so that the two can be compared.
std::string folder_of_repetition(RunOptions const& options);

}  // namespace sysid
