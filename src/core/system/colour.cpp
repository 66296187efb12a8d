// Reads the environment, since a terminal does not report whether it has colours.
#include "core/system/colour.hpp"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace sysid {

bool coloured_messages() {
  auto const variable = [](char const* name) {
    char const* value = std::getenv(name);
    return std::string_view(value == nullptr ? "" : value);
  };
  return variable("NO_COLOR").empty() && variable("TERM") != "dumb" && isatty(STDERR_FILENO) != 0;
}

}  // namespace sysid
