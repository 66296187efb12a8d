// A prompt behind a pseudo-terminal, and somebody who types.
#pragma once
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "repl/prompt.hpp"

namespace sysid {

class PseudoTerminal {
 public:
  /// The prompt in `folder`, with results, history and state there.
  explicit PseudoTerminal(std::filesystem::path const& folder, RunOptions options = {}, unsigned short columns = 100) {
    winsize size = {40, columns, 0, 0};
    child_ = forkpty(&master_, nullptr, nullptr, &size);
    if (child_ != 0) return;
    setenv("XDG_STATE_HOME", (folder / "state").c_str(), 1);
    setenv("HOME", folder.c_str(), 1);
    setenv("TERM", "xterm", 1);
    setenv("NO_COLOR", "1", 1);
    setenv("LC_ALL", "C.UTF-8", 1);
    std::filesystem::current_path(folder);
    _exit(repl::run_prompt(options, ""));
  }
  ~PseudoTerminal() {
    if (child_ > 0 && !ended_) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    close(master_);
  }
  PseudoTerminal(PseudoTerminal const&) = delete;
  PseudoTerminal& operator=(PseudoTerminal const&) = delete;

  void type(std::string const& text) const {
    // The prompt is shown before the terminal hands over key by key: nobody types in that moment, or as fast.
    usleep(20000);
    for (std::size_t at = 0; at < text.size();) {
      auto const written = write(master_, text.data() + at, text.size() - at);
      if (written <= 0) return;
      at += static_cast<std::size_t>(written);
    }
  }
  /// What has been shown since the last call, up to and with `text`; all of it, without `text`, when that does not come in time.
  std::string until(std::string const& text, double seconds = 60) {
    auto const end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (shown_.find(text) == std::string::npos && std::chrono::steady_clock::now() < end && more()) {
    }
    auto const found = shown_.find(text);
    std::string const result = shown_.substr(0, found == std::string::npos ? found : found + text.size());
    shown_.erase(0, result.size());
    return result;
  }
  /// Types a line and waits for the next prompt.
  std::string enter(std::string const& line, double seconds = 60) {
    type(line + "\r");
    until("\n", seconds);  // the echo
    return until(prompt, seconds);
  }
  /// The exit code, once the prompt has ended; -1 when it does not.
  int ended(double seconds = 20) {
    auto const end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      more();
      int status = 0;
      if (waitpid(child_, &status, WNOHANG) == child_) {
        ended_ = true;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      }
    }
    return -1;
  }

  static constexpr char const* prompt = "sysid> ";

 private:
  bool more() {
    pollfd wanted = {master_, POLLIN, 0};
    if (poll(&wanted, 1, 50) <= 0) return true;
    char buffer[4096];
    auto const got = read(master_, buffer, sizeof buffer);
    if (got <= 0) return false;
    shown_.append(buffer, static_cast<std::size_t>(got));
    return true;
  }

  int master_ = -1;
  pid_t child_ = -1;
  std::string shown_;
  bool ended_ = false;
};

}  // namespace sysid
