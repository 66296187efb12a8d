// What is kept between sessions: the history of entries, and work that was not saved.
#pragma once
#include <filesystem>

namespace sysid::repl {

/// $XDG_STATE_HOME/sysid, else ~/.local/state/sysid; made when it is not there. Empty where there is no home.
std::filesystem::path state_folder();

}  // namespace sysid::repl
