// Progress on stderr: on a terminal one bar with rate and time left, redrawn in place; else a plain line now and then.
#pragma once
#include <functional>
#include <string>

#include "core/system/progress.hpp"

namespace sysid {

/// Called by one thread.
class TerminalProgress : public Progress {
 public:
  struct Means {
    bool bar = false;               // a bar redrawn in place, or lines
    int columns = 80;               // width of the terminal
    std::function<double()> clock;  // s, monotonic
    std::function<void(std::string_view)> write;
  };
  /// On stderr: a bar when it is a terminal, lines otherwise.
  TerminalProgress();
  explicit TerminalProgress(Means means);
  ~TerminalProgress() override;

  void begin(std::string_view what, std::uint64_t total) override;
  void expect(std::uint64_t total) override { total_ = total; }
  void advance(std::uint64_t done, std::string_view note) override;
  void end(bool finished = true) override;

 private:
  std::string status(double now) const;

  Means means_;
  std::string what_, note_;
  std::uint64_t total_ = 0, done_ = 0, first_done_ = 0;
  double begun_ = 0, first_time_ = 0, shown_ = 0;
  bool running_ = false, has_first_ = false, visible_ = false;
};

/// "0:07", "12:30", "3:05:00"; no smaller than a second.
std::string format_duration(double seconds);

}  // namespace sysid
