// What is typed behind a command, taken apart at its blanks.
#pragma once
#include <string>
#include <vector>

namespace sysid::repl {

/// What stands between blanks.
std::vector<std::string> words_in(std::string const& text);

}  // namespace sysid::repl
