// The program, asked in a folder of its own.
#pragma once
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "core/system/files.hpp"
#include "said_by.hpp"
#include "temporary_folder.hpp"

namespace sysid::testing {

class Desk {
 public:
  /// `sysid ARGUMENTS`, from this folder.
  Said ask(std::string const& arguments) const {
    return said_by("cd '" + folder_.path().string() + "' && NO_COLOR=1 '" SYSID_PROGRAM "' " + arguments);
  }
  /// The same on a terminal.
  Said ask_on_terminal(std::string const& arguments, unsigned short columns) const {
    winsize size = {40, columns, 0, 0};
    int master = -1;
    pid_t const child = forkpty(&master, nullptr, nullptr, &size);
    if (child == 0) {
      std::string const command = "cd '" + folder_.path().string() + "' && NO_COLOR=1 '" SYSID_PROGRAM "' " + arguments;
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    Said said;
    char buffer[4096];
    for (ssize_t got; (got = read(master, buffer, sizeof buffer)) > 0;) said.text.append(buffer, static_cast<std::size_t>(got));
    std::erase(said.text, '\r');
    int status = 0;
    waitpid(child, &status, 0);
    said.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    close(master);
    return said;
  }
  std::filesystem::path path(std::string const& name) const { return folder_.path() / name; }
  void save(std::string const& name, std::string const& text) const { write_file(path(name), text); }
  bool has(std::string const& name) const { return std::filesystem::exists(path(name)); }

 private:
  TemporaryFolder folder_;
};

/// A line through ten points of bench.csv.
inline std::string const line_model = R"(model line {
  input     u
  parameter slope ~ normal(0, sd = 10)
  observe d ~ normal(slope*u, sd = 0.1)
}
data bench {
  file    "bench.csv"
  input   u = u
  measure d = d
}
posterior = fit line to bench with mh(samples = 60, burn_in = 20, thin = 1, chains = 2), seed = 1
)";

/// With that model, and `more`, as line.sysid beside its data.
class LineDesk : public Desk {
 public:
  explicit LineDesk(std::string const& more = "") {
    save("line.sysid", line_model + more);
    std::string csv = "u,d\n";
    for (int i = 0; i < 10; ++i) csv += std::to_string(i) + "," + std::to_string(2 * i + (i % 3 - 1) * 0.1) + "\n";
    save("bench.csv", csv);
  }
};

}  // namespace sysid::testing
