// Commands of a shell and what they say.
#pragma once
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace sysid::testing {

struct Said {
  int exit = 0;
  std::string text;  // standard output and standard error
};

/// A shell's command and what it says.
inline Said said_by(std::string const& command) {
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start " + command);
  Said said;
  std::array<char, 4096> buffer;
  while (std::size_t const count = std::fread(buffer.data(), 1, buffer.size(), pipe)) said.text.append(buffer.data(), count);
  int const status = pclose(pipe);
  said.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return said;
}

}  // namespace sysid::testing
