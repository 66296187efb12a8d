// As the XDG base directory specification has it.
#include "repl/state.hpp"

#include <cstdlib>
#include <string_view>

namespace sysid::repl {

std::filesystem::path state_folder() {
  auto const variable = [](char const* name) {
    char const* value = std::getenv(name);
    return std::string_view(value == nullptr ? "" : value);
  };
  std::filesystem::path folder;
  if (std::string_view const state = variable("XDG_STATE_HOME"); state.starts_with('/'))
    folder = std::filesystem::path(state) / "sysid";
  else if (!variable("HOME").empty())
    folder = std::filesystem::path(variable("HOME")) / ".local" / "state" / "sysid";
  if (folder.empty()) return folder;
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  return failed ? std::filesystem::path() : folder;
}

}  // namespace sysid::repl
