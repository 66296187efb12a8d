// Ranks that do not lead print nothing, but what they would have printed is kept: where one of them alone fails, it has the reason.
#include "cli/spread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <iostream>
#include <optional>
#include <sstream>
#include <streambuf>

#include "core/ranks/ranks.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"

namespace sysid::cli {
namespace {

/// Takes all there is.
class Nowhere : public std::streambuf {
  int overflow(int c) override { return traits_type::not_eof(c); }
  std::streamsize xsputn(char const*, std::streamsize count) override { return count; }
};

/// Takes the place of both outputs while it lives.
class Muted {
 public:
  Muted() : out_(std::cout.rdbuf(&nowhere_)), errors_(std::cerr.rdbuf(&said_)) {}
  ~Muted() {
    std::cout.rdbuf(out_);
    std::cerr.rdbuf(errors_);
  }
  Muted(Muted const&) = delete;
  Muted& operator=(Muted const&) = delete;
  std::string said() const { return said_.str(); }

 private:
  Nowhere nowhere_;
  std::stringbuf said_;
  std::streambuf *out_, *errors_;
};

ExitCode unjoined(Messages const& messages, ranks::Unjoined const& unjoined) {
  if (!ranks::launched().first_on_node) return ExitCode::io;
  Diagnostics diagnostics;
  diagnostics.add({Severity::error,
                   "E6213",
                   "started as one of several processes, but they cannot find each other: " + unjoined.why,
                   std::nullopt,
                   {},
                   unjoined.help});
  messages.show(diagnostics, Source("sysid", ""));
  return ExitCode::io;
}

/// Without the name of the program, as one would type them, about.
std::string arguments() {
  std::string text = read_file("/proc/self/cmdline");
  text.erase(0, std::min(text.size(), text.find('\0') + 1));
  if (!text.empty()) text.pop_back();
  std::replace(text.begin(), text.end(), '\0', ' ');
  return text;
}

/// What ranks must have alike before they read a file: where they have not, it is said.
bool started_alike(Messages const& messages) {
  auto const other = ranks::difference({{"the version", SYSID_VERSION}, {"the arguments", arguments()}});
  if (!other) return true;
  Diagnostics diagnostics;
  diagnostics.add({Severity::error,
                   "E6215",
                   other->place == 0
                       ? fmt::format("{} is sysid {}, rank 0 is sysid {}", other->who, other->other.made_of, other->leading.made_of)
                       : fmt::format("{} was started with other arguments than rank 0: `{}`, not `{}`", other->who,
                                     other->other.made_of, other->leading.made_of),
                   std::nullopt,
                   {},
                   other->place == 0 ? "install the same version on all nodes" : "start all ranks by one command"});
  messages.show(diagnostics, Source("sysid", ""));
  return false;
}

}  // namespace

ExitCode among_ranks(Messages const& messages, int& threads, std::function<ExitCode()> const& work) {
  if (ranks::launched().size < 2) return work();
  heed_signal(SIGUSR1);  // mpirun passes it on and kills nobody
  try {
    ranks::join();
  } catch (ranks::Unjoined const& reason) {
    return unjoined(messages, reason);
  }
  if (threads == 0) threads = ranks::threads();
  std::optional<Muted> muted;
  if (!ranks::leads()) muted.emplace();
  bool parted = false;
  auto code = ExitCode::internal;
  try {
    code = started_alike(messages) ? work() : ExitCode::usage;
  } catch (ranks::Parted const& others) {
    parted = true;
    code = static_cast<ExitCode>(others.code);
  }
  return static_cast<ExitCode>(ranks::end(static_cast<int>(code), muted ? muted->said() : "", parted));
}

}  // namespace sysid::cli
