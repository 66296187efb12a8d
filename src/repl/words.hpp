// What is typed behind a command, taken apart at its blanks.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sysid::repl {

/// Without the blanks at both ends.
std::string stripped(std::string_view text);
/// What stands between blanks.
std::vector<std::string> words_in(std::string const& text);

}  // namespace sysid::repl
